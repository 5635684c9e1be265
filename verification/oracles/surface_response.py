"""Surface response of the half-plane in double precision: angular integrals by NumPy, and the constitutive law."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

UNITS = np.array([1.0, 1.0, 1e10, 1e8])  # m, m, V, A: all constants of order one with stiffness in 1e11 Pa
STIFFNESS = 1e11
_ANGLES = np.pi * np.arange(2048) / 2048  # 1e-15 while every Stroh root p has |(p-i)/(p+i)| < 0.98


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
        """Return t_1 = (sigma_xx, sigma_xy, D_x, B_x), (4, n).

        t, transform: (4, n), t_2 and its Hilbert transform, SI.
        """
        u_x = self.local @ t + self.compliance @ transform
        units = UNITS[:, None]
        inverse = units * np.linalg.inv(units * self.T * UNITS / STIFFNESS) * UNITS / STIFFNESS
        along: Array = self.Q @ u_x + self.R @ (inverse @ (t - self.R.T @ u_x))
        return along


def surface_response(material: Mapping[str, float]) -> SurfaceResponse:
    """Surface response of a material."""
    m = material
    Q = np.diag([m["c11"], m["c44"], -m["eps11"], -m["mu11"]])
    Q[1, 2:] = Q[2:, 1] = m["e15"], m["f15"]
    Q[2, 3] = Q[3, 2] = -m["g11"]
    T = np.diag([m["c44"], m["c33"], -m["eps33"], -m["mu33"]])
    T[1, 2:] = T[2:, 1] = m["e33"], m["f33"]
    T[2, 3] = T[3, 2] = -m["g33"]
    R = np.zeros((4, 4))
    R[0, 1:], R[1:, 0] = (m["c13"], m["e31"], m["f31"]), (m["c44"], m["e15"], m["f15"])
    scale = UNITS[:, None] * UNITS / STIFFNESS
    local, compliance = angular_integrals(*((block * scale) for block in (Q, R, T)))
    return SurfaceResponse(local * scale, compliance * scale, Q, R, T)


def angular_integrals(Q: Array, R: Array, T: Array) -> tuple[Array, Array]:
    """-S L^-1 and L^-1 from S = mean of N1 and L = mean of -N3 over the angle.

    Q, R, T: (n, n), constitutive blocks of n unknowns, of order one.
    """
    c, s = np.cos(_ANGLES)[:, None, None], np.sin(_ANGLES)[:, None, None]
    q = Q * c**2 + (R + R.T) * c * s + T * s**2
    r = R * c**2 + (T - Q) * c * s - R.T * s**2
    t = T * c**2 - (R + R.T) * c * s + Q * s**2
    n1 = -np.linalg.solve(t, r.transpose(0, 2, 1))
    S, L = n1.mean(axis=0), (q + r @ n1).mean(axis=0)
    compliance = np.linalg.inv(L)
    return -S @ compliance, compliance


def reduced(surface: SurfaceResponse, friction: float, conducted: tuple[int, ...] = (1, 2)) -> tuple[float, float]:
    """lam [1/Pa] and alpha of a punch."""
    fields, scale = [0, *conducted], np.array([1, 1e10, 1e8])
    inverse_n = np.linalg.inv((surface.normal_compliance / np.outer(scale, scale))[np.ix_(fields, fields)])
    lam = 1 / inverse_n[0, 0]
    kap = lam * inverse_n[0] @ (surface.shear_coupling / scale)[fields]
    return lam, float(np.arctan2(1.0, -friction * kap / lam)) / np.pi
