"""Nodes and weights in the wavenumber k for what a stack adds to its top's half-plane (films, section 3)."""

import numpy as np
import scipy  # scipy.special, slow to import, and not every job solves

from approximation.chebyshev import legendre_rule
from solver.arrays import Array
from solver.stack.layers import Stack

#: Exponent at the largest wavenumber: e^-34 is below rounding.
DECAYED = 34.0
_GROWTH = 2.5  # of the panels
_WAVE_NODES = 16  # a panel, beside those that the phase needs
_PHASE = 150.0  # the most of a panel: small rules are cheap to find
_ENDED = 40.0  # thicknesses from which Delta is ended
_END, _SLOPE = 72.0, 12.0  # k times the distance where it ends, and the width of that: e^-36 of it is left


def strip(stack: Stack) -> float:
    """b = 2 h1 g [m]: Delta(k) decays like exp(-b k)."""
    return 2 * stack.top.thickness * float(stack.media[0].slowest)


def wavenumbers(stack: Stack, reach: float, width: float) -> tuple[Array, Array]:
    """Nodes and weights in k for what decays like exp(-width k); (k,) each."""
    ends = panels(stack, width)
    return on_panels(ends, np.full(ends.size - 1, reach))


def on_panels(ends: Array, reaches: Array) -> tuple[Array, Array]:
    """Nodes and weights in k on panels with ends [1/m], each for distances up to its reach (panel,) [m]; (k,) each."""
    nodes, weights = [], []
    for start, end, reach in zip(ends[:-1], ends[1:], reaches, strict=True):
        parts = int(np.ceil((end - start) * reach / _PHASE))
        half = (end - start) / max(parts, 1) / 2
        x, w = legendre_rule(_WAVE_NODES + int(2 * half * reach / 3.2))
        middles = start + half * (2 * np.arange(max(parts, 1)) + 1)
        nodes.append((middles[:, None] + half * x).ravel())
        weights.append(np.tile(half * w, middles.size))
    return np.concatenate(nodes), np.concatenate(weights)


def ended_at(stack: Stack, width: float, x: Array, long: float = _ENDED) -> float | None:
    """Wavenumber at which Delta may end at distances that are all long; none where it decays before."""
    least = float(np.min(x))
    if least <= long * stack.thickness:
        return None
    end = (_END + 6 * _SLOPE) / least
    return end if end < DECAYED / width else None


def tapered(stack: Stack, width: float, x: Array, long: float = _ENDED) -> tuple[Array, Array, Array]:
    """Nodes and weights in k at distances, and a smooth end of Delta that long ones do not see; (k,) each."""
    end = ended_at(stack, width, x, long)
    k, weights = wavenumbers(stack, float(np.max(x)), width if end is None else DECAYED / end)
    taper = np.ones_like(k) if end is None else scipy.special.erfc((k * float(np.min(x)) - _END) / _SLOPE) / 2
    return k, weights, taper


def panels(stack: Stack, width: float) -> Array:
    """Ends of panels in k, which grow from the smallest structure: unlike layers shift it to k H << 1; (end,)."""
    bodies = [np.diagonal(medium.compliance) for medium in (*stack.media, *filter(None, [stack.base_medium]))]
    size = np.abs(bodies)
    least = float(np.min(np.min(size, 0) / np.max(size, 0)))
    ends = [0.0, 0.1 * least / stack.thickness]
    while ends[-1] < DECAYED / width:
        ends.append(ends[-1] * _GROWTH)
    ends[-1] = DECAYED / width
    return np.array(ends)
