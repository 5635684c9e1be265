"""One material in Fourier space: real 8 x 8 form, no eigenvectors (films, section 1).

A wave ``f(y) exp(i k x)``, k > 0, of generalised displacement u and traction t = (sigma_xy, sigma_yy, D_y, B_y), its
x-components multiplied by i, obeys the real system

    d/dy [k u; t] = k [[W^T, T^-1], [Q_s, -W]] [k u; t],   W = S R T^-1,  Q_s = Q - R T^-1 R^T,  S = diag(-1, 1, 1, 1).

What decays downwards in the half-plane y < 0 has ``k u = Y t`` and ``t(y) = exp(k G y) t(0)``, ``G = Q_s Y - W``. The
body turned upside down has S Y S and S G S.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array, ComplexArray
from solver.halfplane.spectrum import spectrum
from solver.halfplane.surface import HalfPlane
from solver.material.constants import Material

#: The mirror y -> -y on (x, y, phi, psi), as a matrix and as the signs of a matrix's entries.
MIRROR = np.diag([-1.0, 1.0, 1.0, 1.0])
FLIP = np.outer(np.diag(MIRROR), np.diag(MIRROR))

_WELL_CONDITIONED = 1e3  # eigenvectors lose three digits there; beyond it the series is used
_DEGREE = 11  # of the Taylor polynomial, at a norm of 1/2: 2^-12 / 12! is below rounding


@dataclass(frozen=True, eq=False)
class Medium:
    """A material in the units of a stack; arrays carry the material's case axes first."""

    material: Material
    scale: Array

    @cached_property
    def halfplane(self) -> HalfPlane:
        """The half-plane of this material."""
        return HalfPlane(self.material)

    @cached_property
    def compliance(self) -> Array:
        """Y of ``k u = Y t``, symmetric; (..., 4, 4)."""
        half = self.halfplane
        N, k = half.compliance, half.friction_coupling
        Y = np.empty((*N.shape[:-2], 4, 4))
        Y[..., 0, 0] = half.tangential_compliance
        Y[..., 0, 1:] = Y[..., 1:, 0] = -k
        Y[..., 1:, 1:] = N
        return Y / (self.scale[..., :, None] * self.scale[..., None, :])

    @cached_property
    def _blocks(self) -> tuple[Array, Array, Array]:
        """W, Q_s and T^-1; (..., 4, 4) each."""
        scales = self.scale[..., :, None] * self.scale[..., None, :]
        Q, R, T = self.material.generalised_stiffness()
        Q, R, T = Q * scales, R * scales, T * scales
        T_inv: Array = np.asarray(np.linalg.inv(T), dtype=np.float64)
        W: Array = MIRROR @ R @ T_inv
        return W, Q - R @ T_inv @ np.swapaxes(R, -1, -2), T_inv

    @property
    def inner(self) -> Array:
        """Q_s; (..., 4, 4)."""
        return self._blocks[1]

    @property
    def system(self) -> Array:
        """The 8 x 8 matrix of the system above; (..., 8, 8)."""
        W, Q_s, T_inv = self._blocks
        upper = np.concatenate([np.swapaxes(W, -1, -2), T_inv], -1)
        return np.concatenate([upper, np.concatenate([Q_s, -W], -1)], -2)

    @cached_property
    def decay(self) -> Array:
        """G: tractions of a wave decay like exp(k G y) downwards; (..., 4, 4), eigenvalues with positive real part."""
        W, Q_s, _ = self._blocks
        return np.asarray(Q_s @ self.compliance - W)

    @cached_property
    def modes(self) -> tuple[ComplexArray, ComplexArray]:
        """Rates m_j (mode,) and parts E_j (mode, 4, 4) of a wave: exp(-G s) = sum_j E_j exp(-m_j s); no case axes.

        Eigenvalues and projectors of G, or a contour around those that coincide (:mod:`solver.halfplane.spectrum`).
        """
        values, vectors = np.linalg.eig(self.decay)
        if np.linalg.cond(vectors) < _WELL_CONDITIONED:
            return values.astype(np.complex128), np.einsum("ij,jk->jik", vectors, np.linalg.inv(vectors)) + 0j
        nodes, parts = spectrum(self.halfplane)
        nonzero = np.any(parts != 0, (-2, -1))
        turned = self.scale / self.halfplane.scale * np.array([1j, 1, 1, 1])
        return 1j * np.conj(nodes[nonzero]), turned[:, None] * np.conj(parts[nonzero]) / turned

    @cached_property
    def slowest(self) -> Array:
        """g: smallest real part of the eigenvalues of G [1]; (...)."""
        return np.asarray(np.min(np.linalg.eigvals(self.decay).real, -1))


def falling(G: Array, s: Array) -> Array:
    """exp(-G s); (..., 4, 4).

    By eigenvectors where they are well conditioned, by Taylor's series of a small enough part, squared again and
    again, elsewhere (degenerate materials). What is squared decays: nothing grows.

    G: (..., 4, 4), with eigenvalues of positive real part; s: (...), >= 0.
    """
    values, vectors = np.linalg.eig(G)
    if np.max(np.linalg.cond(vectors)) < _WELL_CONDITIONED:
        waves = vectors * np.exp(-values * s[..., None])[..., None, :]
        return np.asarray((waves @ np.linalg.inv(vectors)).real)
    exponent = -G * s[..., None, None]
    norm = np.max(np.sum(np.abs(exponent), -1), -1)
    halvings = np.maximum(np.ceil(np.log2(np.maximum(norm, 1e-300))) + 1, 0).astype(int)
    part = exponent / np.exp2(halvings)[..., None, None]
    power: Array = np.eye(4) + part / _DEGREE
    for degree in range(_DEGREE - 1, 0, -1):
        power = np.eye(4) + part @ power / degree
    for step in range(int(np.max(halvings, initial=0))):
        power = np.where((step < halvings)[..., None, None], power @ power, power)
    return power
