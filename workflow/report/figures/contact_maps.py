"""Figures of contacts in space: maps of the surface, spread over random surfaces, charge over the angle of a cut."""

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from scipy.interpolate import make_interp_spline

from approximation.arrays import Array
from solver.units import prefixed
from workflow.language import numbers, titles
from workflow.report.figures.contours import grid
from workflow.report.figures.style import (
    BLUE,
    ORANGE,
    by_ratio,
    factor_scale,
    field_label,
    logarithmic,
    panels,
    styled,
    ticked,
)  # fmt: skip
from workflow.report.svg import INK

_LEVELS = 16
_ANGLES = 361  # of a drawn curve
_DIMS = ("x", "y")


@styled
def maps(data: xr.Dataset) -> Figure:
    """Contours of a contact: a row for each field, on one scale, a column for each value of the factor."""
    scale, unit = prefixed(float(max(np.abs(data[axis]).max() for axis in _DIMS)), "m", digits=2)
    x, y = (data[axis].values / scale for axis in _DIMS)
    height = float(np.clip(3.0 * np.ptp(y) / np.ptp(x), 1.8, 6.0))
    figure, axes, varied = grid(data, height, f"x [{unit}]", f"y [{unit}]")
    for row, name in zip(axes, data.attrs["fields"].split(), strict=True):
        low, high = (float(np.quantile(data[name], share)) for share in (0.0, 1.0))
        divisor, label = field_label(data[name], max(abs(low), abs(high)))
        levels = np.linspace(low / divisor, high / divisor, _LEVELS)
        for number, ax in enumerate(row):
            chosen = data.isel({varied: number}).transpose("y", "x")
            filled = ax.contourf(x, y, chosen[name] / divisor, levels, cmap="viridis")
            filled.set_rasterized(True)  # a tenth of the bytes of the outlines
            pressure = chosen["contact_pressure"].values
            ax.contour(x, y, pressure, [0.01 * float(pressure.max())], colors=INK, linewidths=0.8)
            ax.grid(visible=False)
        figure.colorbar(filled, ax=list(row), label=label, format=ticked, pad=0.01, shrink=0.9)
    return figure


@styled
def spread(data: xr.Dataset) -> Figure:
    """Quantities of every random surface over one factor, with their mean and the band that holds all of them."""
    names = [str(name) for name in data.data_vars]
    figure, axes = panels(len(names), 3, 10.5, 2.9)
    for ax, name in zip(axes, names, strict=True):
        (varied,) = (str(dim) for dim in data[name].dims if dim != "realisation")
        values = data[varied].values
        scale, unit = factor_scale(varied, values) if values.dtype.kind in "iuf" else (1.0, "")
        x: Array = values / scale if values.dtype.kind in "iuf" else np.arange(float(values.size))
        surfaces = data[name].transpose(varied, "realisation")
        divisor, units = prefixed(float(np.abs(surfaces).max()), str(surfaces.attrs["units"]), digits=2)
        y = surfaces.values / divisor
        ax.fill_between(x, y.min(1), y.max(1), color=BLUE, alpha=0.2, lw=0)
        ax.plot(x, y.mean(1), color=BLUE, lw=1.4)
        ax.plot(x, y, ls="", marker=".", ms=3, color=BLUE, alpha=0.6)
        ax.set_ylabel(numbers.label(titles.title(name), units, 32))
        ax.set_xlabel(numbers.label(titles.title(varied), unit, 32))
        if values.dtype.kind not in "iuf":
            ax.set_xticks(x, [str(value) for value in values])
        elif by_ratio(x):
            logarithmic(ax, "x", x)
    return figure


@styled
def polar(data: xr.Dataset) -> Figure:
    """Size of the charge per force over the angle of a cut, the other factors in their middle."""
    charge = data["charge_per_force"]
    middle = {dim: charge.sizes[dim] // 2 for dim in charge.dims if dim != "cut_angle"}
    curve = charge.isel(middle)
    divisor, units = prefixed(float(np.abs(curve).max()), str(charge.attrs["units"]), digits=2)
    levels = curve["cut_angle"].values
    angle = np.linspace(levels[0], levels[-1], _ANGLES)
    values = make_interp_spline(levels, curve.values / divisor, k=min(3, levels.size - 1))(angle)
    figure, ax = plt.subplots(figsize=(4.6, 4.2), subplot_kw={"projection": "polar"})
    for sign, colour, word in ((1, BLUE, "positive"), (-1, ORANGE, "negative")):
        part = np.where(sign * values >= 0, np.abs(values), np.nan)
        for turn in (0.0, np.pi):  # half a turn later the same cut stands upside down
            ax.plot(angle + turn, part, color=colour, lw=1.6, label=word if not turn else None)
    ax.yaxis.set_major_locator(MaxNLocator(4))
    ax.tick_params(axis="y", labelsize=8)
    ax.set_title(numbers.label(titles.title("charge_per_force"), units, 60))
    ax.legend(loc="lower left", bbox_to_anchor=(-0.15, -0.12))
    return figure
