"""Kernels of the layers' contribution along the surface under points, over a distance (points, 4 and 6).

    Lambda(x) = int_0^inf Delta(k) cos(kx) dk,
    chi(s) = N S(s) + (1/pi) int_0^inf [Lambda(s - s') + Lambda(s + s')] S(s') ds',

of the six pairs of (y, phi, psi), Delta = Y_top - Y0. Friction sigma_xy = eta sigma_yy adds to chi of cos(angle)

    -(1/2) int_0^1 [Lambda_x(s + b) + Lambda_x(s - b)] phi_sigma(b) db,    Lambda_x(x) = int_0^inf Delta_ox sin(kx) dk.

Far away only the beginning of Delta matters: it is tapered over a width that the distance does not resolve.
"""

from dataclasses import dataclass, replace

import numpy as np

from approximation.arrays import Indices
from approximation.piecewise import Piecewise
from solver.arrays import Array
from solver.cache import cached
from solver.line.kernel import DEGREE, ENTRIES, fourier_sums, growing, octave
from solver.stack.layers import Stack
from solver.stack.reflection import waves
from solver.stack.wavenumbers import strip, tapered

#: The pairs, over (x, y, phi, psi).
PAIRS = ENTRIES[:6]
_SHEARED = ENTRIES[6:9]

_FAR = 1e4  # strip widths beyond which Lambda falls like 1/x^2 and Lambda_x like 1/x


@dataclass(frozen=True, eq=False)
class SurfaceKernel:
    """Lambda or Lambda_x over the distance."""

    table: Piecewise  # Values of the pairs; (distance, pair)
    odd: bool  # Whether it is Lambda_x

    def at(self, x: Array) -> Array:
        """Return Lambda or Lambda_x at distances x >= 0; (..., pair)."""
        reach = self.table.ends[-1]
        values = self.table.at(np.minimum(x, reach))
        beyond = x > reach
        values[beyond] *= (reach / x[beyond, None]) ** (1 if self.odd else 2)
        return values

    def of(self, pairs: Indices) -> "SurfaceKernel":
        """Return the kernel of some of the pairs."""
        return replace(self, table=replace(self.table, series=self.table.series[..., pairs]))


def normal_kernel(stack: Stack) -> SurfaceKernel:
    """Lambda of a stack."""
    return _kernels(stack)[0]


def shear_kernel(stack: Stack) -> SurfaceKernel:
    """Lambda_x of (y, phi, psi) of a stack, odd in the distance."""
    return _kernels(stack)[1]


@cached
def _kernels(stack: Stack) -> tuple[SurfaceKernel, SurfaceKernel]:
    """Tabulate Lambda and Lambda_x over the distance: both need the same waves, which cost the most."""
    width, count = strip(stack), len(PAIRS)

    def transformed(x: Array) -> Array:
        """Transforms at distances of one octave; (x, pair)."""
        k, weights, taper = tapered(stack, width, x)
        values = waves(stack, k)[0].difference
        rows = np.stack([weights * taper * values[:, i, j] for i, j in (*PAIRS, *_SHEARED)], -1)
        sines, cosines = fourier_sums(x, k, rows[:, count:], rows[:, :count])
        return np.concatenate([cosines, sines], 1)

    ends = growing(width, _FAR * width)
    all_pairs = SurfaceKernel(Piecewise.of(transformed, ends, DEGREE + 1, octave(ends, width)), odd=False)
    return all_pairs.of(np.arange(count)), replace(all_pairs.of(np.arange(count, count + len(_SHEARED))), odd=True)
