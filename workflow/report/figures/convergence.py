"""Figure of the report: errors of the independent methods over their effort."""

from collections.abc import Mapping
from itertools import cycle
from typing import Any

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

from workflow.language import numbers
from workflow.report.figures.style import styled

#: Figures of convergence: title, and whether the effort is on a logarithmic axis.
_CONVERGENCE = {
    "collocation_terms": ("collocation, polynomial profiles", False),
    "collocation_circle": ("collocation, the whole circle", False),
    "film_resolution": ("load on a film, default resolution", True),
    "film_elements": ("spectral elements, load on a film", False),
    "film_air": ("spectral elements, voltage of a film in air", False),
    "points": ("spectral elements, a ball on a film", False),
}


@styled
def figure(findings: Mapping[str, Any]) -> Figure:
    """Errors of an independent method over its effort, a panel for each problem: ``curves`` of a group of checks."""
    curves: list[dict[str, Any]] = findings["curves"]
    names = list(dict.fromkeys(curve["figure"] for curve in curves))
    drawing, axes = plt.subplots(1, len(names), figsize=(5.2 * len(names), 4.2), squeeze=False)
    for ax, name in zip(axes.flat, names, strict=True):
        title, logarithmic = _CONVERGENCE[name]
        shown = [curve for curve in curves if curve["figure"] == name]
        for marker, curve in zip(cycle("os^vD<>P"), shown):
            ax.plot(curve["x"], curve["error"], marker=marker, ms=4, lw=1.2, label=curve["label"])
        ax.set_yscale("log")
        if logarithmic:
            ax.set_xscale("log")
        ticks = sorted({x for curve in shown for x in curve["x"]})
        ax.set_xticks(ticks, [numbers.number(x) for x in ticks])
        ax.minorticks_off()
        ax.set_xlabel(shown[0]["effort"])
        ax.set_title(title)
        ax.legend()
    axes[0, 0].set_ylabel("relative error")
    return drawing
