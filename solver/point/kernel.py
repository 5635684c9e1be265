"""Layers' kernels Lambda and Lambda_x over the distance, of the pairs of (y, phi, psi) (points, 6 and 8)."""

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

#: Pairs of (y, phi, psi), over (x, y, phi, psi).
PAIRS = ENTRIES[:6]
_SHEAR_PAIRS = ENTRIES[6:9]

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
    """Kernel Lambda of a stack."""
    return _kernels(stack)[0]


def shear_kernel(stack: Stack) -> SurfaceKernel:
    """Kernel Lambda_x of (y, phi, psi) of a stack, odd in the distance."""
    return _kernels(stack)[1]


@cached
def _kernels(stack: Stack) -> tuple[SurfaceKernel, SurfaceKernel]:
    """Tabulate Lambda and Lambda_x over the distance: both need the same waves, which cost the most."""
    width, count = strip(stack), len(PAIRS)

    def transformed(x: Array) -> Array:
        """Transforms at distances of one octave, Delta tapered over a width that they do not resolve; (x, pair)."""
        k, weights, taper = tapered(stack, width, x)
        values = waves(stack, k)[0].difference
        rows = np.stack([weights * taper * values[:, i, j] for i, j in (*PAIRS, *_SHEAR_PAIRS)], -1)
        sines, cosines = fourier_sums(x, k, rows[:, count:], rows[:, :count])
        return np.concatenate([cosines, sines], 1)

    ends = growing(width, _FAR * width)
    all_pairs = SurfaceKernel(Piecewise.of(transformed, ends, DEGREE + 1, octave(ends, width)), odd=False)
    return all_pairs.of(np.arange(count)), replace(all_pairs.of(np.arange(count, count + len(_SHEAR_PAIRS))), odd=True)
