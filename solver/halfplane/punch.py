"""The elasticity of the punch: what an isotropic half-plane above adds to the contact conditions (theory section 9)."""

from dataclasses import dataclass, field
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from solver.arrays import Array


@dataclass(frozen=True, eq=False)
class Punch:
    """An elastic punch over the case axes (...); by default a rigid one."""

    compliance: Array = field(default_factory=lambda: np.zeros(()))
    coupling: Array = field(default_factory=lambda: np.zeros(()))

    @classmethod
    def isotropic(cls, young: ArrayLike, poisson: ArrayLike) -> Self:
        """The punch of an isotropic material."""
        E, nu = np.asarray(young, dtype=np.float64), np.asarray(poisson, dtype=np.float64)
        return cls(2 * (1 - nu**2) / E, -(1 + nu) * (1 - 2 * nu) / E)


#: A punch that does not deform.
RIGID_PUNCH = Punch()
