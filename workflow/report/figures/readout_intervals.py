"""Figure of the report: what read-outs infer, over the truth."""

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from workflow.language.factors import FACTORS
from workflow.language.numbers import number, prefixed
from workflow.report.figures.style import BLUE, GREY, logarithmic, styled

_SHOWN = 150  # cases in the figure
_BY_RATIO = 20  # largest over least value from which an axis is logarithmic


@styled
def figure(tried: xr.Dataset) -> Figure:
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
