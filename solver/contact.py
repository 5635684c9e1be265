"""Contact of a rigid circular punch, conducting in both fields, sliding with friction (theory section 3).

Arrays have the case axes first, aligned so that they broadcast; the fields' axis (electric, magnetic) is last where
there is one. Each attribute has the smallest shape that it needs: the friction angle never sees radius or load.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import exprel

from solver.arrays import Array, dot
from solver.halfplane import HalfPlane


@dataclass(frozen=True, eq=False)
class Contact:
    """Contact under one punch per case.

    Parameters
    ----------
    halfplane
        Surface response of the material.
    friction, radius, load
        Coefficient eta >= 0 [1], punch radius R > 0 [m], normal load P > 0 [N/m].
    charges
        Electric charge T [C/m] and magnetic charge J [Wb/m]; (..., 2).

    Notes
    -----
    With ``tan(theta) = eta kap / lam`` and ``delta = theta / pi = alpha - 1/2`` every expression below is regular at
    ``eta = 0`` and at ``kap = 0``: the theory's factor ``lam / kap`` equals ``eta / tan(theta)`` and multiplies a
    bracket of order delta; the pair is evaluated together.
    """

    halfplane: HalfPlane
    friction: Array
    radius: Array
    load: Array
    charges: Array

    @cached_property
    def screening(self) -> Array:
        """r = M^-1 n: how the conducted fields follow the pressure; (..., 2)."""
        return self._solve_conducted(self.halfplane.compliance[..., 1:, 0])

    @cached_property
    def friction_screening(self) -> Array:
        """d = M^-1 kq: how the conducted fields follow the friction; (..., 2)."""
        return self._solve_conducted(self.halfplane.friction_coupling[..., 1:])

    def _solve_conducted(self, right: Array) -> Array:
        """M^-1 right, with rows and columns brought to order one first (theory section 2)."""
        M = self.halfplane.compliance[..., 1:, 1:]
        scale = 1 / np.sqrt(np.abs(np.diagonal(M, axis1=-2, axis2=-1)))
        scaled = M * scale[..., :, None] * scale[..., None, :]
        return np.asarray(np.linalg.solve(scaled, (scale * right)[..., None])[..., 0] * scale)

    @cached_property
    def lam(self) -> Array:
        """N11 - n.r > 0 [1/Pa]: normal compliance under the conducting punch."""
        N = self.halfplane.compliance
        return N[..., 0, 0] - dot(N[..., 0, 1:], self.screening)

    @cached_property
    def kap(self) -> Array:
        """k1 - n.d [1/Pa]: friction coupling under the conducting punch (negative for the usual materials)."""
        n = self.halfplane.compliance[..., 0, 1:]
        return self.halfplane.friction_coupling[..., 0] - dot(n, self.friction_screening)

    @cached_property
    def tan_theta(self) -> Array:
        """eta kap / lam = -cot(pi alpha)."""
        return self.friction * self.kap / self.lam

    @cached_property
    def cos_theta(self) -> Array:
        """sin(pi alpha)."""
        return 1 / np.hypot(1.0, self.tan_theta)

    @cached_property
    def delta(self) -> Array:
        """alpha - 1/2."""
        return np.arctan(self.tan_theta) / np.pi

    @cached_property
    def delta_over_tan(self) -> Array:
        """delta / tan(theta), 1/pi without friction."""
        return self.cos_theta / (np.pi * np.sinc(self.delta))

    @cached_property
    def log_cos_over_tan(self) -> Array:
        """log(cos theta) / tan(theta), 0 without friction."""
        return -self.tan_theta / (2 * exprel(np.log1p(self.tan_theta**2)))

    @property
    def exponent(self) -> Array:
        """Pressure exponent alpha, 0 < alpha < 1."""
        return 0.5 + self.delta

    @cached_property
    def edge_product(self) -> Array:
        """4 alpha (1 - alpha) = 1 - 4 delta^2."""
        return (1 - 2 * self.delta) * (1 + 2 * self.delta)

    @cached_property
    def half_width(self) -> Array:
        """h = (a + b)/2 [m]."""
        return np.sqrt(2 * self.lam * self.radius * self.load / (np.pi * self.edge_product))

    @property
    def trailing(self) -> Array:
        """a [m]: the trailing edge is x = a."""
        return self.half_width * (1 - 2 * self.delta)

    @property
    def leading(self) -> Array:
        """b [m]: the leading edge is x = -b."""
        return self.half_width * (1 + 2 * self.delta)

    @cached_property
    def pressure_scale(self) -> Array:
        """h / (lam R) [Pa]: the unit of the contact stresses."""
        return self.half_width / (self.lam * self.radius)

    @property
    def peak_pressure(self) -> Array:
        """Largest contact pressure [Pa], at X = -2 delta."""
        alpha = self.exponent
        return 2 * self.cos_theta * alpha**alpha * (1 - alpha) ** (1 - alpha) * self.pressure_scale

    @cached_property
    def charge_density(self) -> Array:
        """Strength e0 of the 1/sqrt(1 - X^2) part of (D_y, B_y) that carries the charges; (..., 2).

        ``e0 = [(-T, -J) - r P] / (pi h)``; the friction part of the theory's e stands in
        ``fields.friction_bracket``.
        """
        width = (np.pi * self.half_width)[..., None]
        return -(self.charges + self.screening * self.load[..., None]) / width

    def edge_intensities(self) -> tuple[Array, Array]:
        """lim sqrt(2 pi r) (D_y, B_y) at the trailing and the leading edge [C m^-3/2, T m^1/2]; each (..., 2)."""

        def at(edge: float) -> Array:
            bracket = 2 * self.delta_over_tan * (edge - self.delta)  # of fields.friction_bracket at X = +-1
            friction_part = (self.friction * bracket * self.pressure_scale)[..., None] * self.friction_screening
            return np.asarray(np.sqrt(np.pi * self.half_width)[..., None] * (friction_part + self.charge_density))

        return at(1.0), at(-1.0)

    def edge_stresses(self) -> tuple[Array, Array]:
        """sigma_xx [Pa] on the free surface just outside the trailing and the leading edge."""
        per_length = self.halfplane.in_plane_stiffness * self.halfplane.tangential_compliance
        slope = per_length * self.friction / (self.lam * self.radius)
        return slope * self.trailing, -slope * self.leading
