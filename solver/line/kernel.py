"""Smooth kernels of a stack in x: what its layers and base add to the half-plane of the top (films, sections 3, 5).

With ``Delta = Y_top - Y0``, o one of (y, phi, psi),

    K_oo = -(1/pi) int Delta_oo sin kx dk,   K_ox = -K_xo = -(1/pi) int Delta_ox cos kx dk,   K_xx as K_oo,
    U_oo = (1/pi) int [Delta_oo cos kx + (Y0 - Y_low)_oo exp(-kL)] dk/k,   U_ox = -(1/pi) int Delta_ox sin kx dk/k,

where U' = K gives displacements. They are analytic in the strip |Im x| < b = 2 h1 g, so that a few Chebyshev panels in
|x| hold them: one table per stack serves every half-length, friction and conduction.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import exp1

from approximation.piecewise import Piecewise
from solver.arrays import Array, BoolArray
from solver.cache import cached
from solver.stack.electroded import difference, lowest, surface
from solver.stack.layers import Stack, StackError
from solver.stack.reflection import sideways
from solver.stack.wavenumbers import ended_at, strip, tapered

#: Entries of Delta in the order of the channels: six oo, three ox, then xx (of K only).
ENTRIES = ((1, 1), (1, 2), (1, 3), (2, 2), (2, 3), (3, 3), (1, 0), (2, 0), (3, 0), (0, 0))
#: Channel of the pair (o, o') of (y, phi, psi).
CHANNEL = np.array([[0, 1, 2], [1, 3, 4], [2, 4, 5]])
#: Channels of (o, x), and of (x, x).
SHEAR = np.array([6, 7, 8])
TANGENTIAL = 9
#: Channels of U: those of the pairs, and of (o, x).
POTENTIAL = CHANNEL + 10
POTENTIAL_SHEAR = SHEAR + 10

_ODD = np.array([True] * 6 + [False] * 3 + [True] + [False] * 6 + [True] * 3)  # parity of K, then of U
_GROWN = 1.35  # growth of the panels in x
#: Degree on every panel.
DEGREE = 16  # of the Chebyshev panels in x, the first half as long as the strip is wide: 8.3^-17 is below rounding
_TAIL = 1e-11  # of the largest coefficient: what the last ones of a resolved kernel fall below
_HALVINGS = 6  # of panels that do not resolve: roots with a large real part put singularities beside the first ones
_TRANSFORMS_AT_ONCE = 20_000_000  # entries of one block of the transform: bounded memory
_FARTHEST = 1e5  # reach over the width of the strip: bounded time


@dataclass(frozen=True, eq=False)
class Kernel:
    """K and U of a stack for |x| <= reach, by Chebyshev panels in |x|."""

    stack: Stack  # The stack
    width: float  # b = 2 h1 g [m]: distance of the nearest singularities from the real axis, and the datum L of U
    positive: Piecewise  # K (ten channels) and U (nine) at distances from 0 to the reach [m]; (distance, 19)

    @property
    def ends(self) -> Array:
        """Ends of the panels, from 0 to the reach [m]; (panel + 1,)."""
        return self.positive.ends

    @property
    def reach(self) -> float:
        """Largest distance that the table knows [m]."""
        return float(self.ends[-1])

    @property
    def smoothness(self) -> float:
        """Distance [m] from the real axis within which the kernels are analytic, as their panels tell."""
        lengths = np.diff(self.ends)[:-1] / (0.35 * self.ends[:-2] + self.width / 2)
        return self.width * min(1.0, float(np.min(lengths, initial=1.0)))

    def at(self, x: Array, mixing: Array | None = None) -> Array:
        """Channels, or sums of them, at distances x [m]."""
        farthest = float(np.max(np.abs(x), initial=0.0))
        if farthest > self.reach * (1 + 1e-12):
            raise StackError(f"kernel: distance {farthest:g} m is beyond the resolved {self.reach:g} m")
        return self._both_sides.at(x, mixing)

    @cached_property
    def _both_sides(self) -> Piecewise:
        return self.positive.mirrored(_ODD)


@cached
def kernel(stack: Stack, reach: float, *, by_distance: bool = False) -> Kernel:
    """Table of the kernels for distances up to ``reach`` [m], one for every friction, conduction and punch."""
    width = strip(stack)
    if not reach < _FARTHEST * width:
        raise StackError(
            f"kernel: distance {reach:g} m is beyond the range that can be resolved, {_FARTHEST * width:g} m"
        )
    ends = growing(width, reach)
    ends[-1] = max(reach, (ends[-2] + ends[-1]) / 2)
    octaves = octave(ends, width) if by_distance else None
    return Kernel(stack, width, _resolved(stack, width, ends, octaves))


def growing(width: float, reach: float) -> Array:
    """Ends of panels in the distance from 0 to the reach or beyond [m], which grow from half the width on; (end,)."""
    ends = [0.0, width / 2]
    while ends[-1] < reach:
        ends.append(_GROWN * ends[-1] + width / 2)
    return np.array(ends)


def octave(ends: Array, width: float) -> Array:
    """Octave of the distances of panels over the width, (panel,): transforms of one octave share their wavenumbers."""
    return np.asarray(np.floor(np.log2(ends[1:] / width)))


def _resolved(stack: Stack, width: float, ends: Array, octaves: Array | None) -> Piecewise:
    """The channels on panels, those whose series have not decayed halved until all have."""

    def values(x: Array) -> Array:
        return _transforms(stack, width, x)

    channels = Piecewise.of(values, ends, DEGREE + 1, octaves)
    for _ in range(_HALVINGS):
        large = _undecayed(channels.series)
        if not np.any(large):
            return channels
        channels = channels.halved(values, large)
    if np.any(_undecayed(channels.series)):
        raise StackError(
            "kernel: its table does not resolve this stack: layers too different in thickness or stiffness"
        )
    return channels


def _undecayed(series: Array) -> BoolArray:
    """Panels whose last coefficients are not below ``_TAIL`` of the largest of K anywhere; (panel,)."""
    size = np.max(np.abs(series[:, :, :10]))
    return np.asarray(~(np.max(np.abs(series[:, -2:]), axis=(1, 2)) <= _TAIL * size))


def _transforms(stack: Stack, width: float, x: Array) -> Array:
    """K and U at distances x >= 0; (x, 19)."""
    k, weights, taper = tapered(stack, width, x)
    added = difference(stack, k) * taper[:, None, None]
    regular = surface(stack) - lowest(stack)
    spread = sideways(stack)
    added[:, 3, 3] -= spread / k * np.exp(-k * width) * (1 + k * width)
    rows = np.array([added[:, i, j] for i, j in ENTRIES])  # (channel, k)
    datum = np.array([regular[i, j] for i, j in ENTRIES[:6]])[:, None] * np.exp(-k * width)
    by_sine = (weights * np.concatenate([rows[[*range(6), 9]], rows[6:9] / k])).T
    by_cosine = (weights * np.concatenate([rows[6:9], rows[:6] / k])).T
    offset = (datum * weights / k).sum(-1)
    if (end := ended_at(stack, width, x)) is not None:  # beyond, the datum's part alone is left
        offset += np.array([regular[i, j] for i, j in ENTRIES[:6]]) * float(exp1(end * width))
    sines, cosines = fourier_sums(x, k, by_sine, by_cosine)
    out = np.concatenate(
        [-sines[:, :6], -cosines[:, :3], -sines[:, 6:7], cosines[:, 3:] + offset, -sines[:, 7:]], axis=1
    )
    out /= np.pi
    # the part c_B/k of a stack that passes its flux on sideways, in closed form
    angle = np.arctan(x / width)
    out[:, 5] -= spread / np.pi * (angle + width * x / (x**2 + width**2))
    out[:, 15] += spread / np.pi * (stack.thickness - width - x * angle)
    return out


def fourier_sums(x: Array, k: Array, by_sine: Array, by_cosine: Array) -> tuple[Array, Array]:
    """Sums over wavenumbers of rows (k, row) times sin kx and times cos kx; (x, row) each."""
    sines, cosines = (np.empty((x.size, rows.shape[1])) for rows in (by_sine, by_cosine))
    for start in range(0, x.size, step := max(_TRANSFORMS_AT_ONCE // k.size, 1)):
        phase = x[start : start + step, None] * k
        sines[start : start + step], cosines[start : start + step] = np.sin(phase) @ by_sine, np.cos(phase) @ by_cosine
    return sines, cosines
