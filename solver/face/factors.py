"""Check of the factors of cases: names, values and dimensions."""

from collections.abc import Mapping
from contextlib import suppress
from types import MappingProxyType
from typing import cast

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from solver.arrays import is_finite, nearest, shown, unmasked
from solver.face.factorvalues import FactorValues, absent, settled
from solver.face.refusal import FactorError
from solver.face.rows import CASE, Factors, by_name
from solver.face.rules import check, check_surrounded
from solver.halfplane.profile import Profile
from solver.material.constants import Material
from solver.material.usual import question
from solver.names import BODY, CHOICES, FACTORS, HEIGHT_MAP, MATERIALS, OF_A_FILM
from solver.stack.layers import Stack
from solver.units import in_si

_SMALLEST = float(np.finfo(np.float64).tiny)
_MAY_BE_EMPTY = (*OF_A_FILM, "surroundings")
_OUTPUT_DIMS = ("position", "x", "y")


def checked(factors: Factors, materials: Mapping[str, Material] = MappingProxyType({})) -> dict[str, xr.DataArray]:
    """Return factors as arrays with dimensions, or refuse an unknown name, a value or dimensions that do not fit."""
    values_of = by_name(factors)
    known = (*MATERIALS, *CHOICES, *FACTORS, BODY, HEIGHT_MAP)
    arrays: dict[str, xr.DataArray] = {}
    for name, value in values_of.items():
        if name not in known:
            if isinstance(factors, xr.Dataset) and name in factors.dims:
                continue  # an index of cases, not a factor
            near = nearest(name, known)
            hint = f"did you mean {near!r}?" if near else f"known are {', '.join(known)}"
            raise FactorError(f"{name}: unknown factor; {hint}")
        array = _array(str(name), value)
        if name in MATERIALS:
            array = _with_materials(array, materials)
        if name in FACTORS:
            _check_modulus(str(name), array)
            array = _number(str(name), _in_si(str(name), array))
        elif name in CHOICES and not isinstance(value, Profile):
            _choice(str(name), array, (*CHOICES[str(name)], *((None, "") if name in _MAY_BE_EMPTY else ())))
        arrays[str(name)] = array
    for name, array in arrays.items():
        for dim in array.dims:
            if dim != name and (dim in known or dim in _OUTPUT_DIMS):
                raise FactorError(f"{name}: its dimension {str(dim)!r} has the name of a factor or of an output's axis")
    try:
        arrays = dict(zip(arrays, xr.align(*arrays.values(), join="exact", copy=False), strict=True))
    except ValueError as error:
        raise FactorError(f"factors: dimensions do not fit each other: {str(error).splitlines()[0]}") from error
    check(FactorValues(arrays))
    arrays = settled(arrays)
    check_surrounded(FactorValues(arrays))
    return arrays


def _with_materials(array: xr.DataArray, materials: Mapping[str, Material]) -> xr.DataArray:
    """Replace names of the user's cut crystals and metals, which decide the kind of a contact, by the materials."""
    deciding = {name: m for name, m in materials.items() if not m.axial or np.any(m.conductor)}
    if not deciding or array.dtype.kind not in "OU":
        return array
    cells = np.empty(array.shape, dtype=object)
    for index, value in np.ndenumerate(array.values):
        cells[index] = deciding.get(str(value), value) if isinstance(value, str) else value
    return array.copy(data=cells)


def _check_modulus(name: str, array: xr.DataArray) -> None:
    """Refuse a bare modulus so small that it has probably lost its unit."""
    if name.endswith("_modulus") and array.dtype.kind in "iuf":
        values = array.values.astype(np.float64)
        if complaint := question("young", values[(values > 0) & (values < 1e6)], "Pa"):
            raise FactorError(f"{name}: {complaint.removeprefix('young: ')}")


def _array(name: str, value: object) -> xr.DataArray:
    """Return a scalar without dimension, or a plain sequence along a dimension named after its factor."""
    if isinstance(value, xr.DataArray):
        return value.reset_coords(drop=True)
    if isinstance(value, Material | Profile | Stack) or (name == HEIGHT_MAP and np.ndim(cast(ArrayLike, value)) > 1):
        values = np.empty((), object)
        values[()] = value  # all heights of a map are one value
    else:
        try:
            value = unmasked(value)
            values = np.asarray(value, None if isinstance(value, np.ndarray) else _type(value))
        except ValueError:
            raise FactorError(f"{name}: {shown(value)} is not a plain list of values") from None
    if values.ndim > 1:
        raise FactorError(f"{name}: a plain array of {values.ndim} dimensions; give a DataArray with named ones")
    return xr.DataArray(values, dims=(name,) * values.ndim)


def _type(value: object) -> type | None:
    """Return the type object for a mixed list, whose numbers numpy would turn into text."""
    listed = value if isinstance(value, list | tuple) else ()
    return object if any(isinstance(item, str | Material | Profile | Stack) for item in listed) else None


def _in_si(name: str, array: xr.DataArray) -> xr.DataArray:
    """Return texts such as "20 um" as numbers in SI, and other values unchanged."""
    if array.dtype.kind in "iuf" or not any(isinstance(text, str) for text in array.values.flat):
        return array
    factor, values = FACTORS[name], np.empty(array.shape, dtype=object)
    for index, entry in np.ndenumerate(array.values):
        try:
            values[index] = in_si(str(entry), factor.units) if isinstance(entry, str) else entry
        except ValueError as error:
            wrong = f"{shown(entry)} is not {factor.allowed}, bare or with its unit"
            if "mismatch" in str(error):
                wrong = str(error)
            elif _is_number(str(entry)):
                wrong = f"{shown(entry)} is a text without a unit; give the number, or its unit [{factor.units}]"
            raise FactorError(f"{name}: {wrong}") from None
    numbers = all(is_finite(value) for value in values.flat)
    return array.copy(data=values.astype(np.float64) if numbers else values)


def _is_number(text: str) -> bool:
    """Return whether a text is a number without a unit."""
    with suppress(ValueError):
        return bool(np.isfinite(float(text)))
    return False


def _number(name: str, array: xr.DataArray) -> xr.DataArray:
    """Return a numeric factor as float64, or refuse the first value that is not allowed."""
    factor = FACTORS[name]
    if array.dtype.kind not in "iuf":
        for value in array.values.flat:  # integers beyond 64 bits come as objects, text does not pass as a number
            if not (is_finite(value) or (factor.optional and absent(value))):
                raise FactorError(f"{name}: {shown(value)} is not {factor.allowed}")
        array = array.copy(data=np.frompyfunc(lambda value: np.nan if absent(value) else value, 1, 1)(array.values))
    if array.dtype != np.float64:
        array = array.copy(data=array.values.astype(np.float64))
    values = array.values
    above = values >= factor.low if factor.low_allowed else values > factor.low
    below = values <= factor.high if factor.high_allowed else values < factor.high
    missing = np.isnan(values) & factor.optional
    wrong = ~(np.isfinite(values) & above & below | missing)
    if wrong.any():
        raise FactorError(f"{name}: {values[wrong].flat[0]:g} is not {factor.allowed}{_of_row(array, wrong)}")
    bad = values[(np.abs(values) < _SMALLEST) & (values != 0)]
    if bad.size:  # a subnormal number has lost digits, and its inverse overflows
        raise FactorError(f"{name}: {bad.flat[0]:g} is too small for a number of full precision, {_SMALLEST:.3g}")
    return array


def _of_row(array: xr.DataArray, wrong: NDArray[np.bool_]) -> str:
    """Return the words that name the first wrong row of a labelled table, empty for other arrays."""
    if array.dims != (CASE,) or CASE not in array.coords:
        return ""
    return f" (row {array[CASE].values[int(wrong.argmax())]})"


def _choice(name: str, array: xr.DataArray, allowed: tuple[str | None, ...]) -> None:
    """Refuse a value that is not among the allowed names."""
    values = array.values
    for value in np.unique(values) if values.dtype.kind == "U" else values.flat:
        if not (None in allowed and absent(value)) and not (isinstance(value, str) and value in allowed):
            known = [*filter(None, allowed)]
            hint = f"; did you mean {near!r}?" if (near := nearest(value, known)) else ""
            raise FactorError(f"{name}: {shown(value)} is not one of {', '.join(known)}{hint}")
