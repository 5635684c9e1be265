"""Tractions of point contacts as densities over 0 <= b <= 1, at rest and from friction (points, 7 and 8)."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from approximation.arrays import Indices
from approximation.chebyshev import legendre_rule
from solver.arrays import Array
from solver.point import hankel
from solver.point.profile import Shape
from solver.stack.layers import Stack
from solver.stack.wavenumbers import wavenumbers

_AT_KINK = 3e-4  # least distance over a from a kink: a millionth deep, rounding is 1e-8
_KINK_NODES = 40  # of the integral that a kinked profile adds to the logarithm


@dataclass(frozen=True, eq=False)
class Density:
    """Densities of (sigma_yy, D_y, B_y) without friction, lengths over a; columns of cases or causes."""

    shape: Shape
    strengths: Array  # Strengths at the edge; (column, 3)
    form: Array  # Half-space's pressure over ``halfspace_form``; (column, 3)
    series: Array  # Layers' coefficients, one zero without layers; (column, 3, n)

    @property
    def kinked(self) -> bool:
        """Return True if the profile is not a polynomial of r^2."""
        return not self.shape.flat and self.shape.exponent % 2 != 0

    def part(self, columns: Indices) -> "Density":
        """Densities of some of the columns."""
        return Density(self.shape, self.strengths[columns], self.form[columns], self.series[columns])

    def times(self, units: Array) -> "Density":
        """Densities in other units of the channels, (3,)."""
        form, series = self.form * units, self.series * units[:, None]
        return Density(self.shape, self.strengths * units, form, series)

    def at(self, b: Array) -> Array:
        """Density phi at b, (b,) from 0 to 1; (column, 3, b)."""
        closed = self.strengths[..., None] + self.shape.rise * self.form[..., None] * (1 - b**self.shape.exponent)
        legendre = np.polynomial.legendre.legvander(b, 2 * self._count - 2)[:, ::2]
        return np.asarray(closed + self.signed @ (legendre - 1).T)

    def falling(self, b: Array) -> Array:
        """Return -d phi / db; (column, 3, b)."""
        e = self.shape.exponent
        closed = self.shape.rise * e * self.form[..., None] * b ** (e - 1)
        legendre = np.zeros((*self.series.shape[:2], 2 * self._count - 1))
        legendre[..., ::2] = self.signed
        derived = np.polynomial.legendre.legder(legendre, axis=-1)
        return np.asarray(closed - derived @ np.polynomial.legendre.legvander(b, derived.shape[-1] - 1).T)

    def hilbert(self, b: Array) -> Array:
        """Hilbert transform (1/pi) PV int_-1^1 phi(s) / (b - s) ds at b (b,); (column, 3, b)."""
        artanh, e = np.arctanh(np.minimum(b, 1 - 1e-16)), self.shape.exponent
        if self.shape.flat:  # the pressure of other punches has no strength
            closed = self.strengths[..., None] * artanh
        else:  # b PV int_0^1 (1 - s^e) / (b^2 - s^2) ds of the form
            per_form = (1 - b**e) * artanh + b ** (e - 1) * _power_mean(e, b)
            closed = self.shape.rise * self.form[..., None] * per_form
        return np.asarray((2 / np.pi) * (closed + self._hilbert_series(b, artanh)))

    def _hilbert_series(self, b: Array, artanh: Array) -> Array:
        """Hilbert transform of the layers' contribution times pi/2; (column, 3, b)."""
        degree = 2 * self._count - 2
        P = np.polynomial.legendre.legvander(b, max(degree, 1))
        D = np.zeros((max(degree, 1) + 1, b.size))  # Q_n - P_n artanh, of the same recurrence
        D[1] = -1.0
        for n in range(1, degree):
            D[n + 1] = ((2 * n + 1) * b * D[n] - n * D[n - 1]) / (n + 1)
        return np.asarray(self.signed @ ((P.T[0 : degree + 1 : 2] - 1) * artanh + D[0 : degree + 1 : 2]))

    @cached_property
    def signed(self) -> Array:
        """Coefficients of P_2n(b); (column, 3, n)."""
        return np.asarray(self.series * (-1.0) ** np.arange(self._count))

    @property
    def _count(self) -> int:
        return int(self.series.shape[-1])


def hilbert_form_rates(e: float, b: Array) -> Array:
    """Derivative by b of b PV int_0^1 (1 - s^e) / (b^2 - s^2) ds at 0 < b < 1; (b,)."""
    artanh = np.arctanh(np.minimum(b, 1 - 1e-16))
    return np.asarray(e * (b ** (e - 2) * _power_mean(e, b) - b ** (e - 1) * artanh))


def _power_mean(e: float, b: Array) -> Array:
    """Return int_0^1 (1 - (s/b)^e) / (1 - (s/b)^2) ds; (b,)."""
    if e % 2 == 0:  # a polynomial of 1/b
        powers = np.arange(0, e, 2)
        return np.asarray(b[:, None] ** -powers @ (1 / (powers + 1)))
    gauss, gauss_weights = legendre_rule(_KINK_NODES)
    v = (1 + gauss) / 2  # s = v^4: powers of s are smooth in v
    s, weights = v**4, 2 * gauss_weights * v**3
    log = np.log(s) - np.log(b)[:, None]
    ratio = np.where(np.abs(log) > 1e-12, np.expm1(e * log) / np.expm1(2 * log), e / 2)
    return np.asarray(ratio @ weights)


def second_kind_rates(b: Array, count: int) -> Array:
    """Derivative by b of Q_2n - artanh, n < count, of Legendre functions at 0 <= b < 1; (n, b)."""
    # Q_n = P_n artanh + D_n and P_n = 1 - (1 - b) E_n: the derivative is P_n' artanh + D_n' - E_n / (1 + b)
    degree = max(2 * count - 2, 1)
    P, D, E = (np.zeros((degree + 1, b.size)) for _ in range(3))
    P_rates, D_rates = np.zeros_like(P), np.zeros_like(D)
    P[0], P[1], P_rates[1], D[1], E[1] = 1.0, b, 1.0, -1.0, 1.0
    for n in range(1, degree):
        for values, derivatives in ((P, P_rates), (D, D_rates)):
            values[n + 1] = ((2 * n + 1) * b * values[n] - n * values[n - 1]) / (n + 1)
            derivatives[n + 1] = ((2 * n + 1) * (values[n] + b * derivatives[n]) - n * derivatives[n - 1]) / (n + 1)
        E[n + 1] = ((2 * n + 1) * (b * E[n] + 1) - n * E[n - 1]) / (n + 1)
    rates = P_rates * np.arctanh(np.minimum(b, 1 - 1e-16)) + D_rates - E / (1 + b)
    return np.asarray(rates[: 2 * count : 2])


#: Function of b and columns that returns psi of (sigma_yy, D_y, B_y); (column, 3, b).
Sines = Callable[[Array, Indices], Array]


@dataclass(frozen=True, eq=False)
class Tractions:
    """Tractions of point contacts in the units of a body; columns are cases or causes."""

    ratio: Array  # Contact radius over the unit of the body's lengths; (column,)
    density: Density
    friction: Array  # Coefficient of friction; (column,)
    sines: Sines | None = None  # None without friction

    @property
    def kinked(self) -> bool:
        """Return True if the densities are kinked at 0 or steep at 1."""
        return self.density.kinked or self.sines is not None

    def part(self, columns: Indices) -> "Tractions":
        """Tractions of some of the columns."""
        all_sines = self.sines
        sines = None if all_sines is None else lambda b, chosen: all_sines(b, columns[chosen])
        return Tractions(self.ratio[columns], self.density.part(columns), self.friction[columns], sines)

    def vectors(self, b: Array, columns: Indices) -> tuple[Array, Array | None]:
        """Densities of (sigma_xy, sigma_yy, D_y, B_y) at b, at rest and (None: no friction) of cos(angle).

        (column, 4, b) each, for cos kb in the transform, but for sin kb in sigma_yy, D_y and B_y of cos(angle).
        """
        pressing = self.density.part(columns).at(b)
        plain = np.concatenate([np.zeros_like(pressing[:, :1]), pressing], 1)
        if self.sines is None:
            return plain, None
        return plain, np.concatenate([-self.friction[columns, None, None] * pressing[:, :1], self.sines(b, columns)], 1)

    def least_depth(self, radius: float) -> float:
        """Depth over a from which fields at a radius over a are extrapolated to the surface."""
        from_edge = abs(1 - radius)
        return hankel.least_depth(min(from_edge, max(radius, _AT_KINK)) if self.density.kinked else from_edge)

    def nodes(self, radius: float, near: float) -> hankel.Nodes:
        """Nodes in b for a field point."""
        return hankel.nodes(radius, near, kinked=self.kinked)

    def transforms(self, phases: Array, columns: Indices) -> tuple[Array, Array | None]:
        """Transforms of the tractions at phases k a, at rest and of cos(angle); (k, 4, column) each."""
        nodes = hankel.nodes(parts=hankel.parts(phases), kinked=self.kinked)
        first, second = self.vectors(nodes.b, columns)
        cosines = np.cos(phases[:, None] * nodes.b) * nodes.weights
        top = np.einsum("kb,cib->kic", cosines, first, optimize=True)
        if second is None:
            return top, None
        sines = np.sin(phases[:, None] * nodes.b) * nodes.weights
        along = np.einsum("kb,cib->kic", cosines, second[:, :1], optimize=True)
        down = np.einsum("kb,cib->kic", sines, second[:, 1:], optimize=True)
        return top, np.concatenate([along, down], 1)

    def wavenumbers(self, stack: Stack, reach: float, width: float) -> tuple[Array, Array]:
        """Wavenumbers and weights of integrals over k of a stack."""
        return wavenumbers(stack, reach, width)
