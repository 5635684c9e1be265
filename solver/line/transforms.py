"""Fourier transforms of the tractions' basis (films, section 4): by recurrence where they oscillate, or by rules.

    I_j(q) = int w P_j exp(-i q X) dX,   int T_n exp(-i q X) / sqrt(1 - X^2) dX = pi (-i)^n J_n(q)

A forward recurrence in j is stable as long as j < q; its start is the sum of two series about the edges.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.special import binom, gamma, j0, j1

from solver.arrays import Array, BoolArray, ComplexArray
from solver.line.basis import Basis

_LEAST = 30.0  # q from which the series about the edges are exact to rounding
_SERIES = 19
_ABOVE = 1.2  # q over the number of terms from which the recurrences are used

Recurrence = Callable[[Array, int], Iterator[ComplexArray]]


@dataclass(frozen=True, eq=False)
class Transforms:
    """Transforms of one basis."""

    basis: Basis

    @property
    def _switch(self) -> float:
        return _ABOVE * self.basis.terms + _LEAST

    @cached_property
    def _fine(self) -> Basis:
        return replace(self.basis, samples=self.basis.terms + 20 + int(self._switch / 2))

    def pressed(self, q: Array, terms: Array) -> ComplexArray:
        """Transforms of the pressure; (member, q, column).

        q: (member, q), >= 0; terms: (member, pressures, column).
        """
        return self._whole(q, terms, self._fine.pressure_rule, self._jacobi)

    def charged(self, q: Array, terms: Array) -> ComplexArray:
        """Transforms of a field's charges; (member, q, column).

        q: (member, q), >= 0; terms: (member, M + 1, column).
        """
        return self._whole(q, terms, self._fine.charge_rule, self._bessel)

    def _whole(self, q: Array, terms: Array, rule: tuple[Array, Array], recurrence: Recurrence) -> ComplexArray:
        out: ComplexArray = np.empty((*q.shape, terms.shape[-1]), np.complex128)
        slow: BoolArray = np.asarray(np.min(q, 0, initial=np.inf) < self._switch)  # by wavenumber: some member is slow
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
        """I_j, j < count."""
        A, B = self.basis.exponents
        before: ComplexArray = np.conj(_edges(A, B, q))
        yield before
        current: ComplexArray = (A + 1) * before - (A + B + 2) / 2 * np.conj(_edges(A + 1, B, q))
        for j in range(1, count):
            yield current
            t = 2 * j + A + B
            above = 2 * (j + 1) * (j + A + B + 1) / ((t + 1) * (t + 2))
            constant = (A - B) / t - (B * B - A * A) / (t * (t + 2))
            beneath = 2 * (j + A) * (j + B) / t * (1 - j / (t + 1))
            factor = j * constant - 1j * j * (j + A + B + 1) / q
            current, before = (factor * current + beneath * before) / (j * above), current

    def _bessel(self, q: Array, count: int) -> Iterator[ComplexArray]:
        """pi (-i)^n J_n, n < count."""
        before, current = j0(q), j1(q)
        for n in range(count):
            yield np.asarray(np.pi * (-1j) ** n * before, dtype=np.complex128)
            before, current = current, 2 * (n + 1) / q * current - before


def _edges(A: float, B: float, q: Array) -> ComplexArray:
    """int (1 - X)^A (1 + X)^B exp(i q X) dX at large q, by its series about both edges."""
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
