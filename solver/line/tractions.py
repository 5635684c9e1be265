"""Tractions on the contacts of many films in the basis of one table, and their transforms (films, sections 4, 6)."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.polynomial.chebyshev import chebint, chebvander
from numpy.typing import NDArray
from scipy.special import binom, gamma, j0, j1

from approximation.chebyshev import coefficients, gauss_points
from solver.arrays import Array, BoolArray, ComplexArray, selected
from solver.halfplane.interior import LINE, LINE_WEIGHTS
from solver.line.basis import CANCELS, RULES, Basis, by_gauss, ellipse, gauss_jacobi, jacobi, off_contact
from solver.line.contact import FilmContact
from solver.line.outputs import Assembly
from solver.line.system import System
from solver.line.table import BATCH, Table
from solver.stack.layers import Stack
from solver.stack.wavenumbers import tapered

_MOMENTS_FROM = 2.0  # |z| from which F_0 is a series of moments
_START: ComplexArray = np.array([2j])
_MOMENTS = 60
_PATH_POINTS = 4096  # points of a path at a time: bounded memory


@dataclass(frozen=True, eq=False)
class Antiderivatives:
    """Antiderivatives F_j of the basis's Hilbert transforms at complex points z, Im z >= 0 (films, F6.3)."""

    basis: Basis

    def charged(self, z: ComplexArray) -> ComplexArray:
        """Antiderivatives of T_n / sqrt(1 - X^2); (..., M + 1)."""
        outer = ellipse(z)[0]
        powers: ComplexArray = np.empty((self.basis.terms + 1, *z.shape), np.complex128)
        powers[0], inverse = 1.0, 1 / outer
        for n in range(self.basis.terms):
            powers[n + 1] = powers[n] * inverse
        powers[0] = -np.log(outer / 2j)
        return np.asarray(np.moveaxis(powers, 0, -1) / np.maximum(np.arange(self.basis.terms + 1), 1))

    def pressed(self, z: ComplexArray, terms: Array) -> ComplexArray:
        """Antiderivatives of w sum_j terms_j P_j at z (point,), Im z >= 0, of terms (pressures, c); (point, c)."""
        return np.asarray(self._first(z)[:, None] * terms[0] + self._higher(z, terms[1:]))

    def _first(self, z: ComplexArray) -> ComplexArray:
        """F_0 at z (point,), by moments far away and else by a path from 2i; (point,)."""
        out: ComplexArray = np.empty(z.shape, np.complex128)
        far = np.abs(z) >= _MOMENTS_FROM
        out[far] = self._far(z[far])
        near, start = z[~far], self._far(_START)
        columns = []
        for block in range(0, near.size, _PATH_POINTS):
            path = near[block : block + _PATH_POINTS] - _START
            line = _START + path[:, None] * LINE
            transform = self.basis.outside(line) - self.basis.local(line)[..., 0]
            columns.append(start + path * (transform @ LINE_WEIGHTS))
        out[~far] = np.concatenate(columns) if columns else 0
        return out

    def _far(self, z: ComplexArray) -> ComplexArray:
        """F_0 at |z| >= 2 by its series of moments; (point,)."""
        A, B = self.basis.exponents
        S, weights = gauss_jacobi(_MOMENTS // 2 + 2, A, B)
        orders = np.arange(1, _MOMENTS + 1)
        moments = weights @ S[:, None] ** orders / orders
        return np.asarray((z[:, None] ** -orders @ moments - self.basis.total * np.log(z / 1j)) / np.pi)

    def _higher(self, z: ComplexArray, terms: Array) -> ComplexArray:
        """Sum of terms_j F_j, j >= 1; (point, c)."""
        raised_terms = -terms / (2 * np.arange(1, len(terms) + 1))[:, None]
        return off_contact(
            z, self.basis.terms, self._raised_exponents, raised_terms,
            lambda near: self._edge_part(near, raised_terms) + self._polynomial(near, terms),
        )  # fmt: skip

    @property
    def _raised_exponents(self) -> tuple[float, float]:
        A, B = self.basis.exponents
        return A + 1, B + 1

    def _edge_part(self, z: ComplexArray, raised_terms: Array) -> ComplexArray:
        """Part of :meth:`_higher` near the contact that is singular at the edges; (point, c)."""
        A, B = self.basis.exponents
        edge = -((z - 1) ** (A + 1)) * (z + 1) ** (B + 1) / np.sin(np.pi * A)
        return np.asarray(edge[:, None] * (jacobi(len(raised_terms), A + 1, B + 1, z) @ raised_terms))

    def _polynomial(self, z: ComplexArray, terms: Array) -> ComplexArray:
        """Part of :meth:`_higher` near the contact that is a polynomial; (point, c)."""
        series, constants = self._series
        values = chebvander(z, len(series) - 1)
        return np.asarray(values @ (series @ terms) + constants @ terms)

    @cached_property
    def _series(self) -> tuple[Array, Array]:
        """Chebyshev series of the polynomials, j >= 1 (order, j), and constants (j,), from a point off the contact."""
        size, count = self.basis.terms + 2, self.basis.pressures - 1
        series = -chebint(coefficients(self.basis.local(gauss_points(size))[:, 1:]))
        z: ComplexArray = 1j * np.sinh(np.array([CANCELS / (2 * self.basis.terms)]))
        raised_terms = -np.eye(count) / (2 * np.arange(1, count + 1))
        exact = by_gauss(z, int(np.ceil(RULES[0][0] * self.basis.terms)), self._raised_exponents, raised_terms)
        without_constants = self._edge_part(z, raised_terms) + chebvander(z, len(series) - 1) @ series
        return np.asarray(series), np.asarray((exact - without_constants)[0].real)


_LEAST = 30.0  # q from which the series about the edges are exact to rounding
_SERIES = 19  # terms of these series
_ABOVE = 1.2  # q over the number of terms from which the recurrences are used

Recurrence = Callable[[Array, int], Iterator[ComplexArray]]


@dataclass(frozen=True, eq=False)
class Transforms:
    """Fourier transforms of one basis at q = k h, by quadrature or, at large q, by recurrences.

    The transform of w P_j is I_j(q) = int w P_j exp(-i q X) dX, that of T_n / sqrt(1 - X^2) is pi (-i)^n J_n(q).
    """

    basis: Basis

    @property
    def _switch(self) -> float:
        """Least q of the recurrences, which are stable while j < q."""
        return _ABOVE * self.basis.terms + _LEAST

    @cached_property
    def _fine(self) -> Basis:
        """Basis with enough quadrature nodes for q up to the switch."""
        return replace(self.basis, samples=self.basis.terms + 20 + int(self._switch / 2))

    def pressed(self, q: Array, terms: Array) -> ComplexArray:
        """Transforms of a pressure with terms (member, j, column) at q >= 0 (member, q); (member, q, column)."""
        return self._transformed(q, terms, self._fine.pressure_rule, self._jacobi)

    def charged(self, q: Array, terms: Array) -> ComplexArray:
        """Transforms of a field's charges with terms (member, n, column) at q >= 0 (member, q); (member, q, column)."""
        return self._transformed(q, terms, self._fine.charge_rule, self._bessel)

    def _transformed(self, q: Array, terms: Array, rule: tuple[Array, Array], recurrence: Recurrence) -> ComplexArray:
        """Transforms by a rule or a recurrence, switched by wavenumber; (member, q, column)."""
        out: ComplexArray = np.empty((*q.shape, terms.shape[-1]), np.complex128)
        slow: BoolArray = np.asarray(np.min(q, 0, initial=np.inf) < self._switch)  # for at least one member
        nodes, weights = rule
        sources = weights @ terms
        phase = q[:, slow, None] * nodes
        out[:, slow] = np.cos(phase) @ sources - 1j * (np.sin(phase) @ sources)
        summed: ComplexArray = np.zeros((*q[:, ~slow].shape, terms.shape[-1]), np.complex128)
        for number, values in enumerate(recurrence(q[:, ~slow], terms.shape[1])):
            summed += values[..., None] * terms[:, None, number]
        out[:, ~slow] = summed
        return out

    def _jacobi(self, q: Array, count: int) -> Iterator[ComplexArray]:
        """Yield I_j at q, j < count."""
        A, B = self.basis.exponents
        previous: ComplexArray = np.conj(_edges(A, B, q))
        yield previous
        current: ComplexArray = (A + 1) * previous - (A + B + 2) / 2 * np.conj(_edges(A + 1, B, q))
        for j in range(1, count):
            yield current
            t = 2 * j + A + B
            above = 2 * (j + 1) * (j + A + B + 1) / ((t + 1) * (t + 2))
            constant = (A - B) / t - (B * B - A * A) / (t * (t + 2))
            beneath = 2 * (j + A) * (j + B) / t * (1 - j / (t + 1))
            factor = j * constant - 1j * j * (j + A + B + 1) / q
            current, previous = (factor * current + beneath * previous) / (j * above), current

    def _bessel(self, q: Array, count: int) -> Iterator[ComplexArray]:
        """Yield pi (-i)^n J_n(q), n < count."""
        previous, current = j0(q), j1(q)
        for n in range(count):
            yield np.asarray(np.pi * (-1j) ** n * previous, dtype=np.complex128)
            previous, current = current, 2 * (n + 1) / q * current - previous


def _edges(A: float, B: float, q: Array) -> ComplexArray:
    """Return int (1 - X)^A (1 + X)^B exp(i q X) dX at large q by series about both edges, of the shape of q."""
    orders = np.arange(_SERIES)
    out: ComplexArray = np.zeros(q.shape, np.complex128)
    for exponent, other, sign in ((A, B, 1), (B, A, -1)):
        factors = binom(other, orders) * 2.0 ** (other - orders) * (-1.0) ** orders * gamma(exponent + orders + 1)
        inverse = 1 / (sign * 1j * q)
        series: ComplexArray = np.zeros(q.shape, np.complex128)
        for factor in factors[::-1]:
            series = series * inverse + factor
        out += np.exp(sign * 1j * q) * inverse ** (exponent + 1) * series
    return out


_LONG_WAVES = 8.0  # thicknesses beyond which a smooth end of the wavenumbers costs less than rounding
_SPAN = 32.0  # ratio of the distances that share wavenumbers
_EXPONENTIALS_AT_ONCE = 1 << 20  # entries of a block of exponentials: bounded memory


@dataclass(frozen=True, eq=False)
class Tractions:
    """Tractions under contacts of one system, the members, with several columns each."""

    system: System
    basis: Basis
    half_lengths: Array  # h [m]; (member,)
    pressures: Array  # Terms of sigma_yy; (member, pressures, column)
    charges: Array  # Terms of D_y and B_y; (member, 2, M + 1, column)
    upper: float | None = None  # Longest half-length that the basis resolves [m]; by default the members' longest

    @classmethod
    def by_cause(cls, system: System, half_lengths: Array) -> Self:
        """Return the tractions at half-lengths (member,) [m], with one column for each cause."""
        basis = system.basis(float(np.max(half_lengths)))
        most = max(BATCH // (8 * 19 * basis.samples * (basis.terms + 2)), 1)
        parts = [
            Assembly(system, basis, half_lengths[start : start + most]).unknowns
            for start in range(0, half_lengths.size, most)
        ]
        pressures, charges = system.split(basis, np.swapaxes(np.concatenate(parts), 1, 2))
        return cls(system, basis, half_lengths, np.swapaxes(pressures, 1, 2), np.moveaxis(charges, 1, -1))

    @property
    def longest(self) -> float:
        """Longest half-length that the basis resolves [m]."""
        return float(np.max(self.half_lengths)) if self.upper is None else self.upper

    def part(self, members: slice | NDArray[np.intp]) -> Self:
        """Return the tractions of the selected members."""
        return selected(self, members, "half_lengths", "pressures", "charges")

    def wavenumbers(self, body: Stack, nearest: float, reach: float, width: float) -> tuple[Array, Array]:
        """Nodes and weights in k of fields that decay like exp(-width k), at distances up to ``reach`` [m]; (k,)."""
        k, weights, taper = tapered(body, width, np.array([nearest, reach]), _LONG_WAVES)
        return k, weights * taper

    def by_distance(self, body: Stack, X: Array) -> list[NDArray[np.intp]]:
        """Group the columns of positions X (member or 1, x) that share wavenumbers; short waves vanish far away."""
        nearest = np.min(np.abs(X) * self.half_lengths[:, None], axis=0) - self.longest
        octave = np.floor(np.log(np.maximum(nearest / (_LONG_WAVES * body.thickness), 1 / _SPAN)) / np.log(_SPAN))
        return [np.flatnonzero(octave == number) for number in np.unique(octave)]

    def _vector(self, normal: ComplexArray, fields: Sequence[ComplexArray]) -> list[ComplexArray]:
        """Return (sigma_xy, sigma_yy, D_y, B_y) from sigma_yy and the terms c_n of D_y and B_y (F4.1)."""
        c = self.system.coefficients
        flux = [fields[f] + c.follower[f] * normal if f in c.fields else fields[f] for f in (0, 1)]
        return [c.friction * normal, normal, *flux]

    def in_fourier_space(self, k: Array) -> ComplexArray:
        """(i sigma_xy, sigma_yy, D_y, B_y) at the surface at wavenumbers k [1/m]; (member, k, 4, column)."""
        h, columns = self.half_lengths, self.pressures.shape[-1]
        charges = np.concatenate([self.charges[:, 0], self.charges[:, 1]], -1)
        sums: ComplexArray = np.empty((h.size, k.size, 3 * columns), np.complex128)
        step = max(_EXPONENTIALS_AT_ONCE // (2 * self.basis.terms * h.size), 1)
        for start in range(0, k.size, step):
            part = sums[:, start : start + step]
            phase = h[:, None] * k[start : start + step]
            for terms, out, transforms in (
                (self.pressures, part[..., :columns], self._transforms.pressed),
                (charges, part[..., columns:], self._transforms.charged),
            ):
                out[...] = transforms(phase, terms)
        normal, *fields = np.split(sums, 3, -1)
        t = self._vector(normal, fields)
        t[0] = 1j * t[0]
        return np.asarray(h[:, None, None, None] * np.stack(t, 2), dtype=np.complex128)

    @cached_property
    def _transforms(self) -> Transforms:
        return Transforms(self.basis)

    @cached_property
    def totals(self) -> ComplexArray:
        """Forces and charges: the transforms at k = 0; (member, 4, column)."""
        return self.in_fourier_space(np.zeros(1))[:, 0]

    def on_plane(self, z: ComplexArray, *, integrated: bool = False) -> ComplexArray:
        """Hilbert transforms, or their antiderivatives, of the tractions at z (member or 1, point), Im z >= 0."""
        count, columns = self.half_lengths.size, self.pressures.shape[-1]
        out: ComplexArray = np.empty((4, count, z.shape[1], columns), np.complex128)  # component, member, point, column
        antiderivatives = Antiderivatives(self.basis)
        pressed = antiderivatives.pressed if integrated else self.basis.transformed
        charged = antiderivatives.charged if integrated else self.basis.charged
        for number, points in enumerate(z):
            members = slice(None) if len(z) == 1 else slice(number, number + 1)
            normal = pressed(points, _flat(self.pressures[members]))
            powers = charged(points)
            fields = [powers @ _flat(self.charges[members, f]) for f in (0, 1)]
            for component, value in enumerate(self._vector(normal, fields)):
                out[component, members] = np.moveaxis(value.reshape(points.size, -1, columns), 0, 1)
        return out


def _flat(terms: Array) -> Array:
    """Reshape terms (member, term, column) to (term, members and columns)."""
    return np.moveaxis(terms, 1, 0).reshape(terms.shape[1], -1)


@dataclass(frozen=True, eq=False)
class TractionTable:
    """Tractions over the half-lengths of a table."""

    table: Table

    @cached_property
    def _nodes(self) -> Tractions:
        """Tractions at the half-lengths of the table."""
        return Tractions.by_cause(self.table.system, self.table.half_lengths)

    @cached_property
    def _series(self) -> tuple[Array, Array]:
        """Chebyshev coefficients in log h of the terms of pressure and charges."""
        return coefficients(self._nodes.pressures), coefficients(self._nodes.charges)

    def read(self, contact: FilmContact) -> Tractions:
        """Return the tractions, one column, under contacts that were read from the same table."""
        h = contact.half_width
        read, causes = self.table.interval.read, contact.causes.values
        pressures, charges = (read(np.log(h), series, causes)[..., None] for series in self._series)
        return Tractions(self.table.system, self._nodes.basis, h, pressures, charges, self.table.upper)
