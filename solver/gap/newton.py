"""Newton's iteration of contacts with air, along lines and at points, many cases at a time (theory section 10).

Unknowns are log size, some numbers of the contact, and the densities at the nodes over their size. Equations are the
load, the smooth edge, a charge or the potential that it makes zero, and the gap's law at the nodes,

    D (profile - u_y) = eps0 phi.

All of them are linear in outputs that are tabulated over log size. A case starts from a solved one next to it, whose
factorised equations serve as long as they shrink the steps.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Generic, NamedTuple, Self, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgetrf, dgetrs

from approximation.arrays import Indices
from approximation.chebyshev import coefficients
from approximation.piecewise import Interval
from solver.arrays import Array, BoolArray
from solver.halfplane.pressing import ContactError


@dataclass(frozen=True, eq=False)
class Factored:
    """LU factors of a system, its columns and then its rows divided by their largest entries first.

    Charges a thousand half-lengths away move the contact by a thousand times their density, and the gap's law next to
    the edge is divided by a gap of 1e-9: as it stands, the rounding of the ones is 1e-4 of the others.
    """

    factors: tuple[Array, NDArray[np.int32]]  # Of LAPACK's getrf, without the checks that cost more than the solution
    # Scale factors of rows and columns; (n,) each
    rows: Array
    columns: Array

    @classmethod
    def of(cls, matrix: Array) -> Self:
        """Scale and factorise a matrix (n, n)."""
        columns = 1 / np.max(np.abs(matrix), axis=0)
        scaled = matrix * columns
        rows = 1 / np.max(np.abs(scaled), axis=1)
        scaled *= rows[:, None]
        return cls(dgetrf(scaled.T, overwrite_a=True)[:2], rows, columns)  # in Fortran's order: no copy

    def solve(self, right: Array) -> Array:
        """The solution; right (n,) or (n, m)."""
        result = dgetrs(*self.factors, (right.T * self.rows).T, trans=1)[0]
        return np.asarray((result.T * self.columns).T)

    @cached_property
    def causes(self) -> Array:
        """Solutions for unit right sides of the load, and of the charges that follow the second row; (n, 3)."""
        right = np.zeros((self.columns.size, 1 + _CHARGES))
        right[0, 0] = 1.0
        right[_CLOSING + np.arange(_CHARGES), 1 + np.arange(_CHARGES)] = 1.0
        return self.solve(right)


_CLOSING, _CHARGES = 2, 2  # first row of the charges, behind load and smooth edge, and their largest number


def solved(matrix: Array, right: Array) -> Array:
    """The solution of one system (:class:`Factored`), refined once: pivots of rows of one size may be poor ones."""
    factored = Factored.of(matrix)
    result = factored.solve(right)
    return result + factored.solve(right - matrix @ result)


@dataclass(frozen=True, eq=False)
class Outputs:
    """Outputs of every cause and density, tabulated over log size."""

    values: Array  # At the points of the interval; (point, row, column)
    interval: Interval | None = None  # None: outputs are the same at every size
    clipped: bool = False  # Whether sizes beyond the interval have the outputs of its end

    def at(self, log_size: Array) -> "Reading":
        """Outputs at some sizes."""
        if self.interval is None:
            return Reading(self.values, np.stack([np.ones((log_size.size, 1)), np.zeros((log_size.size, 1))]))
        return Reading(self.values, self.interval.polynomials(log_size, clipped=self.clipped) @ self._series)

    @cached_property
    def _series(self) -> Array:
        """Matrices from values at the points to the series of the function and of its derivative; (2, n, point)."""
        assert self.interval is not None
        series = coefficients(np.eye(self.interval.count))
        return np.stack([series, self.interval.derived(series)])


class SplitOutputs(NamedTuple):
    """Outputs that the equations of a table's contacts need, and the others."""

    solving: Outputs
    others: Outputs

    @classmethod
    def of(cls, values: Array, solving: int, interval: Interval | None, *, clipped: bool = False) -> Self:
        """Split values (point, row, column) behind the first ``solving`` rows."""
        parts = (np.ascontiguousarray(part) for part in (values[:, :solving], values[:, solving:]))
        return cls(*(Outputs(part, interval, clipped) for part in parts))


@dataclass(frozen=True, eq=False)
class Reading:
    """Outputs at the sizes of some cases."""

    values: Array  # At the points of the interval; (point, row, column)
    weights: Array  # To the values and to their derivatives in log size; (2, case, point)

    @property
    def matrices(self) -> Array:
        """Outputs of every column; (case, row, column)."""
        return np.tensordot(self.weights[0], self.values, 1)

    def times(self, columns: Array, rows: int | None = None) -> Array:
        """(First) outputs of columns of sizes (case, column, k), and derivatives in log size; (2, case, row, k)."""
        values, (cases, count, k) = self.values[:, :rows], columns.shape
        flat = values.reshape(-1, count) @ np.moveaxis(columns, 1, 0).reshape(count, -1)
        products = flat.reshape(*values.shape[:2], cases, k)
        return np.asarray(np.einsum("tcp,prck->tcrk", self.weights, products))


@dataclass(frozen=True, eq=False)
class Frame:
    """Properties that contacts of one table share."""

    outputs: Outputs  # Some of the contact, then u_y and the potentials at the nodes less those at the edge
    heads: int  # Number of outputs of the contact
    fields: tuple[int, ...]  # Conducted fields, 0 electric and 1 magnetic
    places: Array  # X or r/a of the nodes; (n,)
    sides: int  # Number of sides on which the nodes lie
    extents: int  # Number of unknowns, first ones, whose steps are bounded; the first start keeps them
    rounds: int  # Number of linear solutions that the first start takes
    load: str  # "load" or "force"
    coordinate: str  # Name of the places


@dataclass(frozen=True, eq=False)
class Linear:
    """Numbers of a contact, and their derivatives in its outputs and in the unknowns before the densities."""

    values: Array  # (case, number)
    by_first: Array  # (case, number, unknown)
    by_outputs: Array | None = None  # (case, number, output); None: independent of these

    def rates(self, outputs: Array, first: Array) -> Array:
        """Derivatives along directions, from those of the outputs (case, output, k) and of the first unknowns."""
        result = self.by_first @ first
        return result if self.by_outputs is None else result + self.by_outputs @ outputs


@dataclass(frozen=True, eq=False)
class Terms:
    """Terms of the equations."""

    head: Linear  # Load and smooth edge, then the charges less the prescribed ones: zero where it is a contact
    profile: Linear  # Gap at the nodes where the surface is flat
    reference: Array  # Sizes of the gap, which scale its law; (case, n)
    conductance: Array  # Density over its size per potential, times gap over reference; (case, field, n)
    growth: Array  # d log conductance / d log size; (case, n)
    sizes: Array  # Scales of the unknowns, over which steps are measured; (case, unknown)


_State = TypeVar("_State", bound="GapStates")


@dataclass(frozen=True, eq=False)
class GapStates(ABC):
    """Contacts that share a table, at some unknowns."""

    frame: Frame
    unknowns: Array  # Log size, numbers of the contact, densities over their size by field; (case, unknown)
    held: tuple[bool, ...]  # Whether the potential of each charge is zero, and its charge follows

    @abstractmethod
    def part(self, cases: Indices) -> Self:
        """Some of the cases."""

    @property
    @abstractmethod
    def causes(self) -> Linear:
        """Sizes of the columns before the densities."""

    @property
    @abstractmethod
    def terms(self) -> Terms:
        """Terms of the equations."""

    @property
    @abstractmethod
    def response(self) -> Linear:
        """Depth, or displacement, and potentials; (case, 1 + charge)."""

    @property
    @abstractmethod
    def by_load(self) -> tuple[Array, Array]:
        """Right sides for unit loads over unit rows, (case, 1 + charge), and the datum's part of the response."""

    # -- equations -----------------------------------------------------------------------------------------------------
    def moved(self, unknowns: Array) -> Self:
        """The same contacts at other unknowns."""
        return replace(self, unknowns=unknowns)

    @property
    def first(self) -> int:
        """Number of unknowns before the densities."""
        return int(self.unknowns.shape[1]) - len(self.frame.fields) * self.frame.places.size

    @property
    def over_size(self) -> Array:
        """Densities over their size; (case, field, n)."""
        return self.unknowns[:, self.first :].reshape(len(self.unknowns), len(self.frame.fields), -1)

    @cached_property
    def _reading(self) -> Reading:
        return self.frame.outputs.at(self.unknowns[:, 0])

    @property
    def columns(self) -> Array:
        """Sizes of the columns of the outputs; (case, column)."""
        return np.concatenate([self.causes.values, self.unknowns[:, self.first :]], 1)

    @cached_property
    def _rows(self) -> Array:
        """Outputs and their derivatives in log size; (2, case, row)."""
        return self._reading.times(self.columns[..., None])[..., 0]

    @property
    def rows(self) -> Array:
        """Outputs; (case, row)."""
        return np.asarray(self._rows[0])

    def _rates(self, directions: Array | None, rows: int | None = None) -> Array:
        """Derivatives of the outputs, or of the first ones, along directions or in the unknowns; (case, row, k)."""
        first, causes = self.first, self.causes.by_first
        by_size: Array | float = self._rows[1][:, :rows, None]
        if directions is None:
            matrices, count = self._reading.matrices, causes.shape[1]
            result = np.empty((*matrices.shape[:2], self.unknowns.shape[1]))
            result[..., :first] = matrices[..., :count] @ causes
            result[..., first:] = matrices[..., count:]
            result[..., :1] += by_size
            return result
        moved = np.concatenate([causes @ directions[:, :first], directions[:, first:]], 1)
        return np.asarray(self._reading.times(moved, rows)[0] + by_size * directions[:, :1])

    def _exterior(self, rows: Array) -> Array:
        """u_y and the potentials beside the contact, of rows (case, row, ...); (case, 1 + field, n, ...)."""
        shape = 1 + len(self.frame.fields), self.frame.places.size
        return rows[:, self.frame.heads :].reshape(len(rows), *shape, *rows.shape[2:])

    @cached_property
    def gap(self) -> Array:
        """Gap at the nodes; (case, n)."""
        return np.asarray(self.terms.profile.values - self._exterior(self._rows[0])[:, 0])

    @property
    def is_open(self) -> BoolArray:
        """Return True for cases whose gap is positive at every node; (case,)."""
        return np.asarray(np.all(self.gap > 0, 1))

    @cached_property
    def residual(self) -> Array:
        """Zero where it is a contact: load, smooth edge, charges or potentials, and the gap's law; (case, unknown)."""
        terms, potentials = self.terms, self._exterior(self._rows[0])[:, 1:]
        law = self.over_size * (self.gap / terms.reference)[:, None] - terms.conductance * potentials
        head = np.array(terms.head.values)
        for charge in np.flatnonzero(self.held):
            head[:, _CLOSING + charge] = self.response.values[:, 1 + charge]
        return np.concatenate([head, law.reshape(len(law), -1)], 1)

    def derivative(self, directions: Array | None = None, *, fixed: bool = False) -> Array:
        """Derivative of the residual where charges are given, along directions or in the unknowns; (case, unknown, k).

        directions: (case, unknown, k); fixed: where the gap does not move, and potentials are held where they are.
        """
        rates, first, count = self._rates(directions), self.first, self.unknowns.shape[1]
        terms, heads = self.terms, rates[:, : self.frame.heads]
        before = np.eye(first, count)[None] if directions is None else directions[:, :first]
        result = np.empty((len(rates), count, rates.shape[2]))
        result[:, :first] = terms.head.rates(heads, before)
        exterior, potentials = self._exterior(rates), self._exterior(self._rows[0])[:, 1:]
        law = result[:, first:].reshape(len(rates), potentials.shape[1], -1, rates.shape[2])
        np.multiply(exterior[:, 1:], -terms.conductance[..., None], out=law)
        by_size = (terms.conductance * terms.growth[:, None] * potentials)[..., None]
        share = self.gap / terms.reference
        if directions is None:
            law[..., :1] -= by_size
            diagonal = np.arange(first, count)
            result[:, diagonal, diagonal] += np.tile(share, potentials.shape[1])
        else:
            law -= by_size * directions[:, None, None, 0]
            law += share[:, None, :, None] * directions[:, first:].reshape(law.shape)
        if fixed:
            by_potential = self.response.rates(heads, before)
            for charge in np.flatnonzero(self.held):
                result[:, _CLOSING + charge] = by_potential[:, 1 + charge]
            return result
        gap = terms.profile.rates(heads, before) - exterior[:, 0]
        for place in range(law.shape[1]):
            law[:, place] += (self.over_size[:, place] / terms.reference)[..., None] * gap
        return result

    def response_rates(self, directions: Array) -> Array:
        """Derivatives of the response along directions (case, unknown, k); (case, 1 + charge, k)."""
        return self.response.rates(self._rates(directions, self.frame.heads), directions[:, : self.first])

    def steps(self, chords: Sequence[Factored]) -> Array:
        """Newton's steps back; rows of held potentials are those of the states themselves; (case, unknown)."""
        right, held = np.array(self.residual), np.flatnonzero(self.held)
        potentials = right[:, _CLOSING + held]
        right[:, _CLOSING + held] = 0.0
        step = _solved(chords, right[..., None])[..., 0]
        if held.size:
            by_charge = np.stack([chord.causes[:, 1 + held] for chord in chords])
            rates = self.response_rates(np.concatenate([by_charge, step[..., None]], 2))[:, 1 + held]
            charges = np.linalg.solve(rates[..., :-1], (potentials - rates[..., -1])[..., None])
            step += (by_charge @ charges)[..., 0]
        return step

    def chords(self) -> list[Factored]:
        """The factorised equations of every case."""
        count, cases = at_once(self), np.arange(len(self.unknowns))
        blocks = [cases[start : start + count] for start in range(0, cases.size, count)]
        parts = [self] if len(blocks) == 1 else [self.part(block) for block in blocks]
        return [Factored.of(matrix) for part in parts for matrix in part.derivative()]

    @property
    def started(self) -> Self:
        """The contacts without air, with the densities that their potentials make at their gap."""
        states, e = self, self.frame.extents
        for _ in range(self.frame.rounds):
            matrices = states.derivative(fixed=True)[:, e:, e:]
            steps = [solved(*pair) for pair in zip(matrices, states.residual[:, e:], strict=True)]
            unknowns = np.array(states.unknowns)
            unknowns[:, e:] -= steps
            states = states.moved(unknowns)
        return states

    @property
    def reopened(self) -> Self:
        """States with densities that open a gap which is closed next to an edge.

        A density that draws the gap shut solves the gap's law too, with a potential of the other sign: Newton's
        iteration may come to it, and from here comes to the contact whose gap is open. Densities from the edge up to
        the first open place become those of that place.
        """
        shape = len(self.unknowns), self.frame.sides, self.frame.places.size // self.frame.sides
        gaps, unknowns = self.gap.reshape(shape), np.array(self.unknowns)
        densities = unknowns[:, self.first :].reshape(shape[0], -1, *shape[1:])
        for case, side in np.ndindex(shape[:2]):
            closed = np.flatnonzero(gaps[case, side] <= 0)
            if closed.size:
                place = min(int(closed[-1]) + 1, shape[2] - 1)
                densities[case, :, side, :place] = densities[case, :, side, place, None]
        return self.moved(np.concatenate([unknowns[:, : self.first], densities.reshape(shape[0], -1)], 1))


_NEWTON_STEPS = 60
_NEWTON_CLOSE, _NEXT_CLOSE = 1e-11, 1e-12  # a step, and the next one if steps shrink as they did
_STALLED = 1e-7  # steps below it that no longer shrink are rounding
_LONGEST = 0.3  # of the extent's unknowns in a step
_REOPENED = 3  # times at most that a closed gap is opened
_SLOW, _SLOW_HELD = 0.02, 0.1  # of a step that the next one is below, or its equations are those of another state
_ROUNDED = 1e-9  # steps below it are slow by rounding: new equations would make them no faster
_NEAR = 0.7  # distance in logarithms of the parameters within which a solved case is a start
_LARGEST, _LARGEST_CHORDS = 4e7, 1e8  # bytes of matrices, and of factorised equations, at a time
_APART = 8  # cases of an order to the first ones, from which the others start


@dataclass(frozen=True, eq=False)
class Settled(Generic[_State]):
    """Solved contacts, with factorised equations of states next to them."""

    states: _State
    chords: list[Factored]
    converged: BoolArray  # (case,)

    def part(self, cases: Indices) -> "Settled[_State]":
        """Some of the cases."""
        chords = [self.chords[case] for case in cases.tolist()]
        return Settled(self.states.part(cases), chords, self.converged[cases])

    @cached_property
    def valid(self) -> BoolArray:
        """Return True for cases that converged to an open gap; (case,)."""
        return self.converged & self.states.is_open

    def require(self) -> Self:
        """Refuse contacts that are not found, and gaps that close."""
        states, frame = self.states, self.states.frame
        for case in np.flatnonzero(~self.valid).tolist():
            if not self.converged[case]:
                raise ContactError(
                    f"surroundings: no contact with air beside it is found for this {frame.load} and these charges"
                )
            names = [name for name, zero in zip(("voltage", "magnetic potential"), states.held, strict=False) if zero]
            held = f", where its {' and '.join(names)} is 0" if names else ""
            place = frame.places[int(np.argmin(states.gap[case] / states.terms.reference[case]))]
            raise ContactError(
                f"surroundings: the punch touches the surface beside the contact, at {frame.coordinate} = {place:.3g}"
                f"{held}: the gap is negative there; must be insulated"
            )
        return self

    @cached_property
    def _changes(self) -> Array:
        """Changes of the unknowns for unit loads, force then charges; (case, unknown, 1 + charge)."""
        states, count = self.states, 1 + len(self.states.held)
        right = np.zeros((states.unknowns.shape[1], count))
        right[0, 0] = 1.0
        right[_CLOSING + np.arange(count - 1), 1 + np.arange(count - 1)] = 1.0
        chords = states.chords()
        result = np.stack([chord.causes[:, :count] for chord in chords])
        result += _solved(chords, right - states.derivative(result))  # pivots of rows of one size may be poor ones
        return result * states.by_load[0][:, None]

    @cached_property
    def tangents(self) -> Array:
        """d response / d (load, charges) with moving edges; (case, 1 + charge, 1 + charge)."""
        result = self.states.response_rates(self._changes)
        result[..., 0] += self.states.by_load[1]
        return result

    @cached_property
    def at_fixed_contact(self) -> Array:
        """d response / d charges at a fixed size, whose load and gap follow; (case, 1 + charge, charge)."""
        by_size = self._changes[:, :1]
        return np.asarray(self.tangents[..., 1:] - self.tangents[..., :1] * (by_size[..., 1:] / by_size[..., :1]))


def at_once(states: GapStates) -> int:
    """Number of cases whose matrices are held at a time."""
    _, rows, columns = states.frame.outputs.values.shape
    return max(int(_LARGEST / (8 * (2 * rows * columns + 2 * states.unknowns.shape[1] ** 2))), 1)


def together(states: GapStates) -> int:
    """Number of cases that are solved together, by the size of their factorised equations."""
    return max(int(_LARGEST_CHORDS / (8 * states.unknowns.shape[1] ** 2)), 1)


def _solved(chords: Sequence[Factored], right: Array) -> Array:
    """Solutions of the cases' equations, those that share theirs at once; (case, unknown, k)."""
    result, members = np.empty_like(right), dict[int, list[int]]()
    for case, chord in enumerate(chords):
        members.setdefault(id(chord), []).append(case)
    for cases in members.values():
        flat = np.moveaxis(right[cases], 0, 1)
        values = chords[cases[0]].solve(flat.reshape(len(flat), -1)).reshape(flat.shape)
        result[cases] = np.moveaxis(values, 1, 0)
    return result


def iterated(states: _State, starts: Sequence[Factored | None], slow: float = _SLOW) -> Settled[_State]:
    """Limits of Newton's iteration, their gaps open or not.

    starts: factorised equations of states next to each case; None: its own; slow: share of a step that the next one is
    below, or the equations are made anew.
    """
    count, unknowns, chords = len(starts), np.array(states.unknowns), list(starts)
    active, part = np.arange(count), states
    converged, last = np.zeros(count, dtype=bool), np.full(count, np.inf)
    for _ in range(_NEWTON_STEPS):
        now, before = part.moved(unknowns[active]), last[active]
        fresh = np.array([chords[case] is None for case in active.tolist()])
        _renew(chords, active, now, np.flatnonzero(fresh))
        change = now.steps(_of(chords, active))
        size = np.max(np.abs(change) / now.terms.sizes, 1)
        stale = np.flatnonzero(~fresh & ~(size < slow * before) & ~(before < _ROUNDED) & np.isfinite(size))
        if stale.size:
            others = now if stale.size == active.size else now.part(stale)
            _renew(chords, active[stale], others, np.arange(stale.size))
            change[stale] = others.steps(_of(chords, active[stale]))
        change /= np.maximum(1.0, np.max(np.abs(change[:, : states.frame.extents]), 1) / _LONGEST)[:, None]
        size = np.max(np.abs(change) / now.terms.sizes, 1)
        unknowns[active] -= change
        last[active] = size
        close = (size < _NEWTON_CLOSE) | ((size < _STALLED) & (size > before / 2))
        # steps of one chord shrink by one factor
        close |= np.isfinite(before) & (size**2 < _NEXT_CLOSE * before)
        converged[active] |= close
        running = np.flatnonzero(~converged[active] & np.isfinite(size))
        if not running.size:
            break
        if running.size < active.size:
            active, part = active[running], part.part(running)
    final = part if active.size == count else states
    return Settled(final.moved(unknowns), _of(chords, np.arange(count)), converged)


def _of(chords: Sequence[Factored | None], cases: Indices) -> list[Factored]:
    return [chord for chord in (chords[case] for case in cases.tolist()) if chord is not None]


def _renew(chords: list[Factored | None], cases: Indices, states: GapStates, places: Indices) -> None:
    """Factorise the equations of some states."""
    if places.size:
        part = states if places.size == len(states.unknowns) else states.part(places)
        for case, chord in zip(cases[places].tolist(), part.chords(), strict=True):
            chords[case] = chord


def continued(states: _State, near: Settled[_State]) -> Settled[_State]:
    """Solutions that start from solved contacts, or from those without air where that leads to none."""
    return _with(iterated(states.moved(near.states.unknowns), near.chords, _SLOW_HELD), states)


def _with(result: Settled[_State], states: _State) -> Settled[_State]:
    """The result, its cases that are not valid solved from the contacts without air on."""
    failed = np.flatnonzero(~result.valid)
    return _replaced(result, failed, _from_first(states.part(failed))) if failed.size else result


def _from_first(states: _State) -> Settled[_State]:
    result = iterated(states.started, [None] * len(states.unknowns))
    for _ in range(_REOPENED):
        closed = np.flatnonzero(result.converged & ~result.valid)
        if not closed.size:
            break
        opened = iterated(result.states.part(closed).reopened, [None] * closed.size)
        result = _replaced(result, closed[opened.converged], opened.part(np.flatnonzero(opened.converged)))
    return result


def _replaced(result: Settled[_State], cases: Indices, others: Settled[_State]) -> Settled[_State]:
    unknowns, chords, converged = np.array(result.states.unknowns), list(result.chords), np.array(result.converged)
    unknowns[cases], converged[cases] = others.states.unknowns, others.converged
    for case, chord in zip(cases.tolist(), others.chords, strict=True):
        chords[case] = chord
    return Settled(result.states.moved(unknowns), chords, converged)


def settled(states: _State, parameters: Array) -> Settled[_State]:
    """Solutions of contacts that start from those without air, or from a solved case next to it.

    parameters: (case, parameter), logarithms of what the cases differ in, the size first.
    """
    count = len(parameters)
    if count == 1:
        return _from_first(states)
    unknowns, converged = np.array(states.unknowns), np.zeros(count, dtype=bool)
    chords: list[Factored | None] = [None] * count
    valid = np.zeros(count, dtype=bool)

    def put(cases: Indices, result: Settled[_State]) -> None:
        unknowns[cases], converged[cases], valid[cases] = result.states.unknowns, result.converged, result.valid
        for case, chord in zip(cases.tolist(), result.chords, strict=True):
            chords[case] = chord

    order = np.argsort(parameters[:, 0], kind="stable")
    is_first = np.arange(count) % _APART == 0
    for cases in (order[is_first], order[~is_first]):
        part, known = states.part(cases), np.flatnonzero(valid)
        parents = np.full(cases.size, -1)
        if known.size:
            distance = np.max(np.abs(parameters[cases][:, None] - parameters[known]), 2)
            nearest = np.argmin(distance, 1)
            parents = np.where(np.min(distance, 1) < _NEAR, known[nearest], -1)
        near, far = np.flatnonzero(parents >= 0), np.flatnonzero(parents < 0)
        if near.size:
            start = part.part(near)
            result = _with(iterated(start.moved(unknowns[parents[near]]), _of(chords, parents[near])), start)
            put(cases[near], result)
        if far.size:
            put(cases[far], _from_first(part.part(far)))
    return Settled(states.moved(unknowns), _of(chords, np.arange(count)), converged)
