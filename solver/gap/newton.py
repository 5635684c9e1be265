"""Newton's iteration for contacts in air, along lines and at points, many cases at a time (theory section 10).

Unknowns are log size (half-length or radius), the contact's other numbers, then the densities over their size.
Equations are the load, the smooth edge, each charge or its zero potential, then the gap's law at the nodes.
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
    """LU factors of a system whose columns and then rows are divided by their largest entries."""

    # Distant charges move the contact by a thousand times their density, and the gap's law next to the edge is divided
    # by a gap of 1e-9: unscaled, rounding of the large entries is 1e-4 of the small ones.
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
        """Return the solution for right sides (n,) or (n, m)."""
        result = dgetrs(*self.factors, (right.T * self.rows).T, trans=1)[0]
        return np.asarray((result.T * self.columns).T)

    @cached_property
    def load_solutions(self) -> Array:
        """Solutions for unit right sides of the load and of each charge; (n, 3)."""
        return self.solve(np.eye(self.columns.size)[:, _LOAD_ROWS])


_FIRST_CHARGE = 2  # row of the first charge, behind load and smooth edge
_LOAD_ROWS = [0, _FIRST_CHARGE, _FIRST_CHARGE + 1]  # of the load and of two charges


def solved(matrix: Array, right: Array) -> Array:
    """Solve one system by :class:`Factored`, refined once, since pivots among rows of equal size may be poor."""
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
        """Outputs at log sizes (case,)."""
        if self.interval is None:
            return Reading(self.values, np.stack([np.ones((log_size.size, 1)), np.zeros((log_size.size, 1))]))
        return Reading(self.values, self.interval.polynomials(log_size, clipped=self.clipped) @ self._series)

    @cached_property
    def _series(self) -> Array:
        """Matrices from values at the points to Chebyshev series of function and derivative; (2, n, point)."""
        assert self.interval is not None
        series = coefficients(np.eye(self.interval.count))
        return np.stack([series, self.interval.derived(series)])


class SplitOutputs(NamedTuple):
    """Outputs that the equations of a table's contacts need, and outputs that are only reported."""

    solving: Outputs
    reported: Outputs

    @classmethod
    def of(cls, values: Array, solving: int, interval: Interval | None, *, clipped: bool = False) -> Self:
        """Split values (point, row, column) after the first ``solving`` rows."""
        parts = (np.ascontiguousarray(part) for part in (values[:, :solving], values[:, solving:]))
        return cls(*(Outputs(part, interval, clipped) for part in parts))


@dataclass(frozen=True, eq=False)
class Reading:
    """Outputs at the sizes of some cases."""

    values: Array  # At the points of the interval; (point, row, column)
    weights: Array  # Of the points in values and in their derivatives by log size; (2, case, point)

    @property
    def matrices(self) -> Array:
        """Outputs of every column; (case, row, column)."""
        return np.tensordot(self.weights[0], self.values, 1)

    def times(self, columns: Array, rows: int | None = None) -> Array:
        """First ``rows`` outputs of ``columns`` (case, column, k), and derivatives by log size; (2, case, row, k)."""
        values, (cases, count, k) = self.values[:, :rows], columns.shape
        flat = values.reshape(-1, count) @ np.moveaxis(columns, 1, 0).reshape(count, -1)
        products = flat.reshape(*values.shape[:2], cases, k)
        return np.asarray(np.einsum("tcp,prck->tcrk", self.weights, products))


@dataclass(frozen=True, eq=False)
class Frame:
    """Properties that contacts of one table share."""

    outputs: Outputs  # Those of the contact, then exterior u_y and potentials less those at the edge
    heads: int  # Number of outputs of the contact
    fields: tuple[int, ...]  # Conducted fields, 0 electric and 1 magnetic
    positions: Array  # X or r/a of the nodes; (n,)
    sides: int  # Number of sides on which the nodes lie
    extents: int  # Number of leading unknowns that have bounded steps and stay fixed in ``started``
    rounds: int  # Number of linear solutions in ``started``
    load: str  # "load" or "force"
    coordinate: str  # Name of the positions


@dataclass(frozen=True, eq=False)
class Linear:
    """Numbers of a contact, and their derivatives by its outputs and by the unknowns before the densities."""

    values: Array  # (case, number)
    by_first: Array  # (case, number, unknown)
    by_outputs: Array | None = None  # (case, number, output); None: independent of the outputs

    def rates(self, outputs: Array, first: Array) -> Array:
        """Derivatives (case, number, k) from those of the outputs (case, output, k) and of the first unknowns."""
        result = self.by_first @ first
        return result if self.by_outputs is None else result + self.by_outputs @ outputs


@dataclass(frozen=True, eq=False)
class Terms:
    """Terms of the equations."""

    head: Linear  # Residuals of load and smooth edge, then of the prescribed charges
    profile: Linear  # Gap between the profile and a flat surface at the nodes
    reference: Array  # Reference gap, which scales the gap's law; (case, n)
    conductance: Array  # Density over its size per potential, times gap over reference; (case, field, n)
    growth: Array  # d log conductance / d log size; (case, n)
    sizes: Array  # Scales of the unknowns, which make steps relative; (case, unknown)


_State = TypeVar("_State", bound="GapStates")


@dataclass(frozen=True, eq=False)
class GapStates(ABC):
    """Contacts that share a table, at some unknowns."""

    frame: Frame
    unknowns: Array  # Log size, numbers of the contact, densities over their size by field; (case, unknown)
    held: tuple[bool, ...]  # Whether each potential is held at zero, so that the charge follows

    @abstractmethod
    def part(self, cases: Indices) -> Self:
        """States of some of the cases."""

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
        """Right sides of unit loads, and the datum's part of the response to the load; (case, 1 + charge) each."""

    # -- equations -----------------------------------------------------------------------------------------------------
    def with_unknowns(self, unknowns: Array) -> Self:
        """Return the contacts at other unknowns."""
        return replace(self, unknowns=unknowns)

    @property
    def first(self) -> int:
        """Number of unknowns before the densities."""
        return int(self.unknowns.shape[1]) - len(self.frame.fields) * self.frame.positions.size

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
        """Outputs and their derivatives by log size; (2, case, row)."""
        return self._reading.times(self.columns[..., None])[..., 0]

    @property
    def rows(self) -> Array:
        """Outputs; (case, row)."""
        return np.asarray(self._rows[0])

    def _rates(self, directions: Array | None, rows: int | None = None) -> Array:
        """Derivatives of the (first ``rows``) outputs along directions, None: by the unknowns; (case, row, k)."""
        first, causes = self.first, self.causes.by_first
        by_size: Array | float = self._rows[1][:, :rows, None]
        if directions is None:
            matrices, count = self._reading.matrices, causes.shape[1]
            result = np.empty((*matrices.shape[:2], self.unknowns.shape[1]))
            result[..., :first] = matrices[..., :count] @ causes
            result[..., first:] = matrices[..., count:]
            result[..., :1] += by_size
            return result
        columns = np.concatenate([causes @ directions[:, :first], directions[:, first:]], 1)
        return np.asarray(self._reading.times(columns, rows)[0] + by_size * directions[:, :1])

    def _exterior(self, rows: Array) -> Array:
        """Select exterior u_y and potentials from rows (case, row, ...); (case, 1 + field, n, ...)."""
        shape = 1 + len(self.frame.fields), self.frame.positions.size
        return rows[:, self.frame.heads :].reshape(len(rows), *shape, *rows.shape[2:])

    @cached_property
    def gap(self) -> Array:
        """Gap at the nodes; (case, n)."""
        return np.asarray(self.terms.profile.values - self._exterior(self._rows[0])[:, 0])

    @property
    def is_open(self) -> BoolArray:
        """Mark cases whose gap is positive at every node; (case,)."""
        return np.asarray(np.all(self.gap > 0, 1))

    @cached_property
    def residual(self) -> Array:
        """Residual of load, smooth edge, charges or held potentials, and the gap's law; (case, unknown)."""
        terms, potentials = self.terms, self._exterior(self._rows[0])[:, 1:]
        law = self.over_size * (self.gap / terms.reference)[:, None] - terms.conductance * potentials
        head = np.array(terms.head.values)
        for charge in np.flatnonzero(self.held):
            head[:, _FIRST_CHARGE + charge] = self.response.values[:, 1 + charge]
        return np.concatenate([head, law.reshape(len(law), -1)], 1)

    def derivative(self, directions: Array | None = None, *, fixed: bool = False) -> Array:
        """Derivative of the residual with prescribed charges along directions, None: by the unknowns.

        Directions and result are (case, unknown, k); ``fixed``: the gap is fixed, and held potentials replace charges.
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
        relative_gap = self.gap / terms.reference
        if directions is None:
            law[..., :1] -= by_size
            diagonal = np.arange(first, count)
            result[:, diagonal, diagonal] += np.tile(relative_gap, potentials.shape[1])
        else:
            law -= by_size * directions[:, None, None, 0]
            law += relative_gap[:, None, :, None] * directions[:, first:].reshape(law.shape)
        if fixed:
            by_potential = self.response.rates(heads, before)
            for charge in np.flatnonzero(self.held):
                result[:, _FIRST_CHARGE + charge] = by_potential[:, 1 + charge]
            return result
        gap_rates = terms.profile.rates(heads, before) - exterior[:, 0]
        for row in range(law.shape[1]):
            law[:, row] += (self.over_size[:, row] / terms.reference)[..., None] * gap_rates
        return result

    def response_rates(self, directions: Array) -> Array:
        """Derivatives of the response along directions (case, unknown, k); (case, 1 + charge, k)."""
        return self.response.rates(self._rates(directions, self.frame.heads), directions[:, : self.first])

    def steps(self, chords: Sequence[Factored]) -> Array:
        """Newton's steps, to be subtracted; held potentials have the derivatives of the states; (case, unknown)."""
        right, held = np.array(self.residual), np.flatnonzero(self.held)
        potentials = right[:, _FIRST_CHARGE + held]
        right[:, _FIRST_CHARGE + held] = 0.0
        step = _solved(chords, right[..., None])[..., 0]
        if held.size:
            by_charge = np.stack([chord.load_solutions[:, 1 + held] for chord in chords])
            rates = self.response_rates(np.concatenate([by_charge, step[..., None]], 2))[:, 1 + held]
            charges = np.linalg.solve(rates[..., :-1], (potentials - rates[..., -1])[..., None])
            step += (by_charge @ charges)[..., 0]
        return step

    def chords(self) -> list[Factored]:
        """Factorised equations of every case."""
        count, cases = _at_once(self), np.arange(len(self.unknowns))
        blocks = [cases[start : start + count] for start in range(0, cases.size, count)]
        parts = [self] if len(blocks) == 1 else [self.part(block) for block in blocks]
        return [Factored.of(matrix) for part in parts for matrix in part.derivative()]

    @property
    def started(self) -> Self:
        """Contacts of the size without air, with the densities that their potentials cause in their gap."""
        states, e = self, self.frame.extents
        for _ in range(self.frame.rounds):
            matrices = states.derivative(fixed=True)[:, e:, e:]
            steps = [solved(*pair) for pair in zip(matrices, states.residual[:, e:], strict=True)]
            unknowns = np.array(states.unknowns)
            unknowns[:, e:] -= steps
            states = states.with_unknowns(unknowns)
        return states

    @property
    def reopened(self) -> Self:
        """States whose densities up to the first open node are those of that node, from which the gap opens."""
        # a density that closes the gap next to an edge solves the gap's law too, with a potential of the other sign
        shape = len(self.unknowns), self.frame.sides, self.frame.positions.size // self.frame.sides
        gaps, unknowns = self.gap.reshape(shape), np.array(self.unknowns)
        densities = unknowns[:, self.first :].reshape(shape[0], -1, *shape[1:])
        for case, side in np.ndindex(shape[:2]):
            closed = np.flatnonzero(gaps[case, side] <= 0)
            if closed.size:
                node = min(int(closed[-1]) + 1, shape[2] - 1)
                densities[case, :, side, :node] = densities[case, :, side, node, None]
        return self.with_unknowns(np.concatenate([unknowns[:, : self.first], densities.reshape(shape[0], -1)], 1))


_NEWTON_STEPS = 60
_CLOSE, _NEXT_CLOSE = 1e-11, 1e-12  # relative step that converges; the next step, extrapolated, that does
_STALLED = 1e-7  # steps below it that no longer shrink are rounding
_LONGEST = 0.3  # largest step of the extents
_REOPENINGS = 3  # largest number of times that a closed gap is reopened
_SLOW, _SLOW_HELD = 0.02, 0.1  # ratio of successive steps above which the equations are factorised again
_ROUNDED = 1e-9  # steps below it are slow by rounding: new equations would not help
_NEAR = 0.7  # distance in logarithms of the parameters within which a solved case is a start
_MATRIX_BYTES, _CHORD_BYTES = 4e7, 1e8  # of matrices, and of factorised equations, at a time
_EVERY = 8  # every eighth case in order of size is solved first, the reported start from these


@dataclass(frozen=True, eq=False)
class Settled(Generic[_State]):
    """Results of the iteration, with factorised equations of states near them."""

    states: _State
    chords: list[Factored]
    converged: BoolArray  # (case,)

    def part(self, cases: Indices) -> "Settled[_State]":
        """Results of some of the cases."""
        chords = [self.chords[case] for case in cases.tolist()]
        return Settled(self.states.part(cases), chords, self.converged[cases])

    @cached_property
    def valid(self) -> BoolArray:
        """Mark cases that converged to an open gap; (case,)."""
        return self.converged & self.states.is_open

    def require(self) -> Self:
        """Return the results, or refuse cases that did not converge or whose gap closes."""
        states, frame = self.states, self.states.frame
        for case in np.flatnonzero(~self.valid).tolist():
            if not self.converged[case]:
                raise ContactError(
                    f"surroundings: no contact with air beside it is found for this {frame.load} and these charges"
                )
            names = [name for name, zero in zip(("voltage", "magnetic potential"), states.held, strict=False) if zero]
            held = f", where its {' and '.join(names)} is 0" if names else ""
            position = frame.positions[int(np.argmin(states.gap[case] / states.terms.reference[case]))]
            raise ContactError(
                f"surroundings: the punch touches the surface beside the contact, at {frame.coordinate} = "
                f"{position:.3g}{held}: the gap is negative there; must be insulated"
            )
        return self

    @cached_property
    def _changes(self) -> Array:
        """Changes of the unknowns for unit loads, force then charges; (case, unknown, 1 + charge)."""
        states, count = self.states, 1 + len(self.states.held)
        right = np.eye(states.unknowns.shape[1])[:, _LOAD_ROWS[:count]]
        chords = states.chords()
        result = np.stack([chord.load_solutions[:, :count] for chord in chords])
        result += _solved(chords, right - states.derivative(result))  # refined once, as in :func:`solved`
        return result * states.by_load[0][:, None]

    @cached_property
    def tangents(self) -> Array:
        """Return d response / d (load, charges) with moving edges; (case, 1 + charge, 1 + charge)."""
        result = self.states.response_rates(self._changes)
        result[..., 0] += self.states.by_load[1]
        return result

    @cached_property
    def at_fixed_contact(self) -> Array:
        """Return d response / d charges at a fixed size, where load and gap follow; (case, 1 + charge, charge)."""
        by_size = self._changes[:, :1]
        return np.asarray(self.tangents[..., 1:] - self.tangents[..., :1] * (by_size[..., 1:] / by_size[..., :1]))


def _at_once(states: GapStates) -> int:
    """Number of cases whose matrices are in memory at a time."""
    _, rows, columns = states.frame.outputs.values.shape
    return max(int(_MATRIX_BYTES / (8 * (2 * rows * columns + 2 * states.unknowns.shape[1] ** 2))), 1)


def together(states: GapStates) -> int:
    """Number of cases that are solved together, by the size of their factorised equations."""
    return max(int(_CHORD_BYTES / (8 * states.unknowns.shape[1] ** 2)), 1)


def _solved(chords: Sequence[Factored], right: Array) -> Array:
    """Solutions of the cases' equations, (case, unknown, k), with one call for cases that share theirs."""
    result, members = np.empty_like(right), dict[int, list[int]]()
    for case, chord in enumerate(chords):
        members.setdefault(id(chord), []).append(case)
    for cases in members.values():
        flat = np.moveaxis(right[cases], 0, 1)
        values = chords[cases[0]].solve(flat.reshape(len(flat), -1)).reshape(flat.shape)
        result[cases] = np.moveaxis(values, 1, 0)
    return result


def iterated(states: _State, starts: Sequence[Factored | None], slow: float = _SLOW) -> Settled[_State]:
    """Iterate by Newton's method from ``states``, whether the gaps open or close.

    starts: factorised equations of a state near each case, None: of the case itself; slow: ratio of successive steps
    above which the equations are factorised again.
    """
    count, unknowns, chords = len(starts), np.array(states.unknowns), list(starts)
    active, part = np.arange(count), states
    converged, last = np.zeros(count, dtype=bool), np.full(count, np.inf)
    for _ in range(_NEWTON_STEPS):
        current, before = part.with_unknowns(unknowns[active]), last[active]
        fresh = np.array([chords[case] is None for case in active.tolist()])
        _renew(chords, active, current, np.flatnonzero(fresh))
        change = current.steps(_known(chords, active))
        size = np.max(np.abs(change) / current.terms.sizes, 1)
        stale = np.flatnonzero(~fresh & ~(size < slow * before) & ~(before < _ROUNDED) & np.isfinite(size))
        if stale.size:
            slow_states = current if stale.size == active.size else current.part(stale)
            _renew(chords, active[stale], slow_states, np.arange(stale.size))
            change[stale] = slow_states.steps(_known(chords, active[stale]))
        change /= np.maximum(1.0, np.max(np.abs(change[:, : states.frame.extents]), 1) / _LONGEST)[:, None]
        size = np.max(np.abs(change) / current.terms.sizes, 1)
        unknowns[active] -= change
        last[active] = size
        close = (size < _CLOSE) | ((size < _STALLED) & (size > before / 2))
        # steps by the same equations shrink by a constant factor
        close |= np.isfinite(before) & (size**2 < _NEXT_CLOSE * before)
        converged[active] |= close
        running = np.flatnonzero(~converged[active] & np.isfinite(size))
        if not running.size:
            break
        if running.size < active.size:
            active, part = active[running], part.part(running)
    final = part if active.size == count else states
    return Settled(final.with_unknowns(unknowns), _known(chords, np.arange(count)), converged)


def _known(chords: Sequence[Factored | None], cases: Indices) -> list[Factored]:
    return [chord for chord in (chords[case] for case in cases.tolist()) if chord is not None]


def _renew(chords: list[Factored | None], cases: Indices, states: GapStates, members: Indices) -> None:
    """Factorise the equations of some members of ``states``, which belong to ``cases``, into ``chords``."""
    if members.size:
        part = states if members.size == len(states.unknowns) else states.part(members)
        for case, chord in zip(cases[members].tolist(), part.chords(), strict=True):
            chords[case] = chord


def continued(states: _State, near: Settled[_State], slow: float = _SLOW_HELD) -> Settled[_State]:
    """Solve ``states`` from solved contacts, and from contacts without air where that fails."""
    return _retried(iterated(states.with_unknowns(near.states.unknowns), near.chords, slow), states)


def _retried(result: Settled[_State], states: _State) -> Settled[_State]:
    """Solve the invalid cases of ``result`` again from ``states``, contacts without air."""
    failed = np.flatnonzero(~result.valid)
    return _replaced(result, failed, _from_airless(states.part(failed))) if failed.size else result


def _from_airless(states: _State) -> Settled[_State]:
    """Solve from ``states``, contacts without air, and reopen gaps that close."""
    result = iterated(states.started, [None] * len(states.unknowns))
    for _ in range(_REOPENINGS):
        closed = np.flatnonzero(result.converged & ~result.valid)
        if not closed.size:
            break
        opened = iterated(result.states.part(closed).reopened, [None] * closed.size)
        result = _replaced(result, closed[opened.converged], opened.part(np.flatnonzero(opened.converged)))
    return result


def _replaced(result: Settled[_State], cases: Indices, replacement: Settled[_State]) -> Settled[_State]:
    unknowns, chords, converged = np.array(result.states.unknowns), list(result.chords), np.array(result.converged)
    unknowns[cases], converged[cases] = replacement.states.unknowns, replacement.converged
    for case, chord in zip(cases.tolist(), replacement.chords, strict=True):
        chords[case] = chord
    return Settled(result.states.with_unknowns(unknowns), chords, converged)


def settled(states: _State, parameters: Array) -> Settled[_State]:
    """Solve contacts from those without air, ``states``, or from a solved case with similar parameters.

    parameters: (case, parameter), logarithms of the cases' parameters, the size first.
    """
    order, is_first = np.argsort(parameters[:, 0], kind="stable"), np.arange(len(parameters)) % _EVERY == 0
    first, others = order[is_first], order[~is_first]
    parents = _from_airless(states.part(first))
    parts = [(first, parents)]
    # distances to parents, infinite from those that failed
    distance = np.max(np.abs(parameters[others][:, None] - parameters[first]), 2)
    distance[:, ~parents.valid] = np.inf
    is_near, nearest = np.min(distance, 1) < _NEAR, np.argmin(distance, 1)
    if np.any(is_near):
        cases, near = others[is_near], parents.part(nearest[is_near])
        parts.append((cases, continued(states.part(cases), near, _SLOW)))
    if not np.all(is_near):
        cases = others[~is_near]
        parts.append((cases, _from_airless(states.part(cases))))
    cases, results = np.concatenate([cases for cases, _ in parts]), [result for _, result in parts]
    unknowns, converged = np.empty_like(states.unknowns), np.empty(cases.size, dtype=bool)
    unknowns[cases] = np.concatenate([result.states.unknowns for result in results])
    converged[cases] = np.concatenate([result.converged for result in results])
    chords = dict(zip(cases.tolist(), [chord for result in results for chord in result.chords], strict=True))
    return Settled(states.with_unknowns(unknowns), [chords[case] for case in range(cases.size)], converged)
