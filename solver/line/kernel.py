"""Tables of a stack's kernels K and U in x, its difference from the half-plane of the top material (films, section 3).

Channels are named by o, one of (y, phi, psi), and by x; b is the docs' beta.
"""

from dataclasses import dataclass
from functools import cached_property, partial

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
#: Channel of the pair (o, o').
CHANNEL = np.array([[0, 1, 2], [1, 3, 4], [2, 4, 5]])
#: Channels of (o, x), and of (x, x).
SHEAR = np.array([6, 7, 8])
TANGENTIAL = 9
#: Channels of U, of (o, o') and of (o, x).
POTENTIAL = CHANNEL + 10
POTENTIAL_SHEAR = SHEAR + 10

_ODD = np.array([True] * 6 + [False] * 3 + [True] + [False] * 6 + [True] * 3)  # parity of K, then of U
_GROWTH = 1.35  # of the panels in x
#: Degree of the Chebyshev panels in x; the first is half as long as the strip is wide, and 8.3^-17 is below rounding.
DEGREE = 16
_TAIL = 1e-11  # bound on the last coefficients of a resolved kernel, over its largest one
_HALVINGS = 6  # of unresolved panels: roots with a large real part put singularities beside the first ones
_TRANSFORMS_AT_ONCE = 20_000_000  # entries of one block of the transform: bounded memory
_FARTHEST = 1e5  # reach over the width of the strip: bounded time


@dataclass(frozen=True, eq=False)
class Kernel:
    """K and U of a stack for |x| <= reach, by Chebyshev panels in |x|."""

    stack: Stack
    width: float  # b = 2 h1 g [m]: distance of the nearest singularities from the real axis, and datum L of U
    positive: Piecewise  # K (ten channels) and U (nine) at distances from 0 to the reach [m]; (distance, 19)

    @property
    def ends(self) -> Array:
        """Ends of the panels, from 0 to the reach [m]; (panel + 1,)."""
        return self.positive.ends

    @property
    def reach(self) -> float:
        """Largest distance in the table [m]."""
        return float(self.ends[-1])

    @property
    def smoothness(self) -> float:
        """Distance [m] from the real axis within which the kernels are analytic, judged by their panels' lengths."""
        lengths = np.diff(self.ends)[:-1] / (0.35 * self.ends[:-2] + self.width / 2)
        return self.width * min(1.0, float(np.min(lengths, initial=1.0)))

    def at(self, x: Array, mixing: Array | None = None) -> Array:
        """Channels, or sums of them by ``mixing`` (19, sum), at distances x (...) [m]; (..., channel)."""
        farthest = float(np.max(np.abs(x), initial=0.0))
        if farthest > self.reach * (1 + 1e-12):
            raise StackError(f"kernel: distance {farthest:g} m is beyond the resolved {self.reach:g} m")
        return self._both_sides.at(x, mixing)

    @cached_property
    def _both_sides(self) -> Piecewise:
        return self.positive.mirrored(_ODD)


@cached
def kernel(stack: Stack, reach: float, *, by_distance: bool = False) -> Kernel:
    """Return the table of the kernels up to ``reach`` [m], which serves every friction, conduction and punch."""
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
    """Ends of panels from 0 to the reach or beyond [m], which grow from half the strip's width on; (end,)."""
    ends = [0.0, width / 2]
    while ends[-1] < reach:
        ends.append(_GROWTH * ends[-1] + width / 2)
    return np.array(ends)


def octave(ends: Array, width: float) -> Array:
    """Octave of each panel's distance over the width; transforms of one octave share wavenumbers; (panel,)."""
    return np.asarray(np.floor(np.log2(ends[1:] / width)))


def _resolved(stack: Stack, width: float, ends: Array, octaves: Array | None) -> Piecewise:
    """Return the channels on panels, after halving those whose series have not decayed."""
    values = partial(_transforms, stack, width)
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
    """Return True for panels whose last coefficients exceed ``_TAIL`` times the largest one of K; (panel,)."""
    size = np.max(np.abs(series[:, :, :10]))
    return np.asarray(~(np.max(np.abs(series[:, -2:]), axis=(1, 2)) <= _TAIL * size))


def _transforms(stack: Stack, width: float, x: Array) -> Array:
    """K and U at distances x >= 0 [m] (films, F3.2 to F3.4); (x, 19)."""
    k, weights, taper = tapered(stack, width, x)
    delta = difference(stack, k) * taper[:, None, None]
    c_B = sideways(stack)
    delta[:, 3, 3] -= c_B / k * np.exp(-k * width) * (1 + k * width)
    rows = np.array([delta[:, i, j] for i, j in ENTRIES])  # (channel, k)
    at_infinity = surface(stack) - lowest(stack)
    regular = np.array([at_infinity[i, j] for i, j in ENTRIES[:6]])
    datum = regular[:, None] * np.exp(-k * width)
    by_sine = (weights * np.concatenate([rows[[*range(6), 9]], rows[6:9] / k])).T
    by_cosine = (weights * np.concatenate([rows[6:9], rows[:6] / k])).T
    offset = (datum * weights / k).sum(-1)
    if (end := ended_at(stack, width, x)) is not None:  # beyond that wavenumber the datum's part alone remains
        offset += regular * float(exp1(end * width))
    sines, cosines = fourier_sums(x, k, by_sine, by_cosine)
    out = np.concatenate(
        [-sines[:, :6], -cosines[:, :3], -sines[:, 6:7], cosines[:, 3:] + offset, -sines[:, 7:]], axis=1
    )
    out /= np.pi
    # the part c_B/k, of flux that leaves sideways, in closed form
    angle = np.arctan(x / width)
    out[:, 5] -= c_B / np.pi * (angle + width * x / (x**2 + width**2))
    out[:, 15] += c_B / np.pi * (stack.thickness - width - x * angle)
    return out


def fourier_sums(x: Array, k: Array, by_sine: Array, by_cosine: Array) -> tuple[Array, Array]:
    """Sums over wavenumbers k of ``by_sine`` (k, row) times sin kx and ``by_cosine`` times cos kx; (x, row) each."""
    sines, cosines = (np.empty((x.size, rows.shape[1])) for rows in (by_sine, by_cosine))
    for start in range(0, x.size, step := max(_TRANSFORMS_AT_ONCE // k.size, 1)):
        phase = x[start : start + step, None] * k
        sines[start : start + step], cosines[start : start + step] = np.sin(phase) @ by_sine, np.cos(phase) @ by_cosine
    return sines, cosines
