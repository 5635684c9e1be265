"""Response and waves of a stack's layers at every wavenumber, by recursion from the base up (films, section 2)."""

from dataclasses import dataclass

import numpy as np

from solver.arrays import Array, ComplexArray, Points
from solver.stack.fourier import FLIP, MIRROR, Medium
from solver.stack.layers import Stack

# kH below which I + F above an insulated base, singular at k = 0, loses digits, so that _transfer takes its place
_LONG = 0.1
_DEGREE = 24  # of the Taylor polynomial of a layer's transfer at kH = 0.1, for any roots


@dataclass(frozen=True, eq=False)
class LayerWaves:
    """Waves of one layer at wavenumbers (k,)."""

    medium: Medium
    thickness: float
    below: Array  # Y of the body below, before the interface's conditions; (k, 4, 4)
    reflection: Array  # Gamma; (k, 4, 4)
    round_trip: Array  # F; (k, 4, 4)
    difference: Array  # Y_top - Y0, with full relative accuracy; (k, 4, 4), symmetric

    @property
    def amplitude(self) -> Array:
        """Downward wave at the top per traction there, (I + F)^-1; (k, 4, 4)."""
        return np.asarray(np.linalg.inv(np.eye(4) + self.round_trip), dtype=np.float64)


def waves(stack: Stack, k: Array) -> list[LayerWaves]:
    """Return the waves of every layer, the top one first, at wavenumbers k > 0 (k,) [1/m]."""
    Y = np.zeros((k.size, 4, 4))
    if stack.base_medium is not None:
        Y += stack.base_medium.compliance
    layers = []
    long = (k * stack.thickness < _LONG) & stack.insulated
    for number in range(len(stack.layers) - 1, -1, -1):
        medium, thickness = stack.media[number], stack.layers[number].thickness
        Y_below, Y = Y, held(Y, stack.grounded[number])
        compliance = medium.compliance
        A, B = FLIP * compliance + Y, compliance - Y
        if stack.insulated and number == len(stack.layers) - 1:
            A[:, 3], B[:, 3] = np.eye(4)[3], -np.eye(4)[3]
        reflection: Array = np.asarray(np.linalg.solve(A, B), dtype=np.float64)
        E = medium.falling(k * thickness)
        round_trip = (FLIP * E) @ reflection @ E
        difference = _difference(compliance, round_trip)
        if np.any(long):
            lowest = number == len(stack.layers) - 1
            transfer = _transfer(medium, k[long] * thickness)
            difference[long] = (_above_insulated(transfer) if lowest else _above(transfer, Y[long])) - compliance
        layers.append(LayerWaves(medium, thickness, Y_below, reflection, round_trip, difference))
        Y = compliance + difference
    return layers[::-1]


def _difference(compliance: Array, round_trip: Array) -> Array:
    """Y_top - Y0 = -(Y0 + S Y0 S) F (I + F)^-1, from the transposed system; (k, 4, 4), symmetric."""
    Y = -(compliance + FLIP * compliance) @ np.linalg.solve(np.eye(4) + round_trip.mT, round_trip.mT).mT
    return np.asarray(Y + Y.mT) / 2


def _transfer(medium: Medium, s: Array) -> Array:
    """Matrix from (k u, t) at a layer's bottom to its top at s = k h (k,), each entry fully accurate; (k, 8, 8)."""
    units = medium.halfplane.scale / medium.scale  # of the layer, in which the system's entries are of the order of one
    units = np.concatenate([units, 1 / units])
    system = medium.system / units[:, None] * units
    part: Array = np.eye(8) + np.zeros((s.size, 1, 1))
    for degree in range(_DEGREE, 0, -1):
        part = np.eye(8) + (s[:, None, None] / degree) * (system @ part)
    return np.asarray(part * units[:, None] / units)


def _above_insulated(transfer: Array) -> Array:
    """Y on top of a layer with u = 0, phi = 0 and B_y = 0 below; (k, 4, 4)."""
    free = transfer[..., [4, 5, 6, 3]]  # from t_x, t_y, D_y and k psi at the bottom
    return _quotient(free[:, :4], free[:, 4:])


def _above(transfer: Array, Y: Array) -> Array:
    """Y on top of a layer on a body of response Y; (k, 4, 4)."""
    displacement, traction = transfer[:, :4], transfer[:, 4:]
    return _quotient(displacement[..., :4] @ Y + displacement[..., 4:], traction[..., :4] @ Y + traction[..., 4:])


def _quotient(displacement: Array, traction: Array) -> Array:
    """Symmetric Y of k u = Y t from both as functions of the same unknowns; (k, 4, 4)."""
    Y = np.linalg.solve(traction.mT, displacement.mT).mT
    return np.asarray(Y + Y.mT) / 2


def held(Y: Points, components: tuple[int, ...]) -> Points:
    """Y (..., m, m) of a body under an interface that holds components of u at zero (films, F2.1)."""
    for c in components:
        pivot = Y[..., c, c]
        share = Y[..., :, c] / np.where(pivot == 0, 1.0, pivot)[..., None]
        Y = Y - share[..., :, None] * Y[..., None, c, :]
        Y[..., c, :] = Y[..., :, c] = 0.0
    return Y


def low(stack: Stack) -> Array:
    """Y_low, the finite part of Y as k goes to 0 (films, F2.3); (4, 4)."""
    Y = np.zeros((4, 4)) if stack.base_medium is None else stack.base_medium.compliance
    for components in reversed(stack.grounded):
        Y = held(Y, components)
    return Y


def sideways(stack: Stack) -> float:
    """c_B of Y_psi,psi ~ c_B / k on an insulated base, where flux leaves sideways (films, F2.4) [1/m]; else 0."""
    if not stack.insulated:
        return 0.0
    permeance = 0.0
    for number in range(len(stack.layers) - 1, -1, -1):
        if 3 in stack.grounded[number]:
            permeance = np.inf
        m = stack.layers[number].material
        permeance += stack.layers[number].thickness * float(m.mu11 + m.f15**2 / m.c44)
    return -1 / permeance / float(stack.scale[3]) ** 2


#: Factors from [k u; t] of the real form, whose x-components are multiplied by i, to [u,x; t].
TURN: ComplexArray = np.array([1, 1j, 1j, 1j, -1j, 1, 1, 1])


def modal(
    medium: Medium,
    k: Array,  # Wavenumbers [1/m]; (k,)
    depth: Array,  # From where the wave starts [m]; (member, y)
    t: ComplexArray,  # Tractions where the wave starts; (member, k, 4, column)
    rows: Array,  # (row, 8)
    *,
    upward: bool = False,
) -> ComplexArray:
    """Rows of [u,x; t] of a wave at depths; (member, k, y, row, column)."""
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
    layer: LayerWaves,
    k: Array,  # Wavenumbers [1/m]; (k,)
    depth: Array,  # Below the layer's top [m]; (member, y)
    amplitude: ComplexArray,  # Tractions of the downward wave at the top; (member, k, 4, column)
    rows: Array,  # (row, 8)
    *,
    reflected: bool,  # Without the part of the layer's half-plane
) -> ComplexArray:
    """Rows of [u,x; t] at depths within a layer; (member, k, y, row, column)."""
    down = -layer.round_trip @ amplitude if reflected else amplitude  # (I + F)^-1 - I = -F (I + F)^-1
    up = layer.reflection @ layer.medium.falling(k * layer.thickness) @ amplitude
    downward = modal(layer.medium, k, depth, down, rows)
    return downward + modal(layer.medium, k, layer.thickness - depth, up, rows, upward=True)


def below(layer: LayerWaves, k: Array, amplitude: ComplexArray, grounded: tuple[int, ...]) -> ComplexArray:
    """Tractions under the interface below a layer, from its downward wave at the top; (member, k, 4, column) each."""
    down = layer.medium.falling(k * layer.thickness) @ amplitude
    t: ComplexArray = down + layer.reflection @ down
    free = [i for i in range(4) if i not in grounded]
    if grounded and np.any(layer.below):
        Y = layer.below[:, list(grounded)]
        t[..., list(grounded), :] = -np.linalg.solve(Y[:, :, list(grounded)], Y[:, :, free] @ t[..., free, :])
    return t
