"""What the layers of a stack add along the surface under points, over a distance (points, 4 and 6).

    Lambda(x) = int_0^inf Delta(k) cos(kx) dk,
    chi(s) = N S(s) + (1/pi) int_0^inf [Lambda(s - s') + Lambda(s + s')] S(s') ds',

of the six pairs of (y, phi, psi), Delta = Y_top - Y0. Far away only the beginning of Delta matters: a smooth end is
put to it, of a width that the distance does not see. Under a graded layer Lambda = sum_j Y_j rho_j(x) + T(x): rho_j are
closed and hold what is singular at x = 0, T stands in the table; the same of what friction makes of the pressure,
M(x) = int_0^inf Delta_ox(k) sin(kx) dk.
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from approximation.arrays import Indices
from approximation.piecewise import Piecewise
from solver.arrays import Array
from solver.film.grading import local_sines, local_tails
from solver.film.kernel import DEGREE, ENTRIES, FINEST, graded_response, graded_strip, growing, octave, strip, tapered
from solver.film.reflection import waves
from solver.film.stack import Stack

#: The pairs, over (x, y, phi, psi).
PAIRS = ENTRIES[:6]
#: Those of what friction along x does.
SHEARED = ENTRIES[6:9]

_FAR = 1e4  # strips from which what is left falls like 1/x^2
_MOST = 4_000_000  # values of one block of a transform
_TAILS = 4


@dataclass(frozen=True, eq=False)
class Spread:
    """Lambda or M over the distance.

    Attributes
    ----------
    table
        Lambda or M, without the tails' own under a graded layer, of the pairs; (distance, pair).
    width
        b of rho_j, see :func:`solver.film.grading.local_tails`.
    tails
        Y_j of the pairs under a graded layer; (4, pair).
    odd
        Whether it is M.
    """

    table: Piecewise
    width: float
    tails: Array | None = None
    odd: bool = False

    def at(self, x: Array) -> Array:
        """Lambda or M at distances x >= 0; (..., pair)."""
        reach = self.table.ends[-1]
        found = self.table.at(np.minimum(x, reach))
        beyond = x > reach
        found[beyond] *= (reach / x[beyond, None]) ** 2
        if self.tails is not None:
            local = local_sines if self.odd else local_tails
            found += (local(x.ravel(), self.width).T @ self.tails).reshape(found.shape)
        return found

    def of(self, pairs: Indices) -> "Spread":
        """Of some of the pairs."""
        table = replace(self.table, series=self.table.series[..., pairs])
        return replace(self, table=table, tails=None if self.tails is None else self.tails[:, pairs])


@lru_cache(32)
def spread(stack: Stack, reach: float | None = None) -> Spread:
    """Lambda of a stack.

    Parameters
    ----------
    stack
        Layers and base.
    reach
        How far a graded layer's is asked for [m]; others' is known everywhere.

    Raises
    ------
    StackError
        A profile that is not smooth.
    """
    width = strip(stack)
    if stack.top.graded:
        return _below_graded(stack, width, float(reach or _FAR * width), odd=False)
    ends = growing(width, reach or _FAR * width)

    def transformed(x: Array) -> Array:
        k, weights, taper = tapered(stack, width, x)
        return _summed(x, k, weights * taper, waves(stack, k)[0].difference, odd=False)

    return Spread(Piecewise.of(transformed, ends, DEGREE + 1, octave(ends, width)), width)


@lru_cache(32)
def sheared_spread(stack: Stack, reach: float) -> Spread:
    """M below a graded layer, of what friction along x does to (y, phi, psi).

    Parameters
    ----------
    stack : Stack, its top layer graded
    reach : float, how far it is asked for [m]

    Raises
    ------
    StackError
        A profile that is not smooth.
    """
    return _below_graded(stack, strip(stack), reach, odd=True)


def _below_graded(stack: Stack, width: float, reach: float, *, odd: bool) -> Spread:
    response, pairs = graded_response(stack), SHEARED if odd else PAIRS
    ends = growing(width, reach, halvings=FINEST)

    def transformed(x: Array) -> Array:
        k, weights, taper = tapered(stack, graded_strip(stack), x, long=1.0)
        return _summed(x, k, weights * taper, response.decayed(k, width, _TAILS), odd=odd)

    table = Piecewise.of(transformed, ends, DEGREE + 1, octave(ends, width))
    return Spread(table, width, np.stack([response.tails[:, i, j] for i, j in pairs], -1), odd)


def _summed(x: Array, k: Array, weights: Array, values: Array, *, odd: bool) -> Array:
    """int of values (k, 4, 4) times cos kx, or sin kx where odd, at distances that are not far apart; (x, pair)."""
    pairs, wave = (SHEARED, np.sin) if odd else (PAIRS, np.cos)
    rows = np.stack([weights * values[:, i, j] for i, j in pairs], -1)
    found, step = np.empty((x.size, len(pairs))), max(_MOST // k.size, 1)
    for start in range(0, x.size, step):
        found[start : start + step] = wave(x[start : start + step, None] * k) @ rows
    return found
