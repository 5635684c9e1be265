"""Heat conduction into layers on a half-space, by transforms over position and time (docs/heat.md, Layers)."""

from dataclasses import dataclass

import numpy as np

from approximation.arrays import Array
from solver.arrays import ComplexArray

_TALBOT = 16  # nodes: truncated to 1e-10, rounded to 1e-13


@dataclass(frozen=True, eq=False)
class Conduction:
    """Thermal layers from the top down, the base last."""

    thickness: Array  # of the layers [m]; (layer,)
    conductivity: Array  # [W/m/K]; (layer + 1,)
    capacity: Array  # heat capacity by volume [J/m3/K]; (layer + 1,)

    def transfers(self, k: Array, s: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """Admittance of the surface (k, s), and mean temperature of each layer over the surface's (layer, k, s)."""
        squared = k[:, None] ** 2
        q = [np.sqrt(squared + s * (c / kappa)) for c, kappa in zip(self.capacity, self.conductivity, strict=True)]
        admittance, means, ratios = self.conductivity[-1] * q[-1], [], []
        for h, kappa, wave in zip(self.thickness[::-1], self.conductivity[-2::-1], q[-2::-1], strict=True):
            z = kappa * wave
            # cosh and sinh of qh, both times 2 exp(-qh), so that nothing cancels in thin layers
            lost = -np.expm1(-wave * h)
            left, relative = 1 - lost, admittance / z
            cosh, sinh = 1 + left**2, lost * (1 + left)
            denominator = cosh + relative * sinh
            means.append((sinh + relative * lost**2) / (wave * h * denominator))
            ratios.append(2 * left / denominator)
            admittance = z * (relative * cosh + sinh) / denominator
        top = np.ones_like(q[0])
        for number in range(len(means) - 1, -1, -1):
            means[number] = means[number] * top
            top = top * ratios[number]
        return admittance, np.array(means[::-1])

    def means(self, k: Array, time: float, leak: float = np.inf) -> Array:
        """Mean temperatures after a unit step at the surface, read with a time constant ``leak`` [s]; (layer, k)."""
        s = laplace(time)
        return in_time(self.transfers(k, s)[1] / (s + 1 / leak), time)


def laplace(time: float) -> ComplexArray:
    """Values of the Laplace variable from which :func:`in_time` returns to a time [1/s]; (node,)."""
    return np.asarray(_DELTA / time)


def in_time(transformed: ComplexArray, time: float) -> Array:
    """Inverse of a Laplace transform at a time, from its values (..., node) at :func:`laplace`; (...)."""
    return np.asarray((transformed @ _GAMMA).real * (2 / (5 * time)))


def _talbot() -> tuple[ComplexArray, ComplexArray]:
    """Nodes and weights of Talbot's contour (J. Abate, P.P. Valko, Int. J. Numer. Meth. Eng. 60 (2004) 979)."""
    angle = np.pi * np.arange(1, _TALBOT) / _TALBOT
    cotangent = 1 / np.tan(angle)
    delta = np.concatenate([[2 * _TALBOT / 5], 2 * _TALBOT / 5 * angle * (cotangent + 1j)])
    gamma = np.concatenate([[0.5], 1 + 1j * angle * (1 + cotangent**2) - 1j * cotangent]) * np.exp(delta)
    return delta, gamma


_DELTA, _GAMMA = _talbot()
