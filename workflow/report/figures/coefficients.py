"""Figure of the report: decay of the Chebyshev coefficients along every factor, the reason for its levels."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from workflow.language import titles
from workflow.report.figures.style import BLUE, GREY, ORANGE, panels, styled

_COLUMNS = 3
_FLOOR = 1e-17


@styled
def figure(validation: xr.Dataset, quantities: Sequence[str]) -> Figure:
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
        for output in slab["output"].values[slab["kinked"].values > 0]:
            ax.semilogy(
                sizes[:, list(slab["output"].values).index(output)], color=ORANGE, lw=1.6, label=f"kinked: {output}"
            )
            ax.legend(loc="lower left")
        ax.axhline(validation.attrs["tolerance"], color=GREY, ls="--", lw=1)
        ax.set_title(f"{titles.title(name)}: {len(sizes)} levels")
        ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    drawing.supxlabel("degree along the factor", fontsize=9)
    drawing.supylabel("largest coefficient over range", fontsize=9)
    return drawing
