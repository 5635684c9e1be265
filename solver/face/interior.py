"""The labelled face of the interior fields: named factors and a grid in, an ``xarray.Dataset`` with units out."""

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from types import MappingProxyType

import numpy as np
import xarray as xr

from solver.arrays import Array, unmasked
from solver.face.bodies import body_of
from solver.face.cases import Cases
from solver.face.factors import checked
from solver.face.refusal import FactorError
from solver.face.rows import Factors
from solver.fields import EVERY_INTERIOR
from solver.material.constants import Material

_ALONG_X = {"units": "1", "long_name": "position (x - c)/h along the surface"}
_ALONG_Y = {"units": "1", "long_name": "height y/h over the surface"}


def solve_interior(
    factors: Factors,
    x: Iterable[float],
    y: Iterable[float],
    *,
    fields: Sequence[str] | None = None,
    materials: Mapping[str, Material] = MappingProxyType({}),
    phases: Sequence[str | Material] = ("BaTiO3", "CoFe2O4"),
) -> xr.Dataset:
    """Exact fields inside half-planes, films and their bases, on the surface too, for every case on a grid.

    Parameters
    ----------
    factors, materials, phases
        As for :func:`solve`.
    x, y
        (x - c)/h and y/h <= 0, dimensionless: the grid is their product. An edge of the contact, (+-1, 0), has no
        value. On the surface the fields are those of the body. Under a film the fields are those of its base; a rigid
        base has none: NaN. A point on an interface belongs to the film.
    fields
        Names of ``solver.fields.INTERIOR`` and ``INTERIOR_ON_REQUEST``; by default all of the former, without what
        needs c12 if a material has none.

    Returns
    -------
    xarray.Dataset
        Fields over the factors' dimensions, ``y`` and ``x``, SI units. Potentials in a film above a grounded interface
        are absolute.

    Raises
    ------
    FactorError
        As :func:`solve`; a point above the surface or on an edge; an unknown field.
    MaterialError
        Unknown or inadmissible material, or one without c12 when a field asked for needs it; inside a film, points
        some hundred thicknesses beside the contact, or the magnetic potential over a base that insulates that field.

    Examples
    --------
    >>> film = {"material": "BaTiO3", "thickness": 0.5e-3, "base": "rigid", "radius": 0.05, "load": 1e5}
    >>> round(float(solve_interior(film, [0.0], [-1.0], fields=["stress_yy"])["stress_yy"].squeeze()) / 1e6, 3)
    -221.335
    """
    cases = Cases(checked(factors), materials, phases)
    grid_x, grid_y = _grid(x, y)
    for name in fields or ():
        if name not in EVERY_INTERIOR:
            raise FactorError(f"fields: {name!r} is not one of {', '.join(EVERY_INTERIOR)}")
    axes = {"y": xr.Variable("y", grid_y, _ALONG_Y), "x": xr.Variable("x", grid_x, _ALONG_X)}

    def part(cases: Cases) -> xr.Dataset:
        body = body_of(cases)
        values = body.interior(grid_x, grid_y, fields)
        outputs = cases.labelled(values, EVERY_INTERIOR, "factors and points (overflow)", axes, hollow=body.hollow)
        return xr.Dataset(outputs, cases.coordinates | axes)

    return cases.solved("exact fields inside a magneto-electro-elastic half-plane below a punch", part)


def _grid(x: Iterable[float], y: Iterable[float]) -> tuple[Array, Array]:
    """Checked grid lines."""
    lines = []
    for name, values in (("x", x), ("y", y)):
        line = np.empty(())
        with suppress(TypeError, ValueError):
            line = np.asarray(list(unmasked(values)), dtype=np.float64)
        if line.ndim != 1 or not line.size or not np.all(np.isfinite(line)):
            raise FactorError(f"{name}: not a list of at least one finite number")
        lines.append(line)
    if np.any(lines[1] > 0):
        raise FactorError(f"y: {lines[1].max():g} is above the surface; y/h must be <= 0")
    if np.any(lines[1] == 0) and np.any(np.abs(lines[0]) == 1):
        raise FactorError("x: the fields have no value on an edge of the contact, x = +-1 at y = 0")
    return lines[0], lines[1]
