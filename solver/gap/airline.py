"""Equations of line contacts in air, in log h, c/h, T, J and the exterior densities (theory section 10)."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, selected
from solver.gap.newton import Frame, GapStates, Linear, Settled, Terms, continued, settled
from solver.gap.operators import BALANCE, DISPLACEMENT, LOAD, SOLVING, AirTable, Operators
from solver.line.contact import FilmContact, rise
from solver.line.extent import Causes, Loading

_EXTENT = 2  # unknowns before the charges: log h, c/h


@dataclass(frozen=True, eq=False)
class LineStates(GapStates):
    """Line contacts, in the units of the stack."""

    table: AirTable
    loading: Loading
    far: Array  # Displacements per load that the datum adds; (case, 3, 3)
    media: Array  # eps0 and mu0 of the conducted fields; (case, field)

    def part(self, cases: Indices) -> Self:
        """States of some of the cases."""
        loading = selected(self.loading, cases, "slope", "loads")
        return replace(selected(self, cases, "unknowns", "far", "media"), loading=loading)

    @cached_property
    def half(self) -> Array:
        """Half-length h; (case,)."""
        return np.exp(self.unknowns[:, 0])

    @property
    def centre(self) -> Array:
        """Centre of the contact, c/h; (case,)."""
        return self.unknowns[:, 1]

    @cached_property
    def loads(self) -> Array:
        """Loads P, T, J; (case, 3)."""
        return np.concatenate([self.loading.loads[:, :1], self.unknowns[:, _EXTENT : _EXTENT + 2]], 1)

    @cached_property
    def _extent(self) -> Causes:
        return replace(self.loading, loads=self.loads).at(self.half, self.centre)

    @cached_property
    def causes(self) -> Linear:
        """Causes: coefficients of the slope's powers of X, T/h and J/h."""
        extent = self._extent
        by_first = np.zeros((*extent.values.shape, _EXTENT + 2))
        by_first[..., 0], by_first[..., 1] = extent.by_width, extent.by_centre
        by_first[:, -2, _EXTENT] = by_first[:, -1, _EXTENT + 1] = 1 / self.half
        return Linear(extent.values, by_first)

    @cached_property
    def terms(self) -> Terms:
        """Terms of the load, the balance of the slope, the charges and the gap's law."""
        rows, extent, load = self.rows, self._extent, self.loads[:, 0]
        count, first, over_load = load.size, _EXTENT + 2, self.half / load
        head, by_first, by_outputs = (np.zeros((count, first, *size)) for size in ((), (first,), (SOLVING,)))
        head[:, 0], head[:, 1] = over_load * rows[:, LOAD] - 1, extent.constant - rows[:, BALANCE]
        head[:, _EXTENT:] = self.loads[:, 1:] - self.loading.loads[:, 1:]
        by_outputs[:, 0, LOAD], by_outputs[:, 1, BALANCE] = over_load, -1.0
        by_first[:, 0, 0] = over_load * rows[:, LOAD]
        by_first[:, 1, 0], by_first[:, 1, 1] = extent.constant_by_width, extent.constant_by_centre
        by_first[:, _EXTENT, _EXTENT] = by_first[:, _EXTENT + 1, _EXTENT + 1] = 1.0
        constants = np.stack([extent.constant, extent.constant_by_width, extent.constant_by_centre])
        powers = np.stack([extent.values, extent.by_width, extent.by_centre])[..., :-2]
        slopes = np.concatenate([constants[..., None], powers], 2)
        profile, size = slopes @ self.table.powers.T, self.table.size
        profile_rates = np.zeros((count, profile.shape[2], first))
        profile_rates[..., :_EXTENT] = np.moveaxis(profile[1:], 0, 2)
        X = np.abs(self.frame.positions)
        reference = (X - 1) ** 1.5 / np.sqrt(X) * np.max(np.abs(slopes[0]), 1)[:, None]
        weights = np.sqrt(size)  # the last panel's unknowns are D X^2, and its charge is D X
        largest = np.max(np.abs(self.over_size) * weights, 2, initial=1e-300)
        largest = np.maximum(largest, (1e-4 * load / self.half)[:, None])
        charges = np.maximum(np.abs(self.loads[:, 1:]), (np.max(largest, 1) * self.half)[:, None])
        sizes = [np.ones((count, _EXTENT)), charges, (largest[..., None] / weights).reshape(count, -1)]
        return Terms(
            Linear(head, by_first, by_outputs), Linear(profile[0], profile_rates), reference,
            self.media[..., None] / (size * reference)[:, None], np.zeros_like(reference), np.concatenate(sizes, 1),
        )  # fmt: skip

    @cached_property
    def response(self) -> Linear:
        """Depth, V and Psi."""
        u = self.half[:, None] * self.rows[:, DISPLACEMENT]
        by_outputs, by_first = np.zeros((len(u), 3, SOLVING)), np.zeros((len(u), 3, _EXTENT + 2))
        by_outputs[:, [0, 1, 2], np.arange(SOLVING)[DISPLACEMENT]] = self.half[:, None] * _SIGNS
        by_first[..., 0] = u * _SIGNS
        by_first[..., _EXTENT:] = -self.far[..., 1:] * _SIGNS[:, None]
        by_first[:, 0, :_EXTENT] += self._rise[:, 1:]
        values = (u - (self.far @ self.loads[..., None])[..., 0]) * _SIGNS
        values[:, 0] += self._rise[:, 0]
        return Linear(values, by_first, by_outputs)

    @cached_property
    def _rise(self) -> Array:
        """Mean of g over the contact and its derivatives in log h and c/h; (case, 3)."""
        return rise(self.loading.slope, self.half, self.centre)

    @property
    def by_load(self) -> tuple[Array, Array]:
        """Right sides for unit loads, and the datum's part of the response to the load; (case, 3) each."""
        right = np.ones((self.half.size, 3))
        right[:, 0] = self.half * self.rows[:, LOAD] / self.loads[:, 0] ** 2
        return right, -self.far[..., 0] * _SIGNS


_SIGNS = np.array([-1.0, 1.0, 1.0])  # of u_y, phi and psi in depth, V and Psi


@dataclass(frozen=True, eq=False)
class AirContacts:
    """Contacts in air that share a table."""

    table: AirTable
    contact: FilmContact
    permittivity: Array  # Permittivity and permeability of the gas in the gaps; (case, 2)

    def states(self, held: tuple[bool, bool] = (False, False)) -> LineStates:
        """Contacts without air, from which the solution starts."""
        contact, scale, operators = self.contact, self.contact.scale, self.table.operators
        fields = operators.system.fields
        unknowns = np.zeros((contact.load.size, _EXTENT + 2 + len(fields) * operators.density_nodes))
        unknowns[:, 0], unknowns[:, 1] = np.log(contact.half_width), contact.centre
        unknowns[:, _EXTENT : _EXTENT + 2] = np.where(held, 0.0, contact.loading.loads[:, 1:])
        media = [self.permittivity[:, f] * scale[2 + f] ** 2 / scale[1] for f in fields]
        far = np.broadcast_to(contact.far, (contact.load.size, 3, 3))
        outputs, sides = self.table.outputs.solving, operators.sides
        frame = Frame(outputs, SOLVING, fields, operators.positions, sides, _EXTENT, 1, "load", "(x - c)/h")
        return LineStates(frame, unknowns, held, self.table, contact.loading, far, np.stack(media, 1))

    @property
    def solved(self) -> Settled[LineStates]:
        """Solutions under the prescribed charges."""
        return self._settled.require()

    @cached_property
    def _settled(self) -> Settled[LineStates]:
        states = self.states()
        loads = states.loading.loads
        parameters = [states.unknowns[:, :1], np.log(loads[:, :1]), loads[:, 1:] / loads[:, :1], np.log(states.media)]
        return settled(states, np.concatenate(parameters, 1))

    @property
    def within(self) -> bool:
        """Return True if all contacts converge to half-lengths within the table."""
        log_half, interval = self._settled.states.unknowns[:, 0], self.table.table.interval
        return bool(np.all(self._settled.valid & (interval.low < log_half) & (log_half < interval.high)))

    def held(self, held: tuple[bool, bool], charged: Settled[LineStates]) -> Settled[LineStates]:
        """Solutions at zero potentials, continued from those with prescribed charges."""
        return continued(self.states(held), charged).require()

    def solutions(self) -> list["LineSolution"]:
        """Solution of every contact."""
        states = self.solved.states
        return [
            LineSolution(
                self.table.operators, self.contact.part(np.array([case])), float(states.half[case]),
                states.causes.values[case], states.over_size[case],
            )
            for case in range(states.half.size)
        ]  # fmt: skip


@dataclass(frozen=True, eq=False)
class LineSolution:
    """One solved contact in the units of the stack."""

    operators: Operators
    contact: FilmContact
    half: float  # h
    causes: Array  # (cause,)
    over_size: Array  # Densities at the nodes over their size; (field, n)
