"""Punches of revolution with the profile g = coefficient r^exponent (points, 3).

A disc is the exponent 0: the end is flat, its edge sharp.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import beta, gammaln, gammasgn

from solver.arrays import Array

#: Exponent of a flat end.
DISC = 0.0


@dataclass(frozen=True)
class Shape:
    """What a power of r is to contacts of every radius."""

    exponent: float  # Of r; 0 for a disc, whose radius is given

    @property
    def flat(self) -> bool:
        """Whether the end is flat, so that the contact has a sharp edge and a given radius."""
        return self.exponent == DISC

    @property
    def driving(self) -> slice:
        """Causes (u0, g) that friction acts on: not the depth of a smooth edge, not a disc's profile."""
        return slice(0, 3) if self.flat else slice(1, 4)

    @property
    def rise(self) -> float:
        """d / (coefficient a^exponent): how deep a half-space is pressed, sqrt(pi) G(e/2 + 1) / G(e/2 + 1/2)."""
        return float((self.exponent + 1) * self.mean)

    @property
    def mean(self) -> float:
        """int_0^1 (1 - x^2)^(e/2) dx."""
        return float(beta(0.5, self.exponent / 2 + 1) / 2)

    def moments(self, count: int) -> Array:
        """int_0^1 (1 - x^2)^(e/2) P_2n(x) dx / abs(P_2n(0)), n = 0 .. count - 1; (n,)."""
        n, q = np.arange(count), self.exponent / 2
        # the integral by Rodrigues' formula; 1 / Gamma(q + 1 - n) is zero where q is a whole number below n
        whole = q == np.floor(q)
        log = 2 * gammaln(q + 1) - gammaln(q + n + 1.5) - gammaln(n + 1) + np.log(np.pi) / 2
        below = q + 1 - n
        inner = np.where(whole & (below <= 0), 1.0, below)
        # 1 / Gamma(1/2 - n) is Gamma(n + 1/2) (-1)^n / pi; over abs(P_2n(0)) = Gamma(n + 1/2) / (sqrt(pi) n!)
        value = np.exp(log - gammaln(inner) + gammaln(n + 1)) * gammasgn(inner) * (-1.0) ** n / 2
        return np.asarray(np.where(whole & (below <= 0), 0.0, value))
