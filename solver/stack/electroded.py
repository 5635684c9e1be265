"""The surface of a stack as a punch meets it: bare, or a grounded electrode without stiffness (films, section 11).

Under the electrode phi = 0 at the surface, and D_y is what the electrode takes: Y of the surface loses phi as at a
grounded interface. With ``Y = Y0 + Delta``, p = Y0_ff and v = Y0_f / p, what the layers add keeps its digits:

    Delta' = D - D_f D_f^T / (p + D_ff),   D = P Delta P^T,  P = I - (v - e) e^T.
"""

from functools import cached_property

import numpy as np

from solver.arrays import Array
from solver.halfplane.surface import HalfPlane
from solver.stack.layers import Stack
from solver.stack.reflection import held, low, waves

_PHI = 2  # of (x, y, phi, psi)


class Electroded(HalfPlane):
    """Half-plane whose surface is a grounded electrode; phi has a diagonal entry only."""

    @cached_property
    def _bare(self) -> HalfPlane:
        return HalfPlane(self.material)

    @cached_property
    def compliance(self) -> Array:
        """N of (y, phi, psi); (..., 3, 3)."""
        full = self._bare.compliance
        bare = full - self._shares[..., 1:, None] * full[..., None, 1, :]
        bare[..., 1, :] = bare[..., :, 1] = 0.0
        bare[..., 1, 1] = full[..., 1, 1]
        return np.asarray(bare)

    @cached_property
    def friction_coupling(self) -> Array:
        """k of (y, phi, psi); (..., 3)."""
        full = self._bare.friction_coupling
        bare = full - self._shares[..., 1:] * full[..., 1:2]
        bare[..., 1] = 0.0
        return np.asarray(bare)

    @cached_property
    def tangential_compliance(self) -> Array:
        """(L^-1)_xx; (...)."""
        return np.asarray(
            self._bare.tangential_compliance + self._shares[..., 0] * self._bare.friction_coupling[..., 1]
        )

    @cached_property
    def _shares(self) -> Array:
        """Shares v of (x, y, phi, psi); (..., 4)."""
        N, k = self._bare.compliance, self._bare.friction_coupling
        return np.concatenate([-k[..., 1:2], N[..., 1]], -1) / N[..., 1, 1, None]


def met(stack: Stack) -> HalfPlane:
    """Half-plane of the top layer as a punch meets it."""
    half = stack.media[0].halfplane
    return Electroded(half.material) if stack.electroded else half


def surface(stack: Stack) -> Array:
    """Compliance Y0 of the top layer as a punch meets it, in the units of the stack; (4, 4)."""
    compliance = stack.media[0].compliance
    if not stack.electroded:
        return compliance
    Y = held(compliance, (_PHI,))
    Y[_PHI, _PHI] = compliance[_PHI, _PHI]
    return Y


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
