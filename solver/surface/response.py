"""Surface multiplier of half-spaces and stacks of any crystal cut, by the Stroh formalism.

Surface displacements U = (u_x, u_y, u_z, phi[, psi]) and tractions T = (s_xz, s_yz, s_zz, D_z[, B_z]) of a wave
``exp(i k (x cos(theta) + y sin(theta)))`` obey ``k U = Y(k, theta) T`` with a Hermitian Y; the body fills z < 0. Waves
of a layer are ``U = A exp(i k p z) q`` and ``T = i k B exp(i k p z) q``: those with Im p < 0 decay downwards. Only
decaying exponentials occur, and Y - Y0 has full relative accuracy, Y0 the multiplier of the layer's half-space.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array, ComplexArray, outer
from solver.material.constants import MaterialError
from solver.stack.reflection import held

NORMAL, PHI = 2, 3  # indices of (u_z, s_zz) and of (phi, D_z)
_PERTURBATION = 1e-5  # of the stiffness where roots coincide; the mean over both signs is exact to its square
_COINCIDENT = 1e4  # condition number of the eigenvectors above which roots count as coincident
_RESOLVED = 1e-6  # share of the largest harmonic below which harmonics of the direction are rounding
_DIRECTIONS = (8, 16, 32, 64, 128)  # numbers of directions; the smallest that resolves every harmonic is used
_INVARIANT = 1e-9  # relative change of a stiffness on rotation below which a body counts as isotropic about z


class SurfaceError(MaterialError):
    """A body, a shape or a loading that the contact in space refuses."""


@dataclass(frozen=True, eq=False)
class SurfaceLayer:
    """A homogeneous layer of any crystal cut and the interface below the layer."""

    stiffness: Array  # E[i, J, K, l] of T_iJ = E_iJKl dU_K/dx_l, SI; (3, m, m, 3), m = 4 or 5
    thickness: float  # [m]
    grounded: bool = False  # Whether phi = 0 at the interface below
    conductor: bool = False  # Whether phi = 0 at both faces


@dataclass(frozen=True, eq=False)
class SurfaceBody:
    """A half-space (no layers), or layers, the top one first, on an elastic or a rigid grounded base."""

    layers: Sequence[SurfaceLayer]
    base: Array | None = None  # Stiffness of the base, as of a layer; None: rigid and at zero potential
    base_conductor: bool = False  # Whether phi = 0 at the top of the base

    def __post_init__(self) -> None:
        object.__setattr__(self, "layers", tuple(self.layers))

    @cached_property
    def _key(self) -> tuple[object, ...]:
        layers = ((np.asarray(s.stiffness).tobytes(), s.thickness, s.grounded, s.conductor) for s in self.layers)
        return (*layers, None if self.base is None else np.asarray(self.base).tobytes(), self.base_conductor)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, SurfaceBody) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self._key)

    @cached_property
    def stiffnesses(self) -> list[Array]:
        """Stiffness of every layer, and of an elastic base last; (3, m, m, 3) each."""
        bodies = [layer.stiffness for layer in self.layers] + ([] if self.base is None else [self.base])
        return [np.asarray(stiffness, dtype=np.float64) for stiffness in bodies]

    @cached_property
    def half_space(self) -> "SurfaceBody":
        """Half-space of the material under the punch."""
        return SurfaceBody((), self.stiffnesses[0])

    @property
    def thickness(self) -> float:
        """Thickness of the top layer [m]; infinite of a half-space."""
        return self.layers[0].thickness if self.layers else np.inf

    @cached_property
    def fields(self) -> int:
        """Number of components: 5 if a magnetic potential couples to the others, else 4."""
        coupled = any(E.shape[1] > PHI + 1 and np.any(E[:, : PHI + 1, PHI + 1 :]) for E in self.stiffnesses)
        return PHI + 2 if coupled else PHI + 1

    @cached_property
    def couples(self) -> bool:
        """True if displacements couple to a potential in a material."""
        return any(np.any(E[:, :PHI, PHI:]) for E in self.stiffnesses)

    @cached_property
    def scale(self) -> Array:
        """Units of U in which the entries of the stiffness of the top have the order of one; (m,)."""
        diagonal = np.abs(np.einsum("iJJi->J", self.stiffnesses[0]))[: self.fields]
        return np.asarray(1 / np.sqrt(diagonal))

    @cached_property
    def isotropic(self) -> bool:
        """True if every material is isotropic about z."""
        return all(_is_isotropic(stiffness) for stiffness in self.stiffnesses)

    @cached_property
    def decay(self) -> float:
        """Smallest |Im p| of the top's waves over all directions [1]: Y - Y0 decays like exp(-2 decay k h)."""
        E = self._scaled[0][0]
        return float(min(np.min(np.abs(_roots(E, theta).imag)) for theta in np.linspace(0, np.pi, 16, endpoint=False)))

    @cached_property
    def directions(self) -> int:
        """Number of directions over a full turn that resolve every harmonic of Y."""
        count = _DIRECTIONS[-1]
        k = np.array([np.inf]) if not self.layers else np.append(np.geomspace(0.03, 3, 5) / self.thickness, np.inf)
        Y = self.multiplier(k, 2 * np.pi * np.arange(count) / count) / outer(self.scale)
        size = np.max(np.abs(np.fft.fft(Y, axis=1)), axis=(0, 2, 3))
        size[1:] = np.maximum(size[1:], size[:0:-1])
        highest = int(np.max(np.flatnonzero(size[: count // 2] > _RESOLVED * np.max(size))))
        return next((n for n in _DIRECTIONS if n > 2 * highest + 1), count)

    def multiplier(self, k: Array, theta: Array) -> ComplexArray:
        """Multiplier Y of ``k U = Y T``; (k, theta, m, m).

        k: (k,), wavenumbers > 0 [1/m], infinite for the half-space of the top; theta: (theta,), directions [rad].
        """
        half, added = self.response(k, theta)
        return np.asarray(half + added)

    def response(self, k: Array, theta: Array) -> tuple[ComplexArray, ComplexArray]:
        """Multiplier Y0 of the top's half-space, (theta, m, m), and Y - Y0, (k, theta, m, m)."""
        k, theta = np.asarray(k, dtype=np.float64), np.asarray(theta, dtype=np.float64)
        units = outer(self.scale)
        responses = [self._response(stiffnesses, k, theta) for stiffnesses in self._scaled]
        half, added = (sum(parts) / len(responses) * units for parts in zip(*responses, strict=True))
        return np.asarray(half), np.asarray(added)

    @cached_property
    def _scaled(self) -> list[list[Array]]:
        """Scaled stiffnesses; two perturbed variants, whose mean response counts, where roots coincide."""
        m, scale = self.fields, self.scale
        scaled = [E[:, :m, :m] * scale[:, None, None] * scale[:, None] for E in self.stiffnesses]
        modes = [_modes(E, np.array([0.0, 1.0])) for E in scaled]
        if all(np.max(np.linalg.cond(np.concatenate([A, B], -2))) < _COINCIDENT for A, B, _ in modes):
            return [scaled]
        noise = np.random.default_rng(1).uniform(-1, 1, (3, m, m, 3))
        noise = _PERTURBATION * (noise + noise.transpose(3, 2, 1, 0))
        return [
            [E + sign * noise * np.sqrt(np.abs(np.einsum("iJJi,kLLk->iJLk", E, E))) for E in scaled] for sign in (1, -1)
        ]

    def _response(self, stiffnesses: list[Array], k: Array, theta: Array) -> tuple[ComplexArray, ComplexArray]:
        """Y0 and Y - Y0 in the units of the stiffnesses."""
        m = self.fields
        below: ComplexArray = np.zeros((1, theta.size, m, m), np.complex128)
        if self.base is not None:
            A, B, _ = _modes(stiffnesses[-1], theta)
            below = -1j * A[..., :m] @ np.linalg.inv(B[..., :m]) + below
        half, added, conducts = below[0], np.zeros_like(below), self.base_conductor
        for layer, E in reversed(list(zip(self.layers, stiffnesses, strict=False))):
            if (layer.grounded or layer.conductor or conducts) and np.any(below):
                below = held(below, (PHI,))  # layers on a rigid base seen from afar are held already
            A, B, p = _modes(E, theta)
            down, up = (A[..., :m], B[..., :m], p[..., :m]), (A[..., m:], B[..., m:], p[..., m:])
            inverse = np.linalg.inv(down[1])
            half = -1j * down[0] @ inverse
            kh = (k * layer.thickness)[:, None, None]
            reflected = -np.linalg.solve(up[0] - 1j * below @ up[1], down[0] - 1j * below @ down[1])
            with np.errstate(invalid="ignore"):  # of infinite wavenumbers: no reflection
                decays = [np.nan_to_num(np.exp(1j * kh * rates)) for rates in (-down[2], up[2])]
            X = decays[1][..., :, None] * reflected * decays[0][..., None, :]
            added = -1j * (up[0] - down[0] @ inverse @ up[1]) @ X @ np.linalg.inv(down[1] + up[1] @ X)
            below, conducts = half + added, layer.conductor
        return half, added + np.zeros((k.size, 1, 1, 1))


def _roots(E: Array, theta: float) -> ComplexArray:
    return np.asarray(_modes(E, np.array([theta]))[2][0])


def _modes(E: Array, theta: Array) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """A and B, (theta, m, 2 m), and p, (theta, 2 m), the modes with Im p < 0 first."""
    m = E.shape[1]
    direction = np.stack([np.cos(theta), np.sin(theta), np.zeros_like(theta)], -1)
    Q = np.einsum("ti,iJKl,tl->tJK", direction, E, direction)
    R = np.einsum("ti,iJK->tJK", direction, E[..., 2])
    inverse = np.linalg.inv(E[2, :, :, 2])
    upper = np.concatenate([-inverse @ R.mT, np.broadcast_to(inverse, Q.shape)], -1)
    lower = np.concatenate([R @ inverse @ R.mT - Q, -R @ inverse], -1)
    roots, vectors = np.linalg.eig(np.concatenate([upper, lower], -2))
    order = np.argsort(roots.imag, axis=-1)
    roots = np.take_along_axis(roots, order, -1).astype(np.complex128)
    vectors = np.take_along_axis(vectors, order[..., None, :], -1)
    return vectors[..., :m, :], vectors[..., m:, :], roots


def _is_isotropic(E: Array) -> bool:
    """Return whether a stiffness, in any units, is invariant under rotation about z."""
    turn = np.eye(E.shape[1])
    turn[:2, :2] = [[np.cos(1), -np.sin(1)], [np.sin(1), np.cos(1)]]
    turned = np.einsum("ia,JB,KC,ld,aBCd->iJKl", turn[:3, :3], turn, turn, turn[:3, :3], E)
    size = np.sqrt(np.abs(np.einsum("iJJi,kLLk->iJLk", E, E)))
    size = np.max(size, axis=(0, 3), keepdims=True)
    return bool(np.all(np.abs(turned - E) <= _INVARIANT * size))
