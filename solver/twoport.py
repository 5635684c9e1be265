"""A contact as a two-port between force and charge of one field, and depth and potential.

Along a line the compliance is at fixed charges, at a point the stiffness is at fixed potentials. Quantities per volt
are therefore at a fixed magnetic charge along a line, at a fixed magnetic potential at a point.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np

from solver.arrays import Array, outer


@dataclass(frozen=True, eq=False)
class Compliance:
    """Derivatives of depth and potential by force and charge of a field at a fixed other charge; (...) each."""

    depth_by_force: Array
    depth_by_charge: Array
    potential_by_force: Array
    potential_by_charge: Array

    @classmethod
    def of(cls, matrix: Array, field: int) -> Self:
        """Return the electric (0) or magnetic (1) compliance of d (depth, V, Psi) / d (P, T, J) (..., 3, 3)."""
        j = 1 + field
        return cls(matrix[..., 0, 0], matrix[..., 0, j], matrix[..., j, 0], matrix[..., j, j])

    @property
    def stroke(self) -> Array:
        """Depth per potential at fixed force; (...)."""
        return np.asarray(self.depth_by_charge / self.potential_by_charge)

    @property
    def blocked_force(self) -> Array:
        """Force per potential at fixed depth; (...)."""
        cross = self.potential_by_force * self.depth_by_charge
        return np.asarray(self.depth_by_charge / (cross - self.potential_by_charge * self.depth_by_force))

    @property
    def capacitance(self) -> Array:
        """Charge per potential at fixed force; (...)."""
        return np.asarray(1 / self.potential_by_charge)


@dataclass(frozen=True, eq=False)
class Stiffness:
    """Stiffness -d (P, T, J) / d (-depth, V, Psi) of the conducted fields, SI."""

    matrix: Array  # (..., n, n)

    @classmethod
    def of(cls, compliance: Array) -> Self:
        """Return the stiffness of a compliance -d (-depth, V, Psi) / d (P, T, J) (..., n, n)."""
        return cls(_inverse(compliance))

    @property
    def compliance(self) -> Array:
        """Compliance -d (-depth, V, Psi) / d (P, T, J); (..., n, n)."""
        return _inverse(self.matrix)

    @property
    def closed(self) -> Array:
        """Force per depth at fixed potentials; (...)."""
        return self.matrix[..., 0, 0]

    @property
    def open(self) -> Array:
        """Force per depth at fixed charges; (...)."""
        return np.asarray(1 / self.compliance[..., 0, 0])

    def potential_per_force(self, j: int) -> Array:
        """Potential of row j per force at fixed charges; (...)."""
        return -self.compliance[..., j, 0]

    def stroke(self, j: int) -> Array:
        """Depth per potential of row j at fixed force; (...)."""
        return np.asarray(self.matrix[..., 0, j] / self.matrix[..., 0, 0])

    def blocked_force(self, j: int) -> Array:
        """Force per potential of row j at fixed depth; (...)."""
        return -self.matrix[..., 0, j]

    def capacitance(self, j: int) -> Array:
        """Charge per potential of row j at fixed force; (...)."""
        moved = self.matrix[..., j, 0] * self.matrix[..., 0, j] / self.matrix[..., 0, 0]
        return np.asarray(moved - self.matrix[..., j, j])


def _inverse(matrix: Array) -> Array:
    """Invert a matrix, scaled to the order of one since units differ by 1e20; (..., n, n)."""
    scales = outer(1 / np.sqrt(np.abs(np.linalg.diagonal(matrix))))
    return np.asarray(np.linalg.inv(matrix * scales) * scales)
