"""One contact with air beside it: Newton's iteration on its extent, its charges and the densities (theory section 10).

Beside the contact D (profile - depth - u_y) = eps0 (phi - V), and the same with B, mu0 and psi. Unknown are log h, c/h,
T, J and the densities at the nodes; a charge is given, or the potential that it makes zero. Tangents follow from the
same linear system.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.gap.opening import MOST
from solver.gap.problem import Problem
from solver.gap.refusal import GapError
from solver.gap.state import Chord, State

_STEPS = 40
_CLOSE = 1e-11
_STALLED = 1e-7  # steps below it that no longer shrink are rounding
_MOST = 0.3  # of log h and c/h in a step
_SLOW = 0.1  # of a step that the next one is below, or its equations are those of another state
_ROUNDED = 1e-9  # steps below it are slow by rounding: new equations would make them no faster
_EXTENT = 2  # unknowns before the charges: log h, c/h


@dataclass(frozen=True, eq=False)
class AirContact(Problem):
    """One that is solved."""

    idle: State | None = None

    @cached_property
    def state(self) -> State:
        """The solution."""
        found = self._from_idle
        if not (found and found.open):
            found = self._sought(self._start)
        for _ in range(MOST):
            if found is None or found.open:
                break
            found = self._sought(State(self, found.reopened, found.near)) or found
        if found is None:
            raise GapError("surroundings: no contact with air beside it is found for this load and these charges")
        found.require_gap()
        return found

    @property
    def _from_idle(self) -> State | None:
        """What held potentials come to from the same contact with its charges given, the nearest start there is.

        It may have a closed gap all the same: that of a half-plane at zero volts, where no charge is left beside it.
        """
        if self.idle is None or not any(self.held):
            return None
        return self._sought(State(self, self.idle.unknowns, self.idle.near), self.idle.chord)

    @property
    def _start(self) -> State:
        """The contact without air, with the densities that its potentials make at its gap."""
        contact = self.contact
        start = np.array([np.log(contact.half_width[0]), contact.centre[0], *contact.loading.loads[0, 1:]])
        start[_EXTENT:][list(self.held)] = 0.0
        state = State(self, np.concatenate([start, np.zeros(self.nodes * len(self.fields))]))
        if any(self.held):
            state = state.moved(state.unknowns_of_held_potentials)
        return state.moved(np.concatenate([state.unknowns[: start.size], state.densities_at_its_gap]))

    def _sought(self, state: State, chord: Chord | None = None) -> State | None:
        """What Newton's iteration comes to, its gap open or not; None where it comes to nothing.

        The equations of one state serve the next ones as long as they make steps shrink.
        """
        last = np.inf
        for _ in range(_STEPS):
            step = (chord or state.chord).step(state)
            if chord and last > _ROUNDED and not np.max(np.abs(step) / state.sizes) < _SLOW * last:
                chord = None
                step = state.chord.step(state)
            chord = chord or state.chord
            step /= max(1.0, float(np.max(np.abs(step[:_EXTENT]))) / _MOST)
            size = float(np.max(np.abs(step) / state.sizes))
            state = state.moved(state.unknowns - step)
            if size < _CLOSE or (size < _STALLED and size > last / 2):
                return state
            last = size
        return None
