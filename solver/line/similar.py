"""Films of any thickness, read from tables of films of unit thickness over windows of half-length over thickness.

The window of a case depends on that case alone, so that its result does not depend on the others.
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
_MARGIN = 1.05  # ratio to the contact's window beyond which rough tables can tell another length from the contact's


@dataclass(frozen=True, eq=False)
class Films:
    """Contacts of cases of one kind, each on its own film."""

    kind: Kind
    profile: Profile
    load: Array  # P [N/m]; (case,)
    charges: Array  # T [C/m] and J [Wb/m]; (case, 2)
    datum: Array  # L [m]; (case,)
    thickness: Array  # Of the top layer [m]; (case,)
    punch_datum: Array | None = None  # Reference length of an elastic punch [m]; (case,)

    def with_charges(self, charges: Array) -> Self:
        """Return these contacts with other charges (case, 2) [C/m, Wb/m]."""
        return replace(self, charges=charges)

    def part(self, cases: slice | Indices) -> Self:
        """Return the contacts of the selected cases."""
        films = selected(self, cases, "load", "charges", "datum", "thickness", "punch_datum")
        return replace(films, profile=self.profile.part(cases, self.load.shape))

    @cached_property
    def parts(self) -> list[tuple[Indices, int, FilmContact]]:
        """Cases, window and contacts on films of unit thickness, for each window."""
        parts = []
        for number in np.unique(self._windows).tolist():
            cases = np.flatnonzero(self._windows == number)
            parts.append((cases, number, self._contact(cases, window(self.kind, number))))
        return parts

    def gather(self, output: Callable[[FilmContact], Array]) -> Array:
        """Return an output of the contacts on films of unit thickness; (case, ...)."""
        parts = [(cases, {"output": output(contact)}) for cases, _, contact in self.parts]
        return joined(parts, self.load.size)["output"]

    def _contact(self, cases: Indices, table: Table) -> FilmContact:
        """Return contacts on films of unit thickness: lengths, loads and charges over the thickness."""
        h = self.thickness[cases]
        profile = self.profile.part(cases, self.load.shape).in_units_of(h)
        charges = self.charges[cases] / h[:, None]
        punch_datum = None if self.punch_datum is None else self.punch_datum[cases] / h
        return FilmContact(table, profile, self.load[cases] / h, charges, self.datum[cases] / h, punch_datum)

    # -- windows -------------------------------------------------------------------------------------------------------
    @cached_property
    def _windows(self) -> Indices:
        """Number of the window of every case; (case,)."""
        if self.profile.width is not None:
            return number_of(np.broadcast_to(self.profile.width / (2 * self.thickness), self.load.shape))
        return searched(
            self._guess, lambda cases, number: self._direction(cases, window(self.kind, number)), self.thickness,
            "half-length", "load",
        )  # fmt: skip

    def _direction(self, cases: Indices, table: Table) -> Indices:
        """Return -1, 0 or 1 where the half-length is below, in or above a table; (case,)."""
        enough = self._enough(cases, table)
        require_one(enough)
        return np.where(enough[:, 0], -1, np.where(enough[:, -1], 0, 1))

    def _enough(self, cases: Indices, table: Table) -> BoolArray:
        """Return True for half-lengths of a table that carry at least the load; (case, node)."""
        contact = self._contact(cases, table)
        load = load_at_nodes(table, Loading.of(table, contact.profile, contact.load, contact.charges))
        return np.asarray(load >= contact.load[:, None] * contact.scale[1])

    def require_one_length(self) -> None:
        """Refuse loads that contacts of other lengths carry, too; charges allow them up to a decade shorter."""
        charged = np.any(self.charges != 0, -1)
        if self.profile.width is not None or not np.any(charged):
            return
        for number in np.unique(self._windows[charged]).tolist():
            cases = np.flatnonzero(charged & (self._windows == number))
            exact = window(self.kind, number)
            lengths, enough = [exact.half_lengths], [self._enough(cases, exact)]
            for neighbour in {*range(max(number - _BELOW, FIRST), min(number + _ABOVE, LAST) + 1)} - {number}:
                rough = window(self.kind, neighbour, rough=True)
                elsewhere = (rough.half_lengths * _MARGIN < exact.lower) | (rough.half_lengths > exact.upper * _MARGIN)
                lengths.append(rough.half_lengths[elsewhere])
                enough.append(self._enough(cases, rough)[:, elsewhere])
            require_one(np.concatenate(enough, -1)[:, np.argsort(np.concatenate(lengths))])

    @property
    def _guess(self) -> Array:
        """Half-length over thickness by the top's half-plane, reduced for thin films on a rigid base; (case,)."""
        kind = self.kind
        top = met(kind.stack)
        sliding = Sliding(top, np.array(kind.friction), np.array(kind.conducts), kind.elastic)
        try:
            half = Contact(sliding, self.profile, self.load, self.charges).half_width
        except ContactError:
            half = self.thickness
        ratio = np.broadcast_to(half / self.thickness, self.load.shape)
        return np.asarray(np.where(ratio > 1, ratio ** (2 / 3), ratio)) if self.kind.stack.rigid else ratio
