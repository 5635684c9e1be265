"""What a contact is asked for, as linear functionals of the unknowns of its system (films, sections 4 and 5).

Powers of the half-length are taken out: ``P = h load``, displacements ``u = h displacement``, edge intensities
``K = sqrt(h) intensity``. The displacements are means over the contact with weight (1 - X^2)^(3/2), and have the datum
L = b of the kernels.
"""

import numpy as np

from solver.arrays import Array
from solver.film.basis import Basis, log_mean
from solver.film.system import SAMPLES, System

LOAD = 0  # int p dX
MOMENT = 1  # int X p dX
BALANCE = 2  # constant slope that two smooth edges ask for
DISPLACEMENT = slice(3, 6)  # u_y, phi, psi
INTENSITY = slice(6, 10)  # D_y trailing, leading; B_y trailing, leading
EDGE_STRESS = slice(10, 12)  # sigma_xx just outside the trailing and the leading edge, if smooth
PRESSURE = slice(12, 12 + SAMPLES.size)  # p / w at SAMPLES
COUNT = PRESSURE.stop


def outputs(system: System, basis: Basis, half_lengths: Array) -> Array:
    """Every output for every cause; (half, output, cause)."""
    return np.asarray(_functionals(system, basis, half_lengths) @ system.solve(basis, half_lengths))


def _functionals(system: System, basis: Basis, h: Array) -> Array:
    """(half, output, unknown)."""
    rows = np.zeros((h.size, COUNT, system.unknowns(basis)))
    pressures, signs = slice(0, basis.pressures), (-1.0) ** np.arange(basis.terms + 1)
    rows[:, LOAD, 0] = -basis.total
    rows[:, MOMENT, pressures] = -basis.first_moments
    if basis.order == 1:
        rows[:, BALANCE, -1] = 1.0
    rows[:, PRESSURE, pressures] = -basis.pressure_factor(SAMPLES)
    rows[:, DISPLACEMENT] = mean_displacements(system, basis, h)
    for f, start in system.starts(basis).items():
        charges = slice(start, start + basis.terms + 1)
        rows[:, INTENSITY.start + 2 * f, charges] = np.sqrt(np.pi)
        rows[:, INTENSITY.start + 2 * f + 1, charges] = np.sqrt(np.pi) * signs
    rows[:, EDGE_STRESS] = _edge_stress(system, basis, h)
    return rows


def mean_displacements(system: System, basis: Basis, h: Array) -> Array:
    """Means of (u_y, phi, psi) / h; (half, 3, unknown)."""
    c, (points, weights) = system.coefficients, basis.average_rule
    smooth = system.applied(basis, points, h, "displacements")
    rows = np.asarray(np.einsum("p,hopz->hoz", weights, smooth))
    (S, pressed), (X, charged) = basis.pressure_rule, basis.charge_rule
    logarithm = np.log(h / system.kernel.width)[:, None]
    own = log_mean(S) @ pressed + logarithm * (np.arange(basis.pressures) == 0) * basis.total
    along = c.compliance[:, 0] + c.compliance[:, 1:] @ (c.follower * [f in c.fields for f in (0, 1)])
    rows[:, :, : basis.pressures] -= along[:, None] * own[:, None] / np.pi
    rows[:, :, : basis.pressures] += c.friction * c.coupling[:, None] * basis.sign_moments
    for f, start in system.starts(basis).items():
        own = log_mean(X) @ charged + logarithm * (np.arange(basis.terms + 1) == 0) * np.pi
        columns = slice(start, start + basis.terms + 1)
        rows[:, :, columns] -= c.compliance[:, 1 + f, None] * own[:, None] / np.pi
    return rows


def _edge_stress(system: System, basis: Basis, h: Array) -> Array:
    """sigma_xx just outside the edges; (half, 2, unknown)."""
    c, half, scale = system.coefficients, system.sliding.halfplane, system.kernel.stack.scale
    edges = np.array([1.0, -1.0])
    strain = system.applied(basis, edges, h, "gradients")[:, 3]
    strain[..., : basis.pressures] -= c.tangential * c.friction * basis.local(edges)
    return np.asarray(float(half.in_plane_stiffness) * scale[0] ** 2 * strain * np.array(basis.smooth)[:, None])
