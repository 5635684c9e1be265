"""Figures of the report: predicted against exact, and the errors of every quantity."""

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from solver.names import ALL_QUANTITIES
from workflow.language import numbers
from workflow.report.figures.style import BLUE, GREY, ORANGE, styled
from workflow.study.categories import parted

_PARITIES = 12  # panels


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
        quantity, kinds = parted(name)
        size, units = numbers.prefixed(float(np.abs(exact).max()), ALL_QUANTITIES[quantity].units)
        ends = [float(exact.min()) / size, float(exact.max()) / size]
        ax.plot(ends, ends, color=GREY, lw=0.8)
        ax.plot(exact[some] / size, predicted[some] / size, ".", ms=2.5, color=BLUE, rasterized=True)
        ax.set_title(
            numbers.label(" ".join(filter(None, [quantity.replace("_", " "), kinds])), units, 24), fontsize=7.5
        )
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
    if "baseline_max_error" in validation:
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
