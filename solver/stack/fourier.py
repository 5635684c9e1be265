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

_WELL_CONDITIONED = 1e3  # eigenvectors lose three digits there; beyond it a contour is used


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

    def falling(self, s: Array) -> Array:
        """exp(-G s) at s (...) >= 0; (..., 4, 4). Nothing grows."""
        rates, parts = self.modes
        return np.asarray(np.tensordot(np.exp(-rates * s[..., None]), parts, 1).real)

    @cached_property
    def slowest(self) -> Array:
        """g: smallest real part of the eigenvalues of G [1]; (...)."""
        return np.asarray(np.min(np.linalg.eigvals(self.decay).real, -1))
