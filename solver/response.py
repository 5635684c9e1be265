"""Punch response (depth, potentials) and the sensor and actuator tangents (theory section 6), in closed form.

With ell = log(h / 2L) and kappa = (k1, k_phi, k_psi) the generalised surface displacement at the trailing edge is

    u_J(a) = P (N_J1 ell / pi + B_J) + (N_Jq . (T, J)) ell / pi,        J in (u_y, phi, psi),
    B_J = [lam_J (1/2 + delta Psi) - eta (N_Jq . d) omega] / pi - eta kappa_J / 2,

with lam_J = (lam, 0, 0), N_Jq . d = (k1 - kap, k_phi, k_psi), Psi = [digamma(3/2 + delta) - digamma(3/2)] / delta and
omega = (delta / tan theta) [2 (delta - 2) / (1 - 4 delta^2) - Psi]: the logarithmic moments of the theory, gathered so
that nothing cancels and neither eta = 0 nor kap = 0 is a special case.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array, dot
from solver.contact import Contact
from solver.special import digamma_difference


@dataclass(frozen=True, eq=False)
class Response:
    """Response of the punch; scalars per case, shapes as small as each needs.

    Parameters
    ----------
    contact
        The solved contact.
    datum
        Reference length L > 0 of the logarithmic potentials [m].
    """

    contact: Contact
    datum: Array

    @cached_property
    def log_width(self) -> Array:
        """ell = log(h / 2L)."""
        return np.log(self.contact.half_width / (2 * self.datum))

    @cached_property
    def _load_constant(self) -> Array:
        """B_J; (..., 3)."""
        c = self.contact
        psi = digamma_difference(c.delta)
        omega = c.delta_over_tan * (2 * (c.delta - 2) / c.edge_product - psi)
        k = c.halfplane.friction_coupling
        along = np.stack(np.broadcast_arrays(k[..., 0] - c.kap, k[..., 1], k[..., 2]), -1)
        followed = c.lam * (0.5 + c.delta * psi) / np.pi
        friction_part = along * omega[..., None] / np.pi + k / 2
        return np.asarray(followed[..., None] * np.array([1.0, 0.0, 0.0]) - c.friction[..., None] * friction_part)

    def _displacement(self, J: int) -> Array:
        """u_J(a)."""
        c, N = self.contact, self.contact.halfplane.compliance
        charge_part = dot(N[..., J, 1:], c.charges) / np.pi
        return np.asarray(self._load_part(J) * c.load + charge_part * self.log_width)

    def _load_part(self, J: int) -> Array:
        """u_J(a) / P without charges."""
        N = self.contact.halfplane.compliance
        return N[..., J, 0] / np.pi * self.log_width + self._load_constant[..., J]

    def _load_tangent(self, J: int, *, charged: bool) -> Array:
        """d u_J(a) / dP, with or without the charges of the case."""
        c, N = self.contact, self.contact.halfplane.compliance
        tangent = self._load_part(J) + N[..., J, 0] / (2 * np.pi)
        if charged:
            tangent = tangent + dot(N[..., J, 1:], c.charges) / (2 * np.pi * c.load)
        return tangent

    @property
    def depth(self) -> Array:
        """a^2 / 2R - u_y(a): approach of the punch relative to the datum [m]."""
        return self.contact.trailing**2 / (2 * self.contact.radius) - self._displacement(0)

    @cached_property
    def _depth_tangent(self) -> Array:
        """d depth / dP at fixed charges [m2/N]."""
        c = self.contact
        return c.trailing**2 / (2 * c.radius * c.load) - self._load_tangent(0, charged=True)

    def potential(self, field: int) -> Array:
        """Electric [V] (field 0) or magnetic [A] (field 1) potential of the punch relative to the datum."""
        return self._displacement(1 + field)

    def sensitivity(self, field: int) -> Array:
        """d potential / d load without charges [V m/N, A m/N]."""
        return self._load_tangent(1 + field, charged=False)

    def short_circuit(self, field: int) -> Array:
        """Charge per load that makes the potential 0, the other charge 0 [C/N, Wb/N]."""
        N = self.contact.halfplane.compliance
        return -np.pi * self._load_part(1 + field) / (N[..., 1 + field, 1 + field] * self.log_width)

    def stroke(self, field: int) -> Array:
        """(d depth/d charge) / (d potential/d charge) at fixed load [m/V, m/A]; a constant of the material."""
        N = self.contact.halfplane.compliance
        return -N[..., 0, 1 + field] / N[..., 1 + field, 1 + field]

    def blocked_load(self, field: int) -> Array:
        """d load / d potential at fixed depth and other charge [N/(m V), N/(m A)]."""
        N = self.contact.halfplane.compliance
        cross, own = N[..., 0, 1 + field], N[..., 1 + field, 1 + field]
        return cross / (self._load_tangent(1 + field, charged=True) * cross + own * self._depth_tangent)
