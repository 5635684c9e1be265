"""Figures of measurements: published values beside the model, and what read-outs infer, over the truth."""

from collections.abc import Sequence
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from solver.units import prefixed
from workflow.language.factors import FACTORS
from workflow.language.numbers import number
from workflow.report.figures.style import BLUE, GREY, ORANGE, logarithmic, styled

_COLOURS = {"agrees": BLUE, "disagrees": ORANGE, "cannot be told": GREY}
_TICKS = (0.25, 0.5, 1, 2, 4, 8)
_ROW = 0.36  # height of a row in inches
_SHOWN = 150  # cases in the figure
_BY_RATIO = 20  # largest over least value from which an axis is logarithmic


@styled
def figure(rows: Sequence[dict[str, Any]]) -> Figure:
    """Measured values, the model's and those of rivals, each over the measured value of its row; no predictions."""
    rows = [row for row in rows if row["value"]]
    drawing, ax = plt.subplots(figsize=(9.5, 1.1 + _ROW * len(rows)))
    for place, row in enumerate(rows):
        _row(ax, place, row)
    ax.axvline(1, color=GREY, lw=0.6, zorder=0)
    ax.set_xscale("log")
    ax.xaxis.set_major_locator(FixedLocator(_TICKS))
    ax.xaxis.set_minor_locator(NullLocator())
    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: number(value)))
    ax.set_yticks(range(len(rows)), [row["short"] for row in rows])
    ax.set_ylim(len(rows) - 0.4, -0.6)
    ax.set_xlabel("value over the measured one")
    return drawing


def _row(ax: Axes, place: int, row: dict[str, Any]) -> None:
    size, colour = row["value"], _COLOURS[row["verdict"]]
    error = (row["error"] or 0) / size
    ax.barh(place, 2 * error, left=1 - error, height=0.55, color=GREY, alpha=0.3)
    ax.plot([1, 1], [place - 0.28, place + 0.28], color=GREY, lw=1.5)
    for rival in row["rivals"]:
        if rival["value"] > 0:
            ax.plot(rival["value"] / size, place, "x", color=GREY, ms=5)
    filled = colour if row["verdict"] != "cannot be told" else "none"
    for value in row["model"]:
        spread = value["deviation"] / size
        ax.errorbar(value["value"] / size, place, xerr=spread, fmt="o", ms=5, color=colour, mfc=filled, capsize=2)
    ax.annotate(
        row["verdict"], (1.01, place), xycoords=("axes fraction", "data"), va="center", color=colour, fontsize=9
    )


@styled
def readout(tried: xr.Dataset) -> Figure:
    """Intervals over the truth for some of the cases, a panel for each inferred factor."""
    names = [str(name) for name in tried["factor"].values]
    drawn, axes = plt.subplots(1, len(names), figsize=(4.8 * len(names), 3.8), squeeze=False)
    for ax, name in zip(axes.flat, names, strict=True):
        cases = tried.sel(factor=name).isel(case=slice(0, _SHOWN))
        spread = cases["true"].values
        size, units = prefixed(float(np.abs(spread).max()), FACTORS[name].units)
        true, low, high, mean = (cases[key].values / size for key in ("true", "low", "high", "mean"))
        ends = [float(true.min()), float(true.max())]
        ax.plot(ends, ends, color=GREY, lw=0.8)
        ax.vlines(true, low, high, color=BLUE, lw=0.9, alpha=0.7)
        ax.plot(true, mean, ".", ms=4, color=BLUE, label="posterior mean")
        if spread.min() > 0 and spread.max() / spread.min() > _BY_RATIO:
            logarithmic(ax, "x", true)
            logarithmic(ax, "y", true)
        ax.set_xlabel(f"true {name}" + (f" [{units}]" if units else ""))
        ax.set_ylabel(f"inferred {name}" + (f" [{units}]" if units else ""))
        ax.set_title(f"{number(100 * float(tried['coverage'].sel(factor=name)), 3)} % of {tried.sizes['case']} within")
    return drawn
