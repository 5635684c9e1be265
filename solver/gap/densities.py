"""Integrals of a stack's kernels against charges on the right side of a contact."""

import numpy as np

from solver.arrays import Array, BoolArray
from solver.cache import cached
from solver.gap.grid import RULE, Grid, Pieces, add_pieces, pieces, spans
from solver.line.kernel import POTENTIAL, Kernel
from solver.line.outputs import mixing
from solver.stack.reflection import low

_DIGITS = 30.0  # exponent of the interpolation error between Chebyshev points: below rounding


def integrals(kernel: Kernel, grid: Grid, h: float, X: Array, mix: Array) -> Array:
    """Integrals of kernel sums ``mix`` (19, c) against the densities, at targets X (target,); (target, c, n)."""
    # one rule serves all targets where the kernel is smooth; elsewhere intervals end where the kernel's panels do
    rules, rough = grid.rules, grid.rough_at(X, kernel.smoothness / h)
    target, interval = np.nonzero(~rough)
    values = np.zeros((rules.panel.size, X.size, RULE, mix.shape[1]))
    values[interval, target] = far(kernel, h * (X[target, None] - np.cosh(rules.theta[interval])), mix)
    parts = np.swapaxes(values, 2, 3) @ rules.shape[:, None]  # (interval, target, c, node)
    out = np.zeros((X.size, grid.panels, mix.shape[1], grid.count // grid.panels))
    for number, part in zip(rules.panel.tolist(), parts, strict=True):
        out[:, number] += part
    for row, panel, start, stop in _rough_pieces(kernel, grid, h, X, rough):
        theta, shape = grid.ruled(panel, *spans(start, stop))
        values = far(kernel, h * (X[row, None] - np.cosh(theta)), mix)
        add_pieces(out, row, panel, np.swapaxes(values, 1, 2) @ shape)
    return np.moveaxis(out, 1, 2).reshape(X.size, mix.shape[1], grid.count)


def _rough_pieces(kernel: Kernel, grid: Grid, h: float, X: Array, rough: BoolArray) -> tuple[Pieces, Pieces]:
    """Cut ``rough`` intervals (target, interval) where densities or kernel break; finite panels, then infinite."""
    ends, last = np.array(grid.ends), grid.panels - 1
    farthest = float(np.cosh(ends[-1]))
    breaks = X[:, None] + np.concatenate([kernel.ends, -kernel.ends]) / h
    finite = pieces(ends, np.arccosh(np.clip(breaks, 1.0, farthest)), rough[:, :last])
    inverse = np.exp(-np.arccosh(np.maximum(breaks, farthest)))
    row, interval, start, stop = pieces(grid.infinite_ends, inverse, rough[:, last:])
    return finite, (row, np.full_like(interval, last), start, stop)


def enough(strip: float, length: float) -> int:
    """Number of Chebyshev points on an interval of ``length`` for a function analytic within a strip around it."""
    return 2 + int(_DIGITS / np.arcsinh(2 * strip / length))


def far(wide: Kernel, x: Array, mix: Array) -> Array:
    """Kernel sums ``mix`` (19, c) at distances x (...) [m], by their logarithm beyond the reach; (..., c)."""
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
    """Kernel integrals of the right densities at points near the contact, and displacements at the distant nodes.

    (point, 7 field, n), and (2 node, 3 field, n), right and left; tables of any friction share them.
    """
    mix = np.stack([mixing(0.0, np.eye(3)[1 + f]) for f in fields], 1)
    X = grid.distance[grid.close :]
    near = integrals(wide, grid, h, np.array(points), mix.reshape(19, -1))
    return near, integrals(wide, grid, h, np.concatenate([X, -X]), mix[..., 4:].reshape(19, -1))
