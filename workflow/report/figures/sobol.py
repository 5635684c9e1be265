"""Figures of the report: effects of each factor on the quantities, in variance and on average."""

from collections.abc import Sequence

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from solver.units import prefixed
from workflow.language import titles
from workflow.report import ranked
from workflow.report.figures.style import BLUE, by_ratio, factor_scale, logarithmic, styled
from workflow.study.categories import parted

_SHOWN = 4
_STRIDE = 2  # between drawn positions of a curve
_BAND = 2  # root-mean-square errors on either side of a main effect


def indices(sensitivity: xr.Dataset, quantities: Sequence[str], aims: Sequence[str]) -> str:
    """Sobol' indices as tornado charts, of those outputs that a study aims at; see :func:`ranked.sensitivities`."""
    return ranked.draw(ranked.sensitivities(sensitivity.sel(output=list(quantities)), aims))


@styled
def main_effects(sensitivity: xr.Dataset, quantities: Sequence[str], of_interest: Sequence[str]) -> Figure:
    """Mean of some outputs given one input, minus the mean over the box, and twice its root-mean-square error."""
    sensitivity = sensitivity.sel(output=list(quantities))
    inputs = [str(name) for name in sensitivity["input"].values]
    shown = of_interest[:_SHOWN]
    size = (2.15 * len(inputs), 1.75 * len(shown) + 0.3)
    figure, axes = plt.subplots(len(shown), len(inputs), figsize=size, sharex="col", sharey="row", squeeze=False)
    for row, output in zip(axes, shown, strict=True):
        quantity, categories = parted(output)
        output_indices = sensitivity.sel(output=output)
        scale, units = prefixed(float(np.abs(output_indices["main_effect"]).max()), output_indices["units"].item())
        for ax, name in zip(row, inputs, strict=True):
            _curve(ax, output_indices.sel(input=name).isel(position=slice(None, None, _STRIDE)), name, scale)
        lines = [titles.title(quantity), categories, f"[{units}]" if units else ""]
        row[0].set_ylabel("\n".join(filter(None, lines)), fontsize=8 if categories else 9)
    for ax, name in zip(axes[-1], inputs, strict=True):
        units = factor_scale(name, sensitivity.sel(input=name)["value"].values)[1]
        ax.set_xlabel(titles.title(name) + (f" [{units}]" if units else ""))
    return figure


def _curve(ax: Axes, curve: xr.Dataset, name: str, size: float) -> None:
    value = curve["value"].values / factor_scale(name, curve["value"].values)[0]
    effect, reach = curve["main_effect"].values / size, _BAND * curve["main_effect_std"].values / size
    ax.fill_between(value, effect - reach, effect + reach, color=BLUE, alpha=0.25, lw=0)
    ax.plot(value, effect, color=BLUE, lw=1.4)
    ax.axhline(0, color="black", lw=0.5)
    ax.tick_params(labelsize=8)
    if by_ratio(value):
        logarithmic(ax, "x", value)
