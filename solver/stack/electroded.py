"""Response of a stack's surface to a punch, bare or as a grounded electrode without stiffness (films, F11.4)."""

from functools import cached_property

import numpy as np

from solver.arrays import Array
from solver.halfplane.surface import HalfPlane
from solver.stack.fourier import Medium
from solver.stack.layers import Stack
from solver.stack.reflection import held, low, waves

_PHI = 2  # of (x, y, phi, psi)


class Electroded(HalfPlane):
    """Half-plane whose surface is a grounded electrode; phi has a diagonal entry only."""

    @cached_property
    def _held(self) -> Array:
        """Y of (x, y, phi, psi) under the electrode, SI; (..., 4, 4)."""
        return _grounded(Medium(self.material, np.ones(4)).compliance)

    @property
    def compliance(self) -> Array:
        """Compliance N of (y, phi, psi); (..., 3, 3)."""
        return self._held[..., 1:, 1:]

    @property
    def friction_coupling(self) -> Array:
        """Friction coupling k of (y, phi, psi); (..., 3)."""
        return -self._held[..., 1:, 0]

    @property
    def tangential_compliance(self) -> Array:
        """Tangential compliance (L^-1)_xx; (...)."""
        return self._held[..., 0, 0]


def _grounded(Y: Array) -> Array:
    """Return Y (..., 4, 4) of a surface whose electrode is grounded; phi keeps its diagonal entry."""
    out = held(Y, (_PHI,))
    out[..., _PHI, _PHI] = Y[..., _PHI, _PHI]
    return out


def met(stack: Stack) -> HalfPlane:
    """Return the half-plane of the top layer, with the electrode if there is one."""
    half = stack.media[0].halfplane
    return Electroded(half.material) if stack.electroded else half


def surface(stack: Stack) -> Array:
    """Y0 of the top layer, under the electrode if there is one, in the units of the stack; (4, 4)."""
    compliance = stack.media[0].compliance
    return _grounded(compliance) if stack.electroded else compliance


def difference(stack: Stack, k: Array) -> Array:
    """Delta, the difference of the whole stack from :func:`surface`, at wavenumbers (k,) [1/m]; (k, 4, 4)."""
    delta = waves(stack, k)[0].difference
    if not stack.electroded:
        return delta
    row = stack.media[0].compliance[_PHI]
    pivot, P = row[_PHI], np.eye(4)
    P[:, _PHI] -= np.where(np.arange(4) == _PHI, 0.0, row / pivot)
    D = P @ delta @ P.T
    out = D - D[:, :, None, _PHI] * D[:, None, _PHI, :] / (pivot + D[:, _PHI, _PHI])[:, None, None]
    out[:, _PHI, :] = out[:, :, _PHI] = 0.0
    return np.asarray(out)


def lowest(stack: Stack) -> Array:
    """Finite part of Y of the surface, under the electrode if there is one, as k goes to 0; (4, 4)."""
    return held(low(stack), (_PHI,)) if stack.electroded else low(stack)
