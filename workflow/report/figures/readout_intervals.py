"""Figure of the report: what read-outs infer, over the truth."""

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from workflow.language.factors import FACTORS
from workflow.language.numbers import number, prefixed, raised
from workflow.report.figures.style import BLUE, GREY, styled

_SHOWN = 150  # cases in the figure


@styled
def figure(tried: xr.Dataset) -> Figure:
    """Intervals over the truth for some of the cases, a panel for each inferred factor."""
    names = [str(name) for name in tried["factor"].values]
    drawn, axes = plt.subplots(1, len(names), figsize=(4.8 * len(names), 3.8), squeeze=False)
    for ax, name in zip(axes.flat, names, strict=True):
        one = tried.sel(factor=name).isel(case=slice(0, _SHOWN))
        spread = one["true"].values
        logarithmic = bool(spread.min() > 0 and spread.max() / spread.min() > 20)
        units = FACTORS[name].units
        size, units = (1.0, raised(units)) if logarithmic else prefixed(float(np.abs(spread).max()), units)
        true, low, high, mean = (one[key].values / size for key in ("true", "low", "high", "mean"))
        ends = [float(true.min()), float(true.max())]
        ax.plot(ends, ends, color=GREY, lw=0.8)
        ax.vlines(true, low, high, color=BLUE, lw=0.9, alpha=0.7)
        ax.plot(true, mean, ".", ms=4, color=BLUE, label="posterior mean")
        if logarithmic:
            ax.set_xscale("log")
            ax.set_yscale("log")
        ax.set_xlabel(f"true {name}" + (f" [{units}]" if units else ""))
        ax.set_ylabel(f"inferred {name}" + (f" [{units}]" if units else ""))
        ax.set_title(f"{number(100 * float(tried['coverage'].sel(factor=name)), 3)} % of {tried.sizes['case']} within")
    return drawn
