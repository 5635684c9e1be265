"""Figures of the report: errors along the exact values, and the errors of every quantity."""

from collections.abc import Sequence

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from solver.names import ALL_QUANTITIES
from workflow.language import numbers
from workflow.report.figures.style import BLUE, GREY, ORANGE, panels, styled
from workflow.study.categories import parted, titled

_PANELS, _POINTS = 3, 150


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
        size, units = numbers.prefixed(float(np.abs(exact).max()), ALL_QUANTITIES[quantity].units)
        off = (predicted - exact)[thinned] / float(np.ptp(exact) or 1.0)
        power = 10.0 ** np.floor(np.log10(np.abs(off).max() or 1.0))
        ax.axhline(0, color=GREY, lw=0.8)
        ax.plot(exact[thinned] / size, off / power, ".", ms=2.5, color=BLUE)
        ax.set_title(numbers.label(titled(name), units, 44), fontsize=8)
        ax.set_ylabel(f"in {numbers.number(power, 1)} of range", fontsize=7)
        ax.tick_params(labelsize=6.5)
    figure.supxlabel("exact value", fontsize=9)
    return figure


@styled
def errors(validation: xr.Dataset, quantities: Sequence[str]) -> Figure:
    """Largest error over range of some outputs, the baseline beside it, against the tolerance."""
    validation = validation.sel(output=list(quantities))
    names = [str(name) for name in validation["output"].values]
    y = np.arange(len(names))
    figure, ax = plt.subplots(figsize=(9, 0.27 * len(names) + 1.1))
    floor = 1e-17
    ax.plot(np.maximum(validation["max_error"], floor), y, "o", color=BLUE, label="Gaussian process, max")
    ax.plot(np.maximum(validation["rmse"], floor), y, "o", mfc="none", color=BLUE, label="its RMS error")
    if "baseline_max_error" in validation:
        ax.plot(
            np.maximum(validation["baseline_max_error"], floor), y, "x", color=ORANGE,
            label="tensor Chebyshev interpolation, max",
        )  # fmt: skip
    ax.axvline(validation.attrs["tolerance"], color=GREY, ls="--", lw=1, label="tolerance of the study")
    ax.set_xscale("log")
    ax.set_yticks(y, [titled(name) for name in names])
    ax.invert_yaxis()
    ax.set_xlabel("error over range, on exact cases never trained on")
    ax.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=2)
    return figure
