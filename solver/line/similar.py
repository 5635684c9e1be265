"""Films of any thickness from tables of films of unit thickness: by dimension only P R/h^2, T/P and J/P matter.

Half-lengths over the thickness fall into windows of half a decade. A window has one table for every radius, load,
charge and thickness, and a case is answered by the window that holds its half-length: its answer does not depend on
the cases that are solved beside it.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, BoolArray, joined, selected
from solver.halfplane.contact import Contact
from solver.halfplane.pressing import ContactError
from solver.halfplane.profile import Profile
from solver.halfplane.sliding import Sliding
from solver.line.contact import FilmContact
from solver.line.extent import Loading, load_at_nodes, require_one
from solver.line.table import Table
from solver.line.windows import FIRST, LAST, Kind, number_of, searched, window
from solver.stack.electroded import met

_BELOW, _ABOVE = 2, 1  # windows searched for other lengths of charged contacts
_APART = 1.05  # from the window of a contact, within which they say nothing


@dataclass(frozen=True, eq=False)
class Films:
    """Contacts of cases of one kind, each on its own film."""

    kind: Kind
    profile: Profile
    load: Array
    charges: Array
    datum: Array
    thickness: Array
    punch_datum: Array | None = None

    def with_charges(self, charges: Array) -> Self:
        """The same punches, loads and films with other charges."""
        return replace(self, charges=charges)

    def part(self, places: slice | Indices) -> Self:
        """Some of the cases."""
        chosen = selected(self, places, "load", "charges", "datum", "thickness", "punch_datum")
        return replace(chosen, profile=self.profile.part(places, self.load.shape))

    @cached_property
    def parts(self) -> list[tuple[Indices, int, FilmContact]]:
        """Cases, window and contacts on films of unit thickness."""
        pieces = []
        for number in np.unique(self._windows).tolist():
            places = np.flatnonzero(self._windows == number)
            pieces.append((places, number, self._contact(places, window(self.kind, number))))
        return pieces

    def gather(self, output: Callable[[FilmContact], Array]) -> Array:
        """An output of the contacts on films of unit thickness; (case, ...)."""
        parts = [(places, {"output": output(contact)}) for places, _, contact in self.parts]
        return joined(parts, self.load.size)["output"]

    def _contact(self, places: Indices, table: Table) -> FilmContact:
        """Contacts of some cases on films of unit thickness: lengths, loads and charges over the thickness."""
        h = self.thickness[places]

        unit = self.profile.part(places, self.load.shape).in_units_of(h)
        charges = self.charges[places] / h[:, None]
        punch_datum = None if self.punch_datum is None else self.punch_datum[places] / h
        return FilmContact(table, unit, self.load[places] / h, charges, self.datum[places] / h, punch_datum)

    # -- windows -------------------------------------------------------------------------------------------------------
    @cached_property
    def _windows(self) -> Indices:
        """Window of every case; (case,)."""
        if self.profile.width is not None:
            return number_of(np.broadcast_to(self.profile.width / (2 * self.thickness), self.load.shape))
        return searched(
            self._guess, lambda places, number: self._beside(places, window(self.kind, number)), self.thickness,
            "half-length", "load",
        )  # fmt: skip

    def _beside(self, places: Indices, table: Table) -> Indices:
        """-1 or 1 where the half-length is below or above a table's, 0 where it is within."""
        enough = self._enough(places, table)
        require_one(enough)
        return np.where(enough[:, 0], -1, np.where(enough[:, -1], 0, 1))

    def _enough(self, places: Indices, table: Table) -> BoolArray:
        """True for half-lengths of a table that carry the load or more; (case, node)."""
        contact = self._contact(places, table)
        load = load_at_nodes(table, Loading.of(table, contact.profile, contact.load, contact.charges))
        return np.asarray(load >= contact.load[:, None] * contact.scale[1])

    def require_one_length(self) -> None:
        """Refuse contacts of other lengths that carry the load: charges can make some, up to a decade shorter."""
        charged = np.any(self.charges != 0, -1)
        if self.profile.width is not None or not np.any(charged):
            return
        for number in np.unique(self._windows[charged]).tolist():
            places = np.flatnonzero(charged & (self._windows == number))
            exact = window(self.kind, number)
            lengths, enough = [exact.half_lengths], [self._enough(places, exact)]
            for other in {*range(max(number - _BELOW, FIRST), min(number + _ABOVE, LAST) + 1)} - {number}:
                rough = window(self.kind, other, rough=True)
                elsewhere = (rough.half_lengths * _APART < exact.lower) | (rough.half_lengths > exact.upper * _APART)
                lengths.append(rough.half_lengths[elsewhere])
                enough.append(self._enough(places, rough)[:, elsewhere])
            require_one(np.concatenate(enough, -1)[:, np.argsort(np.concatenate(lengths))])

    @property
    def _guess(self) -> Array:
        """Half-length over thickness that the closed form of the film's half-plane has; less where it is thin."""
        kind = self.kind
        top = met(kind.stack)
        sliding = Sliding(top, np.array(kind.friction), np.array(kind.conducts), kind.elastic)
        try:
            half = Contact(sliding, self.profile, self.load, self.charges).half_width
        except ContactError:
            half = self.thickness
        ratio = np.broadcast_to(half / self.thickness, self.load.shape)
        return np.asarray(np.where(ratio > 1, ratio ** (2 / 3), ratio)) if self.kind.stack.rigid else ratio
