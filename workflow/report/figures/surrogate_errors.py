"""Figures of the surrogate: its errors, the coverage of its intervals, and the decay of its coefficients."""

from collections.abc import Sequence

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from solver.names import ALL_QUANTITIES
from solver.units import prefixed
from surrogate.intervals.distribution import NOMINAL
from workflow.language import numbers, titles
from workflow.report.figures.style import BLUE, GREY, ORANGE, panels, styled
from workflow.study.categories import parted, titled

_PANELS, _POINTS = 3, 150
_COLUMNS = 3
_FLOOR = 1e-17
_COVERAGE_COLUMNS = 4
_TRANSFORMS = {"raw_pit": "PIT, not calibrated", "pit": "PIT, calibrated"}


@styled
def residuals(validation: xr.Dataset, quantities: Sequence[str]) -> Figure:
    """Errors over range of some outputs along the exact values, on cases never trained on: the largest first."""
    validation = validation.sel(output=list(quantities))
    names = [str(name) for name in validation.sortby("max_error", ascending=False)["output"].values[:_PANELS]]
    figure, axes = panels(len(names), len(names), 11, 2.1, 0.3)
    for ax, name in zip(axes, names, strict=True):
        output = validation.sel(output=name)
        exact, predicted = output["exact"].values, output["predicted"].values
        thinned = slice(None, None, max(1, exact.size // _POINTS))
        quantity, _ = parted(name)
        size, units = prefixed(float(np.abs(exact).max()), ALL_QUANTITIES[quantity].units)
        off = (predicted - exact)[thinned] / float(np.ptp(exact) or 1.0)
        power = 10.0 ** np.floor(np.log10(np.abs(off).max() or 1.0))
        ax.axhline(0, color=GREY, lw=0.8)
        ax.plot(exact[thinned] / size, off / power, ".", ms=2.5, color=BLUE)
        ax.set_title(numbers.label(titled(name), units, 44), fontsize=9)
        ax.set_ylabel(f"in {numbers.number(power, 1)} of range", fontsize=8.5)
        ax.tick_params(labelsize=8)
    figure.supxlabel("exact value", fontsize=9)
    return figure


@styled
def errors(validation: xr.Dataset, quantities: Sequence[str]) -> Figure:
    """Largest error over range of some outputs, the baseline beside it, against the tolerance."""
    validation = validation.sel(output=list(quantities))
    names = [str(name) for name in validation["output"].values]
    y = np.arange(len(names))
    figure, ax = plt.subplots(figsize=(9, 0.27 * len(names) + 1.1))
    ax.plot(np.maximum(validation["max_error"], _FLOOR), y, "o", color=BLUE, label="Gaussian process, max")
    ax.plot(np.maximum(validation["rmse"], _FLOOR), y, "o", mfc="none", color=BLUE, label="its RMS error")
    if "baseline_max_error" in validation:
        baseline = np.maximum(validation["baseline_max_error"], _FLOOR)
        ax.plot(baseline, y, "x", color=ORANGE, label="tensor Chebyshev interpolation, max")
    ax.axvline(validation.attrs["tolerance"], color=GREY, ls="--", lw=1, label="tolerance of the study")
    ax.set_xscale("log")
    ax.set_yticks(y, [titled(name) for name in names])
    ax.invert_yaxis()
    ax.set_xlabel("error over range, on exact cases never trained on")
    ax.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=2)
    return figure


@styled
def coefficients(validation: xr.Dataset, quantities: Sequence[str]) -> Figure:
    """Largest coefficient of every output over its range, along every input of the factorial."""
    validation = validation.sel(output=list(quantities))
    along = "axis" if "axis" in validation.dims else "input"  # groups take the place of the inputs
    names = [str(name) for name in validation[along].values]
    drawing, axes = panels(len(names), _COLUMNS, 11, 2.7, sharey=True)
    for ax, name in zip(axes, names, strict=True):
        slab = validation.sel({along: name})
        sizes = slab["coefficient"].transpose("mode", "output").values
        sizes = np.maximum(sizes[~np.isnan(sizes).all(axis=1)], _FLOOR)
        ends = np.nanmin(sizes, axis=1), np.nanmax(sizes, axis=1)
        ax.fill_between(range(len(sizes)), *ends, color=BLUE, alpha=0.25, lw=0)
        ax.semilogy(sizes.max(axis=1), "o-", ms=2.5, color=BLUE, lw=1.6)
        for place in np.flatnonzero(slab["kinked"].values > 0):
            ax.semilogy(sizes[:, place], color=ORANGE, lw=1.6, label=f"kinked: {slab['output'].values[place]}")
            ax.legend(loc="lower left")
        ax.axhline(validation.attrs["tolerance"], color=GREY, ls="--", lw=1)
        ax.set_title(f"{titles.title(name)}: {len(sizes)} levels")
        ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    drawing.supxlabel("degree along the factor", fontsize=9)
    drawing.supylabel("largest coefficient over range", fontsize=9)
    return drawing


@styled
def coverage(validation: xr.Dataset, quantities: Sequence[str]) -> Figure:
    """Coverage in the deciles of every input, and the probability integral transform."""
    validation = validation.sel(output=list(quantities))
    names = [str(name) for name in validation["input"].values]
    drawing, axes = panels(len(names) + len(_TRANSFORMS), _COVERAGE_COLUMNS, 11, 2.6)
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
