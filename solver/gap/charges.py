"""Exterior charges of one contact and the charge induced in it: values, transforms, spectra (theory section 10).

With X = +-cosh(u) outside the contact, z = cosh(w) above it and C the charge beyond u, the transforms of the right side

    H = 1/(pi sinh w) int D sinh^2 u / (cosh u - cosh w) du,    F = -(1/pi) int C [sinh w / (cosh u - cosh w) + 1] du

have F' = H, F = 0 at infinity. On intervals near w Gauss's rule is corrected by its error for the poles 1/(u -+ w).
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.polynomial.legendre import leggauss, legint, legval, legvander
from scipy.special import erf

from approximation.arrays import blocks
from solver.arrays import Array, ComplexArray
from solver.gap.grid import Grid, gauss
from solver.stack.wavenumbers import on_panels

_RULE = 10  # nodes of an interval
_LEGENDRE_NODES, _WEIGHTS = leggauss(_RULE)
_TO_SERIES: Array = np.asarray(np.linalg.inv(legvander(_LEGENDRE_NODES, _RULE - 1)), dtype=np.float64)
_WIDTH = 0.9  # of the intervals into which the infinite panel is cut
#: Number of intervals for fields and for potentials; charge beyond them counts as a charge at infinity, to 1e-10.
NEAR, FAR = 10, 26
_ELLIPSE = 4.5  # rho^-20 is left: 1e-13
_TINY = 1e-300  # least imaginary part: the upper side of the real axis
_TERMS_AT_ONCE = 1 << 20  # points times nodes at a time: bounded memory
_GROWTH, _FIRST = 2.5, 100.0  # of panels in k towards 0, and the largest phase across the first


@dataclass(frozen=True, eq=False)
class Charges:
    """Densities D_y and B_y outside one contact."""

    grid: Grid
    unknowns: Array  # Densities over their size, right side and left; (side, 2, n)
    intervals: int = NEAR  # Number of intervals of the infinite panel

    @cached_property
    def ends(self) -> Array:
        """Ends of intervals in u on which densities are smooth; (interval + 1,)."""
        ends = np.array(self.grid.ends)
        return np.concatenate([ends, ends[-1] + _WIDTH * np.arange(1, self.intervals + 1)])

    def spectrum(self, most: float) -> "Spectrum":
        """Spectrum up to the next power of two of the wavenumber times the half-length ``most``."""
        power = int(np.ceil(np.log2(max(most, 1.0))))
        if power not in self._spectra:
            self._spectra[power] = Spectrum(self, 2.0**power)
        return self._spectra[power]

    @cached_property
    def _spectra(self) -> dict[int, "Spectrum"]:
        return {}

    def wavenumbers(self, ends: Array, half_length: float, reach: float) -> tuple[Array, Array]:
        """Wavenumbers and weights on panels between ``ends`` [1/m], for fields up to ``reach`` [m] from the edges."""
        # smaller first panels keep the farthest charges in phase; distant charges refine those of long waves only
        count = np.log(ends[1] * half_length * np.cosh(self.ends[-1]) / _FIRST) / np.log(_GROWTH)
        below = ends[1] * _GROWTH ** -np.arange(1.0, max(count, 0) + 2)
        ends = np.concatenate([[0.0], below[::-1], ends[1:]])
        spectrum = self.spectrum(float(ends[-1]) * half_length)
        far = [reach + half_length * spectrum.reach(start * half_length) for start in ends[:-1].tolist()]
        return on_panels(ends, np.array(far))

    @cached_property
    def _middles(self) -> Array:
        return np.asarray((self.ends[1:] + self.ends[:-1]) / 2)

    @cached_property
    def _halves(self) -> Array:
        return np.asarray(np.diff(self.ends) / 2)

    @cached_property
    def _u(self) -> Array:
        """Nodes in u; (interval, node)."""
        return np.asarray(self._middles[:, None] + self._halves[:, None] * _LEGENDRE_NODES)

    def densities(self, u: Array) -> Array:
        """Densities at points u of both sides; (side, 2, point)."""
        return np.asarray(self.unknowns @ self.grid.interpolation(u).T * self.grid.size_at(u))

    @cached_property
    def _lines(self) -> Array:
        """Charge per u, D sinh u, at the nodes; (side, 2, interval, node)."""
        return self.densities(self._u.ravel()).reshape(2, 2, *self._u.shape) * np.sinh(self._u)

    @cached_property
    def _series(self) -> Array:
        """Legendre coefficients of the charge per u on every interval; (node, side, 2, interval)."""
        return np.moveaxis(self._lines @ _TO_SERIES.T, -1, 0)

    @cached_property
    def _beyond(self) -> Array:
        """Legendre coefficients of the charge beyond u on every interval; (node, side, 2, interval)."""
        within = legint(self._series, lbnd=1, axis=0) * -self._halves
        whole = np.asarray(legval(-1.0, within))
        within[0] += np.cumsum(whole[..., ::-1], -1)[..., ::-1] - whole
        return np.asarray(within)

    @cached_property
    def _far_charge(self) -> Array:
        """Charge beyond all intervals; (side, 2)."""
        return np.asarray(self.unknowns @ self.grid.totals - np.asarray(legval(-1.0, self._beyond))[..., 0])

    # -- on the surface ------------------------------------------------------------------------------------------------
    def density(self, X: Array) -> Array:
        """Densities at X outside the contact; (2, point)."""
        right, left = self.densities(np.arccosh(np.abs(X)))
        return np.asarray(np.where(X > 0, right, left))

    def induced(self, X: Array) -> Array:
        """Charge densities induced in the contact, at abs(X) < 1; (2, point)."""
        right, left = self.unknowns @ np.stack([self.grid.induced(X).T, self.grid.induced(-X).T])
        return np.asarray((right + left) / np.sqrt((1 - X) * (1 + X)))

    def induced_terms(self, count: int) -> Array:
        """Coefficients of T_n / sqrt(1 - X^2), n < count, in the induced charge densities; (2, n)."""
        right, left = self.unknowns @ self.grid.induced_terms(count).T
        return np.asarray(right + (-1.0) ** np.arange(count) * left)

    # -- off the surface -----------------------------------------------------------------------------------------------
    def transforms(self, z: ComplexArray, *, integrated: bool = False) -> ComplexArray:
        """Transform H of all charges, or F, at points z = X + iY (point,) with Y >= 0; (2, point)."""
        out: ComplexArray = np.empty((2, z.size), np.complex128)
        step = max(_TERMS_AT_ONCE // self._u.size, 1)
        for block in blocks(z.size, step):
            right = self._of_side(0, z[block], integrated)
            left = self._of_side(1, -np.conj(z[block]), integrated)
            out[:, block] = right + (1 if integrated else -1) * np.conj(left)
        return out

    def _of_side(self, side: int, z: ComplexArray, integrated: bool) -> ComplexArray:
        root: ComplexArray = np.sqrt(z - 1) * np.sqrt(z + 1)
        w: ComplexArray = np.log(z + root)
        w.imag = np.maximum(w.imag, _TINY)
        series = (self._beyond if integrated else self._series)[:, side]
        weights = self._halves[:, None] * _WEIGHTS
        lines = legval(_LEGENDRE_NODES, series) if integrated else self._lines[side] * np.sinh(self._u)
        rule = (lines * weights).reshape(2, -1)
        real, imaginary = self._summed(rule, z)
        result: ComplexArray = real + 1j * imaginary
        if integrated:
            result = result * root
        self._correct(result, w, series, weights, integrated)
        if integrated:
            return np.asarray(-(result + rule.sum(1)[:, None]) / np.pi)
        return np.asarray((result + self._far_charge[side, :, None]) / (np.pi * root))

    def _summed(self, rule: Array, z: ComplexArray) -> tuple[Array, Array]:
        """Real and imaginary part of the sum of rule / (cosh u - z); (2, point) each."""
        # cosh u - X as a difference of distances to the edge
        distance = 2 * np.sinh(self._u / 2).ravel()[:, None] ** 2 - (z.real - 1)
        size = distance**2 + z.imag**2
        size[size == 0] = _TINY
        return rule @ (distance / size), (rule @ (1 / size)) * z.imag

    def _correct(
        self, transforms: ComplexArray, w: ComplexArray, series: Array, weights: Array, integrated: bool
    ) -> None:
        """Add the errors of Gauss's rules for the poles u = w and u = -w to ``transforms`` (2, point)."""
        for sign in (1, -1):
            pole = sign * w
            local = (pole - self._middles[:, None]) / self._halves[:, None]
            close = np.abs(local + np.sqrt(local - 1) * np.sqrt(local + 1)) < _ELLIPSE
            for number in np.flatnonzero(close.any(1)).tolist():
                points = np.flatnonzero(close[number])
                poles = pole[points]
                exact = np.log(self.ends[number + 1] - poles) - np.log(self.ends[number] - poles)
                ruled = (1 / (self._u[number] - poles[:, None])) @ weights[number]
                residue = legval(local[number, points], series[..., number])
                transforms[:, points] += (sign if integrated else 1) * residue * (exact - ruled)


_WINDOW, _SLOPE = 0.9, 0.2  # length of windows in log(abs(X) - 1), and the width of their ends
_TAIL = 4.8 * _SLOPE  # beyond which 1e-11 of a window is left
_CUT = 75.0  # wavenumber times the distance of a window's start from the edge beyond which 1e-10 of it is left
_PHASE, _PIECE = 28.0, 24  # largest phase across a piece, and its nodes
_BAND = 6.0  # ratio of wavenumbers that share nodes


@dataclass(frozen=True, eq=False)
class ChargeWindow:
    """Charges between two distances from the edge, on whose scale they vary, so that they have no short waves."""

    charges: Charges  # All charges of the contact
    # Logarithms of the distances
    start: float
    stop: float
    most: float  # Largest wavenumber times the half-length in the window

    @cached_property
    def _inner(self) -> Array:
        """Ends in u of the charges' intervals within the window."""
        ends = self.charges.ends
        distances = np.exp(np.minimum([self.start - _TAIL, self.stop + _TAIL], 300.0))
        nearest, farthest = np.minimum(np.arccosh(1 + distances), ends[-1])
        return np.array([nearest, *ends[(ends > nearest) & (ends < farthest)], farthest])

    @property
    def reach(self) -> float:
        """Largest abs(X) of the window."""
        return float(np.cosh(self._inner[-1]))

    def _rule(self, most: float) -> tuple[Array, Array]:
        """Nodes X on the right, (node,), and weighted charges, (side, 2, node), for waves up to ``most``."""
        cuts = [
            np.linspace(low, high, 1 + int(most * (np.cosh(high) - np.cosh(low)) / _PHASE), endpoint=False)
            for low, high in pairwise(self._inner.tolist())
        ]
        u, weights = gauss(np.append(np.concatenate(cuts), self._inner[-1]), _PIECE)
        log_distance = np.log(2 * np.sinh(u / 2) ** 2)
        window = (erf((log_distance - self.start) / _SLOPE) - erf((log_distance - self.stop) / _SLOPE)) / 2
        return np.cosh(u), self.charges.densities(u) * (weights * np.sinh(u) * window)

    @cached_property
    def _bands(self) -> list[tuple[float, float, Array, Array]]:
        """Bands of wavenumbers, least and largest, each with its rule."""
        result, most = list[tuple[float, float, Array, Array]](), self.most
        while most > 0:
            least = most / _BAND if most * self.reach > 1 else -1.0
            result.append((least, most, *self._rule(most)))
            most = least
        return result

    def add(self, out: ComplexArray, q: Array) -> None:
        """Add the window's spectrum to ``out`` (2, wavenumber), at wavenumbers times the half-length q."""
        for least, most, X, (right, left) in self._bands:
            members = np.flatnonzero((q > least) & (q <= most))
            if members.size:
                phase = q[members, None] * X
                out[:, members] += (right + left) @ np.cos(phase).T - 1j * ((right - left) @ np.sin(phase).T)


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Fourier transform of the charges up to a wavenumber; each window is integrated over its own wavenumbers."""

    charges: Charges
    most: float  # Largest wavenumber times the half-length

    @cached_property
    def windows(self) -> list[ChargeWindow]:
        """Windows from the edge outwards."""
        last = float(np.log(np.cosh(self.charges.ends[-1])))
        ends = [-np.inf, *np.arange(np.log(_CUT / self.most), last, _WINDOW).tolist(), np.inf]
        return [
            ChargeWindow(self.charges, *pair, min(self.most, _CUT * float(np.exp(-pair[0])))) for pair in pairwise(ends)
        ]

    def reach(self, q: float) -> float:
        """Largest abs(X) of the charges whose spectrum exceeds the wavenumber times the half-length q."""
        return max((window.reach for window in self.windows if window.most > q), default=1.0)

    def values(self, q: Array) -> ComplexArray:
        """Integrals of D exp(-i q X) dX over both sides at q (wavenumber,); (2, wavenumber)."""
        out: ComplexArray = np.zeros((2, q.size), np.complex128)
        for window in self.windows:
            window.add(out, q)
        return out
