"""Data of a figure's axes, stored inside the SVG for the pointer of the page."""

import json
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedFormatter
from numpy.typing import NDArray

from approximation.arrays import Array

_DIGITS = 4
_CURVE = 41  # points of one curve
_GRID = 21  # points a side of a map
_maps: "WeakKeyDictionary[Axes, dict[str, Any]]" = WeakKeyDictionary()


def attach_map(ax: Axes, x: Array, y: Array, values: Array, label: str) -> None:
    """Attach values, (m, n), in the label's unit to a filled contour over x, (n,), and y, (m,), in the axes' units."""
    columns, rows = (_thinned(size, _GRID) for size in (x.size, y.size))
    _maps[ax] = {
        "x": _rounded(x[columns]),
        "y": _rounded(y[rows]),
        "values": [None if np.isnan(value) else value for value in _rounded(values[np.ix_(rows, columns)].ravel())],
        "label": _plain(label),
    }


def metadata(figure: Figure) -> str:
    """Return JSON of every axes of a drawn figure: place (shares, from the top left), scales, curves or map."""
    described = [axes for ax in figure.axes if (axes := _axes(ax)) is not None]
    return json.dumps(described, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c").replace("&", "\\u0026")


def _axes(ax: Axes) -> dict[str, Any] | None:
    curves = []
    for line in ax.lines:
        x, y = _data(line.get_xdata(), line.get_ydata())
        if line.get_transform() == ax.transData and x.size:
            label = str(line.get_gid() or line.get_label())
            indices = _thinned(x.size, _CURVE)
            x, y = x[indices], y[indices]
            curves.append({"label": "" if label.startswith("_") else label, "x": _rounded(x), "y": _rounded(y)})
    if not curves and ax not in _maps:
        return None
    box, named = ax.get_position(), isinstance(ax.yaxis.get_major_formatter(), FixedFormatter)
    return {
        "box": _rounded(np.array([box.x0, 1 - box.y1, box.x1, 1 - box.y0])),
        "x": _scale(ax.get_xlim(), ax.get_xscale(), ax.get_xlabel()),
        "y": _scale(ax.get_ylim(), ax.get_yscale(), ax.get_ylabel() or ax.get_title()),
        "names": [text.get_text() for text in ax.get_yticklabels()] if named else [],
        "curves": curves,
        "map": _maps.get(ax),
    }


def _data(x: Any, y: Any) -> tuple[Array, Array]:
    """Return the finite points of a curve; none of a curve over names."""
    try:
        pair = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
    except (TypeError, ValueError):
        return np.empty(0), np.empty(0)
    finite = np.isfinite(pair[0]) & np.isfinite(pair[1])
    return pair[0][finite], pair[1][finite]


def _scale(limits: tuple[float, float], kind: str, label: str) -> dict[str, Any]:
    return {"limits": _rounded(np.array(limits)), "log": kind == "log", "label": _plain(label)}


def _plain(label: str) -> str:
    """Return a label on one line, without the marks of formulas."""
    return " ".join(label.replace("$", "").replace("\\sigma_{xx}", "σxx").split())


def _thinned(size: int, most: int) -> NDArray[np.intp]:
    """Return evenly spread indices of at most so many values, both ends among them."""
    return np.unique(np.linspace(0, size - 1, min(size, most)).astype(np.intp))


def _rounded(values: Array) -> list[float]:
    return [float(f"{value:.{_DIGITS}g}") for value in np.asarray(values, dtype=np.float64)]
