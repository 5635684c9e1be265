"""One contact with air beside it: Newton's iteration on its extent, its charges and the densities (theory section 10).

Beside the contact D (profile - depth - u_y) = eps0 (phi - V), and the same with B, mu0 and psi. Unknown are log h, c/h,
T, J and the densities at the nodes; a charge is given, or the potential that it makes zero. Tangents follow from the
same linear system.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from solver.arrays import Array
from solver.film.contact import FilmContact, mean_power
from solver.halfplane.pressing import ContactError
from solver.surroundings.operators import BALANCE, DISPLACEMENT, FIRST, LOAD
from solver.surroundings.table import AirTable

_STEPS = 40
_CLOSE = 1e-11
_STALLED = 1e-7  # steps below it that no longer shrink are rounding
_MOST = 0.3  # of log h and c/h in a step
_LEAST = 2e-3  # of the way that potentials are taken at a time
_FIELDS = ("voltage", "magnetic potential")
_EXTENT = 2  # unknowns before the charges: log h, c/h


class GapError(ContactError):
    """A punch that touches the surface beside the contact, or a gap that nothing converges for."""


@dataclass(frozen=True, eq=False)
class AirContact:
    """A contact under one punch, air beside it; units of the stack but where SI is said.

    Parameters
    ----------
    table
        Table of air about the half-length.
    contact
        The same punch, load and charges without air: one case.
    permittivity
        Relative permittivity and permeability of what fills the gap times the vacuum's, SI; (2,).
    held
        Whether the potential of each field is held in place of the given charge.
    potentials
        What they are held at.
    """

    table: AirTable
    contact: FilmContact
    permittivity: Array
    held: tuple[bool, bool] = (False, False)
    potentials: tuple[float, float] = (0.0, 0.0)

    # -- what is given -------------------------------------------------------------------------------------------------
    @property
    def fields(self) -> tuple[int, ...]:
        """Conducted fields."""
        return self.table.table.system.fields

    @property
    def nodes(self) -> int:
        """Number of nodes of a field beside the contact."""
        return self.table.operators.beside

    @cached_property
    def _media(self) -> Array:
        """eps0 and mu0 in the units of the stack, of the conducted fields; (field,)."""
        scale = self.contact.scale
        return np.array([self.permittivity[f] * scale[2 + f] ** 2 / scale[1] for f in self.fields])

    @cached_property
    def _powers(self) -> tuple[Array, Array]:
        """Integrals of X^m from the edge to the nodes (n, degree + 1), and densities over the unknowns (n,)."""
        of = self.table.operators
        m = np.arange(1, self.contact.loading.slope.shape[-1] + 1)
        risen = np.expm1(m * np.log1p(2 * np.sinh(of.grid.theta / 2) ** 2)[:, None]) / m
        both = np.concatenate([risen, (-1.0) ** m * risen])[: of.beside]
        return both, np.tile(of.grid.size, of.sides)

    # -- solution ------------------------------------------------------------------------------------------------------
    @cached_property
    def state(self) -> "State":
        """The solution.

        Raises
        ------
        GapError
            The punch would touch the surface beside the contact, or no solution is found.
        """
        found = self._sought(self._start)
        if any(self.held) and not (found and found.open):
            found = self._followed or found
        if found is None:
            raise GapError("surroundings: no contact with air beside it is found for this load and these charges")
        found.require_gap()
        return found

    @property
    def _start(self) -> Array:
        """Unknowns of the contact without air, with the densities that its potentials make at its gap."""
        contact = self.contact
        start = np.array([np.log(contact.half_width[0]), contact.centre[0], *contact.loading.loads[0, 1:]])
        start[_EXTENT:][list(self.held)] = 0.0
        state = State(self, np.concatenate([start, np.zeros(self.nodes * len(self.fields))]))
        if any(self.held):
            state = State(self, state.unknowns_of_held_potentials)
        return np.concatenate([state.unknowns[: start.size], state.densities_at_its_gap])

    def _sought(self, unknowns: Array) -> "State | None":
        """What Newton's iteration comes to, its gap open or not; None where it comes to nothing."""
        state, last = State(self, unknowns), np.inf
        for _ in range(_STEPS):
            step = np.linalg.solve(state.jacobian, state.residual)
            step /= max(1.0, float(np.max(np.abs(step[:_EXTENT]))) / _MOST)
            size = float(np.max(np.abs(step) / state.sizes))
            state = State(self, state.unknowns - step)
            if size < _CLOSE or (size < _STALLED and size > last / 2):
                return state
            last = size
        return None

    @property
    def _followed(self) -> "State | None":
        """The solution from that of given charges on, its potentials taken to zero in steps that keep the gap open.

        From afar Newton's iteration may come to a solution whose gap is closed, which is none.
        """
        state = replace(self, held=(False, False)).state
        free, done, step = state.response[1:], 0.0, 0.5
        while done < 1 and step > _LEAST:
            share = min(done + step, 1.0)
            kept = ((1 - share) * free).tolist()
            found = replace(self, potentials=(kept[0], kept[1]))._sought(state.unknowns)
            if found and found.open:
                state, done, step = found, share, 2 * step
            else:
                step /= 2
        return state if done == 1 else None


@dataclass(frozen=True, eq=False)
class State:
    """Residual, tangents and outputs of :class:`AirContact` at unknowns (log h, c/h, T, J, densities)."""

    of: AirContact
    unknowns: Array

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
        return self.unknowns[_EXTENT + 2 :].reshape(len(self.of.fields), -1)

    @cached_property
    def loads(self) -> Array:
        """P, T, J; (3,)."""
        return np.array([self.of.contact.loading.loads[0, 0], *self.unknowns[_EXTENT : _EXTENT + 2]])

    @cached_property
    def _read(self) -> Array:
        return self.of.table.read(float(self.unknowns[0]))

    @cached_property
    def _causes(self) -> tuple[Array, Array]:
        """Slope a_0, causes, and their derivatives in log h and c/h; (3, m) and (3, cause)."""
        loading = replace(self.of.contact.loading, loads=self.loads[None])
        c = loading.at(np.array([self.half]), np.array([self.centre]))
        values = np.stack([c.values[0], c.by_width[0], c.by_centre[0]])
        constants = np.array([c.constant[0], c.constant_by_width[0], c.constant_by_centre[0]])
        count = loading.slope.shape[-1] - 1
        return np.concatenate([constants[:, None], values[:, :count]], 1), values

    @cached_property
    def outputs(self) -> Array:
        """Rows of :mod:`solver.surroundings.operators`; (row,)."""
        return np.asarray(self._read[0] @ self._columns)

    @property
    def _columns(self) -> Array:
        return np.concatenate([self._causes[1][0], self._densities.ravel()])

    @cached_property
    def _rates(self) -> Array:
        """Derivatives of the rows in (log h, c/h, T, J, densities); (row, unknown)."""
        value, rate = self._read
        causes = self._causes[1]
        first = causes.shape[1] - 2
        extent = np.stack([rate @ self._columns + value[:, : causes.shape[1]] @ causes[1],
                           value[:, : causes.shape[1]] @ causes[2]], 1)  # fmt: skip
        return np.concatenate([extent, value[:, first : first + 2] / self.half, value[:, first + 2 :]], 1)

    def _beside(self, rows: Array) -> tuple[Array, Array]:
        """u_y and potentials beside the contact, from rows (row, ...): (n, ...) and (field, n, ...)."""
        n, count = self.of.nodes, len(self.of.fields)
        part = rows[FIRST : FIRST + n * (1 + count)].reshape(1 + count, n, *rows.shape[1:])
        return part[0], part[1:]

    @cached_property
    def gap(self) -> Array:
        """Gap over h at the nodes; (n,)."""
        return np.asarray(self.of._powers[0] @ self._causes[0][0] - self._beside(self.outputs)[0])

    @cached_property
    def _gap_rates(self) -> Array:
        rates = -self._beside(self._rates)[0]
        rates[:, :_EXTENT] += self.of._powers[0] @ self._causes[0][1:].T
        return rates

    @property
    def densities(self) -> Array:
        """D_y and B_y at the nodes; (field, n)."""
        return self._densities * self.of._powers[1]

    @property
    def densities_at_its_gap(self) -> Array:
        """Densities that potentials make where the gap does not move; (field n,)."""
        n, fields = self.of.nodes, len(self.of.fields)
        potentials = self._beside(self.outputs)[1]
        by_density = self._beside(self._read[0])[1][..., self._causes[1].shape[1] :]
        size = self.of._powers[1]
        matrix = (
            -(self.of._media[:, None, None] * by_density).reshape(n * fields, n * fields)
            / np.tile(size, fields)[:, None]
        )
        matrix[np.diag_indices(n * fields)] += np.tile(self.gap, fields)
        right = (self.of._media[:, None] * potentials / size).ravel()
        return np.asarray(np.linalg.solve(matrix, right))

    @property
    def unknowns_of_held_potentials(self) -> Array:
        """Those with the charges that make held potentials zero where neither the contact nor a density changes."""
        held = [f for f in self.of.fields if self.of.held[f]]
        rows, columns = [1 + f for f in held], [_EXTENT + f for f in held]
        found = np.array(self.unknowns)
        found[columns] -= np.linalg.solve(self.response_rates[np.ix_(rows, columns)], self.response[rows])
        return found

    @cached_property
    def sizes(self) -> Array:
        """What steps of the unknowns are small against; (unknown,)."""
        largest_density = np.max(np.abs(self._densities), 1, initial=1e-300)
        largest_density = np.maximum(largest_density, 1e-4 * self.loads[0] / self.half)
        charge = np.maximum(np.abs(self.loads[1:]), np.max(largest_density) * self.half)
        return np.concatenate([np.ones(_EXTENT), charge, np.repeat(largest_density, self.of.nodes)])

    @cached_property
    def residual(self) -> Array:
        """Zero where it is a contact: load, balance, charges or potentials, and the gap's law at the nodes."""
        load = self.half * self.outputs[LOAD] / self.loads[0] - 1
        balance = self._causes[0][0, 0] - self.outputs[BALANCE]
        closings = [self._closing(f) for f in (0, 1)]
        potentials = self._beside(self.outputs)[1]
        law = self._densities * self.gap - self.of._media[:, None] * potentials / self.of._powers[1]
        return np.concatenate([[load, balance], closings, (law / self._reference).ravel()])

    def _closing(self, f: int) -> float:
        if f in self.of.fields and self.of.held[f]:
            return float(self.response[1 + f] - self.of.potentials[f])
        return float(self.loads[1 + f] - self.of.contact.loading.loads[0, 1 + f])

    @property
    def _reference(self) -> Array:
        """Gap of the profile alone, which scales the law; (n,)."""
        X = np.cosh(np.tile(self.of.table.operators.grid.theta, self.of.table.operators.sides))
        return np.asarray((X - 1) ** 1.5 / np.sqrt(X) * np.max(np.abs(self._causes[0][0])))

    @cached_property
    def jacobian(self) -> Array:
        """Derivatives of the residual; (unknown, unknown)."""
        count = self.unknowns.size
        matrix = np.zeros((count, count))
        matrix[0] = self.half * self._rates[LOAD] / self.loads[0]
        matrix[0, 0] += self.half * self.outputs[LOAD] / self.loads[0]
        matrix[1] = -self._rates[BALANCE]
        matrix[1, :_EXTENT] += self._causes[0][1:, 0]
        for f in (0, 1):
            if f in self.of.fields and self.of.held[f]:
                matrix[_EXTENT + f] = self.response_rates[1 + f]
            else:
                matrix[_EXTENT + f, _EXTENT + f] = 1.0
        n = self.of.nodes
        potentials = self._beside(self._rates)[1]
        for place in range(len(self.of.fields)):
            rows = slice(_EXTENT + 2 + place * n, _EXTENT + 2 + (place + 1) * n)
            law = self._densities[place][:, None] * self._gap_rates
            law -= self.of._media[place] * potentials[place] / self.of._powers[1][:, None]
            law[:, rows][np.diag_indices(n)] += self.gap
            matrix[rows] = law / self._reference[:, None]
        return matrix

    @property
    def open(self) -> bool:
        """Whether the gap is open all along."""
        return bool(np.all(self.gap > 0))

    def require_gap(self) -> None:
        """Refuse a gap that closes.

        Raises
        ------
        GapError
            With the place.
        """
        if not self.open:
            of = self.of.table.operators
            X = np.concatenate([of.grid.distance, -of.grid.distance])[: of.beside]
            worst = int(np.argmin(self.gap / self._reference))
            held = " and ".join(name for name, is_held in zip(_FIELDS, self.of.held, strict=True) if is_held)
            raise GapError(
                f"surroundings: the punch touches the surface beside the contact, at (x - c)/h = {X[worst]:.3g}"
                f"{f', where its {held} is 0' if held else ''}: the gap is negative there"
            )

    # -- outputs -------------------------------------------------------------------------------------------------------
    @cached_property
    def response(self) -> Array:
        """Depth, V and Psi in the units of the stack; (3,)."""
        u = self.half * self.outputs[DISPLACEMENT] - self.of.contact.far[0] @ self.loads
        return np.concatenate([[self._rise[0] - u[0]], u[1:]])

    @cached_property
    def _rise(self) -> Array:
        """Mean of g over the contact and its derivatives in log h and c/h; (3,)."""
        slope, centre = self.of.contact.loading.slope[0], np.array([self.centre])
        found = np.zeros(3)
        for i, coefficient in enumerate(slope):
            size, mean = coefficient * self.half ** (i + 1), float(mean_power(centre, i + 1)[0])
            found += size * np.array([mean / (i + 1), mean, float(mean_power(centre, i)[0])])
        return found

    @cached_property
    def response_rates(self) -> Array:
        """Derivatives of depth, V and Psi in the unknowns, P held; (3, unknown)."""
        rates = self.half * self._rates[DISPLACEMENT]
        rates[:, 0] += self.half * self.outputs[DISPLACEMENT]
        rates[:, _EXTENT : _EXTENT + 2] -= self.of.contact.far[0][:, 1:]
        rates[0] *= -1
        rates[0, :_EXTENT] += self._rise[1:]
        return rates

    @cached_property
    def tangents(self) -> Array:
        """d (depth, V, Psi) / d (P, T, J) with moving edges, SI; (3, 3)."""
        right = np.zeros((self.unknowns.size, 3))
        right[0, 0] = self.half * self.outputs[LOAD] / self.loads[0] ** 2
        right[_EXTENT, 1] = right[_EXTENT + 1, 2] = 1.0
        whole = self.response_rates @ np.linalg.solve(self._with_charges_given, right)
        whole[:, 0] += self._by_load
        scale = self.of.contact.scale[1:]
        return np.asarray(whole * scale[:, None] * scale)

    @property
    def _by_load(self) -> Array:
        """What P adds to depth, V and Psi by the datum; (3,)."""
        own = -self.of.contact.far[0][:, 0]
        return np.asarray(own * np.array([-1.0, 1.0, 1.0]))

    @property
    def _with_charges_given(self) -> Array:
        matrix = np.array(self.jacobian)
        matrix[_EXTENT : _EXTENT + 2] = 0.0
        matrix[_EXTENT, _EXTENT] = matrix[_EXTENT + 1, _EXTENT + 1] = 1.0
        return matrix

    @cached_property
    def at_fixed_contact(self) -> Array:
        """d (depth, V, Psi) / d (T, J) at a fixed contact: the load and the gap follow, SI; (3, 2)."""
        matrix = self._with_charges_given
        load = np.array(matrix[0])
        matrix[0] = 0.0
        matrix[0, 0] = 1.0
        right = np.zeros((self.unknowns.size, 2))
        right[_EXTENT, 0] = right[_EXTENT + 1, 1] = 1.0
        moved = np.linalg.solve(matrix, right)
        whole = self.response_rates @ moved + self._by_load[:, None] * (self.loads[0] * (load @ moved))
        scale = self.of.contact.scale[1:]
        return np.asarray(whole * scale[:, None] * scale[1:])
