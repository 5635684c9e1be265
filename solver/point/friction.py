"""First-order response of half-spaces and layers to friction: tractions, and the tension at the rim (points, 8).

With q = k a, t_o(q) the cosine transform of phi and t_1o(q) the sine transform of psi, layers stretch the rim by

    eps_xx + eps_zz = int Delta_xo [t_o J_0 + t_1o J_1] q dq,    eps_zz = int Delta_xo [t_o J_1 + t_1o J_2] dq;

friction along x acts by Delta_xx and by shear waves with J_1 and J_3.
"""

from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np

from approximation.arrays import Indices
from approximation.chebyshev import legendre_rule
from solver.arrays import Array, BoolArray
from solver.cache import cached
from solver.halfplane.pressing import ContactError
from solver.halfplane.surface import HalfPlane
from solver.point.hankel import bessel_orders
from solver.point.profile import Shape
from solver.point.tractions import Density
from solver.point.waves import ORDERS, ShearWaves
from solver.stack.electroded import difference
from solver.stack.layers import Stack
from solver.stack.wavenumbers import strip, wavenumbers

_EDGE = np.ones(1)


@dataclass(frozen=True, eq=False)
class Response:
    """Half-space's response to friction per eta, without layers (P8.1)."""

    compliance: Array  # N of the contact; (..., 3, 3)
    coupling: Array  # k of the contact; (..., 3)
    shape: Shape  # The punch

    def part(self, cases: Indices) -> "Response":
        """Responses of some of the cases."""
        return Response(self.compliance[cases], self.coupling[cases], self.shape)

    @cached_property
    def factors(self) -> tuple[Array, Array]:
        """Return N^-1 k, and (2/pi) e rise N^-1 e_y for a unit shift; (..., 3) each."""
        inverse = np.linalg.inv(self.compliance)
        unit = 2 / np.pi * self.shape.exponent * self.shape.rise
        by_friction = np.einsum("...ij,...j->...i", inverse, self.coupling)
        return np.asarray(by_friction), np.asarray(unit * inverse[..., 0])

    def shift(self, hilbert: Array) -> Array:
        """Shift c/a times the densities' unit that makes the edge smooth, from H[phi_sigma] at the edge; (...)."""
        if self.shape.flat:  # a disc does not shift
            return np.zeros_like(hilbert)
        by_friction, by_shift = self.factors
        return np.asarray(by_friction[..., 0] * hilbert / by_shift[..., 0])

    def closed(self, hilbert: Array, b: Array, shift: Array) -> Array:
        """Density psi of H[phi_sigma], (..., b), and of shifts c/a times the densities' unit, (...); (..., 3, b)."""
        by_friction, by_shift = self.factors
        return np.asarray(
            shift[..., None, None] * by_shift[..., None] * b ** (self.shape.exponent - 1)
            - by_friction[..., None] * hilbert[..., None, :]
        )

    def smooth(self, hilbert: Array, series: Array, edges: Array) -> Array:
        """Return the shift c/a that makes the edge smooth, and the layers' series of psi; (cause, 1 + 3 n).

        hilbert: (cause,), H[phi_sigma] at the edge; series: (3, n, cause + 1), per cause, then per unit shift; edges:
        (cause + 1,), the layers' part of sigma_yy at the edge.
        """
        shift = np.zeros_like(hilbert)
        if not self.shape.flat:  # a disc does not shift
            closed_edge = self.closed(hilbert[:, None], _EDGE, np.zeros(hilbert.size))[:, 0, 0]
            per_shift = edges[-1] + self.closed(np.zeros((1, 1)), _EDGE, np.ones(1))[0, 0, 0]
            shift = -(closed_edge + edges[:-1]) / per_shift
        shifted = np.moveaxis(series[..., :-1] + series[..., -1:] * shift, -1, 0)
        return np.concatenate([shift[:, None], shifted.reshape(shift.size, -1)], 1)


def contact_coupling(coupling: Array, scale: Array, punch: Array | float, conducts: BoolArray) -> Array:
    """Coupling k of the contact from the body's, less k_p of the punch, in the body's units; (..., 3)."""
    both_surfaces = coupling - np.asarray(punch / (scale[..., 0] * scale[..., 1]))[..., None] * np.eye(3)[0]
    return np.where(np.concatenate([np.ones_like(conducts[..., :1]), conducts], -1), both_surfaces, 0.0)


def legendre(b: Array, count: int) -> Array:
    """Polynomials P_n(2 b - 1) at b, (b,) from 0 to 1; (b, n)."""
    return np.asarray(np.polynomial.legendre.legvander(2 * b - 1, count - 1))


def legendre_rates(b: Array, count: int) -> Array:
    """Derivatives d P_n(2 b - 1) / db at b, (b,) from 0 to 1; (b, n)."""
    derived = np.polynomial.legendre.legder(np.eye(count), axis=0)
    return np.asarray(2 * np.polynomial.legendre.legvander(2 * b - 1, len(derived) - 1) @ derived)


_ANGLES = 60  # nodes of the integrals around the edge


@dataclass(frozen=True, eq=False)
class Rim:
    """Constants of the top material for stresses just outside the contact, SI; (case,) each, or of one body."""

    coupling: Array  # k of the body; (..., 3)
    # C11 = c11 - h T3^-1 h, and c11 - c12 [Pa]
    stiffness: Array
    shear: Array
    share: Array  # h T3^-1; (..., 3)
    # (L^-1)_xx, and 1 / sqrt(c44 c66) [1/Pa]
    tangential: Array
    transverse: Array

    @classmethod
    def of(cls, half: HalfPlane) -> "Rim":
        """Rim of a material with c12."""
        m = half.material
        shear = np.asarray(m.c11 - m.c12)
        transverse = 1 / np.sqrt(m.c44 * shear / 2)
        of_body = half.friction_coupling, half.in_plane_stiffness, shear, half.in_plane_share
        return cls(*of_body, half.tangential_compliance, transverse)

    def part(self, cases: Indices | int) -> "Rim":
        """Rim of some of the cases, or the one body."""
        if self.coupling.ndim == 1:
            return self
        return Rim(*(getattr(self, field.name)[cases] for field in fields(self)))

    def tension(self, moments: Array, sums: tuple[Array, Array]) -> Array:
        """Stress sigma_xx of a half-space at the trailing edge [Pa], from tractions below the contact (P8.3); (...)."""
        # moments: int_0^1 (t s + t_1 s^2) ds of (sigma_yy, D_y, B_y), SI, (..., 3)
        first, third = sums  # eta times :func:`edge_sums`, SI
        along, across = self.tangential, self.transverse * self.shear / 4
        stress = self.shear * np.einsum("...i,...i->...", self.coupling, moments)
        stress = stress - (along * (self.stiffness - self.shear / 4) + across) * first
        return np.asarray(stress + (along * self.shear / 4 - across) * third)

    def charged(self, charges: Array) -> Array:
        """Stress sigma_xx [Pa] of surface charges (0, D_y, B_y), (..., 3), just outside the edge; (...)."""
        return np.asarray(np.einsum("...i,...i->...", self.share - self.stiffness[..., None] * self.coupling, charges))


def edge_sums(pressed: Density) -> tuple[Array, Array]:
    """Return I_n = -int_0^(pi/2) phi_sigma'(sin angle) sin(n angle) d angle, n of 1 and 3; (column,) each."""
    gauss, gauss_weights = legendre_rule(_ANGLES)
    angle, weights = np.pi / 4 * (1 + gauss), np.pi / 4 * gauss_weights
    falling = pressed.falling(np.sin(angle))[:, 0]
    return falling @ (np.sin(angle) * weights), falling @ (np.sin(3 * angle) * weights)


_LONGEST = 2e4  # largest distance over the width of the strip: some seconds, and a gigabyte
_FAR = 20.0  # distance over the longer of contact radius and thickness beyond which functions of b fall as powers
_FALLING = 2, 3  # these powers, of cosines and of sines


def require_thin(stack: Stack) -> None:
    """Refuse layers so thick over the top one that the tension at the edge would take minutes and gigabytes."""
    top, most = stack.top.thickness, _LONGEST * strip(stack) / _FAR
    if stack.thickness > most:
        raise ContactError(
            f"friction: the layers are {stack.thickness / top:.4g} times as thick as the top one, under which the "
            f"tension beside a sliding point in air is resolved up to {most / top:.3g} times; take the thick layer as "
            "base"
        )


def added_tension(stack: Stack, rim: Rim, ratio: float, b: Array, plain: Array, turned: Array) -> float:
    """Layers' part of sigma_xx at the trailing edge [Pa], from the arrays of ``SlidingPoint.weighted``."""
    last = _FAR * max(1.0, stack.thickness / ratio)
    k, added, sheared = _waves(stack, int(np.ceil(np.log2(ratio * (2 + last)))))
    q, near = k * ratio, b < last
    phases = q[:, None] * np.append(b[near], last)
    cosines, sines = np.cos(phases), np.sin(phases)
    falling = (last / b[~near]) ** np.array(_FALLING)[:, None]

    def merged(values: Array, far_weights: Array) -> Array:
        """Merge the far values into one at ``last``; (b, channel)."""
        return np.append(values[:, near], (values[:, ~near] @ far_weights)[:, None], 1).T

    first, second = cosines @ merged(plain, falling[0]), sines @ merged(turned[1:], falling[1])
    J = bessel_orders(q, np.ones(1), ORDERS)[..., 0]
    dilation = q * J[0] * first.T + q * J[1] * second.T
    hoop = J[1] * first.T + J[2] * second.T
    dilated = np.einsum("ki,ik->", added[:, 0, 1:], rim.stiffness * dilation - rim.shear * hoop)
    shear = q * (cosines @ merged(turned[:1], falling[0]))[:, 0]
    along, across = (3 * J[1] - J[3]) / 4, (J[1] + J[3]) / 4
    straight = added[:, 0, 0] * (rim.stiffness * along + (rim.stiffness - rim.shear) * across)
    return float(ratio * stack.scale[0] * (dilated - shear @ (straight + sheared * rim.shear * across)))


@cached
def _waves(stack: Stack, power: int) -> tuple[Array, Array, Array]:
    """Wavenumbers for distances up to a power of two, and Delta and k u over tau of shear waves, times weights."""
    k, weights = wavenumbers(stack, 2.0**power, strip(stack))
    shear = ShearWaves(stack, k).at(0, np.zeros(1), reflected=True)[0, :, 0] / stack.scale[0] ** 2
    return k, difference(stack, k) * weights[:, None, None], shear * weights
