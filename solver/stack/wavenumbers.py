"""Quadrature over the wavenumber k for the difference of a stack from its top's half-plane (films, section 3)."""

import numpy as np
import scipy  # scipy.special, slow to import, and not every job solves

from approximation.chebyshev import legendre_rule
from solver.arrays import Array
from solver.stack.layers import Stack

#: Exponent at the largest wavenumber: e^-34 is below rounding.
DECAYED = 34.0
_GROWTH = 2.5  # of the panels
_WAVE_NODES = 16  # per panel, in addition to those that the phase needs
_PHASE = 150.0  # largest phase over a panel: small rules are cheap to compute
_ENDED = 40.0  # thicknesses from which Delta is tapered
_END, _SLOPE = 72.0, 12.0  # middle and width of the taper in k times the distance: e^-36 of Delta remains


def strip(stack: Stack) -> float:
    """Width b = 2 h1 g of the strip of analyticity [m]; Delta(k) decays like exp(-b k)."""
    return 2 * stack.top.thickness * float(stack.media[0].slowest)


def wavenumbers(stack: Stack, reach: float, width: float) -> tuple[Array, Array]:
    """Nodes and weights in k for integrands that decay like exp(-width k), up to a distance [m]; (k,) each."""
    ends = panels(stack, width)
    return on_panels(ends, np.full(ends.size - 1, reach))


def on_panels(ends: Array, reaches: Array) -> tuple[Array, Array]:
    """Nodes and weights (k,) on panels with ends (panel + 1,) [1/m], for distances up to ``reaches`` (panel,) [m]."""
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
    """Wavenumber [1/m] at which Delta may end if all distances x [m] are long, None if it decays before."""
    least = float(np.min(x))
    if least <= long * stack.thickness:
        return None
    end = (_END + 6 * _SLOPE) / least
    return end if end < DECAYED / width else None


def tapered(stack: Stack, width: float, x: Array, long: float = _ENDED) -> tuple[Array, Array, Array]:
    """Nodes and weights in k for distances x [m], and a taper of Delta negligible at long ones; (k,) each."""
    end = ended_at(stack, width, x, long)
    k, weights = wavenumbers(stack, float(np.max(x)), width if end is None else DECAYED / end)
    taper = np.ones_like(k) if end is None else scipy.special.erfc((k * float(np.min(x)) - _END) / _SLOPE) / 2
    return k, weights, taper


def panels(stack: Stack, width: float) -> Array:
    """Ends of panels in k, which grow from the smallest scale; unlike layers shift it to k H << 1; (end,) [1/m]."""
    media = (*stack.media, *filter(None, [stack.base_medium]))
    sizes = np.abs([np.diagonal(medium.compliance) for medium in media])
    least = float(np.min(np.min(sizes, 0) / np.max(sizes, 0)))
    ends = [0.0, 0.1 * least / stack.thickness]
    while ends[-1] < DECAYED / width:
        ends.append(ends[-1] * _GROWTH)
    ends[-1] = DECAYED / width
    return np.array(ends)
