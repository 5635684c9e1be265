"""What the surface of a body answers just outside a contact that slides (points, 8)."""

from dataclasses import dataclass, fields

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array
from solver.halfplane.surface import HalfPlane
from solver.point.density import Density

_ANGLES = 60  # nodes of the integrals around the edge


@dataclass(frozen=True, eq=False)
class Rim:
    """What the surface of the top answers beside the contact, SI; (case,) each, or of one body."""

    coupling: Array  # k of the body; (..., 3)
    # C11 = c11 - h T3^-1 h, and c11 - c12 [Pa]
    stiffness: Array
    shear: Array
    share: Array  # h T3^-1; (..., 3)
    # (L^-1)_xx, and 1 / sqrt(c44 c66) [1/Pa]
    tangential: Array
    transverse: Array

    @classmethod
    def of(cls, half: HalfPlane) -> "Rim":
        """Of a material with c12."""
        m = half.material
        shear = np.asarray(m.c11 - m.c12)
        transverse = 1 / np.sqrt(m.c44 * shear / 2)
        of_body = half.friction_coupling, half.in_plane_stiffness, shear, half.in_plane_share
        return cls(*of_body, half.tangential_compliance, transverse)

    def part(self, cases: Indices | int) -> "Rim":
        """Those of some cases, or the one body."""
        if self.coupling.ndim == 1:
            return self
        return Rim(*(getattr(self, field.name)[cases] for field in fields(self)))

    def tension(self, moments: Array, rubbed: tuple[Array, Array]) -> Array:
        """sigma_xx at the trailing edge of a half-space whose tractions lie below the contact [Pa]; (...).

        moments: (..., 3), int_0^1 (t s + t_1 s^2) ds of (sigma_yy, D_y, B_y) below the contact, SI; rubbed:
        (ndarray, ndarray), shape (...) each, eta times I_1 and I_3 of :func:`edge_sums`, SI.
        """
        first, third = rubbed
        along, across = self.tangential, self.transverse * self.shear / 4
        found = self.shear * np.einsum("...i,...i->...", self.coupling, moments)
        found = found - (along * (self.stiffness - self.shear / 4) + across) * first
        return np.asarray(found + (along * self.shear / 4 - across) * third)

    def charged(self, beside: Array) -> Array:
        """What charges that the surface carries just outside the edge add to it [Pa]; (...).

        beside: (..., 3), (0, D_y, B_y), SI.
        """
        return np.asarray(np.einsum("...i,...i->...", self.share - self.stiffness[..., None] * self.coupling, beside))


def edge_sums(pressed: Density) -> tuple[Array, Array]:
    """I_n = -int_0^(pi/2) phi_sigma'(sin angle) sin(n angle) d angle, n of 1 and 3; (column,) each."""
    x, w = np.polynomial.legendre.leggauss(_ANGLES)
    angle, weights = np.pi / 4 * (1 + x), np.pi / 4 * w
    falling = pressed.falling(np.sin(angle))[:, 0]
    return falling @ (np.sin(angle) * weights), falling @ (np.sin(3 * angle) * weights)
