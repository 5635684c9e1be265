"""Operators of air over a range of half-lengths: one table for every radius, load, charge and permittivity."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array, BoolArray
from solver.gap.grid import GROWING, LEVEL, Grid
from solver.gap.operators import DISPLACEMENT, FIRST, Operators
from solver.gap.refusal import GapError
from solver.line.contact import FilmContact
from solver.line.system import System
from solver.line.table import Table
from solver.stack.reflection import low

#: Rows before those beside the contact: load, balance, displacements.
SOLVING: int = DISPLACEMENT.stop
_TERMS = 4  # of Taylor's series about a half-length
_NEXT = 1e-3  # of log h: the fourth power of it over what tables resolve is below rounding

_LARGEST = 0.5e9  # bytes of a table, of which some copies exist while it is made; usual ones take 0.01 to 0.2 GB

_MARGIN, _MARGIN_OF_BASE = 10.0, 3.0


@dataclass(frozen=True, eq=False)
class AirTable:
    """Operators at the half-lengths of a table, read between them by Chebyshev's polynomials in log h."""

    table: Table
    farthest: float = 0.0

    @cached_property
    def operators(self) -> Operators:
        """Operators at any half-length of the range."""
        system = self.table.system
        even = system.coefficients.friction == 0 and system.degree == 1
        return Operators(system, grid_of(system, self.table.lower, self.table.upper, self.farthest), even)

    @cached_property
    def _parts(self) -> tuple[Array, Array]:
        """Outputs at the half-lengths: rows that the equations need, and the others; (node, row, column) each."""
        operators = self.operators
        size = (
            8.0
            * self.table.half_lengths.size
            * operators.rows
            * (operators.system.causes + len(operators.system.fields) * operators.density_nodes)
        )
        if size > _LARGEST:
            raise GapError(
                "surroundings: charges spread so far beside the contact that their table would take "
                f"{size / 1e9:.3g} GB; at most {_LARGEST / 1e9:g} GB; must be insulated"
            )
        values = operators.matrices(self.table.half_lengths)
        solving = self._solving
        return np.ascontiguousarray(values[:, solving]), np.ascontiguousarray(values[:, ~solving])

    @property
    def _solving(self) -> BoolArray:
        """Mark the rows that the equations need; (row,)."""
        operators = self.operators
        needed: BoolArray = np.zeros(operators.rows, dtype=bool)
        needed[:SOLVING] = needed[FIRST : FIRST + operators.density_nodes * (1 + len(operators.system.fields))] = True
        return needed

    def near(self, log_half: float) -> "Near":
        """Rows that the equations need about log h."""
        terms = np.tensordot(self._weights(log_half, _TERMS), self._parts[0], 1)
        return Near(log_half, terms)

    def outputs(self, log_half: float, columns: Array) -> Array:
        """All rows at log h, of the sum of causes and densities times ``columns``; (row,).

        columns: (column,), sizes of causes and densities.
        """
        weights, result = self._weights(log_half, 1)[0], np.empty(self.operators.rows)
        for part, rows in zip(self._parts, (self._solving, ~self._solving), strict=True):
            result[rows] = weights @ (part @ columns)
        return result

    def _weights(self, log_half: float, count: int) -> Array:
        """Matrix from values at the half-lengths to Taylor coefficients in log h; (count, node)."""
        return np.asarray(self.table.polynomials(np.array([log_half]))[0] @ self.table.interval.taylor(count))


def grid_of(system: System, shortest: float, longest: float, farthest: float = 0.0) -> Grid:
    """Panels beside contacts of half-lengths between two, as far as the thickness of the film matters."""
    stack = system.kernel.stack
    distance = max(30.0, 40 * stack.thickness / shortest, min(300.0, 2e3 * system.kernel.width / longest), farthest)
    growing = bool(np.any(np.diagonal(low(stack))[2:]))
    return Grid.up_to(distance, GROWING if growing else LEVEL)


def farthest(contact: FilmContact, permittivity: Array) -> float:
    """X as far as which charges beside a contact are not yet those of the open gap: 0 or a power of four.

    Over a film they are from where the gap lets pass less than the film, D = eps0 V/(g + eps0 thickness/eps): the last
    panel, whose terms are powers of 1/X, begins at ten times that distance, which makes 1e-6 of the charges. Over a
    base whose potential grows it is where the gap is x eps0/eps, and the panel has the logarithms of that.
    """
    system, scale = contact.table.system, contact.scale
    stack, powers = system.kernel.stack, [(i, abs(float(c))) for i, c in enumerate(contact.loading.slope[0]) if i and c]
    below, reach = np.diagonal(low(stack)), 0.0
    for f in system.fields:
        medium = float(permittivity[f] * scale[2 + f] ** 2 / scale[1])
        film = medium * abs(float(system.coefficients.compliance[1 + f, 1 + f])) * stack.thickness
        base = medium * abs(float(below[2 + f]))
        reach = max(reach, _MARGIN * min(((i + 1) * film / c) ** (1 / (i + 1)) for i, c in powers))
        reach = max(reach, _MARGIN_OF_BASE * min(((i + 1) * base / c) ** (1 / i) for i, c in powers))
    needed = reach / float(contact.half_width[0])
    return float(4.0 ** np.ceil(np.log(needed) / np.log(4.0))) if needed > 1 else 0.0


@dataclass(frozen=True, eq=False)
class Near:
    """Rows that the equations need, by Taylor's series about one half-length."""

    centre: float
    terms: Array

    def holds(self, log_half: float) -> bool:
        """Return True if log h is within the range of the Taylor series."""
        return abs(log_half - self.centre) <= _NEXT

    def matrix(self, log_half: float, rows: slice = slice(None)) -> Array:
        """Some rows, or all; (row, column)."""
        terms = self._terms(log_half)
        powers = (log_half - self.centre) ** np.arange(len(terms))
        part = terms[:, rows]
        return part[0] if log_half == self.centre else np.asarray(np.tensordot(powers, part, 1))

    def products(self, log_half: float, columns: Array) -> tuple[Array, Array]:
        """Rows times columns, and their derivatives in log h; (row,) each.

        columns: (column,), sizes of causes and densities.
        """
        series, change = self._terms(log_half) @ columns, log_half - self.centre
        k = np.arange(len(series))
        return change**k @ series, (k[1:] * change ** k[:-1]) @ series[1:]

    def _terms(self, log_half: float) -> Array:
        """Taylor terms that matter: two if the next one is below rounding."""
        return self.terms[:2] if abs(log_half - self.centre) < _NEXT**3 else self.terms
