"""The one way through the face: checked factors, one body for the cases of a kind, labelled outputs, put together.

An entrance (:func:`solver.solve`, :func:`solver.solve_interior`) says which outputs of a body it asks for, and nothing
about how the cases are told apart, aligned or labelled. Which body the cases lie on is decided by ``face/solution.py``.
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
_OF_A_KIND = ("profile", "corner")  # one of each at a time; what varies is solved part by part

Rows: TypeAlias = slice | Indices


@dataclass(frozen=True, eq=False)
class Cases(FactorValues):
    """Cases by their factors."""

    materials: Mapping[str, Material]
    phases: Sequence[str | Material]
    # Of a block of a table: a case of each distinct material and speed, and the one of each row unless all share one
    distinct: Self | None = None
    case_index: Indices | None = None

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
        """The one profile of cases of a kind."""
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
        """Return whether the leading and the trailing edge of cases of a kind are smooth: the punch has no corner."""
        if self.kind.contact == "point":
            smooth = self._one("profile") != "disc"
            return smooth, smooth
        trailing, leading = self.profile.smooth
        return leading, trailing

    @property
    def outline(self) -> Outline:
        """Factors that the profile of the cases takes; none if the user made the profile."""
        kind = self._one("profile")
        return Outline(()) if isinstance(kind, Profile) else PROFILES[kind]

    def _one(self, name: str) -> Any:
        """A named choice that all cases share, or its default."""
        return self.values[name].flat[0] if name in self.values else CHOICES[name][0]

    @property
    def kind(self) -> Kind:
        """The kind of body of cases of one kind."""
        return self.kinds[0]

    @property
    def coordinates(self) -> dict[str, xr.Variable]:
        """The factors as coordinates with units, and labels of the cases; materials and own profiles by name."""
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
        """Outputs over the dimensions of the cases and own axes; what does not vary is a broadcast view.

        values: mapping of str to ndarray, shape (..., own axes), SI.
        """
        extra = {name: axis.size for name, axis in (axes or {}).items()}
        outputs = {}
        for name, value in values.items():
            finite = np.isfinite(value)
            if not finite.all() and not np.all(finite | (np.isnan(value) & (described[name].sparse | hollow))):
                raise CaseError(f"{name}: not finite for these {origin}")
            whole = np.broadcast_to(value, (*self.sizes.values(), *extra.values()))
            outputs[name] = xr.Variable(
                (*self.sizes, *extra), whole, of_output(described[name], self.arrays, self.kinds)
            )
        return outputs

    def by_blocks(
        self, solved: Callable[[Self], Sequence[Mapping[str, Array]]], *shapes: tuple[int, ...], values: int = 1
    ) -> list[Mapping[str, Array]]:
        """Outputs of all cases, as far as all have them; a table of closed forms is solved block by block.

        solved: returns outputs by name for each of the shapes of own axes; (..., own axes). values: numbers a case
        that its largest temporaries hold.
        """
        if len(self.sizes) != 1 or self.kind.tabled:
            return list(solved(self))
        whole: list[dict[str, Array]] | None = None
        for rows, block in self._blocks(min(_BLOCK, max(1, _VALUES // values)), sort=values > 1):
            parts = solved(block)
            if whole is None:
                whole = [dict[str, Array]() for _ in shapes]
                names = [list(outputs) for outputs in parts]
            for outputs, known, shape, wanted in zip(parts, whole, shapes, names, strict=True):
                wanted[:] = [name for name in wanted if name in outputs]
                for name in wanted:
                    self._fill(known, name, outputs[name], shape, rows)
        return [{name: known[name] for name in wanted} for known, wanted in zip(whole or (), names, strict=True)]

    def _fill(self, whole: dict[str, Array], name: str, values: Array, shape: tuple[int, ...], rows: Rows) -> None:
        """Put an output of some rows among those of all; one that no row changes is kept once."""
        known = whole.get(name)
        if values.ndim <= len(shape) and (known is None or np.array_equal(values, known, equal_nan=True)):
            whole[name] = values
            return
        if known is None or known.ndim <= len(shape):
            whole[name] = np.empty((*self.sizes.values(), *shape))
            if known is not None:
                whole[name][...] = known
        whole[name][rows] = values

    def _blocks(self, most: int, sort: bool) -> Iterator[tuple[Rows, Self]]:
        """Yield rows and cases of each block; sorted rows of one material follow each other."""
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
                alike = min(_alike(number[order[begin:end]]) for number in numbers)
                end = begin + alike if alike > most // 8 else end  # enough for a block of one material
            rows = slice(begin, end) if order is None else order[begin:end]
            arrays = {name: _column(values, rows, dim) for name, values in columns.items()}
            case_index = None if first.size == 1 else which[rows]
            yield rows, replace(self, arrays=arrays, distinct=shared, case_index=case_index)
            begin, end = end, end + most

    def solved(self, title: str, part: Callable[[Self], xr.Dataset]) -> xr.Dataset:
        """The part of each kind of case, put together, with global attributes."""
        try:
            with one_thread():
                return self._by_kind(part).assign_attrs(attributes(title, self, self.phases))
        finally:
            trim_at_times()

    def _by_kind(self, part: Callable[[Self], xr.Dataset]) -> xr.Dataset:
        """The part of each profile, corner, surroundings and body, put together along what they vary on."""
        of_a_kind = (self.values.get(name, np.array("")) for name in (*_OF_A_KIND, "surroundings"))
        for labels in (*of_a_kind, self.kind_names):
            if labels.size < 2 or len(dict.fromkeys(labels.flat)) < 2:
                continue
            axis, places = _split(labels)
            dim = [*self.sizes][axis]
            solved = [self.selected(dim, place)._by_kind(part) for place in places]
            shared = [key for key in solved[0].data_vars if all(key in part for part in solved)]
            whole = xr.concat(
                [part[shared] for part in solved],
                dim, data_vars="all", coords="minimal", compat="override", join="override",
            )  # fmt: skip
            return whole.isel({dim: np.argsort(np.concatenate(places))})
        return part(self)

    def selected(self, dim: str, places: NDArray[np.intp]) -> Self:
        """Cases at some places of a dimension."""
        arrays = self.arrays.items()
        part = {k: a.isel({dim: places}) if dim in a.dims else a for k, a in arrays}
        return replace(self, arrays=part, distinct=None, case_index=None)


def factorized(labels: NDArray[Any]) -> tuple[NDArray[Any], Sequence[Any]]:
    """Number of each label, in small integers, which are sorted fastest, and the distinct labels."""
    flat = labels.ravel()
    try:
        codes, distinct = pd.factorize(flat, use_na_sentinel=False)
    except TypeError:  # no label, and refused when the material is looked up
        codes, distinct = np.arange(flat.size), flat
    return codes.astype(np.int16) if len(distinct) < 2**15 else codes, flat[_first(codes)].tolist()


def _first(codes: NDArray[Any]) -> Indices:
    """Place of each code, which are numbered as they first occur."""
    return np.flatnonzero(np.diff(np.maximum.accumulate(codes), prepend=-1))


def _distinct(numbers: Sequence[NDArray[Any]]) -> tuple[Indices, Indices]:
    """First row of each distinct combination of numbers, and the combination of every row."""
    if not numbers:
        return np.zeros(1, dtype=np.intp), np.zeros(0, dtype=np.intp)
    codes = pd.factorize(numbers[0], use_na_sentinel=False)[0]
    for number in numbers[1:]:
        known, values = pd.factorize(number, use_na_sentinel=False)
        codes = pd.factorize(codes * len(values) + known)[0]
    return _first(codes), codes


def _alike(values: NDArray[Any]) -> int:
    """Number of values at the beginning that are those of the first."""
    changes = np.append(values[1:] != values[:-1], True)
    return int(np.argmax(changes)) + 1


def _column(values: NDArray[Any], rows: Rows, dim: str) -> xr.DataArray:
    """Rows of a column, without dimension where one value is that of all."""
    if not values.ndim:
        return xr.DataArray(values)
    part = values[rows]
    alike = part[0] == part[-1] and np.all(part == part[:1])
    return xr.DataArray(part[:1].reshape(())) if alike else xr.DataArray(part, dims=dim)


def _split(kinds: NDArray[Any]) -> tuple[int, list[Indices]]:
    """An axis along which kinds differ, and the places on it that are alike on all others."""
    for axis, count in enumerate(kinds.shape):
        slices: dict[tuple[object, ...], list[int]] = {}
        for place, values in enumerate(np.moveaxis(kinds, axis, 0).reshape(count, -1)):
            slices.setdefault(tuple(values), []).append(place)
        if len(slices) > 1:
            break
    return axis, [np.array(places) for places in slices.values()]


def _label(value: object) -> str:
    if isinstance(value, Material | Stack):
        return value.name
    return "own" if isinstance(value, Profile | np.ndarray) else str(value)
