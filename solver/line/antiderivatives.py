"""Antiderivatives of the basis's transforms: what potentials inside a film are made of (films, section 6).

    F_j(z) = -(1/pi) int w P_j log[(z - S)/i] dS,   F_j' = H[w P_j],

and so for the fields' terms. By parts F_j = -H[w+ P_(j-1)+]/(2j), j >= 1, of the basis with exponents A + 1 and B + 1.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial.chebyshev import chebint, chebvander

from approximation.chebyshev import coefficients, gauss_points
from solver.arrays import Array, ComplexArray
from solver.halfplane.potentials import LINE, LINE_WEIGHTS
from solver.line.basis import CANCELS, RULES, Basis, by_gauss, ellipse, gauss_jacobi, jacobi, off_contact

_FAR = 2.0  # |z| from which F_0 is a series of moments
_START: ComplexArray = np.array([2j])
_MOMENTS = 60
_BLOCK = 4096  # points of a path at a time: bounded memory


@dataclass(frozen=True, eq=False)
class Antiderivatives:
    """F of the terms of a basis at complex points z, Im z >= 0."""

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
        """Antiderivatives of w sum_j terms_j P_j; (point, c).

        z: (point,), Im z >= 0; terms: (pressures, c).
        """
        return np.asarray(self._first(z)[:, None] * terms[0] + self._others(z, terms[1:]))

    def _first(self, z: ComplexArray) -> ComplexArray:
        """F_0; (point,)."""
        out: ComplexArray = np.empty(z.shape, np.complex128)
        far = np.abs(z) >= _FAR
        out[far] = self._far(z[far])
        near, start = z[~far], self._far(_START)
        columns = []
        for block in range(0, near.size, _BLOCK):
            path = near[block : block + _BLOCK] - _START
            line = _START + path[:, None] * LINE
            columns.append(start + path * (self._first_transform(line) @ LINE_WEIGHTS))
        out[~far] = np.concatenate(columns) if columns else 0
        return out

    def _far(self, z: ComplexArray) -> ComplexArray:
        """F_0 at |z| >= 2."""
        A, B = self.basis.exponents
        S, weights = gauss_jacobi(_MOMENTS // 2 + 2, A, B)
        orders = np.arange(1, _MOMENTS + 1)
        moments = weights @ S[:, None] ** orders / orders
        return np.asarray((z[:, None] ** -orders @ moments - self.basis.total * np.log(z / 1j)) / np.pi)

    def _first_transform(self, z: ComplexArray) -> ComplexArray:
        A, B = self.basis.exponents
        whole = self.basis.gain / 2.0**self.basis.order * (z - 1) ** A * (z + 1) ** B
        return np.asarray(whole - self.basis.local(z)[..., 0])

    def _others(self, z: ComplexArray, terms: Array) -> ComplexArray:
        """Sum of F_j, j >= 1; (point, c)."""
        share = -terms / (2 * np.arange(1, len(terms) + 1))[:, None]
        return off_contact(
            z,
            self.basis.terms,
            self._raised,
            share,
            lambda near: self._near(near, share) + self._polynomial(near, terms),
        )

    @property
    def _raised(self) -> tuple[float, float]:
        """A + 1 and B + 1."""
        A, B = self.basis.exponents
        return A + 1, B + 1

    def _near(self, z: ComplexArray, share: Array) -> ComplexArray:
        """The part near the contact that is no polynomial."""
        A, B = self.basis.exponents
        edge = -((z - 1) ** (A + 1)) * (z + 1) ** (B + 1) / np.sin(np.pi * A)
        return np.asarray(edge[:, None] * (jacobi(len(share), A + 1, B + 1, z) @ share))

    def _polynomial(self, z: ComplexArray, terms: Array) -> ComplexArray:
        series, constants = self._series
        values = chebvander(z, len(series) - 1)
        return np.asarray(values @ (series @ terms) + constants @ terms)

    @cached_property
    def _series(self) -> tuple[Array, Array]:
        """Minus the integrals of the polynomial parts, j >= 1, and their constants, from a point off the contact."""
        size, count = self.basis.terms + 2, self.basis.pressures - 1
        series = -chebint(coefficients(self.basis.local(gauss_points(size))[:, 1:]))
        z: ComplexArray = 1j * np.sinh(np.array([CANCELS / (2 * self.basis.terms)]))
        share = -np.eye(count) / (2 * np.arange(1, count + 1))
        exact = by_gauss(z, int(np.ceil(RULES[0][0] * self.basis.terms)), self._raised, share)
        known = self._near(z, share) + chebvander(z, len(series) - 1) @ series
        return np.asarray(series), np.asarray((exact - known)[0].real)
