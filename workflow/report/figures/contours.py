"""Filled contours of fields: a row for each field, on one scale, a column for each value of a factor."""

from collections.abc import Sequence
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure, FigureBase
from matplotlib.ticker import MaxNLocator

from solver.body import HALF_PLANE
from workflow.language import numbers, titles
from workflow.report.figures.style import field_label, ticked
from workflow.report.svg import INK

_ROUND = MaxNLocator(18, steps=[1, 2, 2.5, 5, 10])  # levels


def said(value: xr.DataArray, digits: int = 3) -> str:
    """Return one value of an axis in words, with the axis' unit: it may be a product of factors."""
    plain = value.item()
    if isinstance(plain, str):
        return plain
    return HALF_PLANE.name if np.isnan(plain) else numbers.shown(plain, value.attrs.get("units", "1"), digits)


def grid(data: xr.Dataset, height: float, across: str, down: str) -> tuple[Figure, Any, str]:
    """Return a figure, its axes (field, value of the factor) of a height in inches, and the factor's name."""
    (varied,) = (str(dim) for dim in data.dims if dim not in ("x", "y"))
    names, values = data.attrs["fields"].split(), data[varied]
    size = (3.3 * values.size + 1.0, 0.4 + height * len(names))
    figure, axes = plt.subplots(len(names), values.size, figsize=size, squeeze=False, sharex=True, sharey=True)
    for row in axes:
        row[0].set_ylabel(down)
    for ax, value in zip(axes[0], values, strict=True):
        ax.set_title(f"{titles.title(varied)} {said(value)}")
    for ax in axes[-1]:
        ax.set_xlabel(across)
    return figure, axes, varied


def below(
    figure: FigureBase, axes: Sequence[Axes], fields: Sequence[xr.DataArray], where: str = ""
) -> tuple[float, str]:
    """Draw fields over ``x`` and ``y`` with one colour bar, topmost percent cut; return unit's size and label."""
    low, high = np.nanquantile([field.values for field in fields], [0.005, 0.99])
    signed = low < -0.02 * high
    bound = float(max(abs(low), abs(high)))
    size, label = field_label(fields[0], bound, where)
    most = bound / size or 1.0
    levels = _ROUND.tick_values(-most if signed else 0.0, most)
    for ax, field in zip(axes, fields, strict=True):
        x, y, values = field["x"].values, field["y"].values, field.transpose("y", "x").values / size
        filled = ax.contourf(x, y, values, levels, cmap="RdBu_r" if signed else "viridis", extend="both")
        filled.set_rasterized(True)  # a tenth of the bytes of the outlines
        ax.plot([-1, 1], [0, 0], color=INK, lw=2.5, solid_capstyle="butt", clip_on=False)
        ax.set_aspect("equal")
        ax.grid(visible=False)
    figure.colorbar(filled, ax=list(axes), label=label, format=ticked, pad=0.01, shrink=0.9)
    return size, label
