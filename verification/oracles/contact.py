"""Tractions under the circular punch in mpmath (theory section 3) and their transforms by quadrature.

Points of the contact are given by u = (a - x)/l and v = (x + b)/l = 1 - u, exact at both edges.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache

from mpmath import acot, cot, fdot, fsum, inverse, log, matrix, mpf, pi, sin, sqrt

from verification.oracles.half_plane import HalfPlane
from verification.oracles.quadrature import integrate, nodes

# D_y and B_y have the form 0/0 at kap = 0. A kap of this size in its place moves the results by 1e-40 of themselves,
# and the cancellation that it leaves costs 40 of the 100 working digits.
_LEAST_KAP = mpf("1e-40")


@dataclass(frozen=True, eq=False)
class Sliding:
    """Half-plane, friction, radius and conducted fields: all inputs but loads."""

    half: HalfPlane
    friction: mpf
    radius: mpf
    conducted: tuple[int, ...]  # Which of (y, phi, psi) beside y the punch holds: any of 1 and 2

    @cached_property
    def reduction(self) -> tuple[matrix, matrix, mpf, mpf]:
        """Theory section 3, r, d, lam, kap over the conducted fields."""
        N, k = self.half.normal_compliance, self.half.shear_coupling
        if not self.conducted:
            return matrix(0, 1), matrix(0, 1), N[0, 0], k[0]
        M = inverse(matrix([[N[i, j] for j in self.conducted] for i in self.conducted]))
        n, kq = matrix([N[i, 0] for i in self.conducted]), matrix([k[i] for i in self.conducted])
        r, d = M * n, M * kq
        lam, kap = N[0, 0] - (n.T * r)[0], k[0] - (n.T * d)[0]
        return r, d, lam, kap if abs(kap) > _LEAST_KAP * lam else _LEAST_KAP * lam

    @cached_property
    def alpha(self) -> mpf:
        """Exponent of the pressure at the trailing edge, cot(pi alpha) = -eta kap/lam."""
        _, _, lam, kap = self.reduction
        angle = acot(-self.friction * kap / lam) if self.friction else pi / 2
        return (angle if angle > 0 else angle + pi) / pi


# Tractions are sums of four functions of u and v, one of them of alpha: their integrals are found once for all loads.


def _shape(alpha: mpf, u: mpf, v: mpf) -> list[mpf]:
    return [u**alpha * v ** (1 - alpha)]


def _roots(u: mpf, v: mpf) -> list[mpf]:
    X, root = v - u, 2 * sqrt(u * v)
    return [X / root, (2 * X**2 - 1) / root, 1 / root]


@lru_cache(maxsize=64)
def functions(alpha: mpf | None, level: int) -> list[list[mpf]]:
    """Return the function of alpha, or without alpha those with a root, times the weights at the nodes of a level."""
    rows = [[w * f for f in (_roots(u, v) if alpha is None else _shape(alpha, u, v))] for u, v, w in nodes(level)]
    return [list(column) for column in zip(*rows, strict=True)]


@lru_cache(maxsize=64)
def _logarithms(level: int) -> list[mpf]:
    return [log(u) for u, _, _ in nodes(level)]


@lru_cache(maxsize=2**12)
def _logarithmic(alpha: mpf | None) -> tuple[list[mpf], list[mpf]]:
    """Return the integrals over u of the functions times log u, and of the functions, for one alpha and all loads."""

    def sums(level: int) -> list[mpf]:
        values = functions(alpha, level)
        return [*(fdot(f, _logarithms(level)) for f in values), *map(fsum, values)]

    integrals = integrate(sums)
    return integrals[: len(integrals) // 2], integrals[len(integrals) // 2 :]


@lru_cache(maxsize=2**12)
def _cauchy(alpha: mpf | None, X: mpf) -> list[mpf]:
    """H of the functions at |X| > 1; on an edge that of alpha only, an ordinary integral there."""

    def sums(level: int) -> list[mpf]:
        # X(s) - X written so that nothing cancels beside the near edge
        table, beyond = nodes(level), abs(X) - 1
        kernel = [-1 / (beyond + 2 * u) if X > 0 else 1 / (beyond + 2 * v) for u, v, _ in table]
        return [2 / pi * fdot(f, kernel) for f in functions(alpha, level)]

    return integrate(sums)


@dataclass(frozen=True, eq=False)
class Contact:
    """A loaded contact."""

    sliding: Sliding
    # P, T, J
    load: mpf
    charge: mpf
    magnetic_charge: mpf

    @cached_property
    def width(self) -> mpf:
        """Contact width l = a + b."""
        s = self.sliding
        return sqrt(2 * s.reduction[2] * s.radius * self.load / (pi * s.alpha * (1 - s.alpha)))

    @cached_property
    def _charge_terms(self) -> list[tuple[int, mpf, mpf, mpf]]:
        """Each conducted field and its factors of sigma_yy, of (c T1 + h/2 T2)/sqrt(1-X^2) and of 1/sqrt(1-X^2)."""
        r, d, lam, kap = self.sliding.reduction
        terms = []
        for j, i in enumerate(self.sliding.conducted):
            total = -(self.charge, self.magnetic_charge)[i - 1] - r[j] * self.load + lam / kap * d[j] * self.load
            of_root = total / (pi * self.width / 2)
            terms.append((i, lam / kap * d[j] - r[j], -d[j] / (kap * self.sliding.radius), of_root))
        return terms

    @cached_property
    def coefficients(self) -> list[list[mpf]]:
        """sigma_yy, D_y and B_y by the four functions, theory section 3."""
        s, h, zero = self.sliding, self.width / 2, mpf(0)
        normal = -sin(pi * s.alpha) / (s.reduction[2] * s.radius) * self.width
        rows = [[normal, zero, zero, zero], [zero] * 4, [zero] * 4]
        for i, of_normal, of_chebyshev, of_root in self._charge_terms:
            rows[i] = [of_normal * normal, of_chebyshev * h * (1 - 2 * s.alpha), of_chebyshev * h / 2, of_root]
        return rows

    def tractions(self, u: mpf, v: mpf) -> list[mpf]:
        """(sigma_xy, sigma_yy, D_y, B_y) in the contact."""
        values = _shape(self.sliding.alpha, u, v) + _roots(u, v)
        normal, *charges = (fdot(row, values) for row in self.coefficients)
        return [self.sliding.friction * normal, normal, *charges]

    def transforms_inside(self, u: mpf, v: mpf) -> list[mpf]:
        """H of the tractions in the contact, theory section 4."""
        s, width = self.sliding, self.width
        normal = self.tractions(u, v)[1]
        h_normal = cot(pi * s.alpha) * normal + width * (v - s.alpha) / (s.reduction[2] * s.radius)
        out = [s.friction * h_normal, h_normal, mpf(0), mpf(0)]
        for i, of_normal, of_chebyshev, _ in self._charge_terms:
            out[i + 1] = of_normal * h_normal + of_chebyshev * width * (v - s.alpha)  # x = c U0 + h/2 U1
        return out

    def transforms_outside(self, X: mpf) -> list[mpf]:
        """H of the tractions at |X| > 1, by quadrature."""
        transforms = _cauchy(self.sliding.alpha, X) + _cauchy(None, X)
        normal, *charges = (fdot(row, transforms) for row in self.coefficients)
        return [self.sliding.friction * normal, normal, *charges]

    def shear_transform_at_edge(self, X: mpf) -> mpf:
        """H of sigma_xy on the edge X = +-1, where the integral is an ordinary one."""
        return self.sliding.friction * self.coefficients[0][0] * _cauchy(self.sliding.alpha, X)[0]

    def punch_response(self, datum: mpf) -> list[mpf]:
        """Depth, voltage and magnetic potential: logarithmic potentials at x = a by quadrature, theory section 6."""
        s, half = self.sliding, self.sliding.half
        log_u, log_1 = (a + b for a, b in zip(_logarithmic(s.alpha), _logarithmic(None), strict=True))
        beyond = log(self.width / datum)
        logarithms = [log_u_f + beyond * f for log_u_f, f in zip(log_u, log_1, strict=True)]
        logarithmic = [self.width * fdot(row, logarithms) for row in self.coefficients]
        shear = matrix(half.shear_coupling) * s.friction * self.width * self.coefficients[0][0] * log_1[0] / 2
        potentials = shear - half.normal_compliance * matrix(logarithmic) / pi
        a = (1 - s.alpha) * self.width
        return [a**2 / (2 * s.radius) - potentials[0], potentials[1], potentials[2]]
