"""Coefficients of the integral equations (theory, 2.2 and 3.1) for a material, friction, conduction and punch."""

from dataclasses import dataclass, field
from functools import cache, cached_property
from math import factorial
from typing import Self

import numpy as np
import scipy  # scipy.special, slow to import, and not every job solves
from numpy.typing import ArrayLike

from solver.arrays import Array, BoolArray, column, dot, outer, stack
from solver.halfplane.surface import HalfPlane, shared_by_cases

_DIGITS = 37.0  # -log of the rounding unit


@cache
def digamma_series() -> Array:
    """Taylor coefficients of (digamma(3/2 + delta) - digamma(3/2)) / delta, to rounding for |delta| <= 1/2; (48,)."""
    return np.array([float(scipy.special.polygamma(n, 1.5)) / factorial(n) for n in range(1, 49)])


@dataclass(frozen=True, eq=False)
class FrictionAngle:
    """Friction angle theta of each case, and functions of it; (...) each."""

    tan: Array  # tan(theta) = eta kap / lam

    @cached_property
    def cos(self) -> Array:
        """Cosine of theta, sin(pi alpha)."""
        return 1 / np.hypot(1.0, self.tan)

    @cached_property
    def delta(self) -> Array:
        """Angle over pi, alpha - 1/2."""
        return np.arctan(self.tan) / np.pi

    @cached_property
    def digamma_difference(self) -> Array:
        """(digamma(3/2 + delta) - digamma(3/2)) / delta by its Taylor series of radius 3/2."""
        series = digamma_series()
        largest = float(np.max(np.abs(self.delta), initial=0.0))
        terms = series.size if not 0 < largest < 0.5 else 3 + int(_DIGITS / np.log(1.5 / largest))
        value = np.full_like(self.delta, series[terms - 1])
        for coefficient in series[terms - 2 :: -1]:
            value *= self.delta
            value += coefficient
        return value

    @cached_property
    def delta_over_tan(self) -> Array:
        """Ratio delta / tan(theta), 1/pi without friction."""
        return self.cos / (np.pi * np.sinc(self.delta))

    @cached_property
    def log_cos_over_tan(self) -> Array:
        """Ratio log(cos theta) / tan(theta), 0 without friction."""
        return -self.tan / (2 * scipy.special.exprel(np.log1p(self.tan**2)))


@dataclass(frozen=True, eq=False)
class Punch:
    """Elasticity of a punch (theory, section 9), by default rigid."""

    compliance: Array = field(default_factory=lambda: np.zeros(()))  # N_p [1/Pa]; (...)
    coupling: Array = field(default_factory=lambda: np.zeros(()))  # k_p [1/Pa]; (...)

    @classmethod
    def isotropic(cls, young: ArrayLike, poisson: ArrayLike) -> Self:
        """Return the punch of an isotropic material with Young's modulus [Pa] and Poisson's ratio."""
        E, nu = np.asarray(young, dtype=np.float64), np.asarray(poisson, dtype=np.float64)
        return cls(2 * (1 - nu**2) / E, -(1 + nu) * (1 - 2 * nu) / E)


#: A punch that does not deform.
RIGID_PUNCH = Punch()


@dataclass(frozen=True, eq=False)
class Sliding:
    """Elimination of the conducted fields from (2.2)."""

    halfplane: HalfPlane
    friction: Array  # eta; (...)
    conducts: BoolArray  # Whether the punch conducts (electric, magnetic); (..., 2)
    punch: Punch = RIGID_PUNCH

    @cached_property
    def distinct(self) -> "Sliding":
        """Sliding on the distinct half-planes, unless the cases differ in conduction or punch."""
        varies = self.conducts.size > 2 or self.punch.compliance.size > 1 or self.punch.coupling.size > 1
        distinct = self.halfplane.distinct
        if varies or distinct is self.halfplane:
            return self
        return Sliding(distinct, np.zeros(()), self.conducts.reshape(2), self.punch)

    def of_cases(self, values: Array) -> Array:
        """Repeat values of the distinct half-planes (distinct, ...) for the cases; (case, ...)."""
        return self.halfplane.of_cases(values)

    @shared_by_cases
    def compliance(self) -> Array:
        """N of (2.2), with that of the punch at (y, y); (..., 3, 3)."""
        return np.asarray(self.halfplane.compliance + column(self.punch.compliance) * np.diag([1.0, 0.0, 0.0]))

    @shared_by_cases
    def coupling(self) -> Array:
        """k of (2.2), minus that of the punch at y; (..., 3)."""
        return np.asarray(self.halfplane.friction_coupling - self.punch.coupling[..., None] * np.array([1.0, 0.0, 0.0]))

    @shared_by_cases
    def screening(self) -> Array:
        """Response r = M^-1 n of the conducted fields to the pressure; (..., 2)."""
        return self._solve_conducted(self.halfplane.compliance[..., 1:, 0])

    @shared_by_cases
    def friction_screening(self) -> Array:
        """Response d = M^-1 kq of the conducted fields to friction; (..., 2)."""
        return self._solve_conducted(self.halfplane.friction_coupling[..., 1:])

    def _solve_conducted(self, right: Array) -> Array:
        """M^-1 right (..., 2) over the conducted fields, 0 for others, with M scaled to the order of one; (..., 2)."""
        M = self.halfplane.compliance[..., 1:, 1:]
        scale = 1 / np.sqrt(np.abs(np.linalg.diagonal(M)))
        conducted = self.conducts[..., :, None] & self.conducts[..., None, :]
        scaled = np.where(conducted, M * outer(scale), np.eye(2))
        masked = np.where(self.conducts, scale * right, 0.0)
        return np.asarray(np.linalg.solve(scaled, masked[..., None])[..., 0] * scale)

    @shared_by_cases
    def normal_compliance(self) -> Array:
        """N_J0 - N_Jq.r of J = (u_y, phi, psi), lam for u_y and 0 for a conducted field; (..., 3)."""
        return self._eliminated(self.compliance[..., 0], self.screening)

    @shared_by_cases
    def friction_coupling(self) -> Array:
        """k_J - N_Jq.d of J = (u_y, phi, psi), kap for u_y and 0 for a conducted field; (..., 3)."""
        return self._eliminated(self.coupling, self.friction_screening)

    def _eliminated(self, direct: Array, screening: Array) -> Array:
        """Values (..., 3) minus N_Jq times the response (..., 2) of the conducted fields; (..., 3)."""
        N = self.halfplane.compliance
        values = stack(*(direct[..., J] - dot(N[..., J, 1:], screening) for J in range(3)))
        return np.concatenate([values[..., :1], np.where(self.conducts, 0.0, values[..., 1:])], -1)

    @property
    def lam(self) -> Array:
        """Normal compliance N11 - n.r > 0 under the punch [1/Pa]; (...)."""
        return self.normal_compliance[..., 0]

    @property
    def kap(self) -> Array:
        """Friction coupling k1 - n.d under the punch, negative for the usual materials [1/Pa]; (...)."""
        return self.friction_coupling[..., 0]

    @cached_property
    def angle(self) -> FrictionAngle:
        """Friction angle theta."""
        return FrictionAngle(self.friction * self.kap / self.lam)
