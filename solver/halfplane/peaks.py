"""Largest von Mises stress and largest principal stress of the body below a depth of 0.1 h, and their curves.

A scan over the body finds local maxima of each case, then Newton's iteration on difference quotients, batched over
cases and maxima, climbs to their tops. Stresses decay as 1/r, and a far field of one direction is largest at the least
depth: only there does the scan go far. The curves are the stresses on panels tied to the edges of the contact.
"""

from collections.abc import Callable, Set

import numpy as np

from approximation.arrays import Indices, blocks
from solver.arrays import Array, BoolArray
from solver.curves import REGIONS
from solver.halfplane.contact import Contact
from solver.halfplane.interior import interior_parts, principal_tension, von_mises
from solver.names import PEAKS

DEPTH = 0.1  # of the half-width: the least depth
# of the half-width: the largest depth of the curves; deeper there is no largest von Mises stress, and no tension as
# large as at the least depth
_DEEPEST = 2.0
_REGION = REGIONS["body"]
_STRESSES = _REGION.fields[:4]
_ACROSS = np.concatenate([np.linspace(0.0, 0.6, 7), 1 + np.linspace(-0.36, 0.36, 37), 1.36 * 1.5 ** np.arange(1, 6)])
_FAR: Array = np.asarray(6.0 * 1.5 ** np.arange(31), dtype=np.float64)
_LEAST = np.array([-DEPTH])
Grid = tuple[Array, Array]
_BODY: Grid = (np.concatenate([-_ACROSS[:0:-1], _ACROSS]), np.asarray(-DEPTH * 1.4 ** np.arange(11)))
_LINES: tuple[Grid, Grid] = ((_FAR, _LEAST), (-_FAR[::-1], _LEAST))
_CHUNK = 4_000_000  # stresses of a scan held at a time
_MAXIMA = 3  # highest local maxima of a scan, which are climbed
_RIVAL = 0.1  # of the largest stress: greatest distance of a climbed local maximum below the highest one
_STEPS = 40
_CLOSE = 1e-5  # step of Newton's iteration over distance to the edges and depth; the next is of its square
_STENCIL = np.array([(i, j) for j in (-1, 0, 1) for i in (-1, 0, 1)], dtype=np.float64)
_TINY = np.finfo(float).tiny
_NEGLIGIBLE = 1e-12  # of the pressure scale: tension that counts as 0

Measure = Callable[[Array, Array, Array, Array], Array]


def peaks(contact: Contact, requested: Set[str]) -> dict[str, Array]:
    """Requested quantities of ``solver.names.PEAKS`` with relative errors of 1e-9; (...) each."""
    scale, out = contact.pressure_scale, dict[str, Array]()
    if {"peak_von_mises", "peak_von_mises_depth"} & requested:
        value, depth = _peak(contact, von_mises, *_starts(contact, von_mises, _BODY))
        out |= {"peak_von_mises": scale * value, "peak_von_mises_depth": contact.half_width * depth}
    if "peak_principal_tension" in requested:  # 0, that of points far away, where no tension is found
        value, _ = _peak(contact, principal_tension, *_starts(contact, principal_tension, _BODY, *_LINES))
        out["peak_principal_tension"] = np.where(value < _NEGLIGIBLE, 0.0, scale * value)
    return {name: out[name] for name in PEAKS if name in requested}


def _peak(contact: Contact, measure: Measure, x: Array, y: Array) -> tuple[Array, Array]:
    """Largest measure over the pressure scale, and its depth over h, from starting points (..., start)."""
    reach, moved = np.full_like(x, 0.2), np.full_like(x, np.inf)
    highest = np.stack([x, y, np.full_like(x, -np.inf)])  # position and measure of the best point of every climb
    ended: BoolArray = np.zeros_like(x, dtype=bool)  # an ended climb stays: no result depends on the other cases
    for _ in range(_STEPS):
        step = np.clip(reach / 8, 1e-4, 0.02)  # of the stencil, over the distance to the edges and the depth
        across, down = step * np.hypot(np.minimum(np.abs(x - 1), np.abs(x + 1)), y), -step * y
        around = _around(contact, measure, (x, across), (y, down))
        current = np.stack([x, y, around[..., 4]])
        up = (current[2] >= highest[2]) & ~ended
        highest = np.where(up, current, highest)
        to_zero = (current[2] < _NEGLIGIBLE) & (np.hypot(x, y) > _FAR[0])  # at infinity
        ended |= (moved < _CLOSE) | to_zero
        if np.all(ended):
            break
        dx, dy = _newton_step(around, (-DEPTH - y) / down, reach / step)
        length = np.hypot(dx, dy) * step
        # a climb that went down returns and tries again with a quarter of the reach
        x = np.where(up, x + dx * across, highest[0])
        y = np.where(up, np.minimum(y + dy * down, -DEPTH), highest[1])
        reach = np.where(up, np.clip(2 * length, 1e-6, reach), moved / 4)
        moved = np.where(up, length, moved / 4)
    top = np.argmax(highest[2], -1)[..., None]
    return np.take_along_axis(highest[2], top, -1)[..., 0], -np.take_along_axis(highest[1], top, -1)[..., 0]


def _around(contact: Contact, measure: Measure, *axes: tuple[Array, Array]) -> Array:
    """Measure on the stencil about points, by position and spacing, rows from the deepest on; (..., start, 9)."""
    stencil = [middle[..., None] + size[..., None] * _STENCIL[:, k] for k, (middle, size) in enumerate(axes)]
    cases = stencil[0].shape[:-2]
    return measure(*_stresses(contact, *(points.reshape(*cases, -1) for points in stencil))).reshape(stencil[0].shape)


def _stresses(contact: Contact, x: Array, y: Array) -> list[Array]:
    """Stresses over the pressure scale; (..., point) each."""
    parts, e = interior_parts(contact, x, y, _STRESSES), contact.relative_charge_density[..., None, None, :]
    stresses = parts.of_load + e[..., 0] * parts.of_charges[0] + e[..., 1] * parts.of_charges[1]
    return [stresses[..., k, :] for k in range(4)]


def _starts(contact: Contact, measure: Measure, *grids: Grid) -> tuple[Array, Array]:
    """Positions x and y of the highest local maxima of scans over grids; (..., start) each."""
    scans = [_maxima(contact, measure, *grid) for grid in grids]
    x, y, values, largest = (np.concatenate(parts, -1) for parts in zip(*scans, strict=True))
    order = np.argsort(-values, axis=-1)[..., :_MAXIMA]
    ranked = np.take_along_axis(values, order, -1)
    rivals = np.isfinite(ranked) & (ranked >= ranked[..., :1] - _RIVAL * np.max(largest, -1, keepdims=True))
    order = np.where(rivals, order, order[..., :1])[..., : int(rivals.sum(-1).max(initial=1))]  # else the highest again
    return np.take_along_axis(x, order, -1), np.take_along_axis(y, order, -1)


def _maxima(contact: Contact, measure: Measure, across: Array, down: Array) -> tuple[Array, Array, Array, Array]:
    """Positions and values (-inf: none) of the maxima of a scan (..., maximum), and its largest stress (..., 1)."""
    x, y = (grid.ravel() for grid in np.meshgrid(across, down))
    parts = interior_parts(contact, x, y, _STRESSES)
    e = contact.relative_charge_density
    shape = np.broadcast_shapes(parts.of_load.shape[:-2], parts.of_charges[0].shape[:-2], e.shape[:-1])
    count, scans = int(np.prod(shape)), list[tuple[Indices, Array, Array]]()
    for block in blocks(count, max(1, _CHUNK // (4 * x.size))):
        cases = np.unravel_index(np.arange(count)[block], (1, *shape))

        def part(values: Array, cases: tuple[Indices, ...] = cases) -> Array:
            return np.broadcast_to(values, (1, *shape, *values.shape[-2:]))[cases]

        electric, magnetic = (part(e[..., j, None, None]) * part(parts.of_charges[j]) for j in (0, 1))
        stresses = part(parts.of_load) + electric + magnetic
        values = measure(*(stresses[:, k] for k in range(4)))
        grid = values.reshape(-1, down.size, across.size)
        ranked = np.where(_is_top(grid), grid, -np.inf).reshape(values.shape)
        order = np.argsort(-ranked, axis=-1)[:, :_MAXIMA]
        largest = np.max(np.abs(stresses), axis=(-2, -1))[:, None]
        scans.append((order, np.take_along_axis(ranked, order, -1), largest))
    best, highest, largest = (np.concatenate(values).reshape(*shape, -1) for values in zip(*scans, strict=True))
    return x[best], y[best], highest, largest


def _is_top(grid: Array) -> BoolArray:
    """Return True where a value is at least that of its neighbours along both axes, except at the ends across."""
    padded = np.pad(grid, [(0, 0)] * (grid.ndim - 2) + [(1, 1), (1, 1)], constant_values=-np.inf)
    centre = padded[..., 1:-1, 1:-1]
    across = np.maximum(padded[..., 1:-1, 2:], padded[..., 1:-1, :-2])
    down = np.maximum(padded[..., 2:, 1:-1], padded[..., :-2, 1:-1])
    top = np.asarray((centre >= across) & (centre >= down))
    top[..., [0, -1]] = False
    return top


def _newton_step(around: Array, ceiling: Array, reach: Array) -> tuple[Array, Array]:
    """Upward step in units of the stencil, no longer than the reach and not above the ceiling; (...) each."""
    sw, s, se, w, centre, e, nw, n, ne = np.moveaxis(around, -1, 0)
    gx, gy = (e - w) / 2, (n - s) / 2
    xx, yy, xy = e + w - 2 * centre, n + s - 2 * centre, (ne - nw - se + sw) / 4
    # the eigenvalues of the curvature, mean +- half, are made negative, so that the step goes up from a saddle too
    mean, half = (xx + yy) / 2, np.hypot((xx - yy) / 2, xy)
    least = 1e-3 * (np.abs(mean) + half) + _TINY
    high, low = -np.maximum(np.abs(mean + half), least), -np.maximum(np.abs(mean - half), least)
    angle = np.arctan2(2 * xy, xx - yy) / 2
    cos, sin = np.cos(angle), np.sin(angle)
    along, over = -(cos * gx + sin * gy) / high, -(-sin * gx + cos * gy) / low
    dx, dy = cos * along - sin * over, sin * along + cos * over
    # at the ceiling the step follows it, by the curvature along it
    bound = dy > ceiling
    along_ceiling = (gx + xy * ceiling) / np.maximum(np.abs(xx), least)
    dx, dy = np.where(bound, along_ceiling, dx), np.where(bound, ceiling, dy)
    length = np.hypot(dx, dy)
    factor = np.minimum(length, reach) / np.maximum(length, _TINY)
    return dx * factor, np.where(bound & (length <= reach), ceiling, dy * factor)


def body_curves(contact: Contact) -> dict[str, Array]:
    """Fields of the region ``body`` by name; (..., point), SI."""
    X, depth = (_REGION.panels.by_panel(grid) for grid in np.meshgrid(*lines()))
    stresses = interior_parts(contact, X, -depth, _STRESSES).whole(contact)
    return named(stresses, contact.half_width, depth)


def named(stresses: Array, half_width: Array, depth: Array) -> dict[str, Array]:
    """Fields of the region by name, SI, from stresses (..., 4, point) [Pa] at depths over h (point,)."""
    curves = {f"body_{name}": stresses[..., k, :] for k, name in enumerate(_STRESSES)}
    return curves | {"body_depth": half_width[..., None] * depth}


def lines() -> tuple[Array, Array]:
    """X of the points across (x,), and depths over h of those down, even in the logarithm (depth,)."""
    across, down = _REGION.lines()
    size = np.abs(across)
    X = np.where(size < 1, across, np.sign(across) * (1 + (size - 1) / (2 - size)))  # infinite at 2
    return X, DEPTH * (_DEEPEST / DEPTH) ** down
