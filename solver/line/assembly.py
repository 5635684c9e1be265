"""The smooth kernels applied to the basis of the tractions, at many half-lengths at once (films, section 4)."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from solver.arrays import Array
from solver.line.basis import Basis
from solver.line.kernel import CHANNEL, POTENTIAL, POTENTIAL_SHEAR, SHEAR, TANGENTIAL
from solver.line.system import System

EDGES = np.array([1.0, -1.0])


@dataclass(frozen=True, eq=False)
class Assembly:
    """Integrals of kernels against the basis of one system at half-lengths of like size."""

    system: System
    basis: Basis
    half_lengths: Array
    points: Array = field(default_factory=lambda: EDGES)

    @cached_property
    def unknowns(self) -> Array:
        """Unknowns for every cause; (half, unknown, cause)."""
        return self.system.solve(self.basis, self.at_nodes)

    @property
    def at_nodes(self) -> Array:
        """du/dx of (y, phi, psi) at the collocation nodes, by the smooth kernels; (half, 3, M, unknown)."""
        return self._integrals[0][:, :3, : self.basis.terms]

    @property
    def gradients(self) -> Array:
        """du/dx of (y, phi, psi, x) at the points; (half, 4, point, unknown)."""
        return self._integrals[0][:, :, self.basis.terms :]

    @property
    def displacements(self) -> Array:
        """Means of u / h of (y, phi, psi) with weight (1 - X^2)^(3/2); (half, 3, unknown)."""
        return self._integrals[1]

    @cached_property
    def _integrals(self) -> tuple[Array, Array]:
        points = np.concatenate([self.basis.nodes, self.points])
        size = self.half_lengths.size
        gradients = np.zeros((size, 4, points.size, self.system.unknowns(self.basis)))
        displacements = np.zeros((size, 3, self.system.unknowns(self.basis)))
        for columns, nodes, rule, carried in self.sources():
            distances = self.half_lengths[:, None, None] * (points[:, None] - nodes)
            kernels = self.system.kernel.at(distances, mixing(self.system.coefficients.friction, carried))
            # (half, 4, point, node), contiguous: matrices that are not are multiplied without BLAS
            slopes = np.ascontiguousarray(np.moveaxis(kernels[..., :4], -1, 1))
            gradients[..., columns] = self.half_lengths[:, None, None, None] * (slopes @ rule)
            mean = np.tensordot(self.basis.mean, kernels[:, : self.basis.terms, :, 4:], (0, 1))
            displacements[..., columns] = np.swapaxes(mean, 1, 2) @ rule
        return gradients, displacements

    def sources(self) -> list[tuple[slice, Array, Array, Array]]:
        """Unknowns, quadrature nodes, rule and (sigma_yy, D_y, B_y) carried, of the pressure and of each field."""
        basis, c = self.basis, self.system.coefficients
        carried = np.concatenate([[1.0], c.follower * [f in c.fields for f in (0, 1)]])
        rules = [(slice(0, basis.pressures), *basis.pressure_rule, carried)]
        for f, start in self.system.starts(basis).items():
            rules.append((slice(start, start + basis.terms + 1), *basis.charge_rule, np.eye(3)[1 + f]))
        return rules


def mixing(friction: float, carried: Array) -> Array:
    """Matrix from the kernel's channels to du/dx of (y, phi, psi, x), then u of (y, phi, psi); (19, 7)."""
    matrix = np.zeros((19, 7))
    shear = friction * carried[0]
    for o in range(3):
        for source in range(3):
            matrix[CHANNEL[o, source], o] += carried[source]
            matrix[POTENTIAL[o, source], 4 + o] += carried[source]
        matrix[SHEAR[o], o] += shear
        matrix[POTENTIAL_SHEAR[o], 4 + o] += shear
        matrix[SHEAR[o], 3] -= carried[o]
    matrix[TANGENTIAL, 3] += shear
    return matrix
