"""Named factors of the cases: checked, aligned and made into the arrays of a contact."""

from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver.arrays import Array, is_finite, stack
from solver.halfplane.contact import Contact
from solver.halfplane.profile import Profile
from solver.halfplane.sliding import Sliding
from solver.halfplane.speed import limiting_speed
from solver.halfplane.surface import HalfPlane
from solver.material.composite import fibrous, laminate
from solver.material.constants import UNITS, Material
from solver.material.library import find
from solver.names import CHOICES, FACTORS, PROFILES

_COMPOSITES = {"fibrous": fibrous, "laminate": laminate}
_OUTPUT_DIMS = ("position", "x", "y")
_CHARGES = {"charge": "electric", "magnetic_charge": "magnetic"}


class FactorError(ValueError):
    """A factor that is unknown, missing or outside what is allowed."""


def checked(factors: Mapping[str, Any] | xr.Dataset) -> dict[str, xr.DataArray]:
    """Factors as arrays with dimensions, every name known and every value allowed.

    Raises
    ------
    FactorError
        Naming the factor, its value and what is allowed.
    """
    given = {**factors.data_vars, **factors.coords} if isinstance(factors, xr.Dataset) else dict(factors)
    known = ("material", *CHOICES, *FACTORS)
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
        elif name in CHOICES and not isinstance(value, Profile):
            _choice(str(name), array, CHOICES[str(name)])
        arrays[str(name)] = array
    if "material" in arrays and {"composite", "volume_fraction"} & set(arrays):
        raise FactorError("material: give either a material or a composite's volume_fraction, not both")
    if "material" not in arrays and "volume_fraction" not in arrays:
        raise FactorError("material: missing; give a material's name, or a composite's volume_fraction")
    _check_profile(arrays)
    for name, array in arrays.items():
        for dim in array.dims:
            if dim != name and (dim in known or dim in _OUTPUT_DIMS):
                raise FactorError(f"{name}: its dimension {str(dim)!r} has the name of a factor or of an output's axis")
    try:
        return dict(zip(arrays, xr.align(*arrays.values(), join="exact", copy=False), strict=True))
    except ValueError as error:
        raise FactorError(f"factors: dimensions do not fit each other: {str(error).splitlines()[0]}") from error


def _check_profile(arrays: Mapping[str, xr.DataArray]) -> None:
    """Every profile has the factors that it needs, and no factor is there that none of them takes."""
    kinds = list(dict.fromkeys(arrays["profile"].values.flat)) if "profile" in arrays else ["cylinder"]
    profiles = [str(kind) for kind in kinds if not isinstance(kind, Profile)]
    takes = {name: PROFILES[name] for name in profiles}
    for profile, (needs, _) in takes.items():
        for name in needs:
            if name not in arrays:
                raise FactorError(f"{name}: missing; must be {FACTORS[name].allowed} (profile {profile})")
    if "load" not in arrays:
        raise FactorError(f"load: missing; must be {FACTORS['load'].allowed}")
    taken = {name for needs, may in takes.values() for name in (*needs, *may)}
    for name in ("radius", "width", "slope", "moment", "corner"):
        if name in arrays and name not in taken:
            raise FactorError(f"{name}: the profile {', '.join(profiles) or 'given'} has none")
    if "moment" in arrays and "slope" in arrays and "flat" in profiles:
        raise FactorError("moment: give either the slope or the moment of a flat punch, not both")
    if "wedge" in profiles and np.any(arrays["slope"].values <= 0) and "flat" not in profiles:
        bad = arrays["slope"].values[arrays["slope"].values <= 0].flat[0]
        raise FactorError(f"slope: {bad:g} is not a finite number > 0 [1] (profile wedge)")


def align(arrays: Mapping[str, xr.DataArray]) -> tuple[dict[str, NDArray[Any]], dict[str, int]]:
    """Values with one axis for each dimension, of length one where the factor does not vary; the dimensions' sizes."""
    sizes = {str(dim): size for array in arrays.values() for dim, size in array.sizes.items()}
    aligned = {}
    for name, array in arrays.items():
        present = [dim for dim in sizes if dim in array.dims]
        shape = [array.sizes.get(dim, 1) for dim in sizes]
        aligned[name] = array.transpose(*present).values.reshape(shape)
    return aligned, sizes


def contact_of(
    aligned: Mapping[str, NDArray[Any]], materials: Mapping[str, Material], phases: Sequence[str | Material]
) -> tuple[Contact, Array]:
    """Contact of cases with one profile, and the datum of their potentials.

    Raises
    ------
    FactorError, MaterialError
        A charge on an insulating punch, a speed at or above the limiting one, an inadmissible material.
    """
    if len(phases) != 2:
        raise FactorError(f"phases: {len(phases)} given; a composite has two")
    number: dict[str, Array] = {n: aligned.get(n, np.array(factor.default or 0.0)) for n, factor in FACTORS.items()}
    conducts = stack(*(aligned.get(name, np.array("conducting")) == "conducting" for name in ("electric", "magnetic")))
    for j, (charge, field) in enumerate(_CHARGES.items()):
        carried, conducting = np.broadcast_arrays(number[charge], conducts[..., j])
        if np.any(bad := (carried != 0) & ~conducting):
            raise FactorError(f"{charge}: {carried[bad].flat[0]:g} on a punch that is {field} insulating; must be 0")
    material = _material(aligned, materials, [_phase(phase, materials) for phase in phases])
    speed = number["speed"]
    if np.any(speed > 0):
        _refuse_fast(material, conducts, speed)
    halfplane = HalfPlane(material, speed) if np.any(speed > 0) else HalfPlane(material)
    sliding = Sliding(halfplane, number["friction"], conducts)
    charges = stack(number["charge"], number["magnetic_charge"])
    return Contact(sliding, _profile(aligned, number), number["load"], charges), number["datum"]


def _refuse_fast(material: Material, conducts: NDArray[np.bool_], speed: Array) -> None:
    if np.any(np.isnan(material.rho)):
        raise FactorError(f"speed: needs the density rho [kg m-3] of {material.name}")
    V, limit = np.broadcast_arrays(speed, limiting_speed(material, conducts))
    if np.any(bad := limit <= V):
        raise FactorError(f"speed: {V[bad].flat[0]:g} m/s is not below the limiting speed {limit[bad].flat[0]:.6g} m/s")


def _profile(aligned: Mapping[str, NDArray[Any]], number: Mapping[str, Array]) -> Profile:
    """The one profile of all cases."""
    kind = aligned["profile"].flat[0] if "profile" in aligned else "cylinder"
    if isinstance(kind, Profile):
        return kind
    corner = str(aligned["corner"].flat[0]) if "corner" in aligned else "leading"
    if kind == "cylinder":
        return Profile.cylinder(number["radius"])
    if kind == "flat":
        return Profile.flat(number["width"], number["slope"], number["moment"] if "moment" in aligned else None)
    if kind == "wedge":
        return Profile.wedge(number["slope"], corner)
    return Profile.half_cylinder(number["radius"], corner)


def _array(name: str, value: object) -> xr.DataArray:
    """A scalar without dimension, a plain sequence as a dimension named after its factor."""
    if isinstance(value, xr.DataArray):
        return value.reset_coords(drop=True)
    if isinstance(value, Material | Profile):
        values = np.empty((), object)
        values[()] = value
    else:
        try:
            values = np.asarray(value, None if isinstance(value, np.ndarray) else _type(value))
        except ValueError:
            raise FactorError(f"{name}: {str(value)!r} is not a plain list of values") from None
    if values.ndim > 1:
        raise FactorError(f"{name}: a plain array of {values.ndim} dimensions; give a DataArray with named ones")
    return xr.DataArray(values, dims=(name,) * values.ndim)


def _type(value: object) -> type | None:
    """Object where numpy would turn the numbers of a mixed list into text."""
    listed = value if isinstance(value, list | tuple) else ()
    return object if any(isinstance(one, str | Material | Profile) for one in listed) else None


def _number(name: str, array: xr.DataArray) -> xr.DataArray:
    factor = FACTORS[name]
    if array.dtype.kind not in "iuf":
        for one in array.values.flat:  # integers beyond 64 bits come as objects, text does not pass as a number
            if not is_finite(one):
                raise FactorError(f"{name}: {str(one)[:40]!r} is not {factor.allowed}")
    array = array.astype(np.float64)
    values = array.values
    above = values >= factor.low if factor.low_allowed else values > factor.low
    bad = values[~(np.isfinite(values) & above & (values <= factor.high))]
    if bad.size:
        raise FactorError(f"{name}: {bad.flat[0]:g} is not {factor.allowed}")
    return array


def _choice(name: str, array: xr.DataArray, allowed: tuple[str, ...]) -> None:
    values = array.values
    for value in np.unique(values) if values.dtype.kind == "U" else values.flat:
        if not isinstance(value, str) or value not in allowed:
            raise FactorError(f"{name}: {str(value)!r} is not one of {', '.join(allowed)}")


def _phase(phase: str | Material, materials: Mapping[str, Material]) -> Material:
    return phase if isinstance(phase, Material) else find(phase, materials)


def _material(aligned: Mapping[str, Any], materials: Mapping[str, Material], phases: list[Material]) -> Material:
    """The material of every case, constants over aligned axes."""
    if "material" in aligned:
        which = aligned["material"]
        asked = [m if isinstance(m, Material) else str(m) for m in which.flat]
        place = {m: k for k, m in enumerate(dict.fromkeys(asked))}
        chosen = [_phase(m, materials) for m in place]  # each is found and checked once, however many cases it has
        for material in chosen:
            if material.shape:
                raise FactorError(f"material: {material.name!r} holds arrays; a factor takes one material a value")
            material.check()
        of_case = np.array([place[m] for m in asked], dtype=np.intp).reshape(which.shape)
        constants: dict[str, Any] = {c: np.array([getattr(m, c) for m in chosen])[of_case] for c in UNITS}
        return Material(**constants, name=chosen[0].name if len(chosen) == 1 else "material")
    fraction, kind = aligned["volume_fraction"], aligned.get("composite", np.array("fibrous"))
    one, two = phases
    mixed = [_COMPOSITES[name](one, two, fraction) for name in CHOICES["composite"] if np.any(kind == name)]
    if len(mixed) == 1:
        return mixed[0]
    either: dict[str, Any] = {c: np.where(kind == "fibrous", *(getattr(m, c) for m in mixed)) for c in UNITS}
    return Material(**either, name="composite")
