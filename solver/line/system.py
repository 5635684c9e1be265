"""The contact as a linear system at given half-lengths, in the units of the stack (films, section 4).

Unknowns are the terms of the pressure, those of the conducted fields and, between smooth edges, a constant slope. The
half-length is divided out: ``P = h load``, ``T = h charge``.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array, outer
from solver.halfplane.sliding import Sliding
from solver.line.basis import Basis
from solver.line.kernel import Kernel

#: Positions X, edges included, at which the pressure over its weight is sampled to find tension.
SAMPLES: Array = np.cos(np.pi * np.arange(193) / 192)

_SAMPLES = 13.5  # half the logarithm of the error of the rules that integrate the kernels
_NO_COUPLING = 1e-6  # of lam: a friction coupling kap below this is replaced by it (films, section 4)


@dataclass(frozen=True, eq=False)
class Coefficients:
    """Coefficients of sliding on the top material for one friction and conduction, in the units of the stack."""

    friction: float  # eta
    fields: tuple[int, ...]  # Conducted fields among (0 electric, 1 magnetic)
    delta: float  # Friction angle over pi
    # Compliance and friction coupling under the punch
    lam: float
    kap: float
    # r and d over both fields, 0 where not conducted; (2,)
    screening: Array
    friction_screening: Array
    inverse: Array  # M^-1 over the conducted fields; (fields, fields)
    # N (3, 3), k (3,) and (L^-1)_xx of the body
    compliance: Array
    coupling: Array
    tangential: float
    # N_p and -k_p, which an elastic punch adds to N11 and k1 in the contact conditions
    punch: tuple[float, float] = (0.0, 0.0)

    @classmethod
    def of(cls, sliding: Sliding, scale: Array) -> "Coefficients":
        """Return the coefficients of a sliding without case axes, in the units ``scale`` (4,) of a stack."""
        half, units = sliding.halfplane, scale[1:]
        fields = tuple(int(f) for f in np.flatnonzero(sliding.conducts))
        N = half.compliance / outer(units)
        conducted = np.array(fields, dtype=int) + 1
        lam = float(sliding.lam) / units[0] ** 2
        kap = float(sliding.kap) / units[0] ** 2
        if abs(kap) < _NO_COUPLING * lam:
            kap = float(np.copysign(_NO_COUPLING * lam, kap))
        return cls(
            friction=float(sliding.friction),
            fields=fields,
            delta=float(np.arctan(float(sliding.friction) * kap / lam) / np.pi),
            lam=lam,
            kap=kap,
            screening=sliding.screening * units[1:] / units[0],
            friction_screening=sliding.friction_screening * units[1:] / units[0],
            inverse=np.linalg.inv(N[np.ix_(conducted, conducted)]),
            compliance=N,
            coupling=half.friction_coupling / (units * scale[0]),
            tangential=float(half.tangential_compliance) / float(scale[0]) ** 2,
            punch=(float(sliding.punch.compliance) / units[0] ** 2, -float(sliding.punch.coupling) / units[0] ** 2),
        )

    @property
    def follower(self) -> Array:
        """D1 = (lam / kap) d - r, the part of (D_y, B_y) proportional to the pressure (F4.1); (2,)."""
        return np.asarray(self.lam / self.kap * self.friction_screening - self.screening)


@dataclass(frozen=True, eq=False)
class System:
    """Contacts of one stack, friction, conduction and kind of edges at any half-length."""

    kernel: Kernel
    sliding: Sliding
    smooth: tuple[bool, bool]  # Whether the trailing and the leading edge are smooth
    degree: int  # Largest power of X in the punch's slope
    accuracy: float = 1.0  # Factor on the number of terms

    @cached_property
    def coefficients(self) -> Coefficients:
        """Coefficients of the sliding in the units of the stack."""
        return Coefficients.of(self.sliding, self.kernel.stack.scale)

    @property
    def fields(self) -> tuple[int, ...]:
        """Conducted fields among (0 electric, 1 magnetic)."""
        return self.coefficients.fields

    @property
    def powers(self) -> range:
        """Powers of X among the right sides; between smooth edges the constant is an unknown instead."""
        return range(1 if all(self.smooth) else 0, self.degree + 1)

    @property
    def causes(self) -> int:
        """Number of right sides: powers of X in the slope, T, J and, between corners, P."""
        return len(self.powers) + 2 + (not any(self.smooth))

    def basis(self, half_length: float) -> Basis:
        """Basis whose terms resolve contacts up to a half-length [m]."""
        terms = self.terms(half_length)
        samples = terms // 2 + 6 + int(_SAMPLES / np.arcsinh(self.kernel.width / half_length))
        return Basis(self.coefficients.delta, self.smooth, terms, samples)

    def terms(self, half_length: float) -> int:
        """Even number M of terms for errors of 1e-8 or less at a half-length [m] (films, section 4)."""
        stack = self.kernel.stack
        ratio = half_length / (stack.top.thickness * min(float(stack.media[0].slowest), 1.0))
        count = self.accuracy * 0.8 * (16 + 7 * np.sqrt(ratio) + 0.2 * ratio) + self.degree
        return max(2 * int(np.ceil(count / 2)), 8)

    def solve(self, basis: Basis, gradients: Array, sources: Array | None = None) -> Array:
        """Unknowns for every right side, from kernel gradients (half, 3, M, unknown); (half, unknown, right side)."""
        matrix = self._matrix(basis, gradients)
        count = len(self.powers)
        slopes = np.zeros((1, 3, basis.terms, count))
        slopes[0, 0] = basis.nodes[:, None] ** np.array(self.powers)
        right = np.zeros((matrix.shape[-1], self.causes))
        right[:, :count] = self._projected(basis, slopes)[0]
        if basis.order == -1:
            right[0, -1] = 1.0
        for f, start in self.starts(basis).items():
            right[start, count + f] = -1.0
        right_sides = np.broadcast_to(right, (*matrix.shape[:-1], self.causes))
        if sources is not None:  # gradients to cancel
            right_sides = np.concatenate([right_sides, -self._projected(basis, sources)], -1)
        return np.asarray(np.linalg.solve(matrix, right_sides), dtype=np.float64)

    def _projected(self, basis: Basis, gradients: Array) -> Array:
        """Projections of gradients of (u_y, phi, psi), (half, 3, M, c), in the rows of F4.3; (half, unknown, c)."""
        pressed, charged = self.eliminated(gradients)
        projected, series = basis.projection @ pressed, basis.charge_projection @ charged
        rows = np.zeros((gradients.shape[0], self.unknowns(basis), gradients.shape[-1]))
        rows[:, max(-basis.order, 0) : basis.pressures] = projected[:, max(basis.order, 0) :]
        if basis.order == 1:
            rows[:, -1] = projected[:, 0]
        for j, start in enumerate(self.starts(basis).values()):
            rows[:, start + 1 : start + 1 + basis.terms] = series[:, j]
        return rows

    def starts(self, basis: Basis) -> dict[int, int]:
        """Index of the first unknown of each conducted field."""
        return {f: basis.pressures + j * (basis.terms + 1) for j, f in enumerate(self.fields)}

    def unknowns(self, basis: Basis) -> int:
        """Number of unknowns."""
        return basis.pressures + len(self.fields) * (basis.terms + 1) + (basis.order == 1)

    def split(self, basis: Basis, unknowns: Array) -> tuple[Array, Array]:
        """Return s (..., pressures) and c (..., 2, M + 1), 0 where not conducted, of unknowns (..., unknown)."""
        charges = np.zeros((*unknowns.shape[:-1], 2, basis.terms + 1))
        for f, start in self.starts(basis).items():
            charges[..., f, :] = unknowns[..., start : start + basis.terms + 1]
        return unknowns[..., : basis.pressures], charges

    def eliminated(self, gradients: Array) -> tuple[Array, Array]:
        """K_hat (half, M, c) and M^-1 K_q - (d / kap) K_hat (half, field, M, c) of gradients (half, 3, M, c) (F4.3)."""
        c, flux = self.coefficients, gradients[:, [1 + f for f in self.fields]]
        pressed = gradients[:, 0] - np.einsum("f,hfmz->hmz", c.screening[list(self.fields)], flux)
        ratio = c.friction_screening[list(self.fields), None, None] / c.kap
        return pressed, np.einsum("fg,hgmz->hfmz", c.inverse, flux) - ratio * pressed[:, None]

    def _matrix(self, basis: Basis, gradients: Array) -> Array:
        """Matrix of the system F4.3; (half, unknown, unknown)."""
        c, matrix = self.coefficients, self._projected(basis, gradients)
        diagonal = np.arange(max(-basis.order, 0), basis.pressures)
        matrix[:, diagonal, diagonal] -= c.lam * basis.gain
        if basis.order == 1:
            matrix[:, -1, -1] = -1.0
        if basis.order == -1:
            matrix[:, 0, 0] = -basis.total
        for f, start in self.starts(basis).items():
            rows = np.arange(start + 1, start + 1 + basis.terms)
            matrix[:, rows, rows] += 1.0
            if basis.order == 1:
                matrix[:, rows[0], -1] += c.friction_screening[f] / c.kap
            matrix[:, start, start] = np.pi
            matrix[:, start, 0] = c.follower[f] * basis.total
        return matrix
