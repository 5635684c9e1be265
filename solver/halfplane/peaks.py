"""Largest von Mises stress and largest principal stress of the body below a depth of 0.1 h.

In units of the half-width and of the pressure scale the stresses depend on material, friction, conduction, profile and
on charges per load; nothing else. A scan over the body finds the local maxima of each such case, then Newton's
iteration on difference quotients, batched over cases and maxima, climbs to their tops within the body. Stresses decay
as 1/r, and a far field of one direction is largest at the least depth: the scan goes far only along that line.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from solver.arrays import Array, BoolArray
from solver.halfplane.contact import Contact
from solver.halfplane.interior import InteriorParts, interior_parts, principal_tension, von_mises

DEPTH = 0.1  # of the half-width: the least depth
_STRESSES = ("stress_xx", "stress_yy", "stress_xy", "stress_zz")
_ACROSS = np.concatenate([np.linspace(0.0, 0.6, 7), 1 + np.linspace(-0.36, 0.36, 37), 1.36 * 1.5 ** np.arange(1, 6)])
_AWAY: Array = np.asarray(6.0 * 1.5 ** np.arange(31), dtype=np.float64)
_LEAST = np.array([-DEPTH])
Grid = tuple[Array, Array]
_BODY: Grid = (np.concatenate([-_ACROSS[:0:-1], _ACROSS]), np.asarray(-DEPTH * 1.4 ** np.arange(11)))
_LINES: tuple[Grid, Grid] = ((_AWAY, _LEAST), (-_AWAY[::-1], _LEAST))
_CHUNK = 4_000_000  # stresses of a scan held at a time
_MAXIMA = 3  # local maxima of a scan that are climbed, the the highest ones
_RIVAL = 0.1  # of the largest stress: how far below the highest a local maximum of the scan is still climbed
_STEPS = 40
_CLOSE = 1e-5  # step of Newton's iteration over distance to the edges and depth; the next is of its square
_STENCIL = np.array([(i, j) for j in (-1, 0, 1) for i in (-1, 0, 1)], dtype=np.float64)
_NOTHING = 1e-12  # of the pressure scale: a tension below it is none

Measure = Callable[[Array, Array, Array, Array], Array]


@dataclass(frozen=True, eq=False)
class Peak:
    """A largest stress [Pa] and its depth [m]; (...)."""

    value: Array
    depth: Array


def peak_von_mises(contact: Contact) -> Peak:
    """Largest von Mises stress below depth 0.1 h, to 1e-9 of itself."""
    value, depth = _peak(contact, von_mises, *_starts(contact, von_mises, _BODY))
    return Peak(contact.pressure_scale * value, contact.half_width * depth)


def peak_principal_tension(contact: Contact) -> Peak:
    """Largest principal stress below depth 0.1 h; 0, that of points far away, where no tension is found.

    The depth is infinite where there is no tension.
    """
    value, depth = _peak(contact, principal_tension, *_starts(contact, principal_tension, _BODY, *_LINES))
    none = value < _NOTHING
    scale, half = contact.pressure_scale, contact.half_width
    return Peak(np.where(none, 0.0, scale * value), np.where(none, np.inf, half * depth))


def _peak(contact: Contact, measure: Measure, x: Array, y: Array) -> tuple[Array, Array]:
    """Largest measure over the pressure scale, and its depth over h, from starting points (..., start)."""
    reach, moved = np.full_like(x, 0.2), np.full_like(x, np.inf)
    held_x, held_y, held = x, y, np.full_like(x, -np.inf)  # the highest place so far of every start
    for _ in range(_STEPS):
        step = np.clip(reach / 8, 1e-4, 0.02)
        along, over = step * np.hypot(np.minimum(np.abs(x - 1), np.abs(x + 1)), y), -step * y
        points = (x[..., None] + along[..., None] * _STENCIL[:, 0], y[..., None] + over[..., None] * _STENCIL[:, 1])
        flat = [p.reshape(*x.shape[:-1], -1) for p in points]
        around = measure(*_stresses(contact, *flat)).reshape(points[0].shape)
        up = around[..., 4] >= held
        close = (moved < _CLOSE) | ((around[..., 4] < _NOTHING) & (np.hypot(x, y) > _AWAY[0]))  # to zero at infinity
        held_x, held_y, held = np.where(up, x, held_x), np.where(up, y, held_y), np.where(up, around[..., 4], held)
        if np.all(close):
            break
        dx, dy = _climb(around, (-DEPTH - y) / over, reach / step)
        length = np.hypot(dx, dy) * step
        # what went down goes back and tries again with a quarter of the reach
        x, y = np.where(up, x + dx * along, held_x), np.where(up, np.minimum(y + dy * over, -DEPTH), held_y)
        reach = np.where(up, np.clip(2 * length, 1e-6, reach), moved / 4)
        moved = np.where(up, length, moved / 4)
    top = np.argmax(held, -1)[..., None]
    return np.take_along_axis(held, top, -1)[..., 0], -np.take_along_axis(held_y, top, -1)[..., 0]


def _stresses(contact: Contact, x: Array, y: Array) -> list[Array]:
    """Stresses over the pressure scale; (..., point) each."""
    parts = interior_parts(contact, x, y, _STRESSES)
    whole = _combined(parts, contact.relative_charge_density)
    return [whole[..., k, :] for k in range(4)]


def _combined(parts: InteriorParts, e: Array) -> Array:
    electric, magnetic = (e[..., j, None, None] * parts.of_charges[j] for j in (0, 1))
    return np.asarray(parts.of_load + electric + magnetic)


def _starts(contact: Contact, measure: Measure, *grids: Grid) -> tuple[Array, Array]:
    """Places of the highest local maxima of scans over grids; (..., start) each."""
    scans = [_maxima(contact, measure, *grid) for grid in grids]
    x, y, values, largest = (np.concatenate(parts, -1) for parts in zip(*scans, strict=True))
    order = np.argsort(-values, axis=-1)[..., :_MAXIMA]
    ranked = np.take_along_axis(values, order, -1)
    found = np.isfinite(ranked) & (ranked >= ranked[..., :1] - _RIVAL * np.max(largest, -1, keepdims=True))
    order = np.where(found, order, order[..., :1])[..., : int(found.sum(-1).max(initial=1))]  # else the highest again
    return np.take_along_axis(x, order, -1), np.take_along_axis(y, order, -1)


def _maxima(contact: Contact, measure: Measure, across: Array, down: Array) -> tuple[Array, Array, Array, Array]:
    """Places and values of the highest local maxima of one scan, -inf for want of them, and its largest stress.

    The last is (..., 1), the others are (..., maximum).
    """
    x, y = (grid.ravel() for grid in np.meshgrid(across, down))
    parts = interior_parts(contact, x, y, _STRESSES)
    e = contact.relative_charge_density
    shape = np.broadcast_shapes(parts.of_load.shape[:-2], parts.of_charges[0].shape[:-2], e.shape[:-1])
    best, highest, largest = (np.empty((*shape, count)) for count in (_MAXIMA, _MAXIMA, 1))
    for chunk in _chunks(shape, 4 * x.size):
        some = InteriorParts(
            _part(parts.of_load, chunk, 2),
            (_part(parts.of_charges[0], chunk, 2), _part(parts.of_charges[1], chunk, 2)),
        )
        stresses = _combined(some, _part(e, chunk, 1))
        values = measure(*(stresses[..., k, :] for k in range(4)))
        grid = values.reshape(*values.shape[:-1], down.size, across.size)
        ranked = np.where(_is_top(grid), grid, -np.inf).reshape(values.shape)
        order = np.argsort(-ranked, axis=-1)[..., :_MAXIMA]
        best[chunk], highest[chunk] = order, np.take_along_axis(ranked, order, -1)
        largest[chunk] = np.max(np.abs(stresses), axis=(-2, -1))[..., None]
    places = best.astype(int)
    return x[places], y[places], highest, largest


def _is_top(grid: Array) -> BoolArray:
    """Whether a value is no less than its neighbours along both axes, and not the first or last across."""
    padded = np.pad(grid, [(0, 0)] * (grid.ndim - 2) + [(1, 1), (1, 1)], constant_values=-np.inf)
    centre = padded[..., 1:-1, 1:-1]
    across = np.maximum(padded[..., 1:-1, 2:], padded[..., 1:-1, :-2])
    down = np.maximum(padded[..., 2:, 1:-1], padded[..., :-2, 1:-1])
    top = np.asarray((centre >= across) & (centre >= down))
    top[..., [0, -1]] = False
    return top


def _climb(around: Array, ceiling: Array, reach: Array) -> tuple[Array, Array]:
    """Newton step up, in steps of the stencil, no longer than the reach and not above the ceiling; each (...)."""
    sw, s, se, w, _, e, nw, n, ne = np.moveaxis(around, -1, 0)
    centre = around[..., 4]
    gx, gy = (e - w) / 2, (n - s) / 2
    xx, yy, xy = e + w - 2 * centre, n + s - 2 * centre, (ne - nw - se + sw) / 4
    mean, half = (xx + yy) / 2, np.hypot((xx - yy) / 2, xy)
    floor = 1e-3 * (np.abs(mean) + half) + np.finfo(float).tiny
    # eigenvalues made negative, so that the step goes up from a saddle too
    high, low = -np.maximum(np.abs(mean + half), floor), -np.maximum(np.abs(mean - half), floor)
    angle = np.arctan2(2 * xy, xx - yy) / 2
    c, s_ = np.cos(angle), np.sin(angle)
    along, over = -(c * gx + s_ * gy) / high, -(-s_ * gx + c * gy) / low
    dx, dy = c * along - s_ * over, s_ * along + c * over
    # at the ceiling the step is along it; its own curvature counts there
    held = dy > ceiling
    alone = -(gx + xy * ceiling) / -np.maximum(np.abs(xx), floor)
    dx, dy = np.where(held, alone, dx), np.where(held, ceiling, dy)
    length = np.hypot(dx, dy)
    short = np.minimum(length, reach) / np.maximum(length, np.finfo(float).tiny)
    return dx * short, np.where(held & (length <= reach), ceiling, dy * short)


def _chunks(shape: tuple[int, ...], each: int) -> Iterator[tuple[slice, ...]]:
    """Slices over the longest axis that keep the arrays of a scan small."""
    if not shape:
        yield ()
        return
    axis = int(np.argmax(shape))
    rest = int(np.prod(shape)) // max(shape[axis], 1)
    count = max(1, _CHUNK // max(each * rest, 1))
    for start in range(0, shape[axis], count):
        yield tuple(slice(start, start + count) if k == axis else slice(None) for k in range(len(shape)))


def _part(values: Array, chunk: tuple[slice, ...], own: int) -> Array:
    """The chunk of an array whose case axes may be of length one or missing; its last ``own`` axes stay."""
    axes = values.ndim - own
    kept = chunk[len(chunk) - axes :] if axes else ()
    return values[tuple(slice(None) if size == 1 else part for size, part in zip(values.shape, kept, strict=False))]
