"""The labelled face of the solver: named factors in, an ``xarray.Dataset`` with units out."""

from collections.abc import Iterable, Mapping, Sequence
from difflib import get_close_matches
from types import MappingProxyType
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver.arrays import Array
from solver.composite import fibrous, laminate
from solver.contact import Contact
from solver.fields import surface_fields
from solver.halfplane import HalfPlane
from solver.library import find
from solver.material import UNITS, Material
from solver.names import CHOICES, FACTORS, FIELDS, FIXED, QUANTITIES, SINGULAR
from solver.response import Response

_COMPOSITES = {"fibrous": fibrous, "laminate": laminate}


class FactorError(ValueError):
    """A factor that is unknown, missing or outside what is allowed."""


def solve(
    factors: Mapping[str, Any] | xr.Dataset,
    positions: Iterable[float] | None = None,
    *,
    materials: Mapping[str, Material] = MappingProxyType({}),
    phases: Sequence[str | Material] = ("BaTiO3", "CoFe2O4"),
    regular: bool = False,
) -> xr.Dataset:
    """Exact solution of every case: all quantities, and the surface fields where positions are given.

    Parameters
    ----------
    factors
        Values by factor name: scalars, ``DataArray`` of any dimensions, or plain sequences, which become a dimension
        named after their factor; dimensions broadcast, so sequences span the full factorial. ``radius`` and ``load``
        must be given, and either ``material`` (a name or :class:`Material`) or ``volume_fraction`` (with
        ``composite``, default ``fibrous``). The rest default to 0 (``datum``: 1 m).
    positions
        Surface positions X = (x - c)/h, dimensionless, any but +-1.
    materials
        Own materials by name, beside the built-in ones.
    phases
        Phase one and phase two of a composite, names or :class:`Material`.
    regular
        Also give ``<field>_regular``, the square-root singular fields times sqrt|1 - X^2|.

    Returns
    -------
    xarray.Dataset
        Quantities over the factors' dimensions, fields over these and ``position``; names and units as in
        ``solver.names``. Values that a dimension does not change are broadcast views, not copies.

    Raises
    ------
    FactorError
        Unknown, missing, non-finite or out-of-range factor or position; names field, value and what is allowed.
    MaterialError
        Unknown or inadmissible material.
    """
    arrays = _checked(factors)
    dims = tuple(dict.fromkeys(str(dim) for array in arrays.values() for dim in array.dims))
    sizes = {dim: size for array in arrays.values() for dim, size in array.sizes.items()}
    aligned = {name: _aligned(array, dims) for name, array in arrays.items()}

    if len(phases) != 2:
        raise FactorError(f"phases: {len(phases)} given; a composite has two")
    material = _material(aligned, materials, [_phase(phase, materials) for phase in phases])
    number: dict[str, Array] = {n: aligned.get(n, np.array(factor.default or 0.0)) for n, factor in FACTORS.items()}
    charges = np.stack(np.broadcast_arrays(number["charge"], number["magnetic_charge"]), -1)
    contact = Contact(HalfPlane(material), number["friction"], number["radius"], number["load"], charges)

    with np.errstate(all="ignore"):  # what is not finite is named below
        values = quantities(contact, number["datum"])
    for name, value in values.items():
        if not np.all(np.isfinite(value)):
            raise FactorError(f"{name}: not finite for these factors (contact as wide as the datum, or overflow)")
    shape = tuple(sizes[dim] for dim in dims)
    out = xr.Dataset(
        {name: (dims, np.broadcast_to(value, shape), QUANTITIES[name].attrs) for name, value in values.items()},
        coords={name: _coordinate(name, array) for name, array in arrays.items()},
    )
    if positions is not None:
        X = _positions(positions)
        with np.errstate(all="ignore"):  # what is not finite is named below
            fields = surface_fields(contact, X)
        out = out.assign_coords(position=("position", X, {"units": "1", "long_name": "surface position X = (x - c)/h"}))
        for name, described in FIELDS.items():
            with np.errstate(all="ignore"):
                value = fields.singular(name) if name in SINGULAR else getattr(fields, name)
            if not np.all(np.isfinite(value)):
                raise FactorError(f"{name}: not finite for these factors and positions (overflow)")
            out[name] = ((*dims, "position"), np.broadcast_to(value, (*shape, X.size)), described.attrs)
            if regular and name in SINGULAR:
                attrs = {"units": described.units, "long_name": f"{described.long_name}, times sqrt|1 - X^2|"}
                whole = np.broadcast_to(getattr(fields, f"{name}_regular"), (*shape, X.size))
                out[f"{name}_regular"] = ((*dims, "position"), whole, attrs)
    return out


def quantities(contact: Contact, datum: Array) -> dict[str, Array]:
    """Every closed-form quantity of ``solver.names.QUANTITIES``, each in the smallest shape that it needs."""
    response = Response(contact, datum)
    trailing, leading = contact.edge_intensities()
    tension, compression = contact.edge_stresses()
    return {
        "contact_trailing": contact.trailing,
        "contact_leading": contact.leading,
        "pressure_exponent": contact.exponent,
        "peak_pressure": contact.peak_pressure,
        "depth": response.depth,
        "voltage": response.potential(0),
        "magnetic_potential": response.potential(1),
        "electric_edge_intensity_trailing": trailing[..., 0],
        "electric_edge_intensity_leading": leading[..., 0],
        "magnetic_edge_intensity_trailing": trailing[..., 1],
        "magnetic_edge_intensity_leading": leading[..., 1],
        "trailing_tension": tension,
        "leading_compression": compression,
        "voltage_sensitivity": response.sensitivity(0),
        "magnetic_sensitivity": response.sensitivity(1),
        "charge_sensitivity": response.short_circuit(0),
        "flux_sensitivity": response.short_circuit(1),
        "stroke_per_volt": response.stroke(0),
        "stroke_per_ampere": response.stroke(1),
        "blocked_load_per_volt": response.blocked_load(0),
        "blocked_load_per_ampere": response.blocked_load(1),
    }


def _checked(factors: Mapping[str, Any] | xr.Dataset) -> dict[str, xr.DataArray]:
    """Factors as arrays with dimensions, every name known and every value allowed."""
    given = {**factors.data_vars, **factors.coords} if isinstance(factors, xr.Dataset) else dict(factors)
    known = ("material", *CHOICES, *FACTORS, *FIXED)
    arrays: dict[str, xr.DataArray] = {}
    for name, value in given.items():
        if name not in known:
            if isinstance(factors, xr.Dataset) and name in factors.dims:
                continue  # an index of cases, not a factor
            near = get_close_matches(str(name), known, 1, 0.5)
            hint = f"did you mean {near[0]!r}? " if near else ""
            raise FactorError(f"{name}: unknown factor; {hint}known are {', '.join(known)}")
        array = _array(str(name), value)
        if name in FACTORS:
            array = _number(str(name), array)
        elif name in CHOICES:
            _choice(str(name), array, CHOICES[str(name)])
        elif name in FIXED:
            _choice(str(name), array, (FIXED[str(name)],))
        arrays[str(name)] = array
    if "material" in arrays and {"composite", "volume_fraction"} & set(arrays):
        raise FactorError("material: give either a material or a composite's volume_fraction, not both")
    if "material" not in arrays and "volume_fraction" not in arrays:
        raise FactorError("material: missing; give a material's name, or a composite's volume_fraction")
    for name in ("radius", "load"):
        if name not in arrays:
            raise FactorError(f"{name}: missing; must be {FACTORS[name].allowed}")
    try:
        return dict(zip(arrays, xr.align(*arrays.values(), join="exact", copy=False), strict=True))
    except ValueError as error:
        raise FactorError(f"factors: dimensions do not fit each other: {str(error).splitlines()[0]}") from error


def _array(name: str, value: object) -> xr.DataArray:
    """A scalar without dimension, a plain sequence as a dimension named after its factor."""
    if isinstance(value, xr.DataArray):
        return value.reset_coords(drop=True)
    values = np.empty((), object) if isinstance(value, Material) else np.asarray(value)
    if isinstance(value, Material):
        values[()] = value
    if values.ndim > 1:
        raise FactorError(f"{name}: a plain array of {values.ndim} dimensions; give a DataArray with named ones")
    return xr.DataArray(values, dims=(name,) * values.ndim)


def _number(name: str, array: xr.DataArray) -> xr.DataArray:
    factor = FACTORS[name]
    try:
        array = array.astype(np.float64)
    except (TypeError, ValueError):
        raise FactorError(f"{name}: {str(array.values.flat[0])!r} is not {factor.allowed}") from None
    values = array.values
    above = values >= factor.low if factor.low_allowed else values > factor.low
    bad = values[~(np.isfinite(values) & above & (values <= factor.high))]
    if bad.size:
        raise FactorError(f"{name}: {bad.flat[0]:g} is not {factor.allowed}")
    return array


def _choice(name: str, array: xr.DataArray, allowed: tuple[str | float, ...]) -> None:
    for value in array.values.flat:
        if value not in allowed:
            raise FactorError(f"{name}: {str(value)!r} is not one of {', '.join(map(str, allowed))}")


def _aligned(array: xr.DataArray, dims: tuple[str, ...]) -> NDArray[Any]:
    """Values with one axis for each of ``dims``, of length one where the factor does not vary."""
    present = [dim for dim in dims if dim in array.dims]
    return array.transpose(*present).values.reshape([array.sizes.get(dim, 1) for dim in dims])


def _phase(phase: str | Material, materials: Mapping[str, Material]) -> Material:
    return phase if isinstance(phase, Material) else find(phase, materials)


def _material(aligned: Mapping[str, Any], materials: Mapping[str, Material], phases: list[Material]) -> Material:
    """The material of every case, constants over aligned axes."""
    if "material" in aligned:
        which = aligned["material"]
        chosen = [_phase(m if isinstance(m, Material) else str(m), materials) for m in which.flat]
        for material in chosen:
            if material.shape:
                raise FactorError(f"material: {material.name!r} holds arrays; a factor takes one material a value")
            material.check()
        constants: dict[str, Any] = {c: np.array([getattr(m, c) for m in chosen]).reshape(which.shape) for c in UNITS}
        return Material(**constants, name=chosen[0].name if len(chosen) == 1 else "material")
    fraction, kind = aligned["volume_fraction"], aligned.get("composite", np.array("fibrous"))
    one, two = phases
    kinds = [_COMPOSITES[name](one, two, fraction) for name in CHOICES["composite"] if np.any(kind == name)]
    if len(kinds) == 1:
        return kinds[0]
    either: dict[str, Any] = {c: np.where(kind == "fibrous", *(getattr(m, c) for m in kinds)) for c in UNITS}
    return Material(**either, name="composite")


def _coordinate(name: str, array: xr.DataArray) -> xr.Variable:
    values = array.values
    if name == "material":
        values = np.array([m.name if isinstance(m, Material) else str(m) for m in values.flat]).reshape(values.shape)
    factor = FACTORS.get(name)
    attrs = {"units": factor.units, "long_name": factor.long_name} if factor else {}
    return xr.Variable(array.dims, values, attrs)


def _positions(positions: Iterable[float]) -> Array:
    X = np.asarray(list(positions) if not isinstance(positions, np.ndarray) else positions, dtype=np.float64)
    if X.ndim != 1 or not X.size:
        raise FactorError("positions: not a list of at least one number")
    bad = X[~np.isfinite(X) | (np.abs(X) == 1)]
    if bad.size:
        raise FactorError(f"positions: {bad[0]:g} is not allowed; any finite X but -1 and 1 (the edges are singular)")
    return X
