"""Bodies under a point contact: stiffness at a radius, and the radius at which they carry a force."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, BoolArray, selected
from solver.line.table import LEAST, MOST, LengthsError
from solver.line.windows import FIRST, LAST, beyond, number_of, searched
from solver.point.profile import Shape
from solver.point.state import PressedState, Stiffness, halfspace
from solver.point.table import PointKind, PointWindow, window

_RADIUS_STEPS = 60
_RADIUS_CLOSE = 1e-8  # last step in log a: the error after it is of the order of its square
_SLACK = 1e-6
_AROUND = 2  # windows searched for other radii of charged contacts
_SEVERAL = "contact: contacts of several radii carry the force (charges too large for it)"


@dataclass(frozen=True, eq=False)
class PointLoading:
    """Profile, force and charges of cases, in the units of a body."""

    coefficient: Array  # C of the profile C r^e; (case,)
    force: Array  # P; (case,)
    charges: Array  # T and J; zero if ``grounded``; (case, 2)
    grounded: bool = False  # Whether V and Psi are held at zero

    def part(self, cases: Indices) -> "PointLoading":
        """Loading of some of the cases."""
        return selected(self, cases, "coefficient", "force", "charges")

    def state(self, stiffness: Stiffness, shape: Shape, radius: Array) -> PressedState:
        """Contacts of given radii (case,) under the charges; only a disc's force is prescribed."""
        displacement = np.ones_like(radius) if shape.flat else self.coefficient * radius**shape.exponent
        load = displacement * radius
        force = -self.force / load if shape.flat else None
        return PressedState(stiffness, shape, -self.charges / load[..., None], self.grounded, force)


@dataclass(frozen=True, eq=False)
class HalfSpace:
    """Half-space, whose pressure is independent of the charges."""

    compliance: Array  # N of the contact in the units of the half-space; (case, 3, 3)
    shape: Shape  # The punch

    def stiffness(self, radius: Array) -> Stiffness:
        """Stiffness, the same at every radius."""
        return halfspace(self.compliance, self.shape)

    def radius(self, loading: PointLoading) -> Array:
        """Radii that carry the force, which grows as C a^(e+1); (case,)."""
        grounded = PressedState(self.stiffness(loading.force), self.shape, np.zeros(2), grounded=True)
        force = grounded.loads[..., 0] * loading.coefficient
        return np.asarray((loading.force / force) ** (1 / (self.shape.exponent + 1)))


@dataclass(frozen=True, eq=False)
class Film:
    """Films of one kind."""

    kind: PointKind  # The film, its top layer of unit thickness, and the punch
    thickness: Array  # Thickness of the top layers [m]; (case,)

    @property
    def shape(self) -> Shape:
        """The punch."""
        return self.kind.shape

    def part(self, cases: Indices) -> "Film":
        """Film of some of the cases."""
        return Film(self.kind, self.thickness[cases])

    def windows(self, radius: Array) -> Iterator[tuple[Indices, PointWindow, Array]]:
        """Yield the cases of each window that holds their radius [m], and log (a/h) of these."""
        ratio = radius / self.thickness
        if not (np.all(ratio >= LEAST * (1 - _SLACK)) and np.all(ratio <= MOST * (1 + _SLACK))):
            raise beyond(bool(np.any(ratio < LEAST)), self.thickness, "radius")
        numbers = number_of(ratio)
        for number in np.unique(numbers).tolist():
            cases = np.flatnonzero(numbers == number)
            yield cases, window(self.kind, number), np.log(ratio[cases])

    def from_windows(self, radius: Array, output: Callable[[PointWindow, Array, Indices], Array]) -> Array:
        """Join ``output`` of the windows at log (a/h) of their cases, padded with zeros to the longest; (case, ...)."""
        parts = [(cases, output(table, log_ratio, cases)) for cases, table, log_ratio in self.windows(radius)]
        longest = np.max([values.shape[1:] for _, values in parts], axis=0)
        whole = np.empty((radius.size, *longest))
        for cases, values in parts:
            whole[cases] = np.pad(values, [(0, 0), *((0, int(missing)) for missing in longest - values.shape[1:])])
        return whole

    def stiffness(self, radius: Array) -> Stiffness:
        """Stiffness at radii, read from the windows."""
        read = self.from_windows(radius, lambda table, log_ratio, _: table.read(log_ratio))
        return self.kind.stiffness(read)

    def radius(self, loading: PointLoading) -> Array:
        """Radii that carry the force, by Newton's iteration on log a between rungs of a window; (case,) [m]."""
        radii = np.empty(loading.force.size)

        def side(cases: Indices, number: int) -> Indices:
            search = Search(window(self.kind, number), self.thickness[cases], loading.part(cases))
            inside = np.flatnonzero(search.side == 0)
            if inside.size:
                radii[cases[inside]] = search.part(inside).radius()
            return search.side

        searched(self._guess(loading) / self.thickness, side, self.thickness, "radius", "force")
        self._require_one(loading, radii)
        return radii

    def _require_one(self, loading: PointLoading, radius: Array) -> None:
        """Refuse charges under which contacts of several radii carry the force."""
        charged = np.flatnonzero(np.any(loading.charges != 0, -1))
        numbers = number_of(radius / self.thickness)
        for number in np.unique(numbers[charged]).tolist():
            cases = charged[numbers[charged] == number]
            for other in range(max(number - _AROUND, FIRST), min(number + _AROUND, LAST) + 1):
                search = Search(window(self.kind, other), self.thickness[cases], loading.part(cases))
                low, high = search.window.interval.low, search.window.interval.high
                log_ratio = np.log(radius[cases] / self.thickness[cases])
                if np.any(search.side != np.where(log_ratio <= low, -1, np.where(log_ratio > high, 1, 0))):
                    raise LengthsError(_SEVERAL)

    def _guess(self, loading: PointLoading) -> Array:
        """Initial radii from those on a half-space; (case,) [m]."""
        ratio = HalfSpace(self.kind.compliance, self.shape).radius(loading) / self.thickness
        # the square root is nearer for a wide contact on a stiff base
        return np.asarray(np.minimum(ratio, np.sqrt(ratio)) * self.thickness)


@dataclass(frozen=True, eq=False)
class Search:
    """Cases whose radius is sought in one window."""

    window: PointWindow
    thickness: Array  # [m]; (case,)
    loading: PointLoading

    def part(self, cases: Indices) -> Self:
        """Search of some of the cases."""
        return replace(self, thickness=self.thickness[cases], loading=self.loading.part(cases))

    @cached_property
    def _reaches_force(self) -> BoolArray:
        """Mark rungs of the window at which the force reaches the case's force; (case, rung)."""
        forces = [self.forces(np.broadcast_to(rung, self.thickness.shape))[0] for rung in self.window.rungs]
        return np.stack(forces, -1) >= self.loading.force[:, None]

    @cached_property
    def side(self) -> Indices:
        """Return -1 or 1 where the radius is below or above the window, 0 where it is within; (case,)."""
        reached = self._reaches_force
        changes = np.count_nonzero(reached[:, 1:] != reached[:, :-1], axis=-1)
        if np.any((changes > 1) | (reached[:, 0] & ~reached[:, -1])):
            raise LengthsError(_SEVERAL)
        return np.where(reached[:, 0], -1, np.where(reached[:, -1], 0, 1))

    def forces(self, log_ratio: Array) -> tuple[Array, Array]:
        """P and d log P / d log a at log (a/h); (case,) each."""
        radius = self.thickness * np.exp(log_ratio)
        size = self.loading.coefficient * radius ** (self.window.kind.shape.exponent + 1)
        if not np.any(self.loading.charges):
            force, rate = self.window.forces(log_ratio, grounded=self.loading.grounded)
            return force * size, rate
        stiffness = self.window.kind.stiffness(self.window.read(log_ratio))
        state = self.loading.state(stiffness, self.window.kind.shape, radius)
        force = state.loads[..., 0]
        return force * size, state.force_rate / force

    def radius(self) -> Array:
        """Radii [m] between rungs: Newton on log P, halved where it would leave the bracket; (case,)."""
        first = np.argmax(self._reaches_force, axis=-1)
        low, high = self.window.rungs[first - 1], self.window.rungs[first]
        log_ratio = (low + high) / 2
        for _ in range(_RADIUS_STEPS):
            force, rate = self.forces(log_ratio)
            below = force < self.loading.force
            low, high = np.where(below, log_ratio, low), np.where(below, high, log_ratio)
            with np.errstate(all="ignore"):
                next_ratio = log_ratio + np.log(self.loading.force / force) / rate
            next_ratio = np.where((next_ratio >= low) & (next_ratio <= high), next_ratio, (low + high) / 2)
            step, log_ratio = np.abs(next_ratio - log_ratio), next_ratio
            if np.all((step <= _RADIUS_CLOSE) | (high - low <= _RADIUS_CLOSE)):
                break
        return np.asarray(self.thickness * np.exp(log_ratio))
