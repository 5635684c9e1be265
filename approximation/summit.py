"""Newton's iteration to the top of a measure of fields on a panel, all of a block of curves at once."""

from dataclasses import dataclass

import numpy as np

from approximation.arrays import Array, Flags, Indices
from approximation.chebyshev import gauss_points
from approximation.measure import Bent, Floats, Measure
from approximation.panels import jets, rows, spacing

STEPS = 10
# a step of Newton's iteration, in the half-width of a panel: the next is of its square
CLOSE, CLOSEST = 3e-4, 1e-8
CLIMBED, RIVAL = 6, 0.1  # hills that are climbed, and how far below the highest their best points may lie
_ALIKE = 1e-9  # relative difference up to which two tops are equals


@dataclass(frozen=True, eq=False)
class Top:
    """Location of a measure's maximum on each of several fields, (n,), in the panel's coordinates."""

    panel: Indices  # Number of the panel
    # Coordinates in [-1, 1]
    across: Array
    down: Array
    value: Array  # The measure there


def highest(fields: Array, counts: tuple[int, ...], measure: Measure) -> Top:
    """Find where a measure of fields (n, m, down, across) is largest on panels side by side, from several hills.

    Of tops that are equal but for rounding, the first from the left is given.
    """
    ends = np.cumsum((0, *counts))
    curves, down, across = _hills(measure.values(fields.reshape(*fields.shape[:2], -1)), fields.shape[2], ends)
    panel = np.searchsorted(ends, across, "right") - 1
    tops = np.empty((3, curves.size))
    for number, count in enumerate(counts):
        members = np.flatnonzero(panel == number)
        if members.size:
            start = (
                gauss_points(count)[across[members] - ends[number]],
                gauss_points(fields.shape[2])[down[members]],
            )
            part = fields[curves[members], ..., ends[number] : ends[number + 1]]
            tops[:, members] = climb(part, measure, start, CLOSEST)
    value = np.full(len(fields), -np.inf)
    np.maximum.at(value, curves, tops[2])
    alike = np.flatnonzero(tops[2] >= (value - _ALIKE * np.abs(value))[curves])
    order = alike[np.lexsort((2 * panel[alike] + tops[0, alike], curves[alike]))]
    first = order[np.searchsorted(curves[order], np.arange(len(fields)))]
    return Top(panel[first], tops[0, first], tops[1, first], value)


def _hills(values: Floats, down: int, ends: Indices) -> tuple[Indices, Indices, Indices]:
    """Curve, row and column of points that are no lower than those beside them in their panel; the highest few."""
    net = np.pad(values.reshape(len(values), down, -1), ((0, 0), (1, 1), (1, 1)), constant_values=-np.inf)
    inner = net[:, 1:-1, 1:-1]
    hill = (inner >= net[:, :-2, 1:-1]) & (inner >= net[:, 2:, 1:-1])
    for neighbour, edge in ((net[:, 1:-1, :-2], ends[:-1]), (net[:, 1:-1, 2:], ends[1:] - 1)):
        lower = inner >= neighbour
        lower[..., edge] = True
        hill &= lower
    heights = np.where(hill, inner, -np.inf).reshape(len(values), -1)
    few = np.argpartition(-heights, min(CLIMBED, heights.shape[1]) - 1)[:, :CLIMBED]
    best = np.take_along_axis(heights, few, 1)
    top = best.max(1, keepdims=True)
    curves, which = np.nonzero(best >= top - RIVAL * np.abs(top))
    return curves, *np.divmod(few[curves, which], int(ends[-1]))


def climb(
    fields: Array, measure: Measure, start: tuple[Array, Array], close: float = CLOSE
) -> tuple[Array, Array, Array]:
    """Return coordinates and measure of the highest points that climbs on fields (n, m, down, across) meet."""
    counts = fields.shape[3], fields.shape[2]
    (u, v), active = start, np.arange(len(fields))
    best = np.stack([u, v, np.full(len(u), -np.inf)])
    for _ in range(STEPS):
        jet = jets(fields, rows(counts[0], u), rows(counts[1], v))
        bent = measure.bent(jet[..., 0, 0])
        gradient, bends = hill(jet, bent)
        step = _step(gradient, bends, u, v, counts)
        point = np.array([u, v])
        ahead = np.minimum(np.maximum(point + step, -1.0), 1.0)
        last = np.abs(step).max(axis=0) < close
        # the gain of the last step is that on a parabola, up to third order
        gain = np.where(last, np.maximum((gradient * (ahead - point)).sum(axis=0), 0.0) / 2, 0.0)
        value = bent.value + gain
        up = value > best[2, active]
        best[:2, active[up]] = np.where(last, ahead, point)[:, up]
        best[2, active[up]] = value[up]
        u, v = ahead
        if last.any():
            if last.all():
                break
            going = ~last
            active, u, v, fields = active[going], u[going], v[going], fields[going]
    return best[0], best[1], best[2]


def hill(jet: Array, bent: Bent) -> tuple[Array, Array]:
    """Return gradient, (2, n), and curvature of uu, vv and uv, (3, n), of a measure, from `panels.jets` of fields."""
    slope, steep = bent.slope, jet[..., [0, 1], [1, 0]]  # by u, by v: (n, m, 2)
    gradient = np.asarray(slope[:, None] @ steep)[:, 0].T
    quadratic = np.swapaxes(steep, 1, 2) @ bent.bend @ steep
    seconds = (slope[:, None] @ jet[..., [0, 2, 1], [2, 0, 1]])[:, 0]
    return gradient, (seconds + quadratic[:, [0, 1, 0], [0, 1, 1]]).T


def held(place: Array, slope: Array, count: int | Indices) -> Flags:
    """Mark coordinates (n,) that an end of the panel holds, as the measure rises beyond it, or that the panel lacks."""
    return np.asarray(((np.abs(place) >= 1) & (place * slope > 0)) | (np.asarray(count) == 1))


def _step(gradient: Array, bends: Array, u: Array, v: Array, counts: tuple[int, int]) -> Array:
    """Newton's step, (2, n), uphill and no longer than points lie apart; along an end of the panel that holds it."""
    uu, vv, uv = bends
    places, sizes = np.array([u, v]), np.array(counts)[:, None]
    fixed = held(places, gradient, sizes)
    gradient = np.where(fixed, 0.0, gradient)
    gu, gv = gradient
    room = spacing(places, sizes)
    # not on top of a hill: each coordinate by its own curvature, its sign made that of one
    alone = gradient / np.maximum(np.abs(bends[:2]), np.abs(gradient) / room + 1e-300)
    determinant = uu * vv - uv**2
    whole = (uu < 0) & (determinant > 0) & ~fixed.any(axis=0)
    if not whole.any():
        return np.minimum(np.maximum(alone, -room), room)
    newton = np.array([uv * gv - vv * gu, uv * gu - uu * gv]) / np.where(whole, determinant, 1.0)
    return np.minimum(np.maximum(np.where(whole, newton, alone), -room), room)
