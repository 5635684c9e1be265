"""The surroundings of a design on the surrogate: a map over two variables, and a slice along each with its bands."""

from typing import Any

import numpy as np
import xarray as xr

from approximation.arrays import Array
from workflow.design.question.question import Question

_MAP, _COARSE, _COARSEST = 81, 41, 17  # points a side of the map; fewer where every point stands for many draws
_MANY = 128  # scenarios a point from which the map is coarse
_SLICE = 121  # points of a slice


def landscape(design: Question) -> xr.Dataset:
    """Map and slices of the first objective on the surrogate, through one design."""
    return xr.merge([_map(design), _slices(design)])


def _points(question: Question, fine: int, coarse: int, coarsest: int) -> int:
    """Points a side: fewer where each stands for many scenarios, and fewest where one costs as much as a film's."""
    if sum(chosen.count for chosen in question.searched.values()) < _MANY:
        return fine
    return coarsest if question.study.kind.tabled else coarse


def _map(design: Question) -> xr.Dataset:
    names = list(design.inputs)[:2]
    if len(names) < 2:
        return xr.Dataset()
    count = _points(design, _MAP, _COARSE, _COARSEST)
    side = np.linspace(-1.0, 1.0, count)
    points = np.tile(design.x, (count * count, 1))
    points[:, 0], points[:, 1] = (grid.ravel() for grid in np.meshgrid(side, side, indexing="ij"))
    objective, excess = _counted(design.at(points))
    coords: dict[str, Any] = {
        f"map_{axis}": (f"map_{axis}", design.inputs[name].from_unit(side), {"factor": name})
        for axis, name in zip("xy", names, strict=True)
    }
    maps = {"map_objective": objective, "map_excess": excess}
    return xr.Dataset(
        {name: (("map_x", "map_y"), values.reshape(count, count)) for name, values in maps.items()}, coords=coords
    )


def _slices(design: Question) -> xr.Dataset:
    steps = _points(design, _SLICE, _SLICE, _COARSE)
    side = np.linspace(-1.0, 1.0, steps)
    corner, first = design.searched[False], design.terms[0]
    parts = []
    for column, (name, axis) in enumerate(design.inputs.items()):
        points = np.tile(design.x, (steps, 1))
        points[:, column] = side
        along = design.at(points)
        objective, excess = _counted(along)
        values = along.value(design.predicted, corner, first).reshape(steps, -1)
        columns = {
            "slice_value": axis.from_unit(side),
            "slice_objective": objective,
            "slice_excess": excess,
            "slice_low": values.min(1),
            "slice_high": values.max(1),
        }
        parts.append(xr.Dataset({key: ("step", array) for key, array in columns.items()}).assign_coords(slice=name))
    return xr.concat(parts, "slice") if parts else xr.Dataset()


def _counted(designs: Question) -> tuple[Array, Array]:
    """The first objective as it counts, and the largest excess, of every design."""
    objective, excess = designs.problem(designs.predicted).value(designs.x)
    count = objective.shape[1] // designs.objectives
    return designs.terms[0].sign * objective[:, :count].min(1), excess.max(1, initial=-np.inf)
