"""Figures of the report, one function each; SVG without date, so that equal data give equal bytes."""

import io
import re
from collections.abc import Sequence
from itertools import cycle
from pathlib import Path
from typing import Any

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from solver.names import EVERY_QUANTITY, FACTORS
from storage.files import write_bytes
from workflow.language import numbers
from workflow.report.figures import hover
from workflow.report.svg import INK, PAPER

Array = NDArray[np.float64]

#: Style of every figure of the report.
STYLE: dict[Any, Any] = {
    "figure.constrained_layout.use": True,
    "font.size": 9,
    "axes.grid": True,
    "grid.alpha": 0.25,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 9.5,
    # no power of ten apart from its ticks: values are scaled by a prefix that stands in the label
    "axes.formatter.limits": (-15, 15),
    "axes.formatter.useoffset": False,
    "legend.frameon": False,
    "legend.fontsize": 8,
    "svg.hashsalt": "meecontact",
    **dict.fromkeys(("text.color", "axes.labelcolor", "axes.edgecolor", "xtick.color", "ytick.color"), INK),
    "hatch.color": INK,
    "hatch.linewidth": 0.5,
    **dict.fromkeys(("figure.facecolor", "axes.facecolor", "savefig.facecolor"), PAPER),
}
_OUTLINE, _DECIMALS = re.compile(rb'\sd="[^"]*"'), re.compile(rb"(\.\d\d)\d+")
styled = mpl.rc_context(STYLE)
_PARITIES = 12  # panels
_NEAR = 0.02  # distance in X from an edge within which a singular field is cut
BLUE, ORANGE, GREY = "#2166ac", "#d95f02", "#8a8a8a"

#: Fields that the parametric study shows, in the paper's order, and how each is scaled and named on its axis.
SHOWN = {
    "contact_pressure": (1e-6, "contact pressure [MPa]"),
    "electric_displacement_y": (1e3, "$D_y$ [mC/m²]"),
    "magnetic_induction_y": (1e3, "$B_y$ [mT]"),
    "stress_xx": (1e-6, "surface $\\sigma_{xx}$ [MPa]"),
    "electric_displacement_x": (1e3, "$D_x$ [mC/m²]"),
    "magnetic_induction_x": (1e3, "$B_x$ [mT]"),
}


def ticked(value: float, _place: int) -> str:
    """A tick of a colour bar."""
    return numbers.number(value, 3)


def by_ratio(values: Array) -> bool:
    """Whether values of a factor are spread by ratio, as those of a logarithmic one are."""
    return bool(values[0] > 0 and not np.allclose(np.diff(values), np.diff(values)[0]))


def factor_scale(name: str, values: Array) -> tuple[float, str]:
    """What to divide a factor by on its axis, and its unit there; a logarithmic axis has powers of ten of its own."""
    if by_ratio(values):
        return 1.0, numbers.raised(FACTORS[name].units)
    return numbers.prefixed(float(np.abs(values).max()), FACTORS[name].units)


def save(figure: Figure, path: Path) -> None:
    """Write a figure as SVG, with what a pointer over it can say; whole or not at all."""
    drawn = io.BytesIO()
    with mpl.rc_context(STYLE):  # the salt of the ids acts while saving
        said = f'<metadata class="hover">{hover.metadata(figure)}</metadata>\n</svg>'.encode()
        figure.savefig(drawn, format="svg", metadata={"Date": None, "Creator": "meecontact"})
    plt.close(figure)
    outlines = _OUTLINE.sub(lambda one: _DECIMALS.sub(rb"\1", one[0]), drawn.getvalue())  # half of the bytes
    write_bytes(path, said.join(outlines.rsplit(b"</svg>", 1)))


@styled
def fields(slabs: Sequence[xr.Dataset]) -> Figure:
    """Surface fields of a few cases: every factor in its middle but the second, or the only one, which varies.

    The slabs are parts of the whole along its first axis; their number does not change the figure.
    """
    first, *others = (str(dim) for dim in slabs[0]["contact_pressure"].dims if dim != "position")
    if not others:
        return _field_panels(xr.concat(slabs, first), first)
    varied = others[0]
    starts = np.cumsum([0, *(slab.sizes[first] for slab in slabs)])
    sizes = {first: int(starts[-1]), **{name: slabs[0].sizes[name] for name in others[1:]}}
    # categories have no middle: the first of their names
    places = {name: size // 2 if name in FACTORS else 0 for name, size in sizes.items()}
    holds = int(np.searchsorted(starts, places[first], side="right")) - 1
    chosen = slabs[holds].isel({**places, first: places[first] - starts[holds]})
    held = ", ".join(f"{name.replace('_', ' ')} {_said(name, chosen[name].item())}" for name in places)
    figure = _field_panels(chosen, varied)
    figure.suptitle(f"one case a curve: {held}", fontsize=9)
    return figure


def _said(factor: str, value: float | str) -> str:
    return value if isinstance(value, str) else numbers.shown(value, FACTORS[factor].units, digits=4)


@styled
def effect(data: xr.Dataset) -> Figure:
    """Effect of one factor on the six surface fields of the paper's parametric study."""
    varied = next(str(dim) for dim in data["contact_pressure"].dims if dim != "position")
    return _field_panels(data, varied)


#: How the interior's fields are scaled and named; the others are shown in their own units.
_INSIDE = {
    "von_mises": (1e-6, "von Mises stress [MPa]"),
    "principal_tension": (1e-6, "largest principal stress [MPa]"),
    "stress_xx": (1e-6, "$\\sigma_{xx}$ [MPa]"),
    "stress_yy": (1e-6, "$\\sigma_{yy}$ [MPa]"),
    "stress_xy": (1e-6, "$\\sigma_{xy}$ [MPa]"),
    "electric_displacement_x": (1e3, "$D_x$ [mC/m²]"),
    "electric_displacement_y": (1e3, "$D_y$ [mC/m²]"),
    "magnetic_induction_x": (1e3, "$B_x$ [mT]"),
    "magnetic_induction_y": (1e3, "$B_y$ [mT]"),
}


@styled
def interior(data: xr.Dataset) -> Figure:
    """Contours below the punch: a row for each field, on one scale, a column for each value of the factor."""
    varied = next(str(dim) for dim in data.dims if dim not in ("x", "y"))
    names, values = data.attrs["fields"].split(), data[varied].values
    size = (3.3 * len(values) + 1.0, 0.4 + 2.0 * len(names))
    figure, axes = plt.subplots(len(names), len(values), figsize=size, squeeze=False, sharex=True, sharey=True)
    for row, name in zip(axes, names, strict=True):
        scale, label = _INSIDE.get(name, (1.0, f"{name.replace('_', ' ')} [{data[name].attrs['units']}]"))
        shown = data[name].transpose(varied, "y", "x").values * scale
        # the edges of a conducting punch are singular: the scale leaves out the topmost percent
        low, high = np.quantile(shown, [0.005, 0.99])
        signed = low < -0.02 * high
        bound = max(abs(low), abs(high)) or 1.0
        levels = bound * np.linspace(-1.0 if signed else 0.0, 1.0, 15)
        for ax, field in zip(row, shown, strict=True):
            filled = ax.contourf(
                data["x"], data["y"], field, levels, cmap="RdBu_r" if signed else "viridis", extend="both"
            )
            filled.set_rasterized(True)  # a tenth of the bytes of the outlines
            ax.plot([-1, 1], [0, 0], color=INK, lw=2.5, solid_capstyle="butt", clip_on=False)
            ax.set_aspect("equal")
            ax.grid(visible=False)
        figure.colorbar(filled, ax=list(row), label=label, format=ticked, pad=0.01, shrink=0.9)
        row[0].set_ylabel("y/h")
    for ax, value in zip(axes[0], values, strict=True):
        ax.set_title(f"{varied.replace('_', ' ')} = {_said(varied, value)}")
    for ax in axes[-1]:
        ax.set_xlabel("(x - c)/h")
    return figure


def _field_panels(data: xr.Dataset, varied: str) -> Figure:
    values = data[varied].values
    numeric = np.issubdtype(values.dtype, np.number)
    colours = (
        plt.get_cmap("viridis")(np.linspace(0.0, 0.88, len(values)))
        if numeric
        else plt.get_cmap("tab10")(np.arange(len(values)) % 10)
    )
    figure, axes = plt.subplots(2, 3, figsize=(10.5, 5.6))
    X = data["position"].values
    for ax, (name, (scale, label)) in zip(axes.flat, SHOWN.items(), strict=True):
        curves = data[name].transpose(varied, "position").values * scale
        inside_only = name in ("contact_pressure", "electric_displacement_y", "magnetic_induction_y")
        shown = np.abs(X) < 1 if inside_only else np.abs(X) < np.inf
        for curve, value, colour in zip(curves, values, colours, strict=False):
            text = _said(varied, value)
            for part in (X < -1, np.abs(X) < 1, X > 1):  # no line across an edge
                use = part & shown
                if use.any():
                    ax.plot(X[use], curve[use], color=colour, lw=1.4, label=text if part[X.size // 2] else None)
        ax.set_ylabel(label)
        _bounded(ax, curves[:, shown & (np.abs(np.abs(X) - 1) > _NEAR)])
        for edge in (-1, 1):
            ax.axvline(edge, color=GREY, lw=0.7, ls=":")
        if not inside_only:
            ax.set_xlim(-3, 3)
    for ax in axes[1]:
        ax.set_xlabel("X = (x - c)/h   (trailing edge at X = 1)")
    handles = axes[0, 0].get_legend_handles_labels()
    figure.legend(*handles, loc="outside right upper", title=varied.replace("_", " "))
    return figure


def _bounded(ax: Axes, curves: Array) -> None:
    """Set the range by the curves away from the edges: a square-root singularity has no peak."""
    low, high = min(float(curves.min()), 0.0), max(float(curves.max()), 0.0)
    pad = 0.06 * (high - low) or 1.0
    ax.set_ylim(low - pad, high + pad)


@styled
def parity(validation: xr.Dataset) -> Figure:
    """Predicted against exact, on cases that the surrogate never saw: the outputs of the largest errors first."""
    names = [str(name) for name in validation.sortby("max_error", ascending=False)["output"].values[:_PARITIES]]
    columns = 6
    rows = -(-len(names) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(11, 2.1 * rows), squeeze=False)
    for ax, name in zip(axes.flat, names, strict=False):
        one = validation.sel(output=name)
        exact, predicted = one["exact"].values, one["predicted"].values
        some = slice(None, None, max(1, exact.size // 400))
        quantity, bracket, kinds = name.partition("[")
        size, units = numbers.prefixed(float(np.abs(exact).max()), EVERY_QUANTITY[quantity].units)
        ends = [float(exact.min()) / size, float(exact.max()) / size]
        ax.plot(ends, ends, color=GREY, lw=0.8)
        ax.plot(exact[some] / size, predicted[some] / size, ".", ms=2.5, color=BLUE, rasterized=True)
        ax.set_title(numbers.label(f"{quantity.replace('_', ' ')} {bracket}{kinds}", units, 24), fontsize=7.5)
        ax.tick_params(labelsize=6.5)
        ax.text(0.04, 0.88, numbers.number(float(one["max_error"]), 2), transform=ax.transAxes, fontsize=7)
    for ax in list(axes.flat)[len(names) :]:
        ax.set_visible(False)
    figure.supxlabel("exact", fontsize=9)
    figure.supylabel("predicted", fontsize=9)
    return figure


@styled
def errors(validation: xr.Dataset) -> Figure:
    """Largest error over range of every output, the baseline beside it, against the tolerance."""
    names = [str(name) for name in validation["output"].values]
    y = np.arange(len(names))
    figure, ax = plt.subplots(figsize=(9, 0.27 * len(names) + 1.1))
    floor = 1e-17
    ax.plot(np.maximum(validation["max_error"], floor), y, "o", color=BLUE, label="Gaussian process, max")
    ax.plot(np.maximum(validation["rmse"], floor), y, "o", mfc="none", color=BLUE, label="its RMS error")
    ax.plot(
        np.maximum(validation["baseline_max_error"], floor), y, "x", color=ORANGE,
        label="tensor Chebyshev interpolation, max",
    )  # fmt: skip
    ax.axvline(validation.attrs["tolerance"], color=GREY, ls="--", lw=1, label="tolerance of the study")
    ax.set_xscale("log")
    ax.set_yticks(y, [name.replace("_", " ") for name in names])
    ax.invert_yaxis()
    ax.set_xlabel("error over range, on exact cases never trained on")
    ax.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=2)
    return figure


#: Figures of convergence: title, and whether the effort is on a logarithmic axis.
_CONVERGENCE = {
    "collocation_terms": ("collocation, polynomial profiles", False),
    "collocation_circle": ("collocation, the whole circle", False),
    "fem_fields": ("finite elements, given tractions", True),
    "fem_contact": ("finite elements, unilateral contact", True),
}


@styled
def convergence(curves: list[dict[str, Any]]) -> Figure:
    """Errors of an independent method over its effort, a panel for each problem."""
    names = list(dict.fromkeys(curve["figure"] for curve in curves))
    figure, axes = plt.subplots(1, len(names), figsize=(5.2 * len(names), 4.2), squeeze=False)
    for ax, name in zip(axes.flat, names, strict=True):
        title, logarithmic = _CONVERGENCE[name]
        shown = [curve for curve in curves if curve["figure"] == name]
        for marker, curve in zip(cycle("os^vD<>P"), shown):
            ax.plot(curve["x"], curve["error"], marker=marker, ms=4, lw=1.2, label=curve["label"])
        ax.set_yscale("log")
        if logarithmic:
            ax.set_xscale("log")
        ticks = sorted({x for curve in shown for x in curve["x"]})
        ax.set_xticks(ticks, [numbers.number(x) for x in ticks])
        ax.minorticks_off()
        ax.set_xlabel(shown[0]["effort"])
        ax.set_title(title)
        ax.legend()
    axes[0, 0].set_ylabel("error against the closed form")
    return figure
