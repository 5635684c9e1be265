"""Punches of revolution with the profile C r^e, and the pressure that they cause on a half-space (points, 3).

Over C a^(e-1) the pressure is (2/pi) (N^-1)_yy rise e F(x), with F of (P3.3).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import beta, gammaln, gammasgn, hyp2f1

from approximation.arrays import Indices
from solver.arrays import Array
from solver.cache import cached

#: Exponent of a flat end.
DISC = 0.0


@dataclass(frozen=True)
class Shape:
    """Profile C r^e of a punch, whatever C."""

    exponent: float  # Of r; 0 for a disc, whose radius is given

    @property
    def flat(self) -> bool:
        """Return True for a disc, whose flat end has a sharp edge and a given radius."""
        return self.exponent == DISC

    @property
    def driving(self) -> slice:
        """Causes (u0, g) that friction acts on: not the depth of a smooth edge, not a disc's profile."""
        return slice(0, 3) if self.flat else slice(1, 4)

    @property
    def rise(self) -> float:
        """Depth on a half-space over C a^e, (e + 1) m = sqrt(pi) Gamma(e/2 + 1) / Gamma(e/2 + 1/2)."""
        return float((self.exponent + 1) * self.mean)

    @property
    def mean(self) -> float:
        """Return m = int_0^1 (1 - x^2)^(e/2) dx."""
        return float(beta(0.5, self.exponent / 2 + 1) / 2)

    def moments(self, count: int) -> Array:
        """Return int_0^1 (1 - x^2)^(e/2) P_2n(x) dx / abs(P_2n(0)), n = 0 .. count - 1; (n,)."""
        n, q = np.arange(count), self.exponent / 2
        # the integral by Rodrigues' formula; 1 / Gamma(q + 1 - n) is zero where q is a whole number below n
        whole = q == np.floor(q)
        log = 2 * gammaln(q + 1) - gammaln(q + n + 1.5) - gammaln(n + 1) + np.log(np.pi) / 2
        below = q + 1 - n
        inner = np.where(whole & (below <= 0), 1.0, below)
        # 1 / Gamma(1/2 - n) is Gamma(n + 1/2) (-1)^n / pi; over abs(P_2n(0)) = Gamma(n + 1/2) / (sqrt(pi) n!)
        value = np.exp(log - gammaln(inner) + gammaln(n + 1)) * gammasgn(inner) * (-1.0) ** n / 2
        return np.asarray(np.where(whole & (below <= 0), 0.0, value))


#: Samples x = sqrt(1 - r^2/a^2) at which tables store the pressure, from the edge to the centre.
SAMPLES = np.sin(np.pi / 2 * np.arange(1, 25) / 24)

_NEAR, _SMOOTH = 0.5, 3.0  # r/a near the centre; the exponent from which F is smooth there


def finite(shape: Shape) -> bool:
    """Return True if the pressure is bounded: it is not at a disc's edge and at a cone's apex."""
    return shape.exponent > 1


def halfspace_form(shape: Shape, x: Array, r: Array | None = None) -> Array:
    """Return rise e F at x, or at r/a where x has too few digits; any shape, infinite at r = 0 unless ``finite``."""
    r = np.sqrt((1 - x) * (1 + x)) if r is None else r
    return np.asarray(shape.rise * shape.exponent * _form(shape.exponent, x, r))


def _form(e: float, x: Array, r: Array) -> Array:
    """Return F of (P3.3); any shape."""
    if e == 1:
        return np.arcsinh(x / r)
    is_near = (r > 0) & (r < _NEAR) & (e < _SMOOTH)  # x does not resolve F near the centre: Pfaff's transformation
    radius, x_outside = np.where(is_near, r, 1.0), np.where(is_near, 0.0, x)
    return np.where(
        is_near,
        x * radius ** (e - 2) * hyp2f1(1 - e / 2, 0.5, 1.5, -((x / radius) ** 2)),
        x_outside * hyp2f1(1 - e / 2, 1.0, 1.5, x_outside**2),
    )


@cached
def halfspace_peak(shape: Shape) -> float:
    """Largest value of ``halfspace_form``: at the centre up to the exponent 2, towards the edge above."""
    return float(highest_pressure(halfspace_form(shape, SAMPLES)[None], lambda x, _: halfspace_form(shape, x))[0])


def highest_pressure(samples: Array, pressure: Callable[[Array, Indices], Array]) -> Array:
    """Largest pressures, (case,), from ``samples`` (case, sample) and ``pressure(x, cases)``, (n,) each."""
    best, largest = np.argmax(samples, 1), np.max(samples, 1)
    hills = np.flatnonzero(best < SAMPLES.size - 1)
    if hills.size:
        from scipy.optimize import elementwise  # slow to import, and most cases are largest at the centre

        middle = best[hills]
        bracket = np.where(middle > 0, SAMPLES[middle - 1], 0.0), SAMPLES[middle], SAMPLES[middle + 1]

        def below(x: Array, case: NDArray[Any]) -> Array:
            return -pressure(x, case.astype(np.intp))

        minimum = elementwise.find_minimum(below, bracket, args=(hills,))
        largest[hills] = np.fmax(-minimum.f_x, largest[hills])
    return np.asarray(largest)
