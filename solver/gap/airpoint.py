"""Equations of point contacts in air, in log a, u0 = (-depth, V, Psi) over C a^e and the densities (points, 6)."""

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, selected
from solver.gap.newton import GapStates, Linear, Terms
from solver.gap.ringoperators import Layout, RingOperators, RingTable
from solver.gap.rings import Rings


@dataclass(frozen=True, eq=False)
class PointStates(GapStates):
    """Contacts under punches of revolution, in the units of the body; lengths over that of the body."""

    table: RingTable
    coefficient: Array  # C of the profile C r^e; (case,)
    force: Array  # P; (case,)
    charges: Array  # Prescribed charges of the conducted fields; (case, field)
    media: Array  # eps0 and mu0 of the conducted fields; (case, field)
    end: Array  # Distance at which the gap ends; (case,)

    def part(self, cases: Indices) -> Self:
        """States of some of the cases."""
        return selected(self, cases, "unknowns", "coefficient", "force", "charges", "media", "end")

    @property
    def operators(self) -> RingOperators:
        """Operators at any radius."""
        return self.table.exact

    @property
    def layout(self) -> Layout:
        """Layout of the outputs."""
        return self.operators.layout

    @property
    def rings(self) -> Rings:
        """Transforms of the exterior densities."""
        return self.operators.rings

    @property
    def _exponent(self) -> float:
        return self.operators.shape.exponent

    @cached_property
    def radius(self) -> Array:
        """Contact radius a; (case,)."""
        return np.exp(self.unknowns[:, 0])

    @cached_property
    def size(self) -> Array:
        """Unit of displacements, C a^e; (case,)."""
        return self.coefficient * self.radius**self._exponent

    @property
    def _load_unit(self) -> Array:
        return self.size * self.radius

    @property
    def displacement(self) -> Array:
        """Displacement u0 of the channels over C a^e; (case, channel)."""
        return self.unknowns[:, 1 : self.layout.causes]

    @cached_property
    def causes(self) -> Linear:
        """Causes u0 and g."""
        count, first = len(self.unknowns), self.layout.causes
        by_first = np.broadcast_to(np.eye(first, first, 1), (count, first, first))
        values = np.concatenate([self.displacement, np.ones((count, 1))], 1)
        return Linear(values, by_first)

    @cached_property
    def terms(self) -> Terms:
        """Terms of the force, the smooth edge, the charges and the gap's law."""
        rows, layout, load, e = self.rows, self.layout, self._load_unit, self._exponent
        count, first, over_force = load.size, layout.causes, load / self.force
        head, by_first, by_outputs = (np.zeros((count, first, *size)) for size in ((), (first,), (self.frame.heads,)))
        head[:, 0], head[:, 1] = over_force * rows[:, 0] + 1, rows[:, layout.edges.start]
        by_outputs[:, 0, 0], by_outputs[:, 1, layout.edges.start] = over_force, 1.0
        by_first[:, 0, 0] = (e + 1) * over_force * rows[:, 0]
        for charge in range(first - 2):
            head[:, 2 + charge] = rows[:, 1 + charge] + self.charges[:, charge] / load
            by_outputs[:, 2 + charge, 1 + charge] = 1.0
            by_first[:, 2 + charge, 0] = (e + 1) * rows[:, 1 + charge]
        profile = np.broadcast_to(self.operators.profile, (count, layout.nodes))
        per_potential = self.end_factor / (self.rings.size * profile) * (self.radius / self.size)[:, None]
        displacement = np.abs(self.displacement)
        causes = np.maximum(displacement, 1e-3 * np.max(displacement, 1, keepdims=True))
        largest = np.max(np.abs(self.over_size), 2, initial=1e-300)
        largest = np.maximum(largest, (1e-3 * self.force / load)[:, None])
        return Terms(
            Linear(head, by_first, by_outputs), Linear(profile, np.zeros((count, layout.nodes, first))), profile,
            self.media[..., None] * per_potential[:, None], 1 - e - 2 * (1 - self.end_factor),
            np.concatenate([np.ones((count, 1)), causes, np.repeat(largest, layout.nodes, 1)], 1),
        )  # fmt: skip

    @cached_property
    def response(self) -> Linear:
        """Displacement u0 = (-depth, V, Psi)."""
        u, count = self.size[:, None] * self.displacement, self.layout.causes - 1
        by_first = self.size[:, None, None] * np.eye(count, count + 1, 1)
        by_first[..., 0] = self._exponent * u
        return Linear(u, by_first)

    @property
    def by_load(self) -> tuple[Array, Array]:
        """Right sides for unit loads, (case, 1 + field), and zeros: a point needs no datum."""
        load, count = self._load_unit, self.layout.causes - 1
        right = np.repeat(-1 / load[:, None], count, 1)
        right[:, 0] = load * self.rows[:, 0] / self.force**2
        return right, np.zeros((load.size, count))

    @cached_property
    def end_factor(self) -> Array:
        """Factor 1/(1 + r^2/end^2) by which the finite punch weakens the gap's field; (case, n)."""
        return 1 / (1 + (self.rings.grid.distance * (self.radius / self.end)[:, None]) ** 2)

    @property
    def loads(self) -> Array:
        """Loads (P, T, J) of the channels; (case, channel)."""
        return -self.rows[:, self.layout.loads] * self._load_unit[:, None]
