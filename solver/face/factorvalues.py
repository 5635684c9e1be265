"""Values of factors over all cases: which cases have a factor, and the kind of body of each."""

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
    """Return whether a value means that the case does not have this factor."""
    return (
        value is None or (isinstance(value, str) and not value) or (isinstance(value, float) and bool(np.isnan(value)))
    )


@dataclass(frozen=True, eq=False)
class FactorValues:
    """Factors of cases by name, and what they say of each case; masks have the axes of the cases, (...)."""

    arrays: Mapping[str, xr.DataArray]

    @cached_property
    def sizes(self) -> dict[str, int]:
        """Dimensions of the cases."""
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
        """A numeric factor, or its default; 0 where it has none."""
        return self.values.get(name, np.array(FACTORS[name].default or 0.0))

    def has(self, name: str) -> BoolArray:
        """Cases that have a factor."""
        if name not in self.values:
            return np.array(False)
        values = self.values[name]
        if values.dtype.kind in "fU":
            return np.asarray(~np.isnan(values) if values.dtype.kind == "f" else values != "")
        return np.array([not absent(value) for value in values.flat], dtype=bool).reshape(values.shape)

    def among(self, name: str, *choices: str) -> BoolArray:
        """Cases whose factor is one of the choices; none without the factor."""
        return np.asarray(np.any([self.values.get(name, np.array("")) == choice for choice in choices], axis=0))

    @cached_property
    def space(self) -> BoolArray:
        """Contacts in space: by the profile, or of revolution on a cut crystal."""
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
        """Names of the kinds of body; a case with a thickness or a stack has layers."""
        if not self.values.keys() & {BODY, "thickness", "profile", "surroundings"}:
            return np.array(KINDS["line", False, False].name)
        layered = np.array(True) if BODY in self.values else self.has("thickness")
        pointed, air = self.among("profile", *POINTED), self.among("surroundings", AIR)
        touches = np.select([self.space, pointed], ["space", "point"], "line")
        holds = [(touches == touch) & (layered == layers) & (air == airy) for touch, layers, airy in KINDS]
        return np.select(holds, [kind.name for kind in KINDS.values()], "")

    @cached_property
    def kinds(self) -> list[Kind]:
        """The kinds of body of the cases."""
        return [kind for kind in KINDS.values() if (self.kind_names == kind.name).any()]

    def refuse(self, name: str, bad: BoolArray, why: str) -> None:
        """Raise FactorError with the first value of a factor among the bad cases, if it has any."""
        if name not in self.values or not bad.any():
            return
        values, marked = np.broadcast_arrays(self.values[name], bad)
        first: Any = values[marked].flat[0]
        number = isinstance(first, float | np.floating)
        raise FactorError(f"{name}: {f'{first:g}' if number else shown(getattr(first, 'name', first))} {why}")


#: Factors that :func:`solver.body.around` reads: by their value, or only by whether a case has them, other than 0.
_READ = (
    "surroundings", BODY, "material", "base", "cut", "profile", "electric", "magnetic", "electrode",
    "interface_magnetic",
)  # fmt: skip
_THERE = ("thickness", "gap_radius", *OF_AN_ELECTRODE[1:])


def settled(arrays: Mapping[str, xr.DataArray]) -> dict[str, xr.DataArray]:
    """Factors with the surroundings of every case, where a film or a table leaves them open."""
    surroundings = arrays.get("surroundings")
    opened = (
        arrays.keys() & {BODY, "thickness"} or FactorValues(arrays).space.any()
        if surroundings is None
        else any(map(absent, surroundings.values.flat))
    )
    if not opened:
        return dict(arrays)
    which, cases = distinct_cases(arrays)
    names = [str(case.get("surroundings") or around(case)) for case in cases]
    chosen = which.copy(data=np.array(names)[which.values])
    return {**arrays, "surroundings": chosen if len({*names}) > 1 else chosen[(0,) * chosen.ndim]}


def distinct_cases(arrays: Mapping[str, xr.DataArray]) -> tuple[xr.DataArray, list[dict[str, Any]]]:
    """Number of each case among the distinct ones, as far as their surroundings ask, and these by their factors."""
    read = {name: _labels(arrays[name], name in _THERE) for name in (*_READ, *_THERE) if name in arrays}
    labels = xr.broadcast(*read.values())
    rows = list(zip(*(array.values.flat for array in labels), strict=True))
    number = {row: place for place, row in enumerate(dict.fromkeys(rows))}
    which = xr.DataArray(np.reshape([number[row] for row in rows], labels[0].shape), dims=labels[0].dims)
    named = (zip(read, row, strict=True) for row in number)
    return which, [{name: value for name, value in case if not absent(value)} for case in named]


def _labels(array: xr.DataArray, only_presence: bool) -> xr.DataArray:
    """A factor's values, or 1 where a case has it and it is not 0; without dimension where all are one."""
    values = array.values
    if only_presence:
        values = np.where([not absent(value) and value != 0 for value in values.flat], 1.0, np.nan)
        values = values.reshape(array.shape)
    labels = xr.DataArray(values.astype(object), dims=array.dims)
    first = labels.values.flat[0] if labels.size else None
    alike = all(label is first or label == first or (absent(label) and absent(first)) for label in labels.values.flat)
    return labels.isel(dict.fromkeys(labels.dims, 0)) if labels.size and alike else labels
