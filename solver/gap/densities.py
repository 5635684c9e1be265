"""Integrals of a stack's kernels against charges on the right side of a contact.

One rule serves all targets where the kernel is smooth over an interval (:mod:`solver.gap.grid`); elsewhere
intervals end where the kernel's panels do. About the contact, where densities lie on short panels and targets are many,
the kernel is smooth over all of them: a few Chebyshev points stand for the panels, and a few for the targets.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array, BoolArray
from solver.cache import cached
from solver.gap.grid import CLOSE, RULE, Grid, spans
from solver.line.kernel import POTENTIAL, Kernel
from solver.line.outputs import mixing
from solver.stack.reflection import low

_DIGITS = 30.0  # exponent of the interpolation error between Chebyshev points: below rounding

#: Pieces of panels: target, panel, start and end of each.
_Pieces = tuple[NDArray[np.intp], NDArray[np.intp], Array, Array]


@dataclass(frozen=True, eq=False)
class Densities:
    """Densities of the right side under one stack."""

    grid: Grid
    kernel: Kernel

    def integrals(self, h: float, X: Array, mix: Array) -> Array:
        """Integrals of sums of channels (19, c) against the densities, at targets; (target, c, n)."""
        grid, strip = self.grid, self.kernel.smoothness / h
        first = grid.close_panels if enough(strip, CLOSE - 1) < grid.close_panels * RULE else 0
        rough = grid.rough_at(X, strip)
        rough[:, :first] = False
        rules = grid.rules
        target, interval = np.nonzero(~rough[:, first:])
        values = np.zeros((rules.panel.size - first, X.size, RULE, mix.shape[1]))
        values[interval, target] = far(self.kernel, h * (X[target, None] - np.cosh(rules.theta[first + interval])), mix)
        parts = np.swapaxes(values, 2, 3) @ rules.shape[first:, None]  # (interval, target, c, node)
        out = np.zeros((X.size, mix.shape[1], grid.panels, grid.count // grid.panels))
        for panel, part in zip(rules.panel[first:].tolist(), parts, strict=True):
            out[:, :, panel] += part
        whole: Array = out.reshape(X.size, mix.shape[1], grid.count)
        if first:
            points, weights = grid.close_rule(enough(strip, CLOSE - 1))
            close = far(self.kernel, h * (X[:, None] - points), mix)
            whole[..., : weights.shape[1]] = np.swapaxes(close, 1, 2) @ weights
        return whole + self._by_pieces(h, X, rough, mix) if np.any(rough) else whole

    def _by_pieces(self, h: float, X: Array, rough: BoolArray, mix: Array) -> Array:
        """Integrals over the intervals of :attr:`Grid.rules` on which the kernel is not smooth; (target, ..., n)."""
        grid = self.grid
        targets = np.flatnonzero(rough.any(1))
        result = []
        for row, panel, start, stop in self._pieces(h, X[targets], self.kernel.ends, rough[targets]):
            theta, shape = grid.ruled(panel, *spans(start, stop))
            values = far(self.kernel, h * (X[targets][row, None] - np.cosh(theta)), mix)
            result.append((targets[row] * grid.panels + panel, np.swapaxes(values, 1, 2) @ shape))
        out = np.zeros((X.size * grid.panels, mix.shape[1], grid.count // grid.panels))
        for place, parts in result:  # pieces of a panel follow each other
            first = np.flatnonzero(np.diff(place, prepend=-1))
            if first.size:
                out[place[first]] = np.add.reduceat(parts, first)
        whole = np.moveaxis(out.reshape(X.size, grid.panels, mix.shape[1], -1), 1, 2)
        return np.asarray(whole.reshape(X.size, mix.shape[1], grid.count))

    def _pieces(self, h: float, X: Array, edges: Array, rough: BoolArray) -> tuple[_Pieces, _Pieces]:
        """Pieces of the finite panels and of the infinite one, on which neither a density nor a kernel has a break.

        Target, panel, start and end in u of each, those of a target's panel side by side.
        """
        grid = self.grid
        ends = np.array(grid.ends)
        far = float(np.cosh(ends[-1]))
        breaks = X[:, None] + np.concatenate([edges, -edges]) / h
        inner = np.arccosh(np.clip(breaks, 1.0, far))
        inverse = np.exp(-np.arccosh(np.maximum(breaks, far)))
        result = []
        for panel_ends, kernel_breaks, first in ((ends, inner, 0), (grid.infinite_ends, inverse, grid.panels - 1)):
            all_ends = np.sort(np.concatenate([np.tile(panel_ends, (X.size, 1)), kernel_breaks], 1), 1)
            start, stop = all_ends[:, :-1], np.minimum(all_ends[:, 1:], panel_ends.max())
            interval = np.clip(np.searchsorted(panel_ends, (start + stop) / 2) - 1, 0, panel_ends.size - 2) + first
            row, place = np.nonzero((stop > start) & np.take_along_axis(rough, interval, 1))
            panel = np.minimum(interval[row, place], grid.panels - 1)
            result.append((row, panel, start[row, place], stop[row, place]))
        return result[0], result[1]


def enough(strip: float, length: float) -> int:
    """Number of Chebyshev points that resolve a function analytic within a strip about the interval."""
    return 2 + int(_DIGITS / np.arcsinh(2 * strip / length))


def far(wide: Kernel, x: Array, mix: Array) -> Array:
    """Sums ``mix`` (19, c) of channels at distances x (...) [m], by the logarithm beyond the reach; (..., c)."""
    values = wide.at(np.clip(x, -wide.reach, wide.reach), mix)
    beyond = np.abs(x) > wide.reach
    if np.any(beyond):
        growth = (wide.stack.media[0].compliance - low(wide.stack))[1:, 1:] / np.pi
        channels = np.zeros((19,))
        channels[POTENTIAL[np.triu_indices(3)]] = growth[np.triu_indices(3)]
        values[beyond] += np.log(np.abs(x[beyond]) / wide.reach)[:, None] * (channels @ mix)
    return values


@cached
def sampled(
    wide: Kernel, grid: Grid, fields: tuple[int, ...], h: float, points: tuple[float, ...]
) -> tuple[Array, Array]:
    """Integrals of the kernels against densities of the right side; tables of any friction share them.

    Sums of :func:`mixing` at points about the contact, (point, 7 field, n), and displacements alone at the nodes beyond
    on the right and on the left, (2 node, 3 field, n).
    """
    densities = Densities(grid, wide)
    mix = np.stack([mixing(0.0, np.eye(3)[1 + f]) for f in fields], 1)
    X = grid.distance[grid.close :]
    about = densities.integrals(h, np.array(points), mix.reshape(19, -1))
    return about, densities.integrals(h, np.concatenate([X, -X]), mix[..., 4:].reshape(19, -1))
