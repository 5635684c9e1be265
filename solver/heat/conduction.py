"""Heat conduction into layers on a half-space, by transforms over place and time.

With the wavenumber k along the surface and the Laplace variable s, ``q^2 = k^2 + s c / kappa`` and ``z = kappa q`` in
each layer; Y is the admittance of all below it, z of the base at the lowest. A layer of thickness h has

    theta_bottom / theta_top = 1 / (cosh qh + (Y/z) sinh qh)
    theta_mean / theta_top = (sinh qh + (Y/z)(cosh qh - 1)) / (qh (cosh qh + (Y/z) sinh qh)),

written with exp(-qh), so that nothing cancels in thin layers.
"""

from dataclasses import dataclass

import numpy as np

from approximation.arrays import Array
from solver.arrays import ComplexArray

_TALBOT = 16  # nodes: truncated to 1e-10, rounded to 1e-13


@dataclass(frozen=True, eq=False)
class Conduction:
    """Layers from the top down, the base last."""

    thickness: Array  # of the layers [m]; (layer,)
    conductivity: Array  # [W/m/K]; (layer + 1,)
    capacity: Array  # heat capacity by volume [J/m3/K]; (layer + 1,)

    def transfers(self, k: Array, s: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """Heat flux into the surface over its temperature, (k, s), and every layer's mean over it, (layer, k, s)."""
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
        return admittance, np.array(means[::-1])

    def means(self, k: Array, time: float, leak: float = np.inf) -> Array:
        """Mean temperatures of the layers at a time after a unit step at the surface; (layer, k).

        ``leak`` [s]: time constant of the circuit that reads them, whose response to each change decays.
        """
        s = laplace(time)
        return in_time(self.transfers(k, s)[1] / (s + 1 / leak), time)


def laplace(time: float) -> ComplexArray:
    """Values of the Laplace variable from which :func:`in_time` returns to a time [1/s]; (node,)."""
    return np.asarray(_DELTA / time)


def in_time(transformed: ComplexArray, time: float) -> Array:
    """Inverse of a Laplace transform at a time, from its values (.., node); (..,)."""
    return np.asarray((transformed @ _GAMMA).real * (2 / (5 * time)))


def _talbot() -> tuple[ComplexArray, ComplexArray]:
    """Nodes and weights of Talbot's contour (J. Abate, P.P. Valko, Int. J. Numer. Meth. Eng. 60 (2004) 979)."""
    angle = np.pi * np.arange(1, _TALBOT) / _TALBOT
    cotangent = 1 / np.tan(angle)
    delta = np.concatenate([[2 * _TALBOT / 5], 2 * _TALBOT / 5 * angle * (cotangent + 1j)])
    gamma = np.concatenate([[0.5], 1 + 1j * angle * (1 + cotangent**2) - 1j * cotangent]) * np.exp(delta)
    return delta, gamma


_DELTA, _GAMMA = _talbot()
