"""What the layers of a stack add along the surface under points, over a distance (points, 4 and 6).

    Lambda(x) = int_0^inf Delta(k) cos(kx) dk,
    chi(s) = N S(s) + (1/pi) int_0^inf [Lambda(s - s') + Lambda(s + s')] S(s') ds',

of the six pairs of (y, phi, psi), Delta = Y_top - Y0. Friction sigma_xy = eta sigma_yy adds to chi of cos(angle)

    -(1/2) int_0^1 [Lambda_x(s + b) + Lambda_x(s - b)] phi_sigma(b) db,    Lambda_x(x) = int_0^inf Delta_ox sin(kx) dk.

Far away only the beginning of Delta matters: a smooth end is put to it, of a width that the distance does not see.
Under a graded layer Lambda = sum_j Y_j rho_j(x) + T(x): rho_j are closed and hold what is singular at x = 0, T stands
in the table; Lambda_x likewise.
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from approximation.arrays import Indices
from approximation.piecewise import Piecewise
from solver.arrays import Array
from solver.line.kernel import DEGREE, ENTRIES, FINEST, graded_response, growing, octave
from solver.stack.grading import local_sines, local_tails
from solver.stack.layers import Stack
from solver.stack.reflection import waves
from solver.stack.wavenumbers import graded_strip, strip, tapered

#: The pairs, over (x, y, phi, psi).
PAIRS = ENTRIES[:6]
_SHEARED = ENTRIES[6:9]

_FAR = 1e4  # strips from which what is left falls like 1/x^2, of Lambda_x like 1/x
_MOST = 4_000_000  # values of one block of a transform
_TAILS = 4


@dataclass(frozen=True, eq=False)
class SurfaceKernel:
    """Lambda or Lambda_x over the distance."""

    table: Piecewise  # Either, under a graded layer without what is closed of it, of its pairs; (distance, pair)
    width: float  # b of rho_j, see :func:`solver.stack.grading.local_tails`
    tails: Array | None = None  # Y_j of the pairs under a graded layer; (4, pair)
    odd: bool = False  # Whether it is Lambda_x

    def at(self, x: Array) -> Array:
        """Lambda or Lambda_x at distances x >= 0; (..., pair)."""
        reach = self.table.ends[-1]
        found = self.table.at(np.minimum(x, reach))
        beyond = x > reach
        found[beyond] *= (reach / x[beyond, None]) ** (1 if self.odd else 2)
        if self.tails is not None:
            local = local_sines if self.odd else local_tails
            found += (local(x.ravel(), self.width).T @ self.tails).reshape(found.shape)
        return found

    def of(self, pairs: Indices) -> "SurfaceKernel":
        """Of some of the pairs."""
        table = replace(self.table, series=self.table.series[..., pairs])
        return replace(self, table=table, tails=None if self.tails is None else self.tails[:, pairs])


@lru_cache(32)
def normal_kernel(stack: Stack, reach: float | None = None) -> SurfaceKernel:
    """Lambda of a stack."""
    return _tabled(stack, reach, odd=False)


@lru_cache(32)
def shear_kernel(stack: Stack, reach: float | None = None) -> SurfaceKernel:
    """Lambda_x of (y, phi, psi) at distances x >= 0, odd in them."""
    return _tabled(stack, reach, odd=True)


def _tabled(stack: Stack, reach: float | None, *, odd: bool) -> SurfaceKernel:
    width, graded = strip(stack), graded_response(stack) if stack.top.graded else None
    pairs, wave = (_SHEARED, np.sin) if odd else (PAIRS, np.cos)

    def transformed(x: Array) -> Array:
        """At distances that are not far apart; (x, pair)."""
        if graded is None:
            k, weights, taper = tapered(stack, width, x)
            values = waves(stack, k)[0].difference
        else:
            k, weights, taper = tapered(stack, graded_strip(stack), x, long=1.0)
            values = graded.decayed(k, width, _TAILS)
        rows = np.stack([weights * taper * values[:, i, j] for i, j in pairs], -1)
        found, step = np.empty((x.size, len(pairs))), max(_MOST // k.size, 1)
        for start in range(0, x.size, step):
            found[start : start + step] = wave(x[start : start + step, None] * k) @ rows
        return found

    ends = growing(width, reach or _FAR * width, halvings=FINEST if graded else 0)
    table = Piecewise.of(transformed, ends, DEGREE + 1, octave(ends, width))
    return SurfaceKernel(table, width, np.stack([graded.tails[:, i, j] for i, j in pairs], -1) if graded else None, odd)
