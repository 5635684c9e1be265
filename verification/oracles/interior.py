"""Fields inside the half-plane in 50 digits, by eigenvectors and quadrature of the tractions (mpmath).

The textbook method of Lekhnitskii and Stroh: f_k'(z_k) = [B^-1 g(z_k)]_k with the eigenvectors of N, and g by
double-exponential quadrature. Coalescing roots are split by a change of the constants in the 35th digit, which costs
half as many of the eigenvectors' 100 digits.
"""

from collections.abc import Mapping, Sequence
from functools import lru_cache

from mpmath import diag, fdot, inverse, matrix, mp, mpc, mpf, pi, zeros

from verification.oracles.contact import Contact, Sliding, functions
from verification.oracles.half_plane import STIFFNESS, UNITS, WORK_DIGITS, HalfPlane, half_plane
from verification.oracles.quadrature import integrate, nodes

_SPLIT = mpf("1e-35")

FIELDS = (
    "stress_xx", "stress_yy", "stress_xy", "stress_zz",
    "electric_displacement_x", "electric_displacement_y", "magnetic_induction_x", "magnetic_induction_y",
    "electric_field_x", "electric_field_y", "magnetic_field_x", "magnetic_field_y",
    "strain_xx", "strain_yy", "strain_xy",
)  # fmt: skip


def solve(
    material: Mapping[str, float],
    points: Sequence[tuple[float, float]],
    *,
    radius: float,
    load: float,
    friction: float = 0.0,
    charge: float = 0.0,
    magnetic_charge: float = 0.0,
    conducted: tuple[int, ...] = (1, 2),
    speed: float = 0.0,
) -> dict[str, list[float]]:
    """Fields under the circular punch; SI units."""
    with mp.workdps(WORK_DIGITS):
        sliding = Sliding(half_plane(material, speed), mpf(friction), mpf(radius), conducted)
        state = Contact(sliding, mpf(load), mpf(charge), mpf(magnetic_charge))
        roots, A, B = _eigenvectors(sliding.half)
        rows = [_fields(material, state, roots, A, B, mpf(x), mpf(y)) for x, y in points]
        return {name: [float(row[i]) for row in rows] for i, name in enumerate(FIELDS)}


@lru_cache(maxsize=64)
def _eigenvectors(half: HalfPlane) -> tuple[list[mpc], matrix, matrix]:
    """Upper roots and the eigenvectors A, B in SI units."""
    units = diag(list(UNITS))
    moving = half.Q - half.inertia * diag([1, 1, 0, 0])
    Q, R, T = (units * block * units / STIFFNESS for block in (moving, half.R, half.T))
    Q = Q + diag([_SPLIT * k for k in (1, 3, -7, -12)])
    N1, N2 = -inverse(T) * R.T, inverse(T)
    N = zeros(8)
    N[0:4, 0:4], N[0:4, 4:8], N[4:8, 0:4], N[4:8, 4:8] = N1, N2, -R * N1 - Q, N1.T
    values, vectors = mp.eig(N)
    upper = [k for k in range(8) if values[k].imag > 0]
    A, B = zeros(4), zeros(4)
    for column, k in enumerate(upper):
        for i in range(4):
            A[i, column], B[i, column] = vectors[i, k] * UNITS[i], vectors[i + 4, k] / UNITS[i] * STIFFNESS
    return [values[k] for k in upper], A, B


def _fields(
    m: Mapping[str, float], state: Contact, roots: list[mpc], A: matrix, B: matrix, x: mpf, y: mpf
) -> list[mpf]:
    inverse_B = inverse(B)
    f = matrix([(inverse_B[k, :] * _plemelj(state, x + p * y))[0] for k, p in enumerate(roots)])
    down = diag(roots) * f
    u_x, u_y, t_2 = (2 * (M * v).apply(mp.re) for M, v in ((A, f), (A, down), (B, f)))
    half = state.sliding.half
    xx, _, D_x, B_x = half.Q * u_x + half.R * u_y
    xy, yy, D_y, B_y = t_2
    zz = mpf(m["c12"]) * u_x[0] + mpf(m["c13"]) * u_y[1] + mpf(m["e31"]) * u_y[2] + mpf(m["f31"]) * u_y[3]
    strains = [u_x[0], u_y[1], (u_y[0] + u_x[1]) / 2]
    return [xx, yy, xy, zz, D_x, D_y, B_x, B_y, -u_x[2], -u_y[2], -u_x[3], -u_y[3], *strains]


def _plemelj(state: Contact, z: mpc) -> matrix:
    """g(z) = -(1/2 pi i) int t(s)/(s - z) ds over the contact, in units of the half-width."""
    integrals = _cauchy(state.sliding.alpha, z) + _cauchy(None, z)
    normal, electric, magnetic = (fdot(row, integrals) for row in state.coefficients)
    return matrix([state.sliding.friction * normal, normal, electric, magnetic]) / mpc(0, -2 * pi)


@lru_cache(maxsize=2**12)
def _cauchy(alpha: mpf | None, z: mpc) -> list[mpc]:
    """Integrals of the functions of :mod:`verification.oracles.contact` over s - z, for one alpha and all loads."""

    def sums(level: int) -> list[mpf]:
        totals = [fdot(f, _kernel(z, level)) for f in functions(alpha, level)]
        return [part for total in totals for part in (2 * mp.re(total), 2 * mp.im(total))]

    flat = integrate(sums)
    return [mpc(*flat[i : i + 2]) for i in range(0, len(flat), 2)]


@lru_cache(maxsize=16)
def _kernel(z: mpc, level: int) -> list[mpc]:
    return [1 / (2 * v - 1 - z) for _, v, _ in nodes(level)]
