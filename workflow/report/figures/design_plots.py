"""Figures of one recommended design: map, slices, sensitivities, contact, Pareto front."""

from collections.abc import Callable

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from approximation.arrays import Array
from solver.fields import FIELDS, POINT_FIELDS
from solver.units import prefixed
from workflow.design.search.contact_fields import SURFACE
from workflow.design.verdict.answer import Answer
from workflow.language import titles
from workflow.language.numbers import label
from workflow.report import ranked
from workflow.report.figures.contours import below
from workflow.report.figures.hover import attach_map
from workflow.report.figures.style import (
    BLUE,
    DISTINCT,
    GREY,
    NEAR_EDGE,
    ORANGE,
    by_ratio,
    factor_scale,
    field_label,
    logarithmic,
    panels,
    styled,
    ticked,
)
from workflow.report.svg import INK
from workflow.study.target import Target

_LINE, _SHORT_LINE = 34, 24  # characters of a label beside a map, and beside a slice below its legend
_BESIDE = 0.01  # of a slice: nearer to its design lies nothing but the design itself


def figures_of(answer: Answer, target: Target) -> dict[str, Figure]:
    """Figures of a design by kind; the contact where the answer has its fields."""
    contact = ["contact"] if "position" in answer.pictures.dims else []
    return {kind: _DRAWN[kind](answer) for kind in (*ranked.names(target), *contact) if kind in _DRAWN}


@styled
def _map(answer: Answer) -> Figure:
    """First objective over two design variables, the infeasible region hatched, the exact optimum marked."""
    axes = (answer.pictures["map_x"], answer.pictures["map_y"])
    names = [str(axis.attrs["factor"]) for axis in axes]
    sizes = [factor_scale(name, axis.values)[0] for name, axis in zip(names, axes, strict=True)]
    x, y = (axis.values / size for axis, size in zip(axes, sizes, strict=True))
    figure, ax = plt.subplots(figsize=(5.6, 4.1))
    values, excess = (answer.pictures[f"map_{key}"].values.T for key in ("objective", "excess"))
    size, words = _objective(answer)
    filled = ax.contourf(x, y, values / size, 24, cmap="viridis")
    filled.set_rasterized(True)
    if excess.max() > 0:
        ax.contourf(x, y, excess, [0.0, float(excess.max())], colors="none", hatches=["////"])
        if excess.min() < 0:
            ax.contour(x, y, excess, [0.0], colors="white", linewidths=1.6)
    best = [answer.variable(name).value / size for name, size in zip(names, sizes, strict=True)]
    ax.plot(*([coordinate] for coordinate in best), "*", ms=15, mfc=ORANGE, mec="white", label=_star(answer))
    for name, axis, which in zip(names, axes, ("x", "y"), strict=True):
        _factor_axis(ax, which, name, axis.values)
    attach_map(ax, x, y, values / size, words)
    figure.colorbar(filled, ax=ax, label=words, format=ticked)
    ax.grid(visible=False)
    figure.legend(loc="outside upper left")
    return figure


@styled
def _slices(answer: Answer) -> Figure:
    """The first objective along each variable through the design: as it counts, and its band over the scenarios."""
    slices = answer.pictures
    names = [str(name) for name in slices["slice"].values]
    figure, axes = panels(len(names), len(names), max(2.6 * len(names) + 0.6, 4.6), 3.0, sharey=True)
    size, words = _objective(answer, _SHORT_LINE)
    lowest, highest = float(slices["slice_low"].min()) / size, float(slices["slice_high"].max()) / size
    pad = 0.05 * (highest - lowest)
    ends = (lowest - pad, highest + pad)
    for ax, name in zip(axes, names, strict=True):
        line = slices.sel(slice=name)
        width = factor_scale(name, line["slice_value"].values)[0]
        x, excess = line["slice_value"].values / width, line["slice_excess"].values
        low, high = line["slice_low"].values / size, line["slice_high"].values / size
        ax.fill_between(x, low, high, color=BLUE, alpha=0.18, lw=0, label="all scenarios")
        ax.plot(x, line["slice_objective"].values / size, color=BLUE, lw=1.6, label="as it counts")
        if np.all(excess[np.abs(x - answer.variable(name).value / width) > _BESIDE * np.ptp(x)] > 0):
            ax.set_title("no room: any other value breaks a limit", fontsize=9)
        else:
            ax.fill_between(x, *ends, where=list(excess > 0), facecolor="none", edgecolor=GREY, hatch="////", lw=0,
                            label="breaks a limit")  # fmt: skip
        best = answer.variable(name).value / width
        ax.plot([best], [answer.terms[0].exact / size], "*", ms=13, mfc=ORANGE, mec=INK, mew=0.6,
                label=f"{_star(answer)}, exact")  # fmt: skip
        ax.set_ylim(ends)
        _factor_axis(ax, "x", name, line["slice_value"].values)
    axes[0].set_ylabel(words)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper left", ncols=2)
    return figure


@styled
def _contact(answer: Answer) -> Figure:
    """Exact fields of the contact on the surface, and stresses below it."""
    fields = answer.pictures
    shown_fields = [name for name in SURFACE if f"field_{name}" in fields]
    # no charge enters an insulating punch: D_y is zero all along
    surface = [name for name in shown_fields if name == shown_fields[0] or np.any(fields[f"field_{name}"].values)]
    inside = [name for name in ("von_mises", "stress_xx") if f"inside_{name}" in fields]
    rows = [1, 1.15][: 2 if inside else 1]
    figure = plt.figure(figsize=(10.4, 2.42 * sum(rows)))
    # apart, so that a colour bar below makes no gap above
    above, *under = figure.subfigures(len(rows), 1, height_ratios=rows, squeeze=False)[:, 0]
    X = fields["position"].values
    point = any(name in POINT_FIELDS.keys() - FIELDS.keys() for name in surface)
    along, down = ("r/a", "y/a") if point else ("(x - c)/h", "y/h")
    for name, ax in zip(surface, above.subplots(1, len(surface), squeeze=False).flat, strict=True):
        values = fields[f"field_{name}"].values
        regular = (np.abs(np.abs(X) - 1) > NEAR_EDGE) & (np.abs(X) < 3)
        size, words = field_label(fields[f"field_{name}"].rename(name), float(np.abs(values[regular]).max()))
        for part in (X < -1, np.abs(X) < 1, X > 1):
            ax.plot(X[part], values[part] / size, color=BLUE, lw=1.5)
        ends = np.array([min(values[regular].min(), 0.0), max(values[regular].max(), 0.0)]) / size
        ax.set_ylim(*(ends + np.array([-0.06, 0.06]) * (np.ptp(ends) or 1.0)))
        ax.set_xlim(-3, 3)
        ax.set_title(words)
        ax.set_ylabel("")
        ax.set_xlabel(along)
    for part in under:
        for name, ax in zip(inside, part.subplots(1, len(inside), squeeze=False).flat, strict=True):
            field = fields[f"inside_{name}"].rename(name).transpose("y", "x")
            size, words = below(part, [ax], [field], "below")
            attach_map(ax, field["x"].values, field["y"].values, field.values / size, words)
            ax.set_xlabel(along)
            ax.set_ylabel(down)
    return figure


@styled
def _front(answer: Answer) -> Figure:
    """The exact Pareto front: the first objective against each other one, the compromise marked."""
    front = answer.pictures
    traced = "front" in front.dims  # which no target has that is not reachable
    names = [goal.name for goal in answer.objectives]
    figure, axes = plt.subplots(1, len(names) - 1, figsize=(5.8 * (len(names) - 1) ** 0.7, 4.0), squeeze=False)
    for ax, other in zip(axes.flat, names[1:], strict=True):
        labels, columns, best = [], [], []
        choices = front["front_choice"].values if traced else np.empty(0, dtype=str)
        for name in (names[0], other):
            goal = answer.term(name)
            values = front["front_exact"].sel(objective=name).values if traced else np.array([goal.exact])
            size, units = prefixed(float(np.abs(values).max()), goal.units)
            columns.append(values / size)
            labels.append(label(goal.title, units, 44))
            best.append([goal.exact / size])
        for k, choice in enumerate(dict.fromkeys(choices)):
            of_choice = choices == choice
            # a line would join what another choice lies between
            style = "o-" if len(names) == 2 and of_choice.all() else "o"
            words = f"front, exact: {choice}" if choice else "front, exact"
            x, y = (column[of_choice] for column in columns)
            ax.plot(x, y, style, ms=2.5, lw=1, color=DISTINCT[k % len(DISTINCT)], label=words)
        ax.plot(*best, "*", ms=15, mfc=ORANGE, mec=INK, mew=0.6, label=_star(answer, "compromise"))
        ax.set_xlabel(labels[0])
        ax.set_ylabel(labels[1])
    axes[0, 0].legend()
    return figure


_DRAWN: dict[str, Callable[[Answer], Figure]] = {"map": _map, "slices": _slices, "contact": _contact, "front": _front}


def _star(answer: Answer, kind: str = "design") -> str:
    """Legend of the star in a figure."""
    return f"recommended {kind}" if answer.feasible else "least violated design: not reachable"


def _objective(answer: Answer, most: int = _LINE) -> tuple[float, str]:
    """Divisor of the first objective, and its label in lines of at most ``most`` characters."""
    size, units = prefixed(abs(answer.terms[0].exact), answer.terms[0].units)
    return size, label(f"{answer.statistic} {answer.terms[0].title}", units, most)


def _factor_axis(ax: Axes, which: str, name: str, values: Array) -> None:
    """Scale and label of an axis that is a factor."""
    if by_ratio(values):
        logarithmic(ax, which, values / factor_scale(name, values)[0])
    words = label(titles.title(name), factor_scale(name, values)[1], 40)
    (ax.set_xlabel if which == "x" else ax.set_ylabel)(words)
