"""Values of factors over all cases, masks of cases, and the kind of body of each case."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver.arrays import Array, BoolArray, shown
from solver.body import KINDS, Kind, around, is_cut
from solver.face.refusal import FactorError
from solver.names import AIR, BODY, FACTORS, OF_AN_ELECTRODE, ON_CUTS, PROFILES

POINTED = tuple(name for name, outline in PROFILES.items() if outline.contact == "point")
IN_SPACE = tuple(name for name, outline in PROFILES.items() if outline.space)


def absent(value: object) -> bool:
    """Return whether a value means that the case lacks this factor."""
    return (
        value is None or (isinstance(value, str) and not value) or (isinstance(value, float) and bool(np.isnan(value)))
    )


@dataclass(frozen=True, eq=False)
class FactorValues:
    """Factors of cases by name, and masks of cases over the case axes (...)."""

    arrays: Mapping[str, xr.DataArray]

    @cached_property
    def sizes(self) -> dict[str, int]:
        """Sizes of the cases' dimensions."""
        return {str(dim): size for array in self.arrays.values() for dim, size in array.sizes.items()}

    @cached_property
    def values(self) -> dict[str, NDArray[Any]]:
        """Factors with one axis for each dimension, of length one where the factor does not vary."""
        aligned = {}
        for name, array in self.arrays.items():
            present = [dim for dim in self.sizes if dim in array.dims]
            shape = [array.sizes.get(dim, 1) for dim in self.sizes]
            aligned[name] = array.transpose(*present).values.reshape(shape)
        return aligned

    def number(self, name: str) -> Array:
        """Return a numeric factor, its default or 0; (...)."""
        return self.values.get(name, np.array(FACTORS[name].default or 0.0))

    def has(self, name: str) -> BoolArray:
        """Return True for cases that have a factor; (...)."""
        if name not in self.values:
            return np.array(False)
        values = self.values[name]
        if values.dtype.kind in "fU":
            return np.asarray(~np.isnan(values) if values.dtype.kind == "f" else values != "")
        return np.array([not absent(value) for value in values.flat], dtype=bool).reshape(values.shape)

    def among(self, name: str, *choices: str) -> BoolArray:
        """Return True for cases whose factor is one of the choices; (...)."""
        return np.asarray(np.any([self.values.get(name, np.array("")) == choice for choice in choices], axis=0))

    @cached_property
    def space(self) -> BoolArray:
        """True for contacts in space, by their profile or on a cut crystal; (...)."""
        space, on_cuts = self.among("profile", *IN_SPACE), self.among("profile", *ON_CUTS)
        if not on_cuts.any() or "cut" in self.values:
            return np.asarray(space | on_cuts if on_cuts.any() else space)
        for name in ("material", "base", BODY):
            if name in self.values and self.values[name].dtype.kind in "OU":
                known = {value: is_cut(value) for value in dict.fromkeys(self.values[name].flat)}
                cut = np.array([known[value] for value in self.values[name].flat]).reshape(self.values[name].shape)
                space = space | (on_cuts & cut)
        return space

    @cached_property
    def kind_names(self) -> NDArray[np.str_]:
        """Names of the cases' kinds of body; a case with a thickness or a stack has layers; (...)."""
        if not self.values.keys() & {BODY, "thickness", "profile", "surroundings"}:
            return np.array(KINDS["line", False, False].name)
        layered = np.array(True) if BODY in self.values else self.has("thickness")
        pointed, air = self.among("profile", *POINTED), self.among("surroundings", AIR)
        touches = np.select([self.space, pointed], ["space", "point"], "line")
        masks = [(touches == touch) & (layered == layers) & (air == in_air) for touch, layers, in_air in KINDS]
        return np.select(masks, [kind.name for kind in KINDS.values()], "")

    @cached_property
    def kinds(self) -> list[Kind]:
        """Kinds of body of the cases."""
        return [kind for kind in KINDS.values() if (self.kind_names == kind.name).any()]

    def refuse(self, name: str, bad: BoolArray, why: str) -> None:
        """Refuse the bad cases by the first value of a factor among them, if it is given."""
        if name not in self.values or not bad.any():
            return
        values, marked = np.broadcast_arrays(self.values[name], bad)
        first: Any = values[marked].flat[0]
        number = isinstance(first, float | np.floating)
        raise FactorError(f"{name}: {f'{first:g}' if number else shown(getattr(first, 'name', first))} {why}")


#: Factors that :func:`solver.body.around` reads by their value, and those whose presence, other than as 0, it reads.
_BY_VALUE = (
    "surroundings", BODY, "material", "base", "cut", "profile", "electric", "magnetic", "electrode",
    "interface_magnetic",
)  # fmt: skip
_BY_PRESENCE = ("thickness", "gap_radius", *OF_AN_ELECTRODE[1:])


def settled(arrays: Mapping[str, xr.DataArray]) -> dict[str, xr.DataArray]:
    """Return the factors with default surroundings of cases on films or in tables that lack them."""
    surroundings = arrays.get("surroundings")
    incomplete = (
        arrays.keys() & {BODY, "thickness"} or FactorValues(arrays).space.any()
        if surroundings is None
        else any(map(absent, surroundings.values.flat))
    )
    if not incomplete:
        return dict(arrays)
    index, cases = distinct_cases(arrays)
    names = [str(case.get("surroundings") or around(case)) for case in cases]
    settled_names = index.copy(data=np.array(names)[index.values])
    if len({*names}) == 1:
        settled_names = settled_names[(0,) * settled_names.ndim]
    return {**arrays, "surroundings": settled_names}


def distinct_cases(arrays: Mapping[str, xr.DataArray]) -> tuple[xr.DataArray, list[dict[str, Any]]]:
    """Return the cases that differ in factors of their surroundings, and the index of each case among them."""
    names = [name for name in (*_BY_VALUE, *_BY_PRESENCE) if name in arrays]
    labels = xr.broadcast(*(_labels(arrays[name], name in _BY_PRESENCE) for name in names))
    rows = list(zip(*(array.values.flat for array in labels), strict=True))
    number = {row: count for count, row in enumerate(dict.fromkeys(rows))}
    index = xr.DataArray(np.reshape([number[row] for row in rows], labels[0].shape), dims=labels[0].dims)
    cases = (zip(names, row, strict=True) for row in number)
    return index, [{name: value for name, value in case if not absent(value)} for case in cases]


def _labels(array: xr.DataArray, only_presence: bool) -> xr.DataArray:
    """Return a factor's values, or 1 where a case has it other than as 0; a scalar if all are equal."""
    values = array.values
    if only_presence:
        values = np.where([not absent(value) and value != 0 for value in values.flat], 1.0, np.nan)
        values = values.reshape(array.shape)
    labels = xr.DataArray(values.astype(object), dims=array.dims)
    first = labels.values.flat[0] if labels.size else None
    equal = all(label is first or label == first or (absent(label) and absent(first)) for label in labels.values.flat)
    return labels.isel(dict.fromkeys(labels.dims, 0)) if labels.size and equal else labels
