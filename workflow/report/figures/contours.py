"""A field below the punch as filled contours: one scale for all that stand side by side."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import FigureBase
from matplotlib.ticker import MaxNLocator

from workflow.report.figures.style import field_label, ticked
from workflow.report.svg import INK

_ROUND = MaxNLocator(18, steps=[1, 2, 2.5, 5, 10])  # levels


def below(
    figure: FigureBase, axes: Sequence[Axes], fields: Sequence[xr.DataArray], where: str = ""
) -> tuple[float, str]:
    """Draw fields over ``x`` and ``y`` with one colour bar, topmost percent cut; return unit's size and label."""
    low, high = np.nanquantile([field.values for field in fields], [0.005, 0.99])
    signed = low < -0.02 * high
    bound = float(max(abs(low), abs(high)))
    size, label = field_label(fields[0], bound, where)
    most = bound / size or 1.0
    levels = _ROUND.tick_values(-most if signed else 0.0, most)
    for ax, field in zip(axes, fields, strict=True):
        x, y, values = field["x"].values, field["y"].values, field.transpose("y", "x").values / size
        filled = ax.contourf(x, y, values, levels, cmap="RdBu_r" if signed else "viridis", extend="both")
        filled.set_rasterized(True)  # a tenth of the bytes of the outlines
        ax.plot([-1, 1], [0, 0], color=INK, lw=2.5, solid_capstyle="butt", clip_on=False)
        ax.set_aspect("equal")
        ax.grid(visible=False)
    figure.colorbar(filled, ax=list(axes), label=label, format=ticked, pad=0.01, shrink=0.9)
    return size, label
