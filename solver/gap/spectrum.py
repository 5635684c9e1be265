"""Spectra of the charges beside a contact.

Charges vary on the scale of their distance from the edge: a smooth window of the logarithm of that distance has no
short waves. Each of them is integrated for as long ones as it has; phases are bounded, wherever charges lie.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy.special import erf

from solver.arrays import Array, ComplexArray
from solver.gap.charges import Charges
from solver.gap.rules import gauss

_STEP, _SLOPE = 0.9, 0.2  # of windows in log(abs(X) - 1), and the width of their ends
_TAIL = 4.8 * _SLOPE  # beyond which 1e-11 of a window is left
_CUT = 75.0  # wavenumber times the distance of a window's beginning from the edge beyond which 1e-10 of it is left
_PHASE, _NODES = 28.0, 24  # across a piece, and its nodes
_BAND = 6.0  # of wavenumbers that share nodes


@dataclass(frozen=True, eq=False)
class Window:
    """Charges between two distances from the edge, with smooth ends."""

    charges: Charges  # All of them
    # Logarithms of the distances
    start: float
    stop: float
    most: float  # Largest wavenumber times the half-length that it has

    @cached_property
    def _inner(self) -> Array:
        """Ends in u of what of the window lies within an interval of the charges."""
        ends = self.charges.ends
        reach = np.exp(np.minimum([self.start - _TAIL, self.stop + _TAIL], 300.0))
        least, farthest = np.minimum(np.arccosh(1 + reach), ends[-1])
        return np.array([least, *ends[(ends > least) & (ends < farthest)], farthest])

    @property
    def reach(self) -> float:
        """Largest abs(X) of it."""
        return float(np.cosh(self._inner[-1]))

    def _rule(self, most: float) -> tuple[Array, Array]:
        """X of nodes on the right, (node,), and charges right and left, (side, 2, node), for waves up to a number."""
        cuts = [
            np.linspace(low, high, 1 + int(most * (np.cosh(high) - np.cosh(low)) / _PHASE), endpoint=False)
            for low, high in pairwise(self._inner.tolist())
        ]
        u, weights = gauss(np.append(np.concatenate(cuts), self._inner[-1]), _NODES)
        place = np.log(2 * np.sinh(u / 2) ** 2)
        share = (erf((place - self.start) / _SLOPE) - erf((place - self.stop) / _SLOPE)) / 2
        return np.cosh(u), self.charges.densities(u) * (weights * np.sinh(u) * share)

    @cached_property
    def _bands(self) -> list[tuple[float, float, Array, Array]]:
        """Bands of wavenumbers with the rule of each."""
        result, most = list[tuple[float, float, Array, Array]](), self.most
        while most > 0:
            least = most / _BAND if most * self.reach > 1 else -1.0
            result.append((least, most, *self._rule(most)))
            most = least
        return result

    def add(self, out: ComplexArray, q: Array) -> None:
        """Add its spectrum (2, wavenumber) at q.

        out: (2, wavenumber), complex, what is added to; q: (wavenumber,), wavenumbers times the half-length.
        """
        for least, most, X, (right, left) in self._bands:
            members = np.flatnonzero((q > least) & (q <= most))
            if members.size:
                phase = q[members, None] * X
                out[:, members] += (right + left) @ np.cos(phase).T - 1j * ((right - left) @ np.sin(phase).T)


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Spectrum up to a wavenumber."""

    charges: Charges
    most: float

    @cached_property
    def windows(self) -> list[Window]:
        """Windows from the edge outwards."""
        last = float(np.log(np.cosh(self.charges.ends[-1])))
        ends = [-np.inf, *np.arange(np.log(_CUT / self.most), last, _STEP).tolist(), np.inf]
        return [Window(self.charges, *pair, min(self.most, _CUT * float(np.exp(-pair[0])))) for pair in pairwise(ends)]

    def reach(self, q: float) -> float:
        """Largest abs(X) whose charges count from a wavenumber times the half-length on."""
        return max((window.reach for window in self.windows if window.most > q), default=1.0)

    def values(self, q: Array) -> ComplexArray:
        """Integrals of D exp(-i q X) dX over both sides; (2, wavenumber)."""
        out: ComplexArray = np.zeros((2, q.size), np.complex128)
        for window in self.windows:
            window.add(out, q)
        return out
