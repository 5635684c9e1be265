"""The surroundings of a design on the surrogate: a map over two variables, and a slice along each with its bands."""

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from workflow.design.question import Question
from workflow.design.sources import Predicted

Array = NDArray[np.float64]

_MAP, _COARSE = 81, 41  # points a side of the map; fewer where every point stands for many draws
_MANY = 128  # scenarios a point from which the map is coarse
_SLICE = 121  # points of a slice
_NORMAL = 1.959964


def landscape(question: Question, x: Array, source: Predicted) -> xr.Dataset:
    """Map and slices of the first objective through a design, (d,) in scaled coordinates.

    Returns
    -------
    xarray.Dataset
        ``map_objective`` and ``map_excess`` (the largest relative excess of all limits) over ``map_x``, ``map_y``, with
        two continuous variables or more; ``slice_value``, ``slice_objective``, ``slice_excess``, and the least and
        largest objective over the scenarios, ``slice_low`` and ``slice_high``, over ``slice``, ``step``.
    """
    return xr.merge([_map(question, x, source), _slices(question, x, source)])


def _map(question: Question, x: Array, source: Predicted) -> xr.Dataset:
    names = list(question.inputs)[:2]
    if len(names) < 2:
        return xr.Dataset()
    count = _MAP if sum(one.count for one in question.searched.values()) < _MANY else _COARSE
    side = np.linspace(-1.0, 1.0, count)
    points = np.tile(x, (count * count, 1))
    points[:, 0], points[:, 1] = (grid.ravel() for grid in np.meshgrid(side, side, indexing="ij"))
    objective, excess = _counted(question, points, source)
    coords: dict[str, Any] = {
        f"map_{axis}": (f"map_{axis}", question.inputs[name].from_unit(side), {"factor": name})
        for axis, name in zip("xy", names, strict=True)
    }
    maps = {"map_objective": objective, "map_excess": excess}
    return xr.Dataset(
        {name: (("map_x", "map_y"), one.reshape(count, count)) for name, one in maps.items()}, coords=coords
    )


def _slices(question: Question, x: Array, source: Predicted) -> xr.Dataset:
    side = np.linspace(-1.0, 1.0, _SLICE)
    corner, first = question.searched[False], question.terms[0]
    parts = []
    for column, (name, one) in enumerate(question.inputs.items()):
        points = np.tile(x, (_SLICE, 1))
        points[:, column] = side
        objective, excess = _counted(question, points, source)
        factors = question.factors(points, corner)
        value = question.values(source, factors, corner, [first])[0].reshape(_SLICE, -1)
        columns = {
            "slice_value": one.from_unit(side),
            "slice_objective": objective,
            "slice_excess": excess,
            "slice_low": value.min(1),
            "slice_high": value.max(1),
        }
        parts.append(xr.Dataset({key: ("step", array) for key, array in columns.items()}).assign_coords(slice=name))
    return xr.concat(parts, "slice") if parts else xr.Dataset()


def _counted(question: Question, points: Array, source: Predicted) -> tuple[Array, Array]:
    """The first objective as it counts, and the largest excess, at scaled points (n, d)."""
    objective, excess = question.problem(source).value(points)
    first = question.terms[0]
    count = objective.shape[1] // len(question.target.objectives)
    return first.sign * objective[:, :count].min(1), excess.max(1, initial=-np.inf)
