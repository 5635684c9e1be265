"""The surface of a stack as a punch meets it: bare, or a grounded electrode without stiffness (films, section 11).

Under the electrode phi = 0 at the surface, and D_y is what the electrode takes: Y of the surface loses phi as at a
grounded interface. With ``Y = Y0 + Delta``, p = Y0_ff and v = Y0_f / p, what the layers add keeps its digits:

    Delta' = D - D_f D_f^T / (p + D_ff),   D = P Delta P^T,  P = I - (v - e) e^T.
"""

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
        """Y of (x, y, phi, psi) [SI] as a punch meets it; (..., 4, 4)."""
        return _grounded(Medium(self.material, np.ones(4)).compliance)

    @property
    def compliance(self) -> Array:
        """N of (y, phi, psi); (..., 3, 3)."""
        return self._held[..., 1:, 1:]

    @property
    def friction_coupling(self) -> Array:
        """k of (y, phi, psi); (..., 3)."""
        return -self._held[..., 1:, 0]

    @property
    def tangential_compliance(self) -> Array:
        """(L^-1)_xx; (...)."""
        return self._held[..., 0, 0]


def _grounded(Y: Array) -> Array:
    """Y (..., 4, 4) of a surface whose electrode is grounded; phi keeps its diagonal entry."""
    out = held(Y, (_PHI,))
    out[..., _PHI, _PHI] = Y[..., _PHI, _PHI]
    return out


def met(stack: Stack) -> HalfPlane:
    """Half-plane of the top layer as a punch meets it."""
    half = stack.media[0].halfplane
    return Electroded(half.material) if stack.electroded else half


def surface(stack: Stack) -> Array:
    """Compliance Y0 of the top layer as a punch meets it, in the units of the stack; (4, 4)."""
    compliance = stack.media[0].compliance
    return _grounded(compliance) if stack.electroded else compliance


def difference(stack: Stack, k: Array) -> Array:
    """Layers' and base's contribution to :func:`surface` at wavenumbers (k,) [1/m]; (k, 4, 4)."""
    added = waves(stack, k)[0].difference
    if not stack.electroded:
        return added
    share = np.eye(4)
    share[:, _PHI] -= local(stack)
    D, pivot = share @ added @ share.T, stack.media[0].compliance[_PHI, _PHI]
    out = D - D[:, :, None, _PHI] * D[:, None, _PHI, :] / (pivot + D[:, _PHI, _PHI])[:, None, None]
    out[:, _PHI, :] = out[:, :, _PHI] = 0.0
    return np.asarray(out)


def lowest(stack: Stack) -> Array:
    """Finite part of Y of the surface as k goes to 0, as a punch meets it; (4, 4)."""
    return held(low(stack), (_PHI,)) if stack.electroded else low(stack)


def local(stack: Stack) -> Array:
    """Charge v of the electrode per traction on it, of the top layer's half-plane, 0 for phi; (4,)."""
    row = stack.media[0].compliance[_PHI]
    return np.asarray(np.where(np.arange(4) == _PHI, 0.0, row / row[_PHI]))
