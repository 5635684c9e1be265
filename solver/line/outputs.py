"""Kernels applied to the basis of the tractions, and outputs as linear functionals of a contact's unknowns.

Powers of the half-length are divided out: ``P = h load``, ``u = h displacement``, ``K = sqrt(h) intensity``.
Displacements are the means of films, section 5, with the datum L = b of the kernels.
"""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.fft import dct

from solver.arrays import Array
from solver.line.basis import Basis, log_mean
from solver.line.kernel import CHANNEL, POTENTIAL, POTENTIAL_SHEAR, SHEAR, TANGENTIAL
from solver.line.system import SAMPLES, System

EDGES = np.array([1.0, -1.0])


@dataclass(frozen=True, eq=False)
class Assembly:
    """Integrals of kernels against the basis of one system, at half-lengths (half,) and points X (point,)."""

    system: System
    basis: Basis
    half_lengths: Array
    points: Array = field(default_factory=lambda: EDGES)

    @cached_property
    def unknowns(self) -> Array:
        """Solution of the system for every cause; (half, unknown, cause)."""
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
        """Gradients at nodes and points (half, 4, M + point, unknown), and mean displacements (half, 3, unknown)."""
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
        """Unknowns, quadrature nodes, rule and (sigma_yy, D_y, B_y) carried, by the pressure and by each field."""
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


LOAD = 0  # int p dX
MOMENT = 1  # int X p dX
BALANCE = 2  # constant slope that two smooth edges require
DISPLACEMENT = slice(3, 6)  # u_y, phi, psi
INTENSITY = slice(6, 10)  # D_y trailing, leading; B_y trailing, leading
EDGE_STRESS = slice(10, 12)  # sigma_xx just outside the trailing and the leading edge, if smooth
PRESSURE = slice(12, 12 + SAMPLES.size)  # p / w at SAMPLES
COUNT = PRESSURE.stop

_NEGLIGIBLE = 1e-13  # of the largest coefficient of the pressure


def outputs(assembly: Assembly) -> Array:
    """Every output for every cause; (half, output, cause)."""
    return np.asarray(functionals(assembly) @ assembly.unknowns)


def functionals(assembly: Assembly) -> Array:
    """Outputs per unknown; (half, output, unknown)."""
    system, basis = assembly.system, assembly.basis
    rows = np.zeros((assembly.half_lengths.size, COUNT, system.unknowns(basis)))
    pressures, signs = slice(0, basis.pressures), (-1.0) ** np.arange(basis.terms + 1)
    rows[:, LOAD, 0] = -basis.total
    rows[:, MOMENT, pressures] = -basis.first_moments
    if basis.order == 1:
        rows[:, BALANCE, -1] = 1.0
    rows[:, PRESSURE, pressures] = -basis.pressure_factor(SAMPLES)
    rows[:, DISPLACEMENT] = _displacements(assembly)
    for f, start in system.starts(basis).items():
        charges = slice(start, start + basis.terms + 1)
        rows[:, INTENSITY.start + 2 * f, charges] = np.sqrt(np.pi)
        rows[:, INTENSITY.start + 2 * f + 1, charges] = np.sqrt(np.pi) * signs
    rows[:, EDGE_STRESS] = _edge_stress(assembly)
    return rows


def _displacements(assembly: Assembly) -> Array:
    """Means of (u_y minus that of the punch, phi, psi) / h; (half, 3, unknown)."""
    system, basis = assembly.system, assembly.basis
    c = system.coefficients
    logarithm = np.log(assembly.half_lengths / system.kernel.width)[:, None, None]
    rows = np.array(assembly.displacements)
    compliance, coupling = np.array(c.compliance), np.array(c.coupling)
    compliance[0, 0] += c.punch[0]
    coupling[0] += c.punch[1]
    for columns, nodes, rule, carried in assembly.sources():
        logarithms = log_mean(nodes) @ rule + logarithm * rule.sum(0)
        rows[..., columns] -= (compliance @ carried)[:, None] * logarithms / np.pi
    rows[..., : basis.pressures] += c.friction * coupling[:, None] * basis.sign_moments
    return rows


def _edge_stress(assembly: Assembly) -> Array:
    """sigma_xx just outside the edges; (half, 2, unknown)."""
    system, basis = assembly.system, assembly.basis
    c, half, scale = system.coefficients, system.sliding.halfplane, system.kernel.stack.scale
    strain = np.array(assembly.gradients[:, 3])
    strain[..., : basis.pressures] -= c.tangential * c.friction * basis.local(EDGES)
    return np.asarray(float(half.in_plane_stiffness) * scale[0] ** 2 * strain * np.array(basis.smooth)[:, None])


def pressure_series(samples: Array) -> Array:
    """Chebyshev series in X, without negligible last terms, of samples at ``SAMPLES`` (case, sample, ...)."""
    series = dct(samples, type=1, axis=1) / (samples.shape[1] - 1)
    series[:, [0, -1]] /= 2
    size = np.max(np.abs(series), axis=(0, *range(2, series.ndim)))
    return np.asarray(series[:, : int(np.flatnonzero(size > _NEGLIGIBLE * np.max(size))[-1]) + 1])
