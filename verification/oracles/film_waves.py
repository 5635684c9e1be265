"""Responses over (y, phi) of half-spaces and of a bonded film, by a matrix exponential in wavenumber space.

Units are of order one: displacements and potentials over ``UNITS``, tractions and charges times ``UNITS / STIFFNESS``.
"""

from collections.abc import Mapping

import numpy as np
from scipy.linalg import expm

from verification.oracles.surface_response import STIFFNESS, UNITS, Array, surface_response

_DEEP = 18.0  # wavenumber times the thickness from which a film is its half-space
_PHASE = 25.0  # of a piece of an integral over Bessel functions, and its nodes
_FINE = 16
_PHI = 2  # of (u_x, u_y, phi, psi)


def half_space(material: Mapping[str, float]) -> tuple[Array, Array]:
    """N over (y, phi) and k; (2, 2) and (2,)."""
    half, units = surface_response(material), UNITS[1:3]
    scale = STIFFNESS / units
    return half.normal_compliance[:2, :2] * scale[:, None] / units, half.shear_coupling[:2] * scale


def film(
    material: Mapping[str, float], thickness: float, farthest: float, base: Mapping[str, float] | None = None
) -> tuple[Array, Array, Array]:
    """Wavenumbers, weights, and what a film adds to N and k there; (q,), (q,), (q, 2, 3)."""
    q, weights = pieces(0.0, _DEEP / thickness, farthest)
    half, scale = surface_response(material), UNITS[:, None] * UNITS / STIFFNESS
    Q, R, T = (part * scale for part in (half.Q, half.R, half.T))
    (N, k), inverse = half_space(material), np.linalg.inv(T)
    # of exp(i k x): u' = T^-1 (t - i k R^T u), t' = k^2 Q u - i k R u', u and t / k of one size
    system = np.block([[-1j * inverse @ R.T, inverse], [Q - R @ inverse @ R.T, -1j * R @ inverse]])
    below = np.zeros((4, 4)) if base is None else _grounded(base)
    added = np.empty((q.size, 2, 3))
    for number, wave in enumerate(q * thickness):
        whole = expm(wave * system)
        (of_u, of_t), (t_of_u, t_of_t) = (np.split(rows, 2, axis=1) for rows in np.split(whole, 2))
        answer = (of_u @ below + of_t) @ np.linalg.inv(t_of_u @ below + t_of_t)  # k u per t at the surface
        added[number, :, :2] = answer[1:3, 1:3].real - N
        added[number, :, 2] = -answer[1:3, 0].imag - k
    return q, weights, added


def _grounded(material: Mapping[str, float]) -> Array:
    """K u per t of a half-space whose surface is an electrode at zero volts; (4, 4), complex."""
    half = surface_response(material)
    whole = (half.compliance - 1j * half.local) * STIFFNESS / (UNITS[:, None] * UNITS)
    return np.asarray(whole - np.outer(whole[:, _PHI], whole[_PHI]) / whole[_PHI, _PHI])


def pieces(low: float, high: float, rate: float) -> tuple[Array, Array]:
    """Nodes and weights between two ends, for what turns at a rate."""
    x, w = np.polynomial.legendre.leggauss(_FINE)
    ends = np.linspace(low, high, 2 + int((high - low) * rate / _PHASE))
    half = np.diff(ends)[:, None] / 2
    return (ends[:-1, None] + half * (1 + x)).ravel(), (half * w).ravel()
