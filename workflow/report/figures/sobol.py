"""Figures of the report: which factor matters for which quantity, and how."""

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from workflow.language.numbers import prefixed
from workflow.report.figures.style import BLUE, ORANGE, by_ratio, factor_scale, logarithmic, styled
from workflow.study.categories import parted

_SHOWN = 4
_BAND = 2  # root-mean-square errors on either side of a main effect


@styled
def indices(sensitivity: xr.Dataset) -> Figure:
    """First-order and total Sobol' indices of every output, a panel an input, with their intervals."""
    outputs, inputs = ([str(name) for name in sensitivity[dim].values] for dim in ("output", "input"))
    y = np.arange(len(outputs))
    figure, axes = plt.subplots(
        1, len(inputs), figsize=(2.6 + 1.75 * len(inputs), 0.27 * len(outputs) + 1.2), sharey=True, squeeze=False
    )
    for ax, name in zip(axes.flat, inputs, strict=True):
        one = sensitivity.sel(input=name)
        for key, colour, offset in (("first_order", BLUE, -0.18), ("total", ORANGE, 0.18)):
            values = one[key].values
            ends = np.abs(np.stack([one[f"{key}_low"].values, one[f"{key}_high"].values]) - values)
            label = key.replace("_", " ")
            ax.barh(y + offset, values, 0.36, color=colour, alpha=0.85, label=label)
            ax.errorbar(values, y + offset, xerr=ends, fmt="none", ecolor="black", elinewidth=0.8, capsize=1.5)
        ax.set_title(name.replace("_", " "))
        ax.set_xlim(0, 1.02)
    axes[0, 0].set_yticks(y, [name.replace("_", " ") for name in outputs])
    axes[0, 0].set_ylim(len(outputs) - 0.4, -0.6)
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure


@styled
def main_effects(sensitivity: xr.Dataset, outputs: list[str]) -> Figure:
    """Mean of some outputs given one input, minus the mean over the box, and twice its root-mean-square error."""
    inputs = [str(name) for name in sensitivity["input"].values]
    shown = outputs[:_SHOWN]
    figure, axes = plt.subplots(
        len(shown), len(inputs), figsize=(2.15 * len(inputs), 1.75 * len(shown) + 0.3), sharey="row", squeeze=False
    )
    for row, output in zip(axes, shown, strict=True):
        quantity, kinds = parted(output)
        own = sensitivity.sel(output=output)
        size, units = prefixed(float(np.abs(own["main_effect"]).max()), own["units"].item())
        for ax, name in zip(row, inputs, strict=True):
            _curve(ax, own.sel(input=name), name, size)
        lines = [quantity.replace("_", " "), kinds, f"[{units}]" if units else ""]
        row[0].set_ylabel("\n".join(filter(None, lines)), fontsize=6.5 if kinds else 7.5)
    for ax, name in zip(axes[-1], inputs, strict=True):
        units = factor_scale(name, sensitivity.sel(input=name)["value"].values)[1]
        ax.set_xlabel(name.replace("_", " ") + (f" [{units}]" if units else ""))
    return figure


def _curve(ax: Axes, one: xr.Dataset, name: str, size: float) -> None:
    value, effect = one["value"].values / factor_scale(name, one["value"].values)[0], one["main_effect"].values / size
    reach = _BAND * one["main_effect_std"].values / size
    ax.fill_between(value, effect - reach, effect + reach, color=BLUE, alpha=0.25, lw=0)
    ax.plot(value, effect, color=BLUE, lw=1.4)
    ax.axhline(0, color="black", lw=0.5)
    ax.tick_params(labelsize=7)
    if by_ratio(value):
        logarithmic(ax, "x", value)
