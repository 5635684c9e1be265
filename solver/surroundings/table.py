"""Operators of air over a range of half-lengths: one table for every radius, load, charge and permittivity."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from approximation.chebyshev import coefficients
from solver.arrays import Array
from solver.film.table import Table
from solver.surroundings.operators import Operators, operators


@dataclass(frozen=True, eq=False)
class AirTable:
    """Operators at the half-lengths of a table, read between them by Chebyshev's polynomials in log h.

    Parameters
    ----------
    table
        Table of the contacts without air; its half-lengths are those of this one.
    """

    table: Table

    @cached_property
    def operators(self) -> Operators:
        """Operators at any half-length of the range."""
        return operators(self.table.system, self.table.lower, self.table.upper)

    @cached_property
    def values(self) -> Array:
        """Outputs at the half-lengths; (node, row, column)."""
        return self.operators.at(self.table.half_lengths)

    def read(self, log_half: float) -> Array:
        """Outputs at log h, and their derivatives in it; (2, row, column)."""
        return np.tensordot(self.table.polynomials(np.array([log_half]))[0] @ self._series, self.values, 1)

    @cached_property
    def _series(self) -> Array:
        """From values at the half-lengths to coefficients of the outputs and of their derivatives; (2, term, node)."""
        series = coefficients(np.eye(self.table.nodes))
        rates = np.zeros_like(series)
        rates[:-1] = np.polynomial.chebyshev.chebder(series) * 2 / np.log(self.table.upper / self.table.lower)
        return np.stack([series, rates])
