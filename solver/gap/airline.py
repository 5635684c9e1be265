"""A line contact with air beside it: Newton's iteration on extent, charges and densities (theory section 10).

Beside the contact D (profile - depth - u_y) = eps0 (phi - V), and the same with B, mu0 and psi. Unknowns are log h,
c/h, T, J and the densities at the nodes; a charge is given, or the potential that it makes zero. Tangents follow from
the same linear system.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from solver.arrays import Array
from solver.gap.newton import Factored, is_open, iterated, opened, reopened, solved
from solver.gap.operators import BALANCE, DISPLACEMENT, LOAD, SOLVING, AirTable, Near
from solver.gap.refusal import GapError, require_open
from solver.line.contact import FilmContact, mean_power


@dataclass(frozen=True, eq=False)
class Problem:
    """A contact under one punch with air beside it, in the units of the stack unless SI is stated."""

    table: AirTable
    contact: FilmContact
    permittivity: Array
    held: tuple[bool, bool] = (False, False)

    @property
    def fields(self) -> tuple[int, ...]:
        """Conducted fields."""
        return self.table.table.system.fields

    @property
    def nodes(self) -> int:
        """Number of nodes of a field beside the contact."""
        return self.table.operators.density_nodes

    @cached_property
    def media(self) -> Array:
        """eps0 and mu0 in the units of the stack, of the conducted fields; (field,)."""
        scale = self.contact.scale
        return np.array([self.permittivity[f] * scale[2 + f] ** 2 / scale[1] for f in self.fields])

    @cached_property
    def powers(self) -> tuple[Array, Array]:
        """Integrals of X^m from the edge to the nodes (n, degree + 1), and densities over the unknowns (n,)."""
        operators = self.table.operators
        m = np.arange(1, self.contact.loading.slope.shape[-1] + 1)
        risen = np.expm1(m * np.log1p(2 * np.sinh(operators.grid.theta / 2) ** 2)[:, None]) / m
        integrals = np.concatenate([risen, (-1.0) ** m * risen])[: operators.density_nodes]
        return integrals, np.tile(operators.grid.size, operators.sides)


_FIELDS = ("voltage", "magnetic potential")
_EXTENT = 2  # unknowns before the charges: log h, c/h


@dataclass(frozen=True, eq=False)
class State:
    """Residual, tangents and outputs of ``Problem`` at unknowns (log h, c/h, T, J, densities)."""

    problem: Problem
    unknowns: Array
    known: Near | None = None

    def moved(self, unknowns: Array) -> "State":
        """The same contact at other unknowns."""
        return State(self.problem, unknowns, self.near)

    @property
    def half(self) -> float:
        """h."""
        return float(np.exp(self.unknowns[0]))

    @property
    def centre(self) -> float:
        """c/h."""
        return float(self.unknowns[1])

    @property
    def _densities(self) -> Array:
        """Unknowns of the densities; (field, n)."""
        return self.unknowns[_EXTENT + 2 :].reshape(len(self.problem.fields), -1)

    @cached_property
    def loads(self) -> Array:
        """P, T, J; (3,)."""
        return np.array([self.problem.contact.loading.loads[0, 0], *self.unknowns[_EXTENT : _EXTENT + 2]])

    @cached_property
    def near(self) -> Near:
        """Operators about the half-length."""
        log_half = float(self.unknowns[0])
        return self.known if self.known and self.known.holds(log_half) else self.problem.table.near(log_half)

    @cached_property
    def _causes(self) -> tuple[Array, Array]:
        """Slope a_0, causes, and their derivatives in log h and c/h; (3, m) and (3, cause)."""
        loading = replace(self.problem.contact.loading, loads=self.loads[None])
        c = loading.at(np.array([self.half]), np.array([self.centre]))
        values = np.stack([c.values[0], c.by_width[0], c.by_centre[0]])
        constants = np.array([c.constant[0], c.constant_by_width[0], c.constant_by_centre[0]])
        count = loading.slope.shape[-1] - 1
        return np.concatenate([constants[:, None], values[:, :count]], 1), values

    @cached_property
    def _solved(self) -> tuple[Array, Array]:
        """Rows that the equations need, and their derivatives in log h; (row,) each."""
        return self.near.products(float(self.unknowns[0]), self._columns)

    @cached_property
    def outputs(self) -> Array:
        """Rows of :mod:`solver.gap.operators`; (row,)."""
        return self.problem.table.outputs(float(self.unknowns[0]), self._columns)

    @cached_property
    def _columns(self) -> Array:
        return np.concatenate([self._causes[1][0], self._densities.ravel()])

    @cached_property
    def _rates(self) -> Array:
        """Derivatives of the rows in (log h, c/h, T, J, densities); (row, unknown)."""
        return self._rates_of(slice(None))

    def _rates_of(self, rows: slice) -> Array:
        value = self.near.matrix(float(self.unknowns[0]), rows)
        causes = self._causes[1]
        first = causes.shape[1] - 2
        extent = value[:, : causes.shape[1]] @ causes[1:].T
        extent[:, 0] += self._solved[1][rows]
        return np.concatenate([extent, value[:, first : first + 2] / self.half, value[:, first + 2 :]], 1)

    def _exterior(self, rows: Array) -> tuple[Array, Array]:
        """u_y and potentials beside the contact, from rows (row, ...): (n, ...) and (field, n, ...)."""
        n, count = self.problem.nodes, len(self.problem.fields)
        part = rows[SOLVING : SOLVING + n * (1 + count)].reshape(1 + count, n, *rows.shape[1:])
        return part[0], part[1:]

    @cached_property
    def gap(self) -> Array:
        """Gap over h at the nodes; (n,)."""
        return np.asarray(self.problem.powers[0] @ self._causes[0][0] - self._exterior(self._solved[0])[0])

    @cached_property
    def _gap_rates(self) -> Array:
        rates = -self._exterior(self._rates)[0]
        rates[:, :_EXTENT] += self.problem.powers[0] @ self._causes[0][1:].T
        return rates

    @property
    def densities(self) -> Array:
        """D_y and B_y at the nodes; (field, n)."""
        return self._densities * self.problem.powers[1]

    @property
    def densities_at_its_gap(self) -> Array:
        """Densities that potentials make where the gap does not move; (field n,)."""
        n, fields = self.problem.nodes, len(self.problem.fields)
        potentials = self._exterior(self._solved[0])[1]
        by_density = self._exterior(self.near.matrix(float(self.unknowns[0])))[1][..., self._causes[1].shape[1] :]
        size = self.problem.powers[1]
        matrix = (
            -(self.problem.media[:, None, None] * by_density).reshape(n * fields, n * fields)
            / np.tile(size, fields)[:, None]
        )
        matrix[np.diag_indices(n * fields)] += np.tile(self.gap, fields)
        right = (self.problem.media[:, None] * potentials / size).ravel()
        return solved(matrix, right)

    @property
    def reopened(self) -> Array:
        """Unknowns with densities that open a gap which is closed next to an edge; (unknown,)."""
        sides, start = self.problem.table.operators.sides, _EXTENT + 2
        densities = self.unknowns[start:].reshape(len(self.problem.fields), sides, -1)
        gaps = self.gap.reshape(sides, -1)
        opened = np.stack([reopened(densities[:, side], gap) for side, gap in enumerate(gaps)], 1)
        return np.concatenate([self.unknowns[:start], opened.ravel()])

    @property
    def unknowns_of_held_potentials(self) -> Array:
        """Unknowns with charges that make held potentials zero, contact and densities unchanged; (unknown,)."""
        held = [f for f in self.problem.fields if self.problem.held[f]]
        rows, columns = [1 + f for f in held], [_EXTENT + f for f in held]
        result = np.array(self.unknowns)
        result[columns] -= np.linalg.solve(self.response_rates[np.ix_(rows, columns)], self.response[rows])
        return result

    @cached_property
    def sizes(self) -> Array:
        """Scales of the unknowns, over which steps are measured; (unknown,)."""
        weights = np.sqrt(self.problem.powers[1])  # the last panel's unknowns are D X^2, and its charge is D X
        largest_density = np.max(np.abs(self._densities) * weights, 1, initial=1e-300)
        largest_density = np.maximum(largest_density, 1e-4 * self.loads[0] / self.half)
        charge = np.maximum(np.abs(self.loads[1:]), np.max(largest_density) * self.half)
        return np.concatenate([np.ones(_EXTENT), charge, (largest_density[:, None] / weights).ravel()])

    @cached_property
    def residual(self) -> Array:
        """Zero where it is a contact: load, balance, charges or potentials, and the gap's law at the nodes."""
        load = self.half * self._solved[0][LOAD] / self.loads[0] - 1
        balance = self._causes[0][0, 0] - self._solved[0][BALANCE]
        closings = [self._closing(f) for f in (0, 1)]
        potentials = self._exterior(self._solved[0])[1]
        law = self._densities * self.gap - self.problem.media[:, None] * potentials / self.problem.powers[1]
        return np.concatenate([[load, balance], closings, (law / self._reference).ravel()])

    def _closing(self, f: int) -> float:
        if f in self.problem.fields and self.problem.held[f]:
            return float(self.response[1 + f])
        return float(self.loads[1 + f] - self.problem.contact.loading.loads[0, 1 + f])

    @cached_property
    def _reference(self) -> Array:
        """Gap of the profile alone, which scales the law; (n,)."""
        X = np.cosh(np.tile(self.problem.table.operators.grid.theta, self.problem.table.operators.sides))
        return np.asarray((X - 1) ** 1.5 / np.sqrt(X) * np.max(np.abs(self._causes[0][0])))

    @cached_property
    def jacobian(self) -> Array:
        """Derivatives of the residual where charges are given; (unknown, unknown)."""
        count = self.unknowns.size
        matrix = np.zeros((count, count))
        matrix[0] = self.half * self._rates[LOAD] / self.loads[0]
        matrix[0, 0] += self.half * self._solved[0][LOAD] / self.loads[0]
        matrix[1] = -self._rates[BALANCE]
        matrix[1, :_EXTENT] += self._causes[0][1:, 0]
        matrix[_EXTENT, _EXTENT] = matrix[_EXTENT + 1, _EXTENT + 1] = 1.0
        n = self.problem.nodes
        potentials = self._exterior(self._rates)[1]
        for place in range(len(self.problem.fields)):
            rows = slice(_EXTENT + 2 + place * n, _EXTENT + 2 + (place + 1) * n)
            law = self._densities[place][:, None] * self._gap_rates
            law -= self.problem.media[place] * potentials[place] / self.problem.powers[1][:, None]
            law[:, rows][np.diag_indices(n)] += self.gap
            matrix[rows] = law / self._reference[:, None]
        return matrix

    @cached_property
    def chord(self) -> "Chord":
        """The linear system at this state."""
        return Chord(Factored.of(self.jacobian))

    @property
    def held(self) -> list[int]:
        """Fields whose potentials are held."""
        return [f for f in self.problem.fields if self.problem.held[f]]

    def require_gap(self) -> None:
        """Refuse a gap that closes, as :func:`solver.gap.refusal.require_open`."""
        operators = self.problem.table.operators
        X = np.concatenate([operators.grid.distance, -operators.grid.distance])[: operators.density_nodes]
        held = " and ".join(name for name, is_held in zip(_FIELDS, self.problem.held, strict=True) if is_held)
        require_open(self.gap, self._reference, X, "(x - c)/h", held)

    # -- outputs -------------------------------------------------------------------------------------------------------
    @cached_property
    def response(self) -> Array:
        """Depth, V and Psi in the units of the stack; (3,)."""
        u = self.half * self._solved[0][DISPLACEMENT] - self.problem.contact.far[0] @ self.loads
        return np.concatenate([[self._rise[0] - u[0]], u[1:]])

    @cached_property
    def _rise(self) -> Array:
        """Mean of g over the contact and its derivatives in log h and c/h; (3,)."""
        slope, centre = self.problem.contact.loading.slope[0], np.array([self.centre])
        result = np.zeros(3)
        for i, coefficient in enumerate(slope):
            size, mean = coefficient * self.half ** (i + 1), float(mean_power(centre, i + 1)[0])
            result += size * np.array([mean / (i + 1), mean, float(mean_power(centre, i)[0])])
        return result

    @cached_property
    def response_rates(self) -> Array:
        """Derivatives of depth, V and Psi in the unknowns, P held; (3, unknown)."""
        rates = self.half * self._rates_of(DISPLACEMENT)
        rates[:, 0] += self.half * self._solved[0][DISPLACEMENT]
        rates[:, _EXTENT : _EXTENT + 2] -= self.problem.contact.far[0][:, 1:]
        rates[0] *= -1
        rates[0, :_EXTENT] += self._rise[1:]
        return rates

    @cached_property
    def tangents(self) -> Array:
        """d (depth, V, Psi) / d (P, T, J) with moving edges, SI; (3, 3)."""
        moved = np.array(self.chord.causes)
        moved[:, 0] *= self.half * self._solved[0][LOAD] / self.loads[0] ** 2
        whole = self.response_rates @ moved
        whole[:, 0] += self._by_load
        scale = self.problem.contact.scale[1:]
        return np.asarray(whole * scale[:, None] * scale)

    @property
    def _by_load(self) -> Array:
        """Derivatives of depth, V and Psi in P by the datum alone; (3,)."""
        by_datum = -self.problem.contact.far[0][:, 0]
        return np.asarray(by_datum * np.array([-1.0, 1.0, 1.0]))

    @cached_property
    def at_fixed_contact(self) -> Array:
        """d (depth, V, Psi) / d (T, J) at a fixed contact: the load and the gap follow, SI; (3, 2)."""
        causes = self.chord.causes
        load = -causes[0, 1:] / causes[0, 0]  # that keeps log h
        moved = causes[:, 1:] + causes[:, :1] * load
        whole = self.response_rates @ moved + self._by_load[:, None] * (self.loads[0] * load)
        scale = self.problem.contact.scale[1:]
        return np.asarray(whole * scale[:, None] * scale[1:])


@dataclass(frozen=True, eq=False)
class Chord:
    """LU factors of the equations at one state, charges given, which serve states next to it."""

    system: Factored

    @cached_property
    def causes(self) -> Array:
        """Changes of the unknowns when the residual of the load, of T or of J falls by one; (unknown, 3)."""
        right = np.zeros((self.system.columns.size, 3))
        right[0, 0] = right[_EXTENT, 1] = right[_EXTENT + 1, 2] = 1.0
        return self.system.solve(right)

    def step(self, state: State) -> Array:
        """Newton's step back from a state; rows of held potentials are those of the state itself; (unknown,)."""
        right = np.array(state.residual)
        held = state.held
        rows = [_EXTENT + f for f in held]
        potentials = right[rows]
        right[rows] = 0.0
        step = self.system.solve(right)
        if held:
            rates = state.response_rates[[1 + f for f in held]]
            by_charge = self.causes[:, [1 + f for f in held]]
            step += by_charge @ np.linalg.solve(rates @ by_charge, potentials - rates @ step)
        return step


_SLOW = 0.1  # of a step that the next one is below, or its equations are those of another state
_ROUNDED = 1e-9  # steps below it are slow by rounding: new equations would make them no faster


@dataclass(frozen=True, eq=False)
class AirContact(Problem):
    """One that is solved."""

    idle: State | None = None

    @cached_property
    def state(self) -> State:
        """The solution."""
        result = self._from_idle
        if not (result and is_open(result)):
            result = opened(self._sought(self._start), self._sought)
        if result is None:
            raise GapError("surroundings: no contact with air beside it is found for this load and these charges")
        result.require_gap()
        return result

    @property
    def _from_idle(self) -> State | None:
        """Solution for held potentials, started from the same contact with prescribed charges: the nearest start.

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
        """Limit of Newton's iteration; the equations of one state serve the next ones while they shrink the steps."""

        def step(state: State, last: float) -> Array:
            nonlocal chord
            change = (chord or state.chord).step(state)
            if chord and last > _ROUNDED and not np.max(np.abs(change) / state.sizes) < _SLOW * last:
                chord = None
                change = state.chord.step(state)
            chord = chord or state.chord
            return change

        return iterated(state, step, _EXTENT)
