"""The one way through the face: checked factors, one body for the cases of a kind, labelled outputs, put together.

An entrance (:func:`solver.solve`, :func:`solver.solve_interior`) says which outputs of a body it asks for, and nothing
about how the cases are told apart, aligned or labelled. Which body the cases lie on is decided by ``face/solution.py``.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from approximation.arrays import Indices
from solver.arrays import Array, BoolArray, stack
from solver.body import Kind
from solver.cache import trim_after_call
from solver.described import Described, Outline
from solver.face.attributes import attributes, of_output
from solver.face.filmfactors import kinds_of, present
from solver.face.refusal import CaseError
from solver.halfplane.profile import Profile
from solver.material.constants import Material
from solver.names import CHOICES, FACTORS, PROFILES
from solver.stack.layers import Stack
from solver.threads import one_thread

_OF_A_KIND = ("profile", "corner")  # one of each at a time; what varies is solved part by part


@dataclass(frozen=True, eq=False)
class Cases:
    """Cases by their factors."""

    arrays: Mapping[str, xr.DataArray]
    materials: Mapping[str, Material]
    phases: Sequence[str | Material]

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

    @cached_property
    def kind(self) -> Kind:
        """The kind of body of cases of one kind."""
        return present(self.arrays)[0]

    @property
    def coordinates(self) -> dict[str, xr.Variable]:
        """The factors as coordinates with units, and labels of the cases; materials and own profiles by name."""
        out: dict[str, xr.Variable] = {}
        for name, array in self.arrays.items():
            labels = [dim for dim in array.dims if dim in array.coords and dim not in self.arrays]
            out |= {str(dim): array.coords[dim].variable for dim in labels}
            values = array.values
            if values.dtype == object:
                values = np.array([_label(value) for value in values.flat]).reshape(values.shape)
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
        kinds = present(self.arrays)
        extra = {name: axis.size for name, axis in (axes or {}).items()}
        outputs = {}
        for name, value in values.items():
            if not np.all(np.isfinite(value) | (np.isnan(value) & (described[name].sparse | hollow))):
                raise CaseError(f"{name}: not finite for these {origin}")
            whole = np.broadcast_to(value, (*self.sizes.values(), *extra.values()))
            outputs[name] = xr.Variable((*self.sizes, *extra), whole, of_output(described[name], self.arrays, kinds))
        return outputs

    def solved(self, title: str, part: Callable[[Self], xr.Dataset]) -> xr.Dataset:
        """The part of each kind of case, put together, with global attributes."""
        try:
            with one_thread():
                return self._by_kind(part).assign_attrs(attributes(title, self.arrays, self.phases))
        finally:
            trim_after_call()

    def _by_kind(self, part: Callable[[Self], xr.Dataset]) -> xr.Dataset:
        """The part of each profile, corner, surroundings and body, put together along what they vary on."""
        for name in (*_OF_A_KIND, "surroundings", "thickness"):
            labels = kinds_of(self.arrays) if name == "thickness" else self.arrays.get(name, xr.DataArray())
            kinds = labels.values
            if kinds.size < 2 or len(dict.fromkeys(kinds.flat)) < 2:
                continue
            dim, places = _split(labels)
            solved = [self._selected(dim, place)._by_kind(part) for place in places]
            shared = [key for key in solved[0].data_vars if all(key in part for part in solved)]
            whole = xr.concat(
                [part[shared] for part in solved],
                dim, data_vars="all", coords="minimal", compat="override", join="override",
            )  # fmt: skip
            return whole.isel({dim: np.argsort(np.concatenate(places))})
        return part(self)

    def _selected(self, dim: str, places: NDArray[np.intp]) -> Self:
        arrays = self.arrays.items()
        return replace(self, arrays={k: a.isel({dim: places}) if dim in a.dims else a for k, a in arrays})


def _split(kinds: xr.DataArray) -> tuple[str, list[Indices]]:
    """A dimension along which kinds differ, and the places on it that are alike in all others."""
    for dim in kinds.dims:
        whole = kinds.transpose(dim, ...).values
        slices: dict[tuple[object, ...], list[int]] = {}
        for place, values in enumerate(whole.reshape(len(whole), -1)):
            slices.setdefault(tuple(values), []).append(place)
        if len(slices) > 1:
            break
    return str(dim), [np.array(places) for places in slices.values()]


def _label(value: object) -> str:
    if isinstance(value, Material | Stack):
        return value.name
    return "own" if isinstance(value, Profile) else str(value)
