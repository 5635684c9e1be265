"""The labelled face of the interior fields: named factors and a grid in, an ``xarray.Dataset`` with units out."""

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from types import MappingProxyType
from typing import Any

import numpy as np
import xarray as xr

from solver.arrays import Array
from solver.face.attributes import attributes, of_output
from solver.face.cases import by_kind, contact_of_cases, coordinates, require_c12, require_finite
from solver.face.factors import FactorError, checked
from solver.halfplane.interior import LINEAR, interior_parts, principal_tension, von_mises
from solver.halfplane.potentials import POTENTIALS, potentials
from solver.material.constants import Material
from solver.names import INTERIOR, INTERIOR_ON_REQUEST, NEED_C12

_COMBINED = {"von_mises": von_mises, "principal_tension": principal_tension}
_ALONG_X = {"units": "1", "long_name": "position (x - c)/h along the surface"}
_ALONG_Y = {"units": "1", "long_name": "height y/h over the surface"}


def solve_interior(
    factors: Mapping[str, Any] | xr.Dataset,
    x: Iterable[float],
    y: Iterable[float],
    *,
    fields: Sequence[str] | None = None,
    materials: Mapping[str, Material] = MappingProxyType({}),
    phases: Sequence[str | Material] = ("BaTiO3", "CoFe2O4"),
) -> xr.Dataset:
    """Exact fields inside the half-plane, on the surface too, for every case on a grid.

    Parameters
    ----------
    factors, materials, phases
        As for :func:`solve`.
    x, y
        (x - c)/h and y/h <= 0, dimensionless: the grid is their product. An edge of the contact, (+-1, 0), has no
        value. On the surface the fields are those of the body.
    fields
        Names of ``solver.names.INTERIOR`` and ``INTERIOR_ON_REQUEST``; by default all of the former, without those that
        need c12 if a material has none.

    Returns
    -------
    xarray.Dataset
        Fields over the factors' dimensions, ``y`` and ``x``, SI units.

    Raises
    ------
    FactorError
        As :func:`solve`; a point above the surface or on an edge; an unknown field.
    MaterialError
        Unknown or inadmissible material, or one without c12 when a field asked for needs it.
    """
    arrays = checked(factors)
    grid_x, grid_y = _grid(x, y)
    known = {**INTERIOR, **INTERIOR_ON_REQUEST}
    for name in fields or ():
        if name not in known:
            raise FactorError(f"fields: {name!r} is not one of {', '.join(known)}")

    def part(arrays: dict[str, xr.DataArray]) -> xr.Dataset:
        contact, datum, dims, shape = contact_of_cases(arrays, materials, phases)
        material = contact.halfplane.material
        if np.any(np.isnan(material.c12)):
            require_c12(material, [name for name in fields or () if name in NEED_C12])
            wanted = [name for name in fields or INTERIOR if name not in NEED_C12]
        else:
            wanted = list(fields or INTERIOR)
        combined = [name for name in wanted if name in _COMBINED]
        needed = [name for name in LINEAR if name in wanted or (combined and name in LINEAR[:4])]
        points_y, points_x = (points.ravel() for points in np.meshgrid(grid_y, grid_x, indexing="ij"))
        with np.errstate(all="ignore"):  # what is not finite is named below
            whole = interior_parts(contact, points_x, points_y, tuple(needed)).whole(contact)
            values = {name: whole[..., k, :] for k, name in enumerate(needed)}
            if set(POTENTIALS) & set(wanted):
                of_fields = potentials(contact, points_x, points_y, datum)
                values |= {name: of_fields[..., k, :] for k, name in enumerate(POTENTIALS)}
            for name in combined:
                values[name] = _COMBINED[name](*(values[stress] for stress in LINEAR[:4]))
        size = (*shape, grid_y.size, grid_x.size)
        out = xr.Dataset(coords={**coordinates(arrays), "y": ("y", grid_y, _ALONG_Y), "x": ("x", grid_x, _ALONG_X)})
        for name in wanted:
            require_finite(name, values[name], "factors and points (overflow)")
            value = values[name].reshape(*values[name].shape[:-1], grid_y.size, grid_x.size)
            out[name] = ((*dims, "y", "x"), np.broadcast_to(value, size), of_output(known[name], arrays))
        return out

    title = "exact fields inside a magneto-electro-elastic half-plane below a sliding punch"
    return by_kind(arrays, part).assign_attrs(attributes(title, arrays, phases))


def _grid(x: Iterable[float], y: Iterable[float]) -> tuple[Array, Array]:
    """Checked grid lines."""
    lines = []
    for name, values in (("x", x), ("y", y)):
        line = np.empty(())
        with suppress(TypeError, ValueError):
            line = np.asarray(list(values), dtype=np.float64)
        if line.ndim != 1 or not line.size or not np.all(np.isfinite(line)):
            raise FactorError(f"{name}: not a list of at least one finite number")
        lines.append(line)
    if np.any(lines[1] > 0):
        raise FactorError(f"y: {lines[1].max():g} is above the surface; y/h must be <= 0")
    if np.any(lines[1] == 0) and np.any(np.abs(lines[0]) == 1):
        raise FactorError("x: the fields have no value on an edge of the contact, x = +-1 at y = 0")
    return lines[0], lines[1]
