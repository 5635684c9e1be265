"""What the surface of a body answers just outside a contact that slides (points, 8)."""

from dataclasses import dataclass

import numpy as np

from solver.arrays import Array
from solver.halfplane.surface import HalfPlane


@dataclass(frozen=True, eq=False)
class Rim:
    """What the surface of the top answers beside the contact, SI; (case,) each, or of one body.

    Attributes
    ----------
    coupling
        k of the body; (..., 3).
    stiffness, shear
        C11 = c11 - h T3^-1 h, and c11 - c12 [Pa].
    tangential, transverse
        (L^-1)_xx, and 1 / sqrt(c44 c66) [1/Pa].
    """

    coupling: Array
    stiffness: Array
    shear: Array
    tangential: Array
    transverse: Array

    @classmethod
    def of(cls, half: HalfPlane) -> "Rim":
        """Of a material with c12."""
        m = half.material
        shear = np.asarray(m.c11 - m.c12)
        transverse = 1 / np.sqrt(m.c44 * shear / 2)
        return cls(half.friction_coupling, half.in_plane_stiffness, shear, half.tangential_compliance, transverse)
