"""Films of any thickness from tables of films of unit thickness: by dimension only P R/h^2, T/P and J/P matter.

Half-lengths over the thickness fall into windows of half a decade. A window has one table for every radius, load,
charge and thickness, and a case is answered by the window that holds its half-length: its answer does not depend on
the cases that are solved beside it.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Self

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array, BoolArray
from solver.film.causes import Loading
from solver.film.contact import FilmContact
from solver.film.grading import Graded
from solver.film.peaks import DEPTH, PeakTable
from solver.film.powerlaw import Constants, constants_of, material_from
from solver.film.press import LengthsError, load_at_nodes
from solver.film.speed import critical_speed
from solver.film.stack import RIGID, Layer, Stack
from solver.film.table import LEAST, MOST, RangeError, Table, table
from solver.halfplane.contact import Contact
from solver.halfplane.pressing import ContactError
from solver.halfplane.profile import Profile
from solver.halfplane.sliding import Sliding
from solver.material.constants import Material

_A_DECADE = 2  # windows
_OVERLAP = 1.3  # of a window with its neighbours
_NODES = 20  # half-lengths of a window
_FIRST = int(np.floor(_A_DECADE * np.log10(LEAST)))
_LAST = int(np.ceil(_A_DECADE * np.log10(MOST))) - 1
_ACCURACY = 1.25  # factor on the number of terms: 1e-9 of tractions that are next to zero, too
_BELOW, _ABOVE = 2, 1  # windows searched for other lengths of charged contacts
_ROUGH_NODES, _ROUGH_ACCURACY = 8, 0.5  # of their tables: 1e-3 of the load, for a fifth of the time
_APART = 1.05  # from the window of a contact, within which they say nothing
_TABLES, _PEAK_TABLES = 256, 32  # kept: 0.4 MB and some MB each
_STACKS = 256

Indices = NDArray[np.intp]


@dataclass(frozen=True)
class Coat:
    """One layer, as what tables are told apart by.

    Attributes
    ----------
    of
        Constants of a homogeneous layer, or the profile of a graded one.
    thickness
        Over that of the top layer.
    electric, magnetic
        What the interface below is to each field; None for the default.
    """

    of: Constants | Callable[[Array], Material]
    thickness: float = 1.0
    electric: str | None = None
    magnetic: str | None = None

    @classmethod
    def like(cls, layer: Layer, unit: float) -> Self:
        """Of a layer, with lengths over ``unit`` [m]."""
        of = layer.profile if isinstance(layer, Graded) else constants_of(layer.material)
        return cls(of, layer.thickness / unit, layer.electric, layer.magnetic)

    def layer(self) -> Layer:
        """The layer."""
        if callable(self.of):
            return Graded(self.of, self.thickness, self.electric, self.magnetic)
        return Layer(material_from(self.of, "film"), self.thickness, self.electric, self.magnetic)


@dataclass(frozen=True)
class Kind:
    """What cases share that one set of tables answers.

    Attributes
    ----------
    layers
        From the top down.
    base
        Constants of the base; none: rigid.
    friction
        Coulomb coefficient.
    conducts
        Whether the punch conducts (electric, magnetic).
    smooth
        Whether the trailing and the leading edge of the contact are smooth.
    degree
        Largest power of x in the slope of the punch.
    speed
        Steady sliding speed [m/s].
    """

    layers: tuple[Coat, ...]
    base: Constants | None
    friction: float
    conducts: tuple[bool, bool]
    smooth: tuple[bool, bool]
    degree: int
    speed: float = 0.0

    def stack(self) -> Stack:
        """The film, its top layer of unit thickness, on its base.

        Raises
        ------
        MaterialError
            Inadmissible materials, an interface that the base does not have.
        """
        return _stack(self.layers, self.base, self.speed)

    @property
    def uniform(self) -> bool:
        """Whether the film is one homogeneous layer."""
        return len(self.layers) == 1 and not callable(self.layers[0].of)

    @property
    def above_ground(self) -> float:
        """Thickness above the first grounded electrode, or of all layers, over that of the top layer."""
        stack, total = self.stack(), 0.0
        for layer, held in zip(stack.layers, stack.grounded, strict=True):
            total += layer.thickness
            if 2 in held:
                break
        return total


@lru_cache(_STACKS)
def _stack(layers: tuple[Coat, ...], base: Constants | None, speed: float) -> Stack:
    """One stack for all tables of it: what is found once for a stack, is found once."""
    made = tuple(coat.layer() for coat in layers)
    return Stack(made, RIGID if base is None else material_from(base, "base"), speed)


@lru_cache(_STACKS)
def critical(kind: Kind) -> float:
    """First critical speed [m/s] of films of a kind, whatever their thickness."""
    return critical_speed(kind.stack(), kind.conducts)


@lru_cache(_TABLES)
def window(kind: Kind, number: int) -> Table:
    """Table of a film of unit thickness over one window of half-lengths, counted in half decades from 1."""
    return _table(kind, number, _NODES, _ACCURACY)


@lru_cache(_TABLES)
def _rough_window(kind: Kind, number: int) -> Table:
    """The same, good enough to tell whether its half-lengths carry a load."""
    return _table(kind, number, _ROUGH_NODES, _ROUGH_ACCURACY)


def _table(kind: Kind, number: int, nodes: int, accuracy: float) -> Table:
    ends = 10.0 ** (np.array([number, number + 1]) / _A_DECADE) * np.array([1 / _OVERLAP, _OVERLAP])
    least, most = np.clip(ends, LEAST, MOST)
    return table(
        kind.stack(), kind.friction, kind.conducts,
        smooth=kind.smooth, degree=kind.degree, least=float(least), most=float(most), nodes=nodes, accuracy=accuracy,
    )  # fmt: skip


@lru_cache(_PEAK_TABLES)
def peak_window(kind: Kind, number: int) -> PeakTable:
    """Stresses over one window; of a film no wider than it has a depth below 0.1 h."""
    whole = window(kind, number)
    return PeakTable(replace(whole, upper=min(whole.upper, 0.99 / DEPTH * kind.stack().thickness)))


@dataclass(frozen=True, eq=False)
class Films:
    """Contacts of cases of one kind, each on its own film.

    Parameters
    ----------
    kind
        What the cases share.
    profile
        The punch; parameters (case,) or ().
    load, charges, datum, thickness
        P [N/m] (case,), T [C/m] and J [Wb/m] (case, 2), L [m] and the top layer's thickness [m] (case,).

    Raises
    ------
    ContactError
        No contact, more than one, one that would need tension or that is beyond the resolved range.
    """

    kind: Kind
    profile: Profile
    load: Array
    charges: Array
    datum: Array
    thickness: Array

    def with_charges(self, charges: Array) -> Self:
        """The same punches, loads and films with other charges."""
        return replace(self, charges=charges)

    def part(self, places: slice) -> Self:
        """Some of the cases."""
        p, size = self.profile, self.load.shape

        def chosen(values: Array) -> Array:
            return np.asarray(np.broadcast_to(values, size)[places])

        profile = Profile(
            tuple(chosen(c) for c in p.slope), p.smooth,
            None if p.width is None else chosen(p.width),
            None if p.moment is None else chosen(p.moment),
        )  # fmt: skip
        of_case = {name: getattr(self, name)[places] for name in ("load", "charges", "datum", "thickness")}
        return replace(self, profile=profile, **of_case)

    @cached_property
    def parts(self) -> list[tuple[Indices, int, FilmContact]]:
        """Cases, window and contacts on films of unit thickness."""
        found = []
        for number in np.unique(self._windows).tolist():
            places = np.flatnonzero(self._windows == number)
            found.append((places, number, self._contact(places, window(self.kind, number))))
        return found

    def gather(self, output: Callable[[FilmContact], Array]) -> Array:
        """An output of the contacts on films of unit thickness; (case, ...)."""
        values = [(places, output(contact)) for places, _, contact in self.parts]
        whole = np.empty((self.load.size, *values[0][1].shape[1:]))
        for places, value in values:
            whole[places] = value
        return whole

    def _contact(self, places: Indices, of: Table) -> FilmContact:
        """Contacts of some cases on films of unit thickness: lengths, loads and charges over the thickness."""
        h = self.thickness[places]

        def chosen(values: Array) -> Array:
            return np.asarray(np.broadcast_to(values, self.load.shape)[places])

        profile = self.profile
        unit = Profile(
            tuple(chosen(c) * h**k for k, c in enumerate(profile.slope)),
            profile.smooth,
            None if profile.width is None else chosen(profile.width) / h,
            None if profile.moment is None else chosen(profile.moment) / h**2,
        )
        charges = self.charges[places] / h[:, None]
        return FilmContact(of, unit, self.load[places] / h, charges, self.datum[places] / h)

    # -- windows -------------------------------------------------------------------------------------------------------
    @cached_property
    def _windows(self) -> Indices:
        """Window of every case; (case,)."""
        if self.profile.width is not None:
            return _number(np.broadcast_to(self.profile.width / (2 * self.thickness), self.load.shape))
        number = _number(self._guess)
        asked = np.arange(self.load.size)
        for _ in range(_LAST - _FIRST + 2):
            beside = np.zeros(asked.size, dtype=np.intp)
            for one in np.unique(number[asked]).tolist():
                here = number[asked] == one
                beside[here] = self._beside(asked[here], window(self.kind, one))
            asked, beside = asked[beside != 0], beside[beside != 0]
            if not asked.size:
                return number
            number[asked] += beside
            if np.any((number < _FIRST) | (number > _LAST)):
                raise RangeError(
                    f"contact: {'narrower' if np.any(number < _FIRST) else 'wider'} than the resolved range, "
                    f"{LEAST:g} to {MOST:g} of half-length over thickness"
                )
        raise LengthsError("contact: no contact of one length carries the load (charges too large for it)")

    def _beside(self, places: Indices, of: Table) -> Indices:
        """-1 or 1 where the half-length is below or above a table's, 0 where it is within."""
        enough = self._enough(places, of)
        _require_one(enough)
        return np.where(enough[:, 0], -1, np.where(enough[:, -1], 0, 1))

    def _enough(self, places: Indices, of: Table) -> BoolArray:
        """Whether half-lengths of a table carry the load, or more; (case, node)."""
        contact = self._contact(places, of)
        load = load_at_nodes(of, Loading.of(of, contact.profile, contact.load, contact.charges))
        return np.asarray(load >= contact.load[:, None] * contact.scale[1])

    def require_one_length(self) -> None:
        """Refuse contacts of other lengths that carry the load: charges can make some, up to a decade shorter.

        Raises
        ------
        LengthsError
            Contacts of more than one length carry the load.
        """
        charged = np.any(self.charges != 0, -1)
        if self.profile.width is not None or not np.any(charged):
            return
        for number in np.unique(self._windows[charged]).tolist():
            places = np.flatnonzero(charged & (self._windows == number))
            own = window(self.kind, number)
            lengths, enough = [own.half_lengths], [self._enough(places, own)]
            for other in {*range(max(number - _BELOW, _FIRST), min(number + _ABOVE, _LAST) + 1)} - {number}:
                rough = _rough_window(self.kind, other)
                apart = (rough.half_lengths * _APART < own.lower) | (rough.half_lengths > own.upper * _APART)
                lengths.append(rough.half_lengths[apart])
                enough.append(self._enough(places, rough)[:, apart])
            _require_one(np.concatenate(enough, -1)[:, np.argsort(np.concatenate(lengths))])

    @property
    def _guess(self) -> Array:
        """Half-length over thickness that the closed form of the film's half-plane has; less where it is thin."""
        sliding = Sliding(
            self.kind.stack().media[0].halfplane, np.array(self.kind.friction), np.array(self.kind.conducts)
        )
        try:
            half = Contact(sliding, self.profile, self.load, self.charges).half_width
        except ContactError:
            half = self.thickness
        ratio = np.broadcast_to(half / self.thickness, self.load.shape)
        return ratio if self.kind.base is not None else np.asarray(np.where(ratio > 1, ratio ** (2 / 3), ratio))


def _require_one(enough: BoolArray) -> None:
    if np.any(np.sum(enough[:, 1:] != enough[:, :-1], -1) > 1):
        raise LengthsError("contact: contacts of more than one length carry the load (charges too large for it)")


def _number(ratio: Array) -> Indices:
    found = np.floor(_A_DECADE * np.log10(ratio))
    return np.asarray(np.clip(found, _FIRST, _LAST), dtype=np.intp)
