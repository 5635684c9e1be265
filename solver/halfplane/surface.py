"""Surface response of the half-plane y < 0: the Stroh matrix, its roots, its Barnett-Lothe tensors (theory, 2)."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from approximation.arrays import Indices
from solver.arrays import Array, ComplexArray, column, dot, matrix_of, outer, stack
from solver.material.constants import Material, MaterialError, combined

_NEWTON_STEPS = 40  # quadratic convergence: ordinary materials need 6 to 8
_TOLERANCE = 1e-13
_STALLED = 1e-8  # steps below this that no longer shrink are rounding, which grows as a root nears the real axis
# rows of the Stroh matrix by mirror symmetry: (u_x, t_y, t_phi, t_psi) and (u_y, u_phi, u_psi, t_x)
_EVEN, _ODD = np.array([0, 5, 6, 7]), np.array([1, 2, 3, 4])


def shared_by_cases(method: Callable[[Any], Array]) -> cached_property[Array]:
    """Return a cached property that is computed once per ``distinct`` body and repeated by ``of_cases``."""

    def values(owner: Any) -> Array:
        distinct = owner.distinct
        return method(owner) if distinct is owner else np.asarray(owner.of_cases(getattr(distinct, method.__name__)))

    values.__doc__ = method.__doc__
    return cached_property(values)


@dataclass(frozen=True, eq=False)
class HalfPlane:
    """Response of a material's surface to tractions (theory, 2.1), SI; arrays have the material's case axes first."""

    material: Material
    speed: Array = field(default_factory=lambda: np.zeros(()))
    shared: "tuple[HalfPlane, Indices] | None" = None  # Half-plane of the distinct cases, and each case's index in it

    @property
    def distinct(self) -> "HalfPlane":
        """Half-plane of the distinct materials and speeds of the cases."""
        return self.shared[0] if self.shared else self

    def repeated(self, case_index: Indices) -> "HalfPlane":
        """Return the half-plane of cases (case,) that each have one of these materials, and share its tensors."""
        material = combined(lambda values: _taken(values, case_index), [self.material], self.material.name)
        return HalfPlane(material, _taken(self.speed, case_index), (self, case_index))

    def of_cases(self, values: Array) -> Array:
        """Repeat values of the distinct half-planes (distinct, ...) for the cases; (case, ...)."""
        if self.shared is None:
            return values
        return np.moveaxis(_taken(np.moveaxis(values, 0, -1), self.shared[1]), -1, 0)  # cases contiguous

    @cached_property
    def scale(self) -> Array:
        """Diagonal scale (..., 4) that brings every block of the stiffness to the order of one, in any base units."""
        m = self.material
        return stack(m.c33, m.c33, m.eps33, m.mu33) ** -0.5

    @cached_property
    def stroh_matrix(self) -> Array:
        """Scaled N = [[N1, N2], [N3, N1^T]] of the eigenproblem N [a; b] = p [a; b]; (..., 8, 8), dimensionless."""
        scales = outer(self.scale)
        Q, R, T = self.material.generalised_stiffness()
        inertia = np.where(self.speed > 0, self.material.rho, 0.0) * self.speed**2  # at rest, rho may be unknown
        Q, R, T = (Q - column(inertia) * np.diag([1.0, 1.0, 0.0, 0.0])) * scales, R * scales, T * scales
        T_inv = np.linalg.inv(T)
        N1 = -T_inv @ R.mT
        N3 = -R @ N1 - Q
        N1, T_inv = np.broadcast_to(N1, N3.shape), np.broadcast_to(T_inv, N3.shape)
        return np.concatenate([np.concatenate([N1, T_inv], -1), np.concatenate([N3, N1.mT], -1)], -2)

    @cached_property
    def roots(self) -> ComplexArray:
        """Stroh roots with Im p > 0, sorted by falling imaginary part; (..., 4)."""
        p = np.linalg.eigvals(self.stroh_matrix).astype(np.complex128)
        upper = np.take_along_axis(p, np.argsort(-p.imag, axis=-1)[..., :4], -1)
        order = np.lexsort((upper.real, -np.round(upper.imag, 9)), axis=-1)
        return np.take_along_axis(upper, order, -1)

    @shared_by_cases
    def _barnett_lothe(self) -> Array:
        """S L^-1 and L^-1, scaled as the Stroh matrix is; (..., 2, 4, 4)."""
        # Newton's iteration X <- (mu X - (mu X)^-1) / 2 from N finds [[S, H], [-L, S^T]], the function of N that maps
        # the roots p to i sign(Im p), without eigenvectors. By the mirror symmetry X consists of two 4 x 4 blocks.
        N = self.stroh_matrix
        forth, back, change = N[..., _ODD[:, None], _EVEN], N[..., _EVEN[:, None], _ODD], np.inf
        for _ in range(_NEWTON_STEPS):
            inverse_forth, inverse_back = np.linalg.inv(back), np.linalg.inv(forth)
            mu = np.sqrt(_norm(inverse_forth, inverse_back) / _norm(forth, back))
            mu = column(np.where(abs(mu - 1) < 0.1, 1.0, mu))
            previous, size = (forth, back), max(np.max(abs(forth)), np.max(abs(back)))
            forth, back = (mu * forth - inverse_forth / mu) / 2, (mu * back - inverse_back / mu) / 2
            step = max(float(np.max(abs(new - old))) for new, old in zip((forth, back), previous, strict=True))
            last, change = change, step / float(size)
            if change <= _TOLERANCE or (change <= _STALLED and change >= last / 2):
                break
        else:
            raise MaterialError(
                f"{self.material.name}: a Stroh root is (nearly) real ({self.roots.flat[-1]:.3g}): not elliptic"
            )
        X = np.zeros_like(N)
        X[..., _ODD[:, None], _EVEN] = (forth - np.linalg.inv(back)) / 2
        X[..., _EVEN[:, None], _ODD] = (back - np.linalg.inv(forth)) / 2
        S, L = X[..., :4, :4], -X[..., 4:, :4]
        L_inv = np.linalg.inv(L)
        return np.stack([S @ L_inv, (L_inv + L_inv.mT) / 2], -3)

    @cached_property
    def condition(self) -> Array:
        """Frobenius condition number of the scaled L; (...)."""
        inverse = self._barnett_lothe[..., 1, :, :]
        return np.asarray(
            np.linalg.norm(inverse, axis=(-2, -1)) * np.linalg.norm(np.linalg.inv(inverse), axis=(-2, -1))
        )

    @property
    def surface_impedance(self) -> ComplexArray:
        """Impedance A B^-1 = -S L^-1 - i L^-1, scaled as the Stroh matrix is; (..., 4, 4)."""
        return np.asarray(-self._barnett_lothe[..., 0, :, :] - 1j * self._barnett_lothe[..., 1, :, :])

    @shared_by_cases
    def compliance(self) -> Array:
        """N, the part of L^-1 on (u_y, phi, psi), symmetric; (..., 3, 3)."""
        return (self._barnett_lothe[..., 1, :, :] * outer(self.scale))[..., 1:, 1:]

    @shared_by_cases
    def friction_coupling(self) -> Array:
        """Friction coupling k = -(S L^-1)[(u_y, phi, psi), x]; (..., 3)."""
        return -(self._barnett_lothe[..., 0, :, :] * outer(self.scale))[..., 1:, 0]

    @shared_by_cases
    def tangential_compliance(self) -> Array:
        """Tangential compliance (L^-1)_xx [1/Pa]; (...)."""
        return (self._barnett_lothe[..., 1, :, :] * outer(self.scale))[..., 0, 0]

    @cached_property
    def _in_plane(self) -> tuple[Array, Array]:
        """Coefficients of theory, 5.3: c11 - h T3^-1 h (...) and h T3^-1 (..., 3)."""
        m = self.material
        h = stack(m.c13, m.e31, m.f31)
        scale = self.scale[..., 1:]
        T3 = m.generalised_stiffness()[2][..., 1:, 1:] * outer(scale)
        share = np.linalg.solve(T3, (h * scale)[..., None])[..., 0] * scale
        return m.c11 - dot(h, share), share

    @shared_by_cases
    def in_plane_stiffness(self) -> Array:
        """sigma_xx per du_x/dx on a traction-free surface, c11 - h T3^-1 h (theory, 5.3) [Pa]; (...)."""
        return self._in_plane[0]

    @property
    def in_plane_share(self) -> Array:
        """sigma_xx per (sigma_yy, D_y, B_y) at du_x/dx = 0 on the surface, h T3^-1 (theory, 5.3); (..., 3)."""
        return self._in_plane[1]

    @cached_property
    def transverse_shear_share(self) -> Array:
        """Surface (D_x, B_x) per sigma_xy at d(phi, psi)/dx = 0, (e15, f15) / c44; (..., 2)."""
        m = self.material
        return stack(m.e15 / m.c44, m.f15 / m.c44)

    @cached_property
    def transverse_permittivity(self) -> Array:
        """Surface (D_x, B_x) per -d(phi, psi)/dx at sigma_xy = 0 (theory, 1b and 1c); (..., 2, 2)."""
        m = self.material
        eps, g, mu = m.eps11 + m.e15**2 / m.c44, m.g11 + m.e15 * m.f15 / m.c44, m.mu11 + m.f15**2 / m.c44
        return matrix_of([[eps, g], [g, mu]])


def _taken(values: Array, case_index: Indices) -> Array:
    """Take the values of each case along the last axis, unless all share one; (..., case)."""
    return values if values.ndim == 0 or values.shape[-1] == 1 else np.take(values, case_index, -1)


def _norm(*blocks: NDArray[Any]) -> Array:
    """Frobenius norm of several blocks together; (...)."""
    return np.asarray(np.sqrt(sum(np.einsum("...ij,...ij", block, block) for block in blocks)))
