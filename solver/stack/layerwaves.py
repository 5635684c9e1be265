"""Waves within the layers of a stack, and what they carry on to the layer below (films, section 6)."""

import numpy as np

from solver.arrays import Array, ComplexArray
from solver.stack.fourier import MIRROR, Medium, falling
from solver.stack.reflection import LayerWaves

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
    up = layer.reflection @ falling(layer.medium.decay, k * layer.thickness) @ amplitude
    falls = modal(layer.medium, k, depth, down, rows)
    return falls + modal(layer.medium, k, layer.thickness - depth, up, rows, upward=True)


def below(layer: LayerWaves, k: Array, amplitude: ComplexArray, grounded: tuple[int, ...]) -> ComplexArray:
    """Tractions on the top of what lies below a layer; an electrode carries the flux that it does not pass on.

    k: (k,), wavenumbers [1/m]; amplitude: (member, k, 4, column), traction of what enters at the top.
    """
    down = falling(layer.medium.decay, k * layer.thickness) @ amplitude
    t: ComplexArray = down + layer.reflection @ down
    free = [i for i in range(4) if i not in grounded]
    if grounded and np.any(layer.below):
        Y = layer.below[:, list(grounded)]
        t[..., list(grounded), :] = -np.linalg.solve(Y[:, :, list(grounded)], Y[:, :, free] @ t[..., free, :])
    return t
