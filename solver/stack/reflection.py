"""Surface response of a stack at every wavenumber: recursion from the base up (films, section 2).

Under each layer the body below answers ``k u = Y_below t``; the layer's own upward wave is ``Gamma`` times what its
downward wave leaves at the bottom. With ``E = exp(-G k h)`` and ``F = (S E S) Gamma E``,

    Gamma = (S Y0 S + Y_below)^-1 (Y0 - Y_below),    Y_top - Y0 = -(Y0 + S Y0 S) F (I + F)^-1.

Only decaying exponentials occur, and the difference to the layer's own half-plane has full relative accuracy. Above an
insulated base ``Y_psi,psi ~ c_B / k``: there ``I + F`` is singular as k goes to 0 and loses 1/(kH) of its digits. Long
waves take the layers by the exponential of their system instead, in which nothing cancels.
"""

from dataclasses import dataclass

import numpy as np

from solver.arrays import Array, ComplexArray
from solver.stack.fourier import FLIP, MIRROR, Medium
from solver.stack.layers import Stack

_LONG = 0.1  # kH below which waves above an insulated base are long
_DEGREE = 24  # of the Taylor polynomial of a layer's transfer at kH = 0.1, whatever its roots


@dataclass(frozen=True, eq=False)
class LayerWaves:
    """Waves of one layer at wavenumbers (k,)."""

    # The layer
    medium: Medium
    thickness: float
    below: Array  # Y of the body below, before the interface's rules; (k, 4, 4)
    reflection: Array  # Gamma; (k, 4, 4)
    round_trip: Array  # F; (k, 4, 4)
    difference: Array  # Y_top - Y0, with full relative accuracy; (k, 4, 4), symmetric

    @property
    def amplitude(self) -> Array:
        """(I + F)^-1: the downward wave at the top, per traction there; (k, 4, 4)."""
        return np.asarray(np.linalg.inv(np.eye(4) + self.round_trip), dtype=np.float64)


def waves(stack: Stack, k: Array) -> list[LayerWaves]:
    """Waves of every layer, the top one first, at wavenumbers k > 0 (k,) [1/m]."""
    Y = np.zeros((k.size, 4, 4))
    if stack.base_medium is not None:
        Y += stack.base_medium.compliance
    layers = []
    long = (k * stack.thickness < _LONG) & stack.insulated
    for number in range(len(stack.layers) - 1, -1, -1):
        medium, thickness = stack.media[number], stack.layers[number].thickness
        before, Y = Y, held(Y, stack.grounded[number])
        compliance = medium.compliance
        A, B = FLIP * compliance + Y, compliance - Y
        if stack.insulated and number == len(stack.layers) - 1:
            A[:, 3], B[:, 3] = np.eye(4)[3], -np.eye(4)[3]
        reflection: Array = np.asarray(np.linalg.solve(A, B), dtype=np.float64)
        E = medium.falling(k * thickness)
        round_trip = (FLIP * E) @ reflection @ E
        added = _difference(compliance, round_trip)
        if np.any(long):
            lowest = number == len(stack.layers) - 1
            through = _transfer(medium, k[long] * thickness)
            added[long] = (_above_insulated(through) if lowest else _above(through, Y[long])) - compliance
        layers.append(LayerWaves(medium, thickness, before, reflection, round_trip, added))
        Y = compliance + added
    return layers[::-1]


def _difference(compliance: Array, round_trip: Array) -> Array:
    """Y_top - Y0 = -(Y0 + S Y0 S) F (I + F)^-1, from the transposed system; (k, 4, 4), symmetric."""
    transposed = np.swapaxes(round_trip, -1, -2)
    answer = np.swapaxes(np.linalg.solve(np.eye(4) + transposed, transposed), -1, -2)
    Y = -(compliance + FLIP * compliance) @ answer
    return np.asarray(Y + np.swapaxes(Y, -1, -2)) / 2


def _transfer(medium: Medium, s: Array) -> Array:
    """(k u, t) at the top of a layer from those at its bottom, every entry to full accuracy, s = k h; (k, 8, 8)."""
    units_ratio = (
        medium.halfplane.scale / medium.scale
    )  # in units of its own, entries of the system are of the order of one
    units = np.concatenate([units_ratio, 1 / units_ratio])
    system = medium.system / units[:, None] * units
    part: Array = np.eye(8) + np.zeros((s.size, 1, 1))
    for degree in range(_DEGREE, 0, -1):
        part = np.eye(8) + (s[:, None, None] / degree) * (system @ part)
    return np.asarray(part * units[:, None] / units)


def _above_insulated(through: Array) -> Array:
    """Y on top of a layer with u = 0, phi = 0 and B_y = 0 below; (k, 4, 4)."""
    free = through[..., [4, 5, 6, 3]]  # by t_x, t_y, D_y and k psi at the bottom
    return _quotient(free[:, :4], free[:, 4:])


def _above(through: Array, Y: Array) -> Array:
    """Y on top of a layer on a body of response Y; (k, 4, 4)."""
    displaced, pulled = through[:, :4], through[:, 4:]
    return _quotient(displaced[..., :4] @ Y + displaced[..., 4:], pulled[..., :4] @ Y + pulled[..., 4:])


def _quotient(displacement: Array, traction: Array) -> Array:
    """Y of k u = Y t from both by the same unknowns; (k, 4, 4), symmetric."""
    Y = np.swapaxes(np.linalg.solve(np.swapaxes(traction, -1, -2), np.swapaxes(displacement, -1, -2)), -1, -2)
    return np.asarray(Y + np.swapaxes(Y, -1, -2)) / 2


def held(Y: Array, components: tuple[int, ...]) -> Array:
    """Y of a body (..., 4, 4) below an interface that holds components of u at zero, for the others; (..., 4, 4)."""
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


#: From the real form, whose x-components are times i, to [u,x; t].
TURN: ComplexArray = np.array([1, 1j, 1j, 1j, -1j, 1, 1, 1])


def modal(
    medium: Medium, k: Array, depth: Array, t: ComplexArray, rows: Array, *, upward: bool = False
) -> ComplexArray:
    """Rows of [u,x; t] of a wave at depths; (member, k, y, row, column).

    k: (k,), wavenumbers [1/m]; depth: (member, y), below where the wave starts [m]; t: (member, k, 4, column), with
    which it starts; rows: (row, 8).
    """
    rates, parts = medium.modes
    states = np.concatenate([medium.compliance, np.eye(4)]) @ parts
    if upward:
        states = np.concatenate([-MIRROR @ medium.compliance, MIRROR]) @ parts @ MIRROR
    modes = (rows @ (TURN[:, None] * states)).reshape(-1, 4) @ t  # (member, k, mode and row, column)
    exponent = (k[:, None] * depth[:, None, :])[..., None]
    decay: ComplexArray = np.empty((*exponent.shape[:-1], rates.size), np.complex128)
    size, phase = np.exp(-exponent * rates.real), exponent * rates.imag
    decay.real, decay.imag = size * np.cos(phase), -size * np.sin(phase)
    flat = modes.reshape(*t.shape[:2], rates.size, -1)
    return np.asarray((decay @ flat).reshape(*decay.shape[:3], len(rows), t.shape[-1]))


def layer_waves(
    layer: LayerWaves, k: Array, depth: Array, amplitude: ComplexArray, rows: Array, *, reflected: bool
) -> ComplexArray:
    """Rows of [u,x; t] at depths within a layer; (member, k, y, row, column).

    depth: (member, y), below the layer's top [m]; amplitude: (member, k, 4, column), traction of what enters at the
    top.
    """
    down = -layer.round_trip @ amplitude if reflected else amplitude  # (I + F)^-1 - I = -F (I + F)^-1
    up = layer.reflection @ layer.medium.falling(k * layer.thickness) @ amplitude
    falls = modal(layer.medium, k, depth, down, rows)
    return falls + modal(layer.medium, k, layer.thickness - depth, up, rows, upward=True)


def below(layer: LayerWaves, k: Array, amplitude: ComplexArray, grounded: tuple[int, ...]) -> ComplexArray:
    """Tractions on the top of what lies below a layer; an electrode carries the flux that it does not pass on.

    k: (k,), wavenumbers [1/m]; amplitude: (member, k, 4, column), traction of what enters at the top.
    """
    down = layer.medium.falling(k * layer.thickness) @ amplitude
    t: ComplexArray = down + layer.reflection @ down
    free = [i for i in range(4) if i not in grounded]
    if grounded and np.any(layer.below):
        Y = layer.below[:, list(grounded)]
        t[..., list(grounded), :] = -np.linalg.solve(Y[:, :, list(grounded)], Y[:, :, free] @ t[..., free, :])
    return t
