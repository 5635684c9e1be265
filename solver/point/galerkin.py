"""Tractions below a level and a curved punch at given radii, tested with the functions they consist of (points, 4).

With x = sqrt(1 - s^2/a^2) a traction is sum_n c_n P_2n(x) / (abs(P_2n(0)) x), whose transform is a^2 c_n j_2n(ka):

    a sum_n A_mn c_n = u0 delta_m0 + <g>_m,    A_mn = N pi / (2 (4 n + 1)) delta_mn + K_mn.

The half-space's coefficients, known in closed form, are apart: what the layers add has few terms, whatever the profile.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array
from solver.point.pressure import added_forms
from solver.point.profile import Shape


def halfspace_terms(compliance: Array, shape: Shape, count: int) -> Array:
    """a c of the half-space of N (3, 3), of u0 in each channel and of g = (r/a)^exponent; (3, n, 4).

    compliance: (3, 3), N of the contact.
    """
    inverse = np.linalg.inv(compliance)
    found = np.zeros((3, count, 4))
    found[:, 0, :3] = 2 / np.pi * inverse
    moments = 2 / np.pi * (4 * np.arange(count) + 1) * shape.moments(count)
    found[:, :, 3] = inverse[:, :1] * moments
    return found


@dataclass(frozen=True, eq=False)
class Added:
    """What layers and base add to the coefficients of the half-space."""

    compliance: Array
    interactions: Array
    shape: Shape

    @cached_property
    def halfspace(self) -> Array:
        """a c of the half-space, of u0 in each channel and of g = (r/a)^exponent; (3, n, 4)."""
        return halfspace_terms(self.compliance, self.shape, self.interactions.shape[-1])

    @property
    def loads(self) -> Array:
        """Shares of the coefficients in a load over 2 pi; (n,)."""
        return np.asarray(np.eye(self.interactions.shape[-1])[0])

    @property
    def edges(self) -> Array:
        """Shares of them in the strength at the edge; (n,)."""
        return np.asarray((-1.0) ** np.arange(self.interactions.shape[-1]))

    def forms(self, x: Array) -> Array:
        """Shares of them in a traction less its strength over x = sqrt(1 - r^2/a^2) > 0; (..., n)."""
        return added_forms(x, self.interactions.shape[-1])

    def between(self, series: Array, low: Array, high: Array) -> Callable[[Array], Array]:
        """A traction less its strength over x at x within limits (case,), of coefficients (case, n).

        series: (case, n), coefficients; low, high: (case,), limits of x.
        """
        return lambda x: np.asarray(np.sum(series * self.forms(x), -1))

    @cached_property
    def coefficients(self) -> Array:
        """a c without the half-space's; (radius, 3, n, 4)."""
        count = self.interactions.shape[-1]
        own = np.einsum("ij,mn->imjn", self.compliance, np.diag(np.pi / 2 / (4 * np.arange(count) + 1)))
        layers = np.moveaxis(self.interactions, 2, 3).reshape(-1, 3 * count, 3 * count)
        right = -layers @ self.halfspace.reshape(3 * count, 4)
        solved = np.linalg.solve(own.reshape(3 * count, 3 * count) + layers, right)
        return np.asarray(solved.reshape(-1, 3, count, 4))
