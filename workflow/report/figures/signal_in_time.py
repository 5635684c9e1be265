"""Figure of the report: a press in time, as the amplifier of a device reads it."""

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from solver.units import prefixed
from workflow.language.numbers import label
from workflow.report.figures.style import BLUE, GREY, styled

_SHOWN = ("force", "output")


@styled
def figure(shown: xr.Dataset) -> Figure:
    """Force, and output with its noise, over time: one above the other."""
    drawn, axes = plt.subplots(len(_SHOWN), figsize=(8.4, 3.6), sharex=True)
    for ax, name in zip(axes, _SHOWN, strict=True):
        values = shown[name].values
        size, units = prefixed(float(np.abs(values).max()), str(shown[name].attrs["units"]), 2)
        ax.axhline(0, color=GREY, lw=0.6)
        if name == "output":
            noise = float(shown["noise_output"]) / size
            ax.fill_between(shown["time"], values / size - noise, values / size + noise, color=BLUE, alpha=0.2, lw=0)
        ax.plot(shown["time"], values / size, color=BLUE, lw=1.3)
        ax.set_ylabel(label(name, units, 60))
    axes[-1].set_xlabel("time [s]")
    drawn.align_ylabels(axes)
    return drawn
