"""The smooth kernels applied to the basis of the tractions, at many half-lengths at once (films, section 4)."""

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from scipy.special import exp1, jv

from solver.arrays import Array
from solver.line.basis import Basis
from solver.line.kernel import CHANNEL, POTENTIAL, POTENTIAL_SHEAR, SHEAR, TANGENTIAL
from solver.line.rough import Rough, weights
from solver.line.system import System
from solver.stack.electroded import lowest, surface
from solver.stack.grading import GradedResponse
from solver.stack.wavenumbers import wavenumbers

EDGES = np.array([1.0, -1.0])

_FAR = 300.0  # k h at which the means of a graded layer end: they decay like (k h)^-5


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
        rough = None if self._rough is None else (self._rough[0], self._rough[1][:, :, : self.basis.terms])
        return self.system.solve(self.basis, self.at_nodes, rough)

    @property
    def at_nodes(self) -> Array:
        """du/dx of (y, phi, psi) at the collocation nodes, by the smooth kernels; (half, 3, M, unknown)."""
        return self._integrals[0][:, :3, : self.basis.terms]

    @property
    def gradients(self) -> Array:
        """du/dx of (y, phi, psi, x) at the points; (half, 4, point, unknown)."""
        at_points = self._integrals[0][:, :, self.basis.terms :]
        return at_points if self._rough is None else at_points + self._rough[2]

    @property
    def beyond(self) -> tuple[Array, Array] | None:
        """Terms beyond M by the equations, at X = 1 and -1; None if the top layer is homogeneous.

        Sums of c_n T_n for n > M, (half, field, 2, unknown), and of the right sides s_j of (eta kap + lam H), (half,
        2, unknown): near an edge rough kernels leave terms that fall slowly.
        """
        if self._rough is None:
            return None
        system, M = self.system, self.basis.terms
        series = system.eliminated(self._rough[1])[1]
        signs = np.stack([np.ones(M), (-1.0) ** np.arange(1, M + 1)])
        rows = system.eliminated(self._rough[0])[0], system.eliminated(self._rough[2][:, :3])[0]
        return signs @ series[:, :, :M] - series[:, :, M:], rows[1] - self.basis.dual(EDGES, M).T @ rows[0]

    @property
    def displacements(self) -> Array:
        """Means of u / h of (y, phi, psi) with weight (1 - X^2)^(3/2); (half, 3, unknown)."""
        graded = self.system.kernel.graded
        return self._integrals[1] if graded is None else self._means(graded)

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

    @cached_property
    def _rough(self) -> tuple[Array, Array, Array] | None:
        """Integrals of the rough kernels with each unknown: projected onto P^(-A,-B), onto U, and at the points."""
        graded, h, system = self.system.kernel.graded, self.half_lengths, self.system
        if graded is None:
            return None
        rough = Rough(self.basis)
        at_points = rough.at(self.points)
        size = (h.size, 4, self.basis.terms, system.unknowns(self.basis))
        summed = (*size[:2], self.basis.terms + 2, size[3])
        out = np.zeros(size), np.zeros(summed), np.zeros((*size[:2], self.points.size, size[3]))
        for columns, _, _, carried in self.sources():
            share = weights(graded.tails, system.coefficients.friction, carried, h)
            which = 0 if columns.start == 0 else 1
            for whole, integrals in zip(out, (*rough.projected[which], at_points[which]), strict=True):
                whole[..., columns] = np.tensordot(share, integrals, 1)
        return out[0][:, :3], out[1][:, :3], out[2]

    def _means(self, graded: GradedResponse) -> Array:
        """Displacements under a graded layer in Fourier space (films, section 5); (half, 3, unknown)."""
        system, width = self.system, self.system.kernel.width
        stack, friction = system.kernel.stack, system.coefficients.friction
        regular = (surface(stack) - lowest(stack))[1:, 1:]
        out = np.zeros((self.half_lengths.size, 3, system.unknowns(self.basis)))
        fine = replace(self.basis, samples=max(self.basis.samples, self.basis.terms + int(_FAR / 2) + 20))
        sources = replace(self, basis=fine).sources()
        for number, h in enumerate(self.half_lengths):
            k, weight = wavenumbers(stack, 2 * h, 34 * h / _FAR)
            difference = (weight / k)[:, None, None] * graded.difference(k)
            averaged = difference * (8 * jv(2, k * h) / (k * h) ** 2)[:, None, None]
            datum = float(weight / k @ np.exp(-k * width)) + float(exp1(_FAR / h * width))
            for columns, nodes, rule, carried in sources:
                phase = k[:, None] * h * nodes
                mean = np.einsum("koj,j,kz->oz", averaged[:, 1:, 1:], carried, np.cos(phase) @ rule)
                mean += friction * carried[0] * np.einsum("ko,kz->oz", averaged[:, 1:, 0], np.sin(phase) @ rule)
                mean += datum * (regular @ carried)[:, None] * rule.sum(0)
                out[number][:, columns] = mean / np.pi
        return out

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
