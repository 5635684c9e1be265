"""Effective constants of two-phase composites from the full three-dimensional tensors.

Generalised displacement U = (u_1, u_2, u_3, phi, psi), flux S_iJ = L_iJMn U_M,n, poling along axis 3 (index 2); L is a
symmetric 15 x 15 matrix over (i, J) and (n, M). Nothing is taken from the theory's closed forms: the fibre's field
comes from the polarisation tensor of a cylinder, the laminate's from its conditions of continuity.
"""

from collections.abc import Mapping

import numpy as np

from solver.arrays import Array
from solver.material.cuts import generalised_stiffness

_ANGLES = 12  # the integrand of the polarisation tensor has harmonics 0, 2 and 4 only
_UNITS = np.array([1.0, 1.0, 1.0, 1e10, 1e8])  # of U: all constants are of order one with stiffnesses in 1e11 Pa


def fibrous(fibre: Mapping[str, float], host: Mapping[str, float], fraction: float) -> dict[str, float]:
    """Mori-Tanaka: the mean field of the host is what the single fibre of Eshelby's problem sees."""
    L_host = _tensor(host)
    gap = _tensor(fibre) - L_host
    dilute = np.linalg.inv(np.eye(15) + _cylinder_polarisation(L_host) @ gap)
    return _constants(L_host + fraction * gap @ dilute @ np.linalg.inv((1 - fraction) * np.eye(15) + fraction * dilute))


def laminate(first: Mapping[str, float], second: Mapping[str, float], fraction: float) -> dict[str, float]:
    """Layers normal to the poling axis: gradients along them and fluxes across them are common to both phases."""
    upper, lower = _tensor(first), _tensor(second)
    along, across = slice(0, 10), slice(10, 15)
    # unknown: the gradients across the layers in both phases, by a unit mean gradient of each kind
    system = np.block(
        [[fraction * np.eye(5), (1 - fraction) * np.eye(5)], [upper[across, across], -lower[across, across]]]
    )
    mean = np.zeros((10, 15))
    mean[:5, across], mean[5:, along] = np.eye(5), lower[across, along] - upper[across, along]
    fields = np.zeros((2, 15, 15))
    fields[:, along, along] = np.eye(10)
    fields[:, across] = np.linalg.solve(system, mean).reshape(2, 5, 15)
    return _constants(fraction * upper @ fields[0] + (1 - fraction) * lower @ fields[1])


def _tensor(c: Mapping[str, float]) -> Array:
    """L of one phase, scaled."""
    E = generalised_stiffness({"c14": 0.0, "e11": 0.0, "e14": 0.0, "e22": 0.0, **c}, "")
    scaled = _UNITS[:, None, None] * E * _UNITS[:, None] / 1e11
    return np.asarray(scaled.transpose(0, 1, 3, 2).reshape(15, 15))


def _cylinder_polarisation(L: Array) -> Array:
    """Mean over the directions n normal to the axis of n_n n_i (n L n)^-1_MJ."""
    angles = 2 * np.pi * np.arange(_ANGLES) / _ANGLES
    normals = np.stack([np.cos(angles), np.sin(angles), np.zeros(_ANGLES)], -1)
    directions = np.einsum("ai,JK->aiJK", normals, np.eye(5)).reshape(_ANGLES, 15, 5)
    transposed = directions.transpose(0, 2, 1)
    return np.asarray((directions @ np.linalg.inv(transposed @ L @ directions) @ transposed).mean(axis=0))


def _constants(L: Array) -> dict[str, float]:
    """Constants of a transversely isotropic L."""
    E = L.reshape(3, 5, 3, 5) * 1e11 / (_UNITS[:, None, None] * _UNITS)
    c = {"c11": E[0, 0, 0, 0], "c12": E[0, 0, 1, 1], "c13": E[0, 0, 2, 2], "c33": E[2, 2, 2, 2], "c44": E[0, 2, 2, 0]}
    for J, kind in ((3, "e"), (4, "f")):
        c |= {f"{kind}31": E[2, J, 0, 0], f"{kind}33": E[2, J, 2, 2], f"{kind}15": E[0, J, 2, 0]}
    for J, M, kind in ((3, 3, "eps"), (3, 4, "g"), (4, 4, "mu")):
        c |= {f"{kind}11": -E[0, J, 0, M], f"{kind}33": -E[2, J, 2, M]}
    np.testing.assert_allclose(
        _tensor(c), L, atol=1e-11 * np.abs(L).max(), err_msg="the effective tensor lost its symmetry"
    )
    return {name: float(value) for name, value in c.items()}
