"""Surface response of a stack at every wavenumber: recursion from the base up (films, section 2).

Under each layer the body below answers ``k u = Y_below t``; the layer's own upward wave is ``Gamma`` times what its
downward wave leaves at the bottom. With ``E = exp(-G k h)`` and ``F = (S E S) Gamma E``,

    Gamma = (S Y0 S + Y_below)^-1 (Y0 - Y_below),    Y_top - Y0 = -(Y0 + S Y0 S) F (I + F)^-1.

Only decaying exponentials occur, and the difference to the layer's own half-plane has full relative accuracy.
"""

from dataclasses import dataclass

import numpy as np

from solver.arrays import Array
from solver.film.fourier import FLIP, Medium, falling
from solver.film.stack import Stack, StackError


@dataclass(frozen=True, eq=False)
class LayerWaves:
    """Waves of one layer at wavenumbers (k,).

    Attributes
    ----------
    medium, thickness
        The layer.
    below
        Y of the body below, before the interface's rules; (k, 4, 4).
    reflection
        Gamma; (k, 4, 4).
    round_trip
        F; (k, 4, 4).
    """

    medium: Medium
    thickness: float
    below: Array
    reflection: Array
    round_trip: Array

    @property
    def amplitude(self) -> Array:
        """(I + F)^-1: the downward wave at the top, per traction there; (k, 4, 4)."""
        return np.asarray(np.linalg.inv(np.eye(4) + self.round_trip), dtype=np.float64)

    @property
    def difference(self) -> Array:
        """Y_top - Y0, with full relative accuracy; (k, 4, 4), symmetric."""
        own = self.medium.compliance
        # F (I + F)^-1 from the transposed system
        both = np.swapaxes(self.round_trip, -1, -2)
        answer = np.swapaxes(np.linalg.solve(np.eye(4) + both, both), -1, -2)
        Y = -(own + FLIP * own) @ answer
        return np.asarray(Y + np.swapaxes(Y, -1, -2)) / 2


def waves(stack: Stack, k: Array) -> list[LayerWaves]:
    """Waves of every layer, the top one first, at wavenumbers k > 0 [1/m]; (k,).

    Raises
    ------
    StackError
        A graded layer, which has no waves of its own.
    """
    if stack.top.graded:
        raise StackError("layers: fields outside the contact and below the surface need layers that are not graded")
    return _recursion(stack, k, 0)[1]


def body_below(stack: Stack, k: Array) -> Array:
    """Y of what lies below the top layer, under the rules of its interface, at wavenumbers k; (k, 4, 4)."""
    return held(_recursion(stack, k, 1)[0], stack.grounded[0])


def _recursion(stack: Stack, k: Array, first: int) -> tuple[Array, list[LayerWaves]]:
    """Y on the top of the layer ``first``, and the waves of this and the layers below."""
    Y = np.zeros((k.size, 4, 4))
    if stack.base_medium is not None:
        Y += stack.base_medium.compliance
    found = []
    for number in range(len(stack.layers) - 1, first - 1, -1):
        medium, thickness = stack.media[number], stack.layers[number].thickness
        before, Y = Y, held(Y, stack.grounded[number])
        own = medium.compliance
        A, B = FLIP * own + Y, own - Y
        if stack.insulated and number == len(stack.layers) - 1:
            A[:, 3], B[:, 3] = np.eye(4)[3], -np.eye(4)[3]
        reflection: Array = np.asarray(np.linalg.solve(A, B), dtype=np.float64)
        E = falling(medium.decay, k * thickness)
        layer = LayerWaves(medium, thickness, before, reflection, (FLIP * E) @ reflection @ E)
        Y = own + layer.difference
        found.append(layer)
    return Y, found[::-1]


def held(Y: Array, components: tuple[int, ...]) -> Array:
    """The body below an interface that holds components of u at zero: its Y for the others; (..., 4, 4)."""
    for c in components:
        pivot = Y[..., c, c]
        share = Y[..., :, c] / np.where(pivot == 0, 1.0, pivot)[..., None]
        Y = Y - share[..., :, None] * Y[..., None, c, :]
        Y[..., c, :] = Y[..., :, c] = 0.0
    return Y


def low(stack: Stack) -> Array:
    """Y_low: finite part of Y at the smallest wavenumbers, the base under all rules of the interfaces; (4, 4)."""
    Y = np.zeros((4, 4)) if stack.base_medium is None else stack.base_medium.compliance
    for components in reversed(stack.grounded):
        Y = held(Y, components)
    return Y


def sideways(stack: Stack) -> float:
    """c_B of Y_psi,psi ~ c_B / k: a stack insulated below passes its flux on sideways [1/m]; else 0."""
    if not stack.insulated:
        return 0.0
    carried = 0.0
    for number in range(len(stack.layers) - 1, -1, -1):
        if 3 in stack.grounded[number]:
            carried = np.inf
        m = stack.layers[number].material
        carried += stack.layers[number].thickness * float(m.mu11 + m.f15**2 / m.c44)
    return -1 / carried / float(stack.scale[3]) ** 2
