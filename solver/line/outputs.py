"""Outputs of a contact as linear functionals of the unknowns of its system (films, sections 4 and 5).

Powers of the half-length are taken out: ``P = h load``, displacements ``u = h displacement``, edge intensities
``K = sqrt(h) intensity``. The displacements are means over the contact with weight (1 - X^2)^(3/2), and have the datum
L = b of the kernels.
"""

import numpy as np
from scipy.fft import dct

from solver.arrays import Array
from solver.line.assembly import EDGES, Assembly
from solver.line.basis import log_mean
from solver.line.system import SAMPLES

LOAD = 0  # int p dX
MOMENT = 1  # int X p dX
BALANCE = 2  # constant slope that two smooth edges ask for
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
    """Means of (u_y less that of the punch, phi, psi) / h; (half, 3, unknown)."""
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
    """Chebyshev series in X without its negligible end, by values at ``SAMPLES``, (case, sample, ...)."""
    series = dct(samples, type=1, axis=1) / (samples.shape[1] - 1)
    series[:, [0, -1]] /= 2
    size = np.max(np.abs(series), axis=(0, *range(2, series.ndim)))
    return np.asarray(series[:, : int(np.flatnonzero(size > _NEGLIGIBLE * np.max(size))[-1]) + 1])
