"""Figure of the report: whether the surrogate's intervals hold, before and after calibration."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from surrogate.intervals.distribution import NOMINAL
from workflow.language import titles
from workflow.report.figures.style import BLUE, GREY, ORANGE, panels, styled

_COLUMNS = 4
_TRANSFORMS = {"raw_pit": "PIT, not calibrated", "pit": "PIT, calibrated"}


@styled
def figure(validation: xr.Dataset, quantities: Sequence[str]) -> Figure:
    """Coverage in the deciles of every input, and the probability integral transform."""
    validation = validation.sel(output=list(quantities))
    names = [str(name) for name in validation["input"].values]
    drawing, axes = panels(len(names) + len(_TRANSFORMS), _COLUMNS, 11, 2.6)
    for ax, name in zip(axes, names, strict=False):
        _deciles(ax, validation.sel(input=name), name)
    for ax, (key, title) in zip(axes[len(names) :], _TRANSFORMS.items(), strict=True):
        _transform(ax, validation[key])
        ax.set_title(title)
    return drawing


def _deciles(ax: Axes, output: xr.Dataset, name: str) -> None:
    coverage, decile = output["decile_coverage"].transpose("output", "decile").values, output["decile"].values
    ax.fill_between(decile, coverage.min(axis=0), coverage.max(axis=0), color=BLUE, alpha=0.25, lw=0)
    ax.plot(decile, coverage.min(axis=0), color=ORANGE, lw=1.5, label="least of all quantities")
    ax.axhline(NOMINAL, color=GREY, ls="--", lw=1)
    ax.set_ylim(min(0.84, float(coverage.min()) - 0.01), 1.003)
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    ax.set_title(f"decile of {titles.title(name)}")
    ax.set_ylabel("coverage")
    ax.legend(loc="lower right")


def _transform(ax: Axes, pit: xr.DataArray) -> None:
    share = (np.arange(pit.sizes["case"]) + 0.5) / pit.sizes["case"]
    thinned = slice(None, None, max(1, pit.sizes["case"] // 60))
    rows = np.sort(pit.transpose("output", "case").values, axis=1)[:, thinned]
    ax.fill_between(share[thinned], rows.min(axis=0), rows.max(axis=0), color=BLUE, alpha=0.25, lw=0)
    ax.plot(share[thinned], np.median(rows, axis=0), color=BLUE, lw=1.2, label="median of all quantities")
    ax.plot([0, 1], [0, 1], color=GREY, ls="--", lw=1)
    ax.set_xlabel("share of cases")
