"""Contact of a punch sliding with friction on a half-plane: extent, pressure scale, edge values (theory, 3 and 4).

Case axes come first and broadcast, an axis of the fields (electric, magnetic) comes last. Each attribute has the
smallest shape that it needs: the friction angle does not depend on radius or load.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array, power_series
from solver.halfplane.peakpressure import largest
from solver.halfplane.pressing import Pressing, press
from solver.halfplane.profile import Profile
from solver.halfplane.shape import Shape, chebyshev_of_powers
from solver.halfplane.sliding import FrictionAngle, Sliding
from solver.halfplane.surface import HalfPlane


@dataclass(frozen=True, eq=False)
class Contact:
    """Contact under one punch per case, with S and D of :mod:`solver.halfplane.shape` and s = ``slope_scale``.

    lam sigma_yy = s S,    (D_y, B_y) = (s / lam) (eta d D - r S) + e0 / sqrt(1 - X^2).
    """

    sliding: Sliding
    profile: Profile
    load: Array  # P [N/m]; (...)
    charges: Array  # T [C/m] and J [Wb/m]; (..., 2)

    @property
    def halfplane(self) -> HalfPlane:
        """Surface response of the material."""
        return self.sliding.halfplane

    @property
    def friction(self) -> Array:
        """Coulomb coefficient eta [1]."""
        return self.sliding.friction

    @property
    def angle(self) -> FrictionAngle:
        """Friction angle theta."""
        return self.sliding.angle

    @cached_property
    def pressing(self) -> Pressing:
        """Extent of the contact and shape of the pressure."""
        return press(self.profile, self.angle, self.sliding.lam, self.load)

    @property
    def shape(self) -> Shape:
        """Pressure S, follower D and their transforms."""
        return self.pressing.shape

    @property
    def exponent(self) -> Array:
        """Pressure exponent alpha, 0 < alpha < 1."""
        return 0.5 + self.angle.delta

    @property
    def half_width(self) -> Array:
        """Half-width h = (a + b)/2 [m]."""
        return self.pressing.half_width

    @property
    def trailing(self) -> Array:
        """Position x = a of the trailing edge [m]."""
        return self.half_width * (1 + self.pressing.centre)

    @property
    def leading(self) -> Array:
        """Distance b of the leading edge x = -b [m]."""
        return self.half_width * (1 - self.pressing.centre)

    @cached_property
    def pressure_scale(self) -> Array:
        """Unit s / lam of the contact stresses [Pa]."""
        return self.pressing.slope_scale / self.sliding.lam

    @cached_property
    def peak_pressure(self) -> Array:
        """Largest contact pressure between two smooth edges [Pa]; (...)."""
        factor, delta = -self.shape.factor, self.angle.delta
        if factor.shape[-1] == 1:  # the maximum is at X = -2 delta
            weight = np.sqrt((1 - 2 * delta) * (1 + 2 * delta)) * np.exp(2 * delta * np.arctanh(2 * delta))
            return np.asarray(self.pressure_scale * self.angle.cos * weight * factor[..., 0])
        shape = np.broadcast_shapes(factor.shape[:-1], delta.shape)
        series = np.broadcast_to(factor @ chebyshev_of_powers(factor.shape[-1]), (*shape, factor.shape[-1]))
        peaks = largest(series.reshape(-1, factor.shape[-1]), 0.5 + np.broadcast_to(delta, shape).ravel())
        return np.asarray(self.pressure_scale * self.angle.cos * peaks.reshape(shape))

    @cached_property
    def charge_density(self) -> Array:
        """Strength e0 = [(-T, -J) - r P] / (pi h) of the 1/sqrt(1 - X^2) part of (D_y, B_y); (..., 2)."""
        # the friction part of e (theory, 3.4) is in D
        width, screening = np.pi * self.half_width, self.sliding.screening
        return _by_field(*(-(self.charges[..., j] + screening[..., j] * self.load) / width for j in range(2)))

    @cached_property
    def relative_charge_density(self) -> Array:
        """e0 over the pressure scale, of the pressure's small shape if there are no charges; (..., 2)."""
        carried = -self.shape.total[..., None] * self.sliding.screening  # r P / (h pressure_scale)
        if np.any(self.charges):
            carried = carried + self.charges / (self.half_width * self.pressure_scale)[..., None]
        return -carried / np.pi

    def edge_intensity(self, edge: float) -> Array:
        """Edge intensities lim sqrt(2 pi r) (D_y, B_y) [C m^-3/2, T m^1/2] at a smooth edge X = 1 or -1; (..., 2)."""
        follower = self.friction * self.shape.follower_at(edge) * self.pressure_scale
        root, screening = np.sqrt(np.pi * self.half_width), self.sliding.friction_screening
        return _by_field(*(root * (follower * screening[..., j] + self.charge_density[..., j]) for j in range(2)))

    def edge_stress(self, edge: float) -> Array:
        """Stress sigma_xx on the free surface just outside a smooth edge X = 1 or -1 [Pa]; (...)."""
        slope = power_series(self.pressing.slope, np.array([edge]))[..., 0]
        per_slope = self.halfplane.in_plane_stiffness * self.halfplane.tangential_compliance * self.friction
        return per_slope * self.pressure_scale * slope


def _by_field(electric: Array, magnetic: Array) -> Array:
    """Stack the values of both fields along the last axis, with cases contiguous in memory; (..., 2)."""
    return np.moveaxis(np.stack(np.broadcast_arrays(electric, magnetic)), 0, -1)
