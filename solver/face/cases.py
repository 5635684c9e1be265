"""Cases of checked factors: sorted by kind, solved in blocks, and labelled.

The public functions (:func:`solver.solve`, :func:`solver.solve_interior`) state the outputs of a body that they
request, and leave sorting, aligning and labelling to this module. ``face/solution.py`` chooses the body.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Self, TypeAlias

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from approximation.arrays import Indices
from solver.arrays import Array, BoolArray, stack
from solver.body import Kind
from solver.cache import trim_at_times
from solver.described import Described, Outline
from solver.face.attributes import attributes, of_output
from solver.face.factorvalues import FactorValues
from solver.face.refusal import CaseError
from solver.halfplane.profile import Profile
from solver.material.constants import Material
from solver.names import CHOICES, FACTORS, OF_MATERIAL, PROFILES
from solver.stack.layers import Stack
from solver.threads import one_thread

_BLOCK = 32768  # rows of a table that are solved at a time: some 1 kB of temporaries each
_DISTINCT = 4096  # materials of a table whose tensors are stored: 2 kB each
_VALUES = 2**17  # of a field or a search at a time: some hundred temporaries of 8 bytes each inside the body
_OF_A_KIND = ("profile", "corner")  # factors that are equal in cases solved together

Rows: TypeAlias = slice | Indices


@dataclass(frozen=True, eq=False)
class Cases(FactorValues):
    """Cases by their factors."""

    materials: Mapping[str, Material]
    phases: Sequence[str | Material]
    distinct: Self | None = None  # In a block of a table: one case of each distinct material and speed
    case_index: Indices | None = None  # In a block of a table: index of each row among these, unless all share one

    @property
    def force(self) -> Array:
        """Force on the punch, per metre along a line; (...)."""
        return self.number(self.kind.loads.force)

    @property
    def charges(self) -> Array:
        """Electric and magnetic charge; (..., 2)."""
        return stack(*(self.number(name) for name in self.kind.loads.charges))

    @property
    def conducts(self) -> BoolArray:
        """True where the punch conducts (electric, magnetic); (..., 2)."""
        fields = (self.values.get(name, np.array(CHOICES[name][0])) for name in ("electric", "magnetic"))
        return stack(*(field == "conducting" for field in fields))

    @property
    def profile(self) -> Profile:
        """Profile that all cases share."""
        kind, corner = (self._one(name) for name in _OF_A_KIND)
        if isinstance(kind, Profile):
            return kind
        outline = PROFILES[kind]
        parameters = {name: self.number(name) for name in outline.needs}
        parameters |= {name: self.number(name) for name in outline.may if name in self.values and name in FACTORS}
        named = {"corner": corner} if "corner" in outline.may else {}
        profile: Profile = getattr(Profile, kind)(**parameters, **named)
        return profile

    @property
    def smooth_edges(self) -> tuple[bool, bool]:
        """True for the leading and the trailing edge of the contact if the punch has no corner there."""
        if self.kind.contact == "point":
            smooth = self._one("profile") != "disc"
            return smooth, smooth
        trailing, leading = self.profile.smooth
        return leading, trailing

    @property
    def outline(self) -> Outline:
        """Factors of the cases' profile, none for a profile of the user."""
        kind = self._one("profile")
        return Outline(()) if isinstance(kind, Profile) else PROFILES[kind]

    def _one(self, name: str) -> Any:
        """Return a choice that all cases share, or its default."""
        return self.values[name].flat[0] if name in self.values else CHOICES[name][0]

    @property
    def kind(self) -> Kind:
        """Kind of body that all cases share."""
        return self.kinds[0]

    @property
    def coordinates(self) -> dict[str, xr.Variable]:
        """Factors as coordinates with units, objects by name, and labels of the cases."""
        out: dict[str, xr.Variable] = {}
        for name, array in self.arrays.items():
            labels = [dim for dim in array.dims if dim in array.coords and dim not in self.arrays]
            out |= {str(dim): array.coords[dim].variable for dim in labels}
            values = array.values
            if values.dtype == object:
                codes, distinct = factorized(values)
                values = np.array([_label(value) for value in distinct])[codes].reshape(values.shape)
            factor = FACTORS.get(name)
            words = factor.long_name if factor else f"{name} of the case"
            attrs = {"units": factor.units if factor else "1", "long_name": words}
            out[name] = xr.Variable(array.dims, values, attrs)
        return out

    def labelled(
        self,
        values: Mapping[str, Array],
        described: Mapping[str, Described],
        origin: str,
        axes: Mapping[str, xr.Variable] | None = None,
        *,
        hollow: bool = False,
    ) -> dict[str, xr.Variable]:
        """Return outputs (..., other axes), SI, over the dimensions of the cases and ``axes``, as broadcast views."""
        extra = {name: axis.size for name, axis in (axes or {}).items()}
        outputs = {}
        for name, value in values.items():
            finite = np.isfinite(value)
            if not finite.all() and not np.all(finite | (np.isnan(value) & (described[name].sparse | hollow))):
                raise CaseError(f"{name}: not finite for these {origin}")
            data = np.broadcast_to(value, (*self.sizes.values(), *extra.values()))
            attrs = of_output(described[name], self.arrays, self.kinds)
            outputs[name] = xr.Variable((*self.sizes, *extra), data, attrs)
        return outputs

    def by_blocks(
        self,
        solved: Callable[[Self], Sequence[Mapping[str, Array]]],  # Returns outputs by name for each of the shapes
        *shapes: tuple[int, ...],  # Of the axes after those of the cases
        values: int = 1,  # Numbers per case in the largest temporaries
    ) -> list[Mapping[str, Array]]:
        """Return outputs that all cases have, and solve a table of closed forms block by block; (..., other axes)."""
        if len(self.sizes) != 1 or self.kind.tabled:
            return list(solved(self))
        joined: list[dict[str, Array]] | None = None
        for rows, block in self._blocks(min(_BLOCK, max(1, _VALUES // values)), sort=values > 1):
            parts = solved(block)
            if joined is None:
                joined = [dict[str, Array]() for _ in shapes]
                names = [list(outputs) for outputs in parts]
            for outputs, known, shape, common in zip(parts, joined, shapes, names, strict=True):
                common[:] = [name for name in common if name in outputs]
                for name in common:
                    self._fill(known, name, outputs[name], shape, rows)
        return [{name: known[name] for name in common} for known, common in zip(joined or (), names, strict=True)]

    def _fill(self, outputs: dict[str, Array], name: str, values: Array, shape: tuple[int, ...], rows: Rows) -> None:
        """Insert an output of some rows, which is stored once if it is equal in all rows."""
        known = outputs.get(name)
        if values.ndim <= len(shape) and (known is None or np.array_equal(values, known, equal_nan=True)):
            outputs[name] = values
            return
        if known is None or known.ndim <= len(shape):
            outputs[name] = np.empty((*self.sizes.values(), *shape))
            if known is not None:
                outputs[name][...] = known
        outputs[name][rows] = values

    def _blocks(self, most: int, sort: bool) -> Iterator[tuple[Rows, Self]]:
        """Yield rows and cases of each block, sorted by material if ``sort`` or if there are many."""
        ((dim, count),) = self.sizes.items()
        columns = {name: array.values for name, array in self.arrays.items()}
        keys = [columns[name] for name in (*OF_MATERIAL, "speed") if name in columns and columns[name].ndim]
        numbers = [key if key.dtype.kind == "f" else factorized(key)[0] for key in keys]
        first, which = _distinct(numbers)
        shared = None
        if first.size <= _DISTINCT and not sort:
            numbers, shared = [], replace(self, arrays={k: _column(v, first, dim) for k, v in columns.items()})
        order = np.lexsort(numbers) if numbers else None
        begin, end = 0, most
        while begin < count:
            if order is not None and count > most:
                equal = min(_equal_at_start(number[order[begin:end]]) for number in numbers)
                end = begin + equal if equal > most // 8 else end  # enough for a block of one material
            rows = slice(begin, end) if order is None else order[begin:end]
            arrays = {name: _column(values, rows, dim) for name, values in columns.items()}
            case_index = None if first.size == 1 else which[rows]
            yield rows, replace(self, arrays=arrays, distinct=shared, case_index=case_index)
            begin, end = end, end + most

    def solved(self, title: str, part: Callable[[Self], xr.Dataset]) -> xr.Dataset:
        """Return the joined solutions of each kind of case by ``part``, with global attributes."""
        try:
            with one_thread():
                return self._by_kind(part).assign_attrs(attributes(title, self, self.phases))
        finally:
            trim_at_times()

    def _by_kind(self, part: Callable[[Self], xr.Dataset]) -> xr.Dataset:
        """Return the joined solutions of each profile, corner, surroundings and kind of body by ``part``."""
        choices = (self.values.get(name, np.array("")) for name in (*_OF_A_KIND, "surroundings"))
        for labels in (*choices, self.kind_names):
            if labels.size < 2 or len(dict.fromkeys(labels.flat)) < 2:
                continue
            axis, groups = _split(labels)
            dim = [*self.sizes][axis]
            solved = [self.selected(dim, group)._by_kind(part) for group in groups]
            shared = [key for key in solved[0].data_vars if all(key in part for part in solved)]
            joined = xr.concat(
                [part[shared] for part in solved],
                dim, data_vars="all", coords="minimal", compat="override", join="override",
            )  # fmt: skip
            return joined.isel({dim: np.argsort(np.concatenate(groups))})
        return part(self)

    def selected(self, dim: str, indices: NDArray[np.intp]) -> Self:
        """Return the cases at indices along a dimension."""
        arrays = {name: a.isel({dim: indices}) if dim in a.dims else a for name, a in self.arrays.items()}
        return replace(self, arrays=arrays, distinct=None, case_index=None)


def factorized(labels: NDArray[Any]) -> tuple[NDArray[Any], Sequence[Any]]:
    """Return the number of each label, in small integers, which sort fastest, and the distinct labels."""
    flat = labels.ravel()
    try:
        codes, distinct = pd.factorize(flat, use_na_sentinel=False)
    except TypeError:  # not hashable, and refused when the material is looked up
        codes, distinct = np.arange(flat.size), flat
    return codes.astype(np.int16) if len(distinct) < 2**15 else codes, flat[_first(codes)].tolist()


def _first(codes: NDArray[Any]) -> Indices:
    """Index of each code's first occurrence, of codes numbered in that order."""
    return np.flatnonzero(np.diff(np.maximum.accumulate(codes), prepend=-1))


def _distinct(numbers: Sequence[NDArray[Any]]) -> tuple[Indices, Indices]:
    """Return the first row of each distinct combination of numbers, and the index of each row's combination."""
    if not numbers:
        return np.zeros(1, dtype=np.intp), np.zeros(0, dtype=np.intp)
    codes = pd.factorize(numbers[0], use_na_sentinel=False)[0]
    for number in numbers[1:]:
        known, values = pd.factorize(number, use_na_sentinel=False)
        codes = pd.factorize(codes * len(values) + known)[0]
    return _first(codes), codes


def _equal_at_start(values: NDArray[Any]) -> int:
    """Number of leading values that equal the first."""
    changes = np.append(values[1:] != values[:-1], True)
    return int(np.argmax(changes)) + 1


def _column(values: NDArray[Any], rows: Rows, dim: str) -> xr.DataArray:
    """Return rows of a column, or a scalar if all are equal."""
    if not values.ndim:
        return xr.DataArray(values)
    part = values[rows]
    equal = part[0] == part[-1] and np.all(part == part[:1])
    return xr.DataArray(part[:1].reshape(())) if equal else xr.DataArray(part, dims=dim)


def _split(kinds: NDArray[Any]) -> tuple[int, list[Indices]]:
    """Return an axis along which kinds differ, and groups of indices on it with equal kinds on all other axes."""
    for axis, count in enumerate(kinds.shape):
        groups: dict[tuple[object, ...], list[int]] = {}
        for index, values in enumerate(np.moveaxis(kinds, axis, 0).reshape(count, -1)):
            groups.setdefault(tuple(values), []).append(index)
        if len(groups) > 1:
            break
    return axis, [np.array(indices) for indices in groups.values()]


def _label(value: object) -> str:
    """Return the text of a value of a factor in coordinates."""
    if isinstance(value, Material | Stack):
        return value.name
    return "own" if isinstance(value, Profile | np.ndarray) else str(value)
