"""Heat conduction from a warm spot on the surface into layers on a half-space, by transforms over place and time.

With the wavenumber k along the surface and the Laplace variable s, ``q^2 = k^2 + s c / kappa`` and ``z = kappa q`` in
each layer; Y is the admittance of all below it, z of the base at the lowest. A layer of thickness h has

    theta_bottom / theta_top = 1 / (cosh qh + (Y/z) sinh qh)
    theta_mean / theta_top = (sinh qh + (Y/z)(cosh qh - 1)) / (qh (cosh qh + (Y/z) sinh qh)),

written with exp(-qh), so that nothing cancels in thin layers. Outside the spot the surface keeps its temperature.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.polynomial.chebyshev import chebval
from numpy.polynomial.legendre import leggauss
from scipy.special import j0, j1

from approximation.arrays import Array
from approximation.chebyshev import coefficients, gauss_points
from solver.arrays import ComplexArray

_TALBOT = 16  # nodes: truncated to 1e-10, rounded to 1e-13
_SPECTRUM = 96  # nodes over all wavenumbers: interpolated to 1e-8
_NODES, _WEIGHTS = leggauss(8)  # of a panel
_PHASE = 4.0  # of the fastest oscillation in a panel
_BURIED, _BARE = 22.0, 400.0  # largest wavenumber times the depth of the film, or its thickness where it is on top
_MOST_PANELS = 4_000

Shape = Literal["disc", "strip"]


@dataclass(frozen=True)
class Spot:
    """Warm disc or strip, and the patch of an electrode that collects the charge below it."""

    shape: Shape  # of the warm spot: of a point contact a disc, of one along a line a strip
    half_width: float  # of the spot: radius, half of a width [m]
    patch: Shape | None = None  # None: the electrode has no end
    patch_half_width: float = 0.0  # [m]
    distance: float = 0.0  # of both middles [m]

    @property
    def area(self) -> float:
        """Area of what collects [m2], of a strip below a strip its width [m]; without a patch that of the spot."""
        shape, half = (self.shape, self.half_width) if self.patch is None else (self.patch, self.patch_half_width)
        if shape == "disc":
            return np.pi * half**2
        return 2 * half if self.shape == "strip" else 4 * half * self.half_width


@dataclass(frozen=True, eq=False)
class Conduction:
    """Layers from the top down, the base last."""

    thickness: Array  # of the layers [m]; (layer,)
    conductivity: Array  # [W/m/K]; (layer + 1,)
    capacity: Array  # heat capacity by volume [J/m3/K]; (layer + 1,)

    def transfers(self, k: Array, s: ComplexArray) -> ComplexArray:
        """Mean temperature of every layer over that of the surface, (layer, k, s)."""
        squared = k[:, None] ** 2
        q = [np.sqrt(squared + s * (c / kappa)) for c, kappa in zip(self.capacity, self.conductivity, strict=True)]
        admittance, means, ratios = self.conductivity[-1] * q[-1], [], []
        for h, kappa, wave in zip(self.thickness[::-1], self.conductivity[-2::-1], q[-2::-1], strict=True):
            z = kappa * wave
            lost = -np.expm1(-wave * h)
            left, relative = 1 - lost, admittance / z
            even, odd = 1 + left**2, lost * (1 + left)
            over = even + relative * odd
            means.append((odd + relative * lost**2) / (wave * h * over))
            ratios.append(2 * left / over)
            admittance = z * (relative * even + odd) / over
        top = np.ones_like(q[0])
        for place in range(len(means) - 1, -1, -1):
            means[place] = means[place] * top
            top = top * ratios[place]
        return np.array(means[::-1])

    def means(self, k: Array, time: float, leak: float = np.inf) -> Array:
        """Mean temperatures of the layers at a time after a unit step at the surface; (layer, k).

        ``leak`` [s]: time constant of the circuit that reads them, whose response to each change decays.
        """
        s = _DELTA / time
        transformed = self.transfers(k, s) / (s + 1 / leak)
        return np.asarray((transformed @ _GAMMA).real * (2 / (5 * time)))


@dataclass(frozen=True, eq=False)
class Warming:
    """Weighted mean temperature of layers at one time after a unit step at the surface, by wavenumber."""

    conduction: Conduction
    weights: Array  # of the layers, as their charge per kelvin and area [C m-2 K-1]; (layer,)
    time: float  # [s]
    leak: float = np.inf  # time constant of what reads [s]

    @cached_property
    def uniform(self) -> float:
        """Weighted mean after a uniform step."""
        return float(self.weights @ self.conduction.means(np.zeros(1), self.time, self.leak)[:, 0])

    def over(self, spot: Spot) -> float:
        """Integral of the weighted mean over the patch below a warm spot [.. m2], of a strip per metre [.. m]."""
        if spot.patch is None:
            return self.uniform * (np.pi * spot.half_width**2 if spot.shape == "disc" else 2 * spot.half_width)
        width = spot.half_width + spot.patch_half_width + abs(spot.distance)
        k, weights = self._wavenumbers(width)
        spectrum = self._spectrum(k)
        integral = float(weights @ (_profile(spot, k) * spectrum))
        if spot.shape == spot.patch and spot.patch_half_width == spot.half_width and spot.distance == 0:
            end = float(k[-1])  # of the rest the part that does not oscillate; the spectrum falls as 1/k
            integral += float(spectrum[-1]) / end * (spot.half_width if spot.shape == "disc" else 1 / np.pi)
        return integral

    @cached_property
    def _largest(self) -> float:
        """Wavenumber beyond which the layers stay cold [1/m]."""
        charged = np.flatnonzero(self.weights)
        first = int(charged[0]) if charged.size else 0
        depth = float(self.conduction.thickness[:first].sum())
        bare = _BARE / float(self.conduction.thickness[first])
        return min(_BURIED / depth, bare) if depth else bare

    @cached_property
    def _smallest(self) -> float:
        """Wavenumber below which nothing changes [1/m]: waves longer than heat spreads."""
        spread = np.sqrt((self.conduction.conductivity / self.conduction.capacity).max() * self.time)
        return min(1e-4 / float(spread + self.conduction.thickness.sum()), self._largest / 1e3)

    @cached_property
    def _table(self) -> Array:
        """Chebyshev coefficients of the weighted mean over the logarithm of the wavenumber; (node,)."""
        low, high = np.log(self._smallest), np.log(self._largest)
        k = np.exp((low + high) / 2 + (high - low) / 2 * gauss_points(_SPECTRUM))
        return coefficients(np.asarray(self.weights @ self.conduction.means(k, self.time, self.leak)))

    def _spectrum(self, k: Array) -> Array:
        """Weighted means at some wavenumbers, (k,)."""
        low, high = np.log(self._smallest), np.log(self._largest)
        places = np.clip((2 * np.log(k) - low - high) / (high - low), -1, 1)
        return np.asarray(chebval(places, self._table))

    def _wavenumbers(self, width: float) -> tuple[Array, Array]:
        """Nodes and weights over all wavenumbers, for shapes that oscillate with a width [m]."""
        step = _PHASE / width
        end = min(self._largest, _MOST_PANELS * step)
        first = min(step, end)
        low = min(self._smallest, first / 2)
        edges = np.geomspace(low, first, int(np.ceil(np.log2(first / low))) + 1)
        edges = np.concatenate([[0.0], edges, np.linspace(first, end, int(np.ceil((end - first) / step)) + 1)[1:]])
        middles, halves = (edges[1:] + edges[:-1]) / 2, np.diff(edges) / 2
        return (middles[:, None] + halves[:, None] * _NODES).ravel(), (halves[:, None] * _WEIGHTS).ravel()


def _profile(spot: Spot, k: Array) -> Array:
    """Weight of each wavenumber in the integral over a patch below a spot, (k,)."""
    a, b, d = spot.half_width, spot.patch_half_width, spot.distance
    if spot.shape == "strip":
        return np.asarray(4 / np.pi * np.sin(k * a) * np.sin(k * b) * np.cos(k * d) / k**2)
    if spot.patch == "strip":
        return np.asarray(4 * a * np.sin(k * b) * np.cos(k * d) * j1(k * a) / k**2)
    return np.asarray(2 * np.pi * a * b * j1(k * a) * j1(k * b) * j0(k * d) / k)


def _talbot() -> tuple[ComplexArray, ComplexArray]:
    """Nodes and weights of Talbot's contour (J. Abate, P.P. Valko, Int. J. Numer. Meth. Eng. 60 (2004) 979)."""
    angle = np.pi * np.arange(1, _TALBOT) / _TALBOT
    cotangent = 1 / np.tan(angle)
    delta = np.concatenate([[2 * _TALBOT / 5], 2 * _TALBOT / 5 * angle * (cotangent + 1j)])
    gamma = np.concatenate([[0.5], 1 + 1j * angle * (1 + cotangent**2) - 1j * cotangent]) * np.exp(delta)
    return delta, gamma


_DELTA, _GAMMA = _talbot()
