"""Figures of the report: exact fields along the surface and below the punch, while one factor varies."""

from collections.abc import Collection, Sequence
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure

from approximation.arrays import Array
from solver.body import HALF_PLANE
from solver.fields import POINT_FIELDS
from solver.units import prefixed
from workflow.language import titles
from workflow.report.figures.contours import below, grid, said
from workflow.report.figures.style import DISTINCT, GREY, NEAR_EDGE, felt_only, field_label, panels, styled
from workflow.report.svg import INK

#: Fields that the parametric study shows in the paper's order, with symbols and their equations in docs/theory.md.
_SYMBOLS = {
    "contact_pressure": "−σ_yy (1.1)",
    "electric_displacement_y": "D_y (1b)",
    "magnetic_induction_y": "B_y (1c)",
    "stress_xx": "σ_xx (1a)",
    "electric_displacement_x": "D_x (1b)",
    "magnetic_induction_x": "B_x (1c)",
}
#: Fields that are 0 outside the contact.
_INSIDE = (*list(_SYMBOLS)[:3], "electric_displacement", "magnetic_induction")
_ACROSS, _WIDE = 3, 32  # panels in a row, and letters of a label beside one
_THREE = ("low", "middle", "high")


@styled
def fields(slabs: Sequence[xr.Dataset], felt: Collection[str]) -> Figure:
    """Draw felt surface fields of a few cases: the second factor, or the only one, varies, others are in the middle."""
    slabs = [felt_only(slab, felt) for slab in slabs]
    first, *others = (str(dim) for dim in slabs[0]["contact_pressure"].dims if dim != "position")
    if not others:
        whole = xr.concat(slabs, first)
        return _field_panels(_of_three(whole, first), first, _names(whole[first]))
    varied = others[0]
    starts = np.cumsum([0, *(slab.sizes[first] for slab in slabs)])
    sizes = {first: int(starts[-1]), **{name: slabs[0].sizes[name] for name in others[1:]}}
    # categories have no middle: the first of their names
    places = {name: size // 2 if slabs[0][name].dtype.kind in "iuf" else 0 for name, size in sizes.items()}
    holds = int(np.searchsorted(starts, places[first], side="right")) - 1
    chosen = slabs[holds].isel({**places, first: places[first] - starts[holds]})
    held = ", ".join(f"{titles.title(name)} {said(chosen[name])}" for name in places)
    figure = _field_panels(_of_three(chosen, varied), varied, _names(chosen[varied]))
    figure.suptitle(f"one case a curve: {held}", fontsize=9)
    return figure


def _of_three(data: xr.Dataset, varied: str) -> xr.Dataset:
    """Return the cases at the ends and in the middle of a factor; all of a category."""
    if data[varied].dtype.kind not in "iuf":
        return data
    last = data.sizes[varied] - 1
    return data.isel({varied: list(dict.fromkeys((0, last // 2, last)))})


def _names(values: xr.DataArray) -> list[str] | None:
    """Return words for three values of a factor, whose levels are no round numbers; None for other values."""
    if values.dtype.kind not in "iuf" or values.size < len(_THREE):
        return None
    return [f"{word}: {said(values[k], 2)}" for word, k in zip(_THREE, (0, (values.size - 1) // 2, -1), strict=True)]


@styled
def effect(data: xr.Dataset, felt: Collection[str]) -> Figure:
    """Draw the effect of one factor on felt surface fields, and on the pressure over lengths."""
    lengths = _lengths(data)
    data = felt_only(data, felt)
    varied = next(str(dim) for dim in data["contact_pressure"].dims if dim != "position")
    return _field_panels(data, varied, lengths=lengths)


def _lengths(data: xr.Dataset) -> xr.DataArray | None:
    """Return surface positions from the middle of the punch [m]; None where the contacts' ends are unknown."""
    if "contact_radius" in data:
        return data["contact_radius"] * data["position"]
    if "contact_trailing" in data and "contact_leading" in data:
        a, b = data["contact_trailing"], data["contact_leading"]
        return (a - b) / 2 + (a + b) / 2 * data["position"]
    return None


@styled
def interior(data: xr.Dataset) -> Figure:
    """Contours below the punch: a row for each field, on one scale, a column for each value of the factor."""
    across, down = ("x/a", "y/a") if "force" in data.coords else ("(x - c)/h", "y/h")
    figure, axes, varied = grid(data, 2.0, across, down)
    for row, name in zip(axes, data.attrs["fields"].split(), strict=True):
        below(figure, row, [data[name].isel({varied: number}) for number in range(len(row))])
    return figure


def _field_panels(
    data: xr.Dataset, varied: str, names_of_values: list[str] | None = None, lengths: xr.DataArray | None = None
) -> Figure:
    numeric = np.issubdtype(data[varied].dtype, np.number)
    texts = names_of_values or [said(value) for value in data[varied]]
    colours = (
        plt.get_cmap("viridis")(np.linspace(0.0, 0.88, len(texts)))
        if numeric
        else np.array([to_rgba(DISTINCT[number % len(DISTINCT)]) for number in range(len(texts))])
    )
    # the half-plane beside films
    styles = ["--" if text == HALF_PLANE.name else "-" for text in texts]
    colours[[style == "--" for style in styles]] = to_rgba(INK)
    # the page's script shows the id of every part
    looks = [
        {"color": colour, "ls": style, "lw": 1.4, "gid": text}
        for colour, style, text in zip(colours, styles, texts, strict=True)
    ]
    line = "stress_xx" in data
    names = [
        name for name in (_SYMBOLS if line else POINT_FIELDS) if name in data and data[name].any()
    ]  # not what is 0
    figure, axes = panels(len(names) + (lengths is not None), _ACROSS, 10.5, 2.8)
    X = data["position"].values
    for ax, name in zip(axes, names, strict=False):
        curves = data[name].transpose(varied, "position").values
        inside_only = name in _INSIDE
        shown = np.abs(X) < 1 if inside_only else np.abs(X) < np.inf
        regular = shown & (np.abs(np.abs(X) - 1) > NEAR_EDGE)
        size, label = field_label(data[name], float(np.abs(curves[:, regular]).max()), _SYMBOLS.get(name, ""), _WIDE)
        curves = curves / size
        for curve, look in zip(curves, looks, strict=True):
            for part in (X < -1, np.abs(X) < 1, X > 1):  # no line across an edge
                use = part & shown
                if use.any():
                    ax.plot(X[use], curve[use], **look, label=look["gid"] if part[X.size // 2] else None)
        ax.set_ylabel(label)
        _bounded(ax, curves[:, regular])
        for edge in (-1, 1):
            ax.axvline(edge, color=GREY, lw=0.7, ls=":")
        if not inside_only:
            ax.set_xlim(-3, 3)
    if lengths is not None:
        _over_lengths(axes[-1], data["contact_pressure"], lengths, varied, looks)
    for ax in axes[: len(names)][(len(names) - 1) // _ACROSS * _ACROSS :]:
        ax.set_xlabel("X = (x - c)/h   (trailing edge at X = 1)" if line else "r/a")
    handles = axes[0].get_legend_handles_labels()
    figure.legend(*handles, loc="outside right upper", title=titles.title(varied))
    return figure


def _over_lengths(
    ax: Axes, pressure: xr.DataArray, lengths: xr.DataArray, varied: str, looks: Sequence[dict[str, Any]]
) -> None:
    """Draw the pressure below each punch over lengths from its middle."""
    inside = np.abs(pressure["position"].values) < 1
    x = lengths.broadcast_like(pressure).transpose(varied, "position").values[:, inside]
    curves = pressure.transpose(varied, "position").values[:, inside]
    scale, unit = prefixed(float(np.nanmax(np.abs(x))), "m", digits=2)
    size, label = field_label(pressure, float(np.nanmax(np.abs(curves))), _SYMBOLS["contact_pressure"], _WIDE)
    for positions, curve, look in zip(x / scale, curves / size, looks, strict=True):
        ax.plot(positions, curve, **look)
    ax.set_xlabel(f"x [{unit}]")
    ax.set_ylabel(label)
    regular = np.abs(pressure["position"].values[inside]) < 1 - NEAR_EDGE
    _bounded(ax, curves[:, regular] / size)


def _bounded(ax: Axes, curves: Array) -> None:
    """Set the range of an axis by the curves away from the edges: a square-root singularity has no peak."""
    low, high = min(float(curves.min()), 0.0), max(float(curves.max()), 0.0)
    pad = 0.06 * (high - low) or 1.0
    ax.set_ylim(low - pad, high + pad)
