"""Bodies under a point contact: stiffness at a radius, and the radius at which they carry a force."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, BoolArray
from solver.line.table import LEAST, MOST, LengthsError
from solver.line.windows import FIRST, LAST, beyond, number_of, searched
from solver.point.profile import Shape
from solver.point.state import State, Stiffness, halfspace
from solver.point.table import PointKind, Window, window

_STEPS = 60
_CLOSE = 1e-8  # step in log a: the one after it would be of its square
_SLACK = 1e-6
_AROUND = 2  # windows searched for other radii of charged contacts
_SEVERAL = "contact: contacts of several radii carry the force (charges too large for it)"


@dataclass(frozen=True, eq=False)
class Loading:
    """What presses, in the units of a body."""

    coefficient: Array  # C of the profile C r^e; (case,)
    force: Array  # P; (case,)
    given: Array  # Charges (T, J), or potentials (V, Psi) where held; (case, 2)
    held: tuple[bool, bool] = (False, False)  # Which potentials are held

    def part(self, places: Indices) -> "Loading":
        """Some of the cases."""
        return Loading(self.coefficient[places], self.force[places], self.given[places], self.held)

    def state(self, stiffness: Stiffness, shape: Shape, radius: Array) -> State:
        """Contacts of these radii under the charges and potentials, whatever their force; of a disc with it.

        radius: (case,), a.
        """
        displacement = 1.0 if shape.flat else self.coefficient * radius**shape.exponent
        load = displacement * radius
        given = np.where(self.held, self.given / _column(displacement), -self.given / load[..., None])
        return State(stiffness, shape, given, self.held, -self.force / load if shape.flat else None)


def _column(values: Array | float) -> Array:
    return np.asarray(values)[..., None]


@dataclass(frozen=True, eq=False)
class HalfSpace:
    """A half-space, whose pressure knows nothing of charges."""

    compliance: Array  # N of the contact in the units of the half-space; (case, 3, 3)
    shape: Shape  # The punch

    def stiffness(self, radius: Array) -> Stiffness:
        """Whatever the radius."""
        return halfspace(self.compliance, self.shape)

    def radius(self, loading: Loading) -> Array:
        """From the force of the radius one, which goes with C a^(e+1)."""
        grounded = State(self.stiffness(loading.force), self.shape, np.zeros(2), (True, True))
        force = grounded.loads[..., 0] * loading.coefficient
        return np.asarray((loading.force / force) ** (1 / (self.shape.exponent + 1)))


@dataclass(frozen=True, eq=False)
class Film:
    """Films of one kind."""

    kind: PointKind  # The film, its top layer of unit thickness, and the punch
    thickness: Array  # Of the top layers [m]; (case,)

    @property
    def shape(self) -> Shape:
        """The punch."""
        return self.kind.shape

    def part(self, places: Indices) -> "Film":
        """Some of the cases."""
        return Film(self.kind, self.thickness[places])

    def windows(self, radius: Array) -> Iterator[tuple[Indices, Window, Array]]:
        """Cases by the window that holds their radius [m], and log (a/h) of these."""
        ratio = radius / self.thickness
        if not (np.all(ratio >= LEAST * (1 - _SLACK)) and np.all(ratio <= MOST * (1 + _SLACK))):
            raise beyond(bool(np.any(ratio < LEAST)), self.thickness, "radius")
        numbers = number_of(ratio)
        for number in np.unique(numbers).tolist():
            places = np.flatnonzero(numbers == number)
            yield places, window(self.kind, number), np.log(ratio[places])

    def gathered(self, radius: Array, output: Callable[[Window, Array, Indices], Array]) -> Array:
        """An output of the windows at log (a/h) of their cases, zeros where that of another is longer; (case, ...).

        radius: (case,), a [m].
        """
        parts = [(places, output(of, log_ratio, places)) for places, of, log_ratio in self.windows(radius)]
        longest = np.max([values.shape[1:] for _, values in parts], axis=0)
        whole = np.empty((radius.size, *longest))
        for places, values in parts:
            whole[places] = np.pad(values, [(0, 0), *((0, int(more)) for more in longest - values.shape[1:])])
        return whole

    def stiffness(self, radius: Array) -> Stiffness:
        """Read from the windows."""
        read = self.gathered(radius, lambda of, log_ratio, _: of.read(log_ratio))
        return self.kind.stiffness(read)

    def radius(self, loading: Loading) -> Array:
        """By Newton's iteration on log a between rungs of a window that bracket the force."""
        radii = np.empty(loading.force.size)

        def beside(places: Indices, number: int) -> Indices:
            search = Search(window(self.kind, number), self.thickness[places], loading.part(places))
            inside = np.flatnonzero(search.beside == 0)
            if inside.size:
                radii[places[inside]] = search.part(inside).radius()
            return search.beside

        searched(self._guess(loading) / self.thickness, beside, self.thickness, "radius", "force")
        self._require_one(loading, radii)
        return radii

    def _require_one(self, loading: Loading, radius: Array) -> None:
        """Refuse contacts of other radii that carry the force: charges can make some."""
        charged = np.flatnonzero(np.any(loading.given != 0, -1))
        numbers = number_of(radius / self.thickness)
        for number in np.unique(numbers[charged]).tolist():
            places = charged[numbers[charged] == number]
            for other in range(max(number - _AROUND, FIRST), min(number + _AROUND, LAST) + 1):
                search = Search(window(self.kind, other), self.thickness[places], loading.part(places))
                low, high = search.window.interval.low, search.window.interval.high
                at = np.log(radius[places] / self.thickness[places])
                if np.any(search.beside != np.where(at <= low, -1, np.where(at > high, 1, 0))):
                    raise LengthsError(_SEVERAL)

    def _guess(self, loading: Loading) -> Array:
        """The half-space's radius; that of a wide contact on a base that hardly yields is nearer to its root."""
        ratio = HalfSpace(self.kind.compliance, self.shape).radius(loading) / self.thickness
        return np.asarray(np.minimum(ratio, np.sqrt(ratio)) * self.thickness)


@dataclass(frozen=True, eq=False)
class Search:
    """Cases whose radius is sought in one window."""

    window: Window  # The window
    thickness: Array  # [m]; (case,)
    loading: Loading  # What presses

    def part(self, places: Indices) -> Self:
        """Some of the cases."""
        return replace(self, thickness=self.thickness[places], loading=self.loading.part(places))

    @cached_property
    def _enough(self) -> BoolArray:
        """Whether the rungs of the window carry the force, or more; (case, rung)."""
        forces = [self.forces(np.broadcast_to(rung, self.thickness.shape))[0] for rung in self.window.rungs]
        return np.stack(forces, -1) >= self.loading.force[:, None]

    @cached_property
    def beside(self) -> Indices:
        """-1 or 1 where the radius is below or above the window, 0 where it is within; (case,)."""
        enough = self._enough
        changes = np.count_nonzero(enough[:, 1:] != enough[:, :-1], axis=-1)
        if np.any((changes > 1) | (enough[:, 0] & ~enough[:, -1])):
            raise LengthsError(_SEVERAL)
        return np.where(enough[:, 0], -1, np.where(enough[:, -1], 0, 1))

    def forces(self, log_ratio: Array) -> tuple[Array, Array]:
        """P and d log P / d log a at log (a/h); (case,) each."""
        radius = self.thickness * np.exp(log_ratio)
        size = self.loading.coefficient * radius ** (self.window.kind.shape.exponent + 1)
        if not np.any(self.loading.given):
            force, rate = self.window.forces(log_ratio, self.loading.held)
            return force * size, rate
        stiffness = self.window.kind.stiffness(self.window.read(log_ratio))
        state = self.loading.state(stiffness, self.window.kind.shape, radius)
        force = state.loads[..., 0]
        return force * size, state.force_rate / force

    def radius(self) -> Array:
        """Radii [m] between rungs: Newton on log P, halved where it would leave the bracket; (case,)."""
        first = np.argmax(self._enough, axis=-1)
        low, high = self.window.rungs[first - 1], self.window.rungs[first]
        at = (low + high) / 2
        for _ in range(_STEPS):
            force, rate = self.forces(at)
            below = force < self.loading.force
            low, high = np.where(below, at, low), np.where(below, high, at)
            with np.errstate(all="ignore"):
                ahead = at + np.log(self.loading.force / force) / rate
            ahead = np.where((ahead >= low) & (ahead <= high), ahead, (low + high) / 2)
            moved, at = np.abs(ahead - at), ahead
            if np.all((moved <= _CLOSE) | (high - low <= _CLOSE)):
                break
        return np.asarray(self.thickness * np.exp(at))
