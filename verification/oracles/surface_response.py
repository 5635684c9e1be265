"""Surface response of the half-plane in double precision: angular integrals by NumPy, and the constitutive law."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

UNITS = np.array([1.0, 1.0, 1e10, 1e8])  # m, m, V, A: all constants of order one with stiffness in 1e11 Pa
STIFFNESS = 1e11
_ANGLES = np.pi * np.arange(2048) / 2048  # 1e-15 while every Stroh root p has |(p-i)/(p+i)| < 0.98

# G = (eps_xx, eps_yy, 2 eps_xy, grad phi, grad psi) = ALONG u,x + DOWN u,y with u = (u_x, u_y, phi, psi): equations (2)
ALONG = np.zeros((7, 4))
ALONG[[0, 2, 3, 5], [0, 1, 2, 3]] = 1.0
DOWN = np.zeros((7, 4))
DOWN[[2, 1, 4, 6], [0, 1, 2, 3]] = 1.0


def constitutive_matrix(material: Mapping[str, float]) -> Array:
    """M of the fluxes, equations (1a)-(1c); shape (7, 7), SI units."""
    m = material
    M = np.zeros((7, 7))
    M[:3, :3] = [[m["c11"], m["c13"], 0], [m["c13"], m["c33"], 0], [0, 0, m["c44"]]]
    for row, (k31, k33, k15) in ((3, ("e31", "e33", "e15")), (5, ("f31", "f33", "f15"))):
        coupling = np.array([[0, 0, m[k15]], [m[k31], m[k33], 0]])
        M[row : row + 2, :3], M[:3, row : row + 2] = coupling, coupling.T
    M[3:5, 3:5] = -np.diag([m["eps11"], m["eps33"]])
    M[3:5, 5:], M[5:, 3:5] = (-np.diag([m["g11"], m["g33"]]),) * 2
    M[5:, 5:] = -np.diag([m["mu11"], m["mu33"]])
    return M


def blocks(material: Mapping[str, float]) -> tuple[Array, Array, Array]:
    """Q, R and T of theory section 2, shape (4, 4) each, SI units."""
    M = constitutive_matrix(material)
    return ALONG.T @ M @ ALONG, ALONG.T @ M @ DOWN, DOWN.T @ M @ DOWN


@dataclass(frozen=True, eq=False)
class SurfaceResponse:
    """Theory (2.1) and section 2 of one material, SI units."""

    # shape (4, 4); -S L^-1 and L^-1
    local: Array
    compliance: Array
    # shape (4, 4); Constitutive blocks
    Q: Array
    R: Array
    T: Array

    @property
    def normal_compliance(self) -> Array:
        """N of theory (2.2): L^-1 over (y, phi, psi), shape (3, 3)."""
        return self.compliance[1:, 1:]

    @property
    def shear_coupling(self) -> Array:
        """k of theory (2.2): -(S L^-1)[(y, phi, psi), x], shape (3,)."""
        return self.local[1:, 0]

    def along_surface(self, t: Array, transform: Array) -> Array:
        """Return t_1 = (sigma_xx, sigma_xy, D_x, B_x) from t_2 and its Hilbert transform, (4, n) each, SI."""
        u_x = self.local @ t + self.compliance @ transform
        units = UNITS[:, None]
        inverse = units * np.linalg.inv(units * self.T * UNITS / STIFFNESS) * UNITS / STIFFNESS
        along: Array = self.Q @ u_x + self.R @ (inverse @ (t - self.R.T @ u_x))
        return along


def surface_response(material: Mapping[str, float]) -> SurfaceResponse:
    """Surface response of a material."""
    Q, R, T = blocks(material)
    scale = UNITS[:, None] * UNITS / STIFFNESS
    local, compliance = angular_integrals(*((block * scale) for block in (Q, R, T)))
    return SurfaceResponse(local * scale, compliance * scale, Q, R, T)


def angular_integrals(Q: Array, R: Array, T: Array) -> tuple[Array, Array]:
    """-S L^-1 and L^-1 of blocks (n, n) of order one, from S = mean of N1 and L = mean of -N3 over the angle."""
    c, s = np.cos(_ANGLES)[:, None, None], np.sin(_ANGLES)[:, None, None]
    q = Q * c**2 + (R + R.T) * c * s + T * s**2
    r = R * c**2 + (T - Q) * c * s - R.T * s**2
    t = T * c**2 - (R + R.T) * c * s + Q * s**2
    n1 = -np.linalg.solve(t, r.transpose(0, 2, 1))
    S, L = n1.mean(axis=0), (q + r @ n1).mean(axis=0)
    compliance = np.linalg.inv(L)
    return -S @ compliance, compliance


def reduced(surface: SurfaceResponse, friction: float) -> tuple[float, float]:
    """lam [1/Pa] and alpha of a conducting punch."""
    scale = UNITS[1:]
    inverse_n = np.linalg.inv(surface.normal_compliance / np.outer(scale, scale))
    lam = 1 / inverse_n[0, 0]
    kap = lam * inverse_n[0] @ (surface.shear_coupling / scale)
    return lam, float(np.arctan2(1.0, -friction * kap / lam)) / np.pi
