"""One material in Fourier space, as a real 8 x 8 system and its decaying waves (films, section 1)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array, ComplexArray, outer
from solver.halfplane.spectrum import spectrum
from solver.halfplane.surface import HalfPlane
from solver.material.constants import Material

#: Mirror S (y -> -y) of (x, y, phi, psi), and the signs that S M S gives the entries of M.
MIRROR = np.diag([-1.0, 1.0, 1.0, 1.0])
FLIP = np.outer(np.diag(MIRROR), np.diag(MIRROR))

_WELL_CONDITIONED = 1e3  # condition number at which eigenvectors lose three digits; above it a contour is used


@dataclass(frozen=True, eq=False)
class Medium:
    """A material in the units of a stack; arrays have the material's case axes first."""

    material: Material
    scale: Array  # Units of the stack; (4,)

    @cached_property
    def halfplane(self) -> HalfPlane:
        """Half-plane of this material."""
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
        return Y / outer(self.scale)

    @cached_property
    def _blocks(self) -> tuple[Array, Array, Array]:
        """W, Q_s and T^-1; (..., 4, 4) each."""
        Q, R, T = (block * outer(self.scale) for block in self.material.generalised_stiffness())
        T_inv: Array = np.asarray(np.linalg.inv(T), dtype=np.float64)
        W: Array = MIRROR @ R @ T_inv
        return W, Q - R @ T_inv @ R.mT, T_inv

    @property
    def system(self) -> Array:
        """Matrix of the system F1.1 for [k u; t], without the factor k; (..., 8, 8)."""
        W, Q_s, T_inv = self._blocks
        upper = np.concatenate([W.mT, T_inv], -1)
        return np.concatenate([upper, np.concatenate([Q_s, -W], -1)], -2)

    @cached_property
    def decay(self) -> Array:
        """G of tractions exp(k G y) t(0), whose eigenvalues have a positive real part; (..., 4, 4)."""
        W, Q_s, _ = self._blocks
        return np.asarray(Q_s @ self.compliance - W)

    @cached_property
    def modes(self) -> tuple[ComplexArray, ComplexArray]:
        """Rates m_j (mode,) and parts E_j (mode, 4, 4) of exp(-G s) = sum_j E_j exp(-m_j s), without case axes."""
        values, vectors = np.linalg.eig(self.decay)
        if np.linalg.cond(vectors) < _WELL_CONDITIONED:
            return values.astype(np.complex128), np.einsum("ij,jk->jik", vectors, np.linalg.inv(vectors)) + 0j
        nodes, parts = spectrum(self.halfplane)  # a contour around eigenvalues that coincide
        nonzero = np.any(parts != 0, (-2, -1))
        turned = self.scale / self.halfplane.scale * np.array([1j, 1, 1, 1])
        return 1j * np.conj(nodes[nonzero]), turned[:, None] * np.conj(parts[nonzero]) / turned

    def falling(self, s: Array) -> Array:
        """Return exp(-G s) at s (...) >= 0; (..., 4, 4)."""
        rates, parts = self.modes
        return np.asarray(np.tensordot(np.exp(-rates * s[..., None]), parts, 1).real)

    @cached_property
    def slowest(self) -> Array:
        """Smallest real part g of the eigenvalues of G; (...)."""
        return np.asarray(np.min(np.linalg.eigvals(self.decay).real, -1))
