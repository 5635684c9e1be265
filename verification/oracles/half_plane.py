"""Surface response of the half-plane by the Barnett-Lothe angular integrals, in mpmath.

The integrals need no eigenvectors, so that degenerate materials (isotropic elasticity) need no special treatment, and
the trapezoid rule on their period converges geometrically.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

from mpmath import cos, diag, inverse, matrix, mp, mpf, norm, pi, sin, zeros

from verification.oracles.surface_response import blocks

WORK_DIGITS = 100  # the results are good to 50 of them: the removable singularity kap -> 0 may eat the others
_COUPLING = ("e31", "e33", "e15", "f31", "f33", "f15")
CONSTANTS = ("c11", "c13", "c33", "c44", *_COUPLING, "eps11", "eps33", "g11", "g33", "mu11", "mu33")

# Units of (u_x, u_y, phi, psi) in which all constants are of order one: m, m, 1e10 V, 1e8 A; stiffness 1e11 Pa.
UNITS = (mpf(1), mpf(1), mpf(10) ** 10, mpf(10) ** 8)
STIFFNESS = mpf(10) ** 11


@dataclass(frozen=True, eq=False)
class HalfPlane:
    """Surface response of a half-plane, and its constitutive matrices (SI units, 4x4 mpmath matrices)."""

    local: matrix  # -S L^-1 of theory (2.1), response to the traction at the point itself
    compliance: matrix  # L^-1 of theory (2.1), response to the Hilbert transform of the traction
    # Constitutive blocks of theory section 2: t_1 = Q u,x + R u,y and t_2 = R^T u,x + T u,y
    Q: matrix
    R: matrix
    T: matrix
    inertia: mpf  # density times squared speed of a punch in steady motion

    @property
    def normal_compliance(self) -> matrix:
        """N of theory (2.2): L^-1 over (y, phi, psi), 3x3."""
        return self.compliance[1:4, 1:4]

    @property
    def shear_coupling(self) -> list[mpf]:
        """k of theory (2.2): -(S L^-1)[(y, phi, psi), x], three numbers."""
        return [self.local[i, 0] for i in (1, 2, 3)]


def half_plane(material: Mapping[str, float], speed: float = 0.0) -> HalfPlane:
    """Surface response of a material at rest or under a punch in steady motion."""
    inertia = mpf(material["rho"]) * mpf(speed) ** 2 if speed else mpf(0)
    return _half_plane(tuple(material[name] for name in CONSTANTS), inertia)


@lru_cache(maxsize=64)
def _half_plane(constants: tuple[float, ...], inertia: mpf) -> HalfPlane:
    with mp.workdps(WORK_DIGITS):
        Q, R, T = (matrix(block.tolist()) for block in blocks(dict(zip(CONSTANTS, constants, strict=True))))
        moving = Q - inertia * diag([1, 1, 0, 0])
        units = diag(list(UNITS))
        scaled = [units * block * units / STIFFNESS for block in (moving, R, T)]
        S, L = _angular_means(*scaled)
        compliance = inverse(L)
        local = units * (-S * compliance) * units / STIFFNESS
        return HalfPlane(local, units * compliance * units / STIFFNESS, Q, R, T, inertia)


def _angular_means(Q: matrix, R: matrix, T: matrix) -> tuple[matrix, matrix]:
    """Return Barnett-Lothe S and L, means over the angle of N1 and -N3 (Ting, Anisotropic Elasticity, 1996, 7.6).

    A mirror image in x changes the sign of R. At pi - angle the entries of S that mix x with the rest, and those of L
    that do not, are equal, and the others have opposite signs. So half of the angles are enough.
    """
    count, old, total = 16, zeros(8, 4), zeros(8, 4)
    angles = [pi * j / count for j in range(1, count // 2)]
    for angle in (mpf(0), pi / 2):  # their own mirror images
        total += _rotated(Q, R, T, cos(angle), sin(angle)) / 2
    while True:
        for angle in angles:
            total += _rotated(Q, R, T, cos(angle), sin(angle))
        mean = 2 * total / count
        for i in range(4):
            for j in range(4):
                mean[i + 4 * ((i == 0) != (j == 0)), j] = 0
        if norm(mean - old, mp.inf) < mpf(10) ** (10 - WORK_DIGITS) * norm(mean, mp.inf):
            return mean[0:4, :], mean[4:8, :]
        if count > 2**14:
            raise ArithmeticError("Barnett-Lothe integrals do not converge: a Stroh root is next to the real axis")
        old, angles = mean, [pi * (2 * j + 1) / (2 * count) for j in range(count // 2)]
        count *= 2


def _rotated(Q: matrix, R: matrix, T: matrix, c: mpf, s: mpf) -> matrix:
    """N1 above -N3 in the frame turned by the angle whose cosine and sine are given."""
    mixed = R + R.T
    inv_t = inverse(T * c**2 - mixed * (c * s) + Q * s**2)
    r = R * c**2 + (T - Q) * (c * s) - R.T * s**2
    q = Q * c**2 + mixed * (c * s) + T * s**2
    n1 = -inv_t * r.T
    out = zeros(8, 4)
    out[0:4, :] = n1
    out[4:8, :] = q + r * n1
    return out
