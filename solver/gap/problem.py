"""A contact with air beside it as it is posed: table, load, charges or potentials, and what fills the gap."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array
from solver.gap.table import AirTable
from solver.line.contact import FilmContact


@dataclass(frozen=True, eq=False)
class Problem:
    """A contact under one punch, air beside it; units of the stack but where SI is said."""

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
        return self.table.operators.beside

    @cached_property
    def media(self) -> Array:
        """eps0 and mu0 in the units of the stack, of the conducted fields; (field,)."""
        scale = self.contact.scale
        return np.array([self.permittivity[f] * scale[2 + f] ** 2 / scale[1] for f in self.fields])

    @cached_property
    def powers(self) -> tuple[Array, Array]:
        """Integrals of X^m from the edge to the nodes (n, degree + 1), and densities over the unknowns (n,)."""
        of = self.table.operators
        m = np.arange(1, self.contact.loading.slope.shape[-1] + 1)
        risen = np.expm1(m * np.log1p(2 * np.sinh(of.grid.theta / 2) ** 2)[:, None]) / m
        both = np.concatenate([risen, (-1.0) ** m * risen])[: of.beside]
        return both, np.tile(of.grid.size, of.sides)
