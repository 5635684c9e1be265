"""From checked factors to contacts of one kind and back to labelled arrays: what the labelled faces share."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import xarray as xr

from solver.arrays import Array
from solver.face.factors import FactorError, align, contact_of
from solver.halfplane.contact import Contact
from solver.halfplane.precision import warn_of_rounding
from solver.halfplane.pressing import ContactError
from solver.halfplane.profile import Profile
from solver.material.constants import Material, MaterialError
from solver.names import FACTORS

_OF_A_KIND = ("profile", "corner")  # one of each at a time; what varies is solved part by part


def contact_of_cases(
    arrays: Mapping[str, xr.DataArray], materials: Mapping[str, Material], phases: Sequence[str | Material]
) -> tuple[Contact, Array, tuple[str, ...], tuple[int, ...]]:
    """Contact and datum of cases of one kind; names and sizes of their dimensions.

    Raises
    ------
    FactorError
        What cannot be a case, a contact that does not exist among it.

    Warns
    -----
    PrecisionWarning
        Rounding costs digits: constants many decades apart, a speed next to the limiting one.
    """
    aligned, sizes = align(arrays)
    with np.errstate(all="ignore"):  # what is not finite is named in the outputs
        contact, datum = contact_of(aligned, materials, phases)
        try:
            _ = contact.pressing
        except ContactError as error:
            raise FactorError(str(error)) from None
    warn_of_rounding(contact.halfplane)
    return contact, datum, tuple(sizes), tuple(sizes.values())


def by_kind(arrays: dict[str, xr.DataArray], part: Callable[[dict[str, xr.DataArray]], xr.Dataset]) -> xr.Dataset:
    """The part of each profile and corner, put together along the dimension that they vary on."""
    for name in _OF_A_KIND:
        kinds = arrays[name].values if name in arrays else np.empty(0)
        if kinds.size < 2 or len(found := list(dict.fromkeys(kinds.flat))) < 2:
            continue
        if kinds.ndim > 1:
            raise FactorError(f"{name}: varies along {kinds.ndim} dimensions; give it along one")
        dim = arrays[name].dims[0]
        places = [np.flatnonzero(kinds == kind) for kind in found]
        solved = []
        for place in places:
            some = {key: array.isel({dim: place}) if dim in array.dims else array for key, array in arrays.items()}
            solved.append(by_kind(some, part))
        shared = [key for key in solved[0].data_vars if all(key in one for one in solved)]
        whole = xr.concat(
            [one[shared] for one in solved], dim, data_vars="all", coords="minimal", compat="override", join="override"
        )
        return whole.isel({dim: np.argsort(np.concatenate(places))})
    return part(arrays)


def coordinates(arrays: Mapping[str, xr.DataArray]) -> dict[str, xr.Variable]:
    """The factors as coordinates with units, and labels of the cases; materials and own profiles by name."""
    out: dict[str, xr.Variable] = {}
    for name, array in arrays.items():
        out |= {str(dim): array.coords[dim].variable for dim in array.dims if dim in array.coords and dim not in arrays}
        values = array.values
        if values.dtype == object:
            names = [
                v.name if isinstance(v, Material) else "own" if isinstance(v, Profile) else str(v) for v in values.flat
            ]
            values = np.array(names).reshape(values.shape)
        factor = FACTORS.get(name)
        attrs = {"units": factor.units, "long_name": factor.long_name} if factor else {}
        out[name] = xr.Variable(array.dims, values, attrs)
    return out


def require_c12(material: Material, names: Sequence[str]) -> None:
    """Raise if any output is named and the material has no c12 in some case.

    Raises
    ------
    MaterialError
    """
    if names and np.any(np.isnan(material.c12)):
        raise MaterialError(f"{material.name}: c12: missing; {names[0]} needs it [Pa]")


def require_finite(name: str, value: Array, of: str) -> None:
    """Raise if an output is not finite in some case, so that no file ever holds such a value unawares.

    Raises
    ------
    FactorError
    """
    if not np.all(np.isfinite(value)):
        raise FactorError(f"{name}: not finite for these {of}")
