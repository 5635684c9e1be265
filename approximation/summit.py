"""Maximum of a measure of fields on panels by Newton's iteration, for many curves at once."""

from dataclasses import dataclass

import numpy as np

from approximation.arrays import Array, Flags, Indices
from approximation.chebyshev import gauss_points
from approximation.measure import Bent, Floats, Measure
from approximation.panels import jets, rows, spacing

STEPS = 10
# last steps of Newton's iteration, in half-widths of a panel: the next step would be of the order of the square
CLOSE, CLOSEST = 3e-4, 1e-8
CLIMBED, RIVAL = 6, 0.1  # most local maxima that are climbed, and how far below the highest their points may lie
_EQUAL = 1e-9  # relative difference up to which two maxima are equal


@dataclass(frozen=True, eq=False)
class Top:
    """Maximum of a measure on each of n curves, (n,)."""

    panel: Indices  # number of the panel
    across: Array  # coordinates in the panel, in [-1, 1]
    down: Array
    value: Array  # the measure at its maximum


def highest(fields: Array, counts: tuple[int, ...], measure: Measure) -> Top:
    """Return the maximum of a measure of fields (n, m, down, across) on adjacent panels; of equal ones the leftmost."""
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
    equal = np.flatnonzero(tops[2] >= (value - _EQUAL * np.abs(value))[curves])
    order = equal[np.lexsort((2 * panel[equal] + tops[0, equal], curves[equal]))]
    first = order[np.searchsorted(curves[order], np.arange(len(fields)))]
    return Top(panel[first], tops[0, first], tops[1, first], value)


def _hills(values: Floats, down: int, ends: Indices) -> tuple[Indices, Indices, Indices]:
    """Return curve, row and column of the highest points that no neighbour in their panel exceeds."""
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
    """Return coordinates and measure, (n,) each, of the highest point of every climb on fields (n, m, down, across)."""
    counts = fields.shape[3], fields.shape[2]
    (u, v), active = start, np.arange(len(fields))
    best = np.stack([u, v, np.full(len(u), -np.inf)])
    for _ in range(STEPS):
        jet = jets(fields, rows(counts[0], u), rows(counts[1], v))
        bent = measure.bent(jet[..., 0, 0])
        gradient, curvature = gradient_curvature(jet, bent)
        step = _step(gradient, curvature, u, v, counts)
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


def gradient_curvature(jet: Array, bent: Bent) -> tuple[Array, Array]:
    """Return gradient, (2, n), and second derivatives uu, vv, uv, (3, n), of a measure from `panels.jets` of fields."""
    slope, steep = bent.slope, jet[..., [0, 1], [1, 0]]  # by u, by v: (n, m, 2)
    gradient = np.asarray(slope[:, None] @ steep)[:, 0].T
    quadratic = np.swapaxes(steep, 1, 2) @ bent.bend @ steep
    seconds = (slope[:, None] @ jet[..., [0, 2, 1], [2, 0, 1]])[:, 0]
    return gradient, (seconds + quadratic[:, [0, 1, 0], [0, 1, 1]]).T


def at_bound(place: Array, slope: Array, count: int | Indices) -> Flags:
    """Mark coordinates (n,) at a panel's end beyond which the measure rises, and coordinates that the panel lacks."""
    return np.asarray(((np.abs(place) >= 1) & (place * slope > 0)) | (np.asarray(count) == 1))


def _step(gradient: Array, curvature: Array, u: Array, v: Array, counts: tuple[int, int]) -> Array:
    """Return Newton's step uphill, (2, n), at most the spacing of the points; coordinates at a bound stay there."""
    uu, vv, uv = curvature
    places, sizes = np.array([u, v]), np.array(counts)[:, None]
    fixed = at_bound(places, gradient, sizes)
    gradient = np.where(fixed, 0.0, gradient)
    gu, gv = gradient
    longest = spacing(places, sizes)
    # where the curvature is not that of a maximum, each coordinate steps by the size of its own curvature
    step = gradient / np.maximum(np.abs(curvature[:2]), np.abs(gradient) / longest + 1e-300)
    determinant = uu * vv - uv**2
    concave = (uu < 0) & (determinant > 0) & ~fixed.any(axis=0)
    if concave.any():
        newton = np.array([uv * gv - vv * gu, uv * gu - uu * gv]) / np.where(concave, determinant, 1.0)
        step = np.where(concave, newton, step)
    return np.minimum(np.maximum(step, -longest), longest)
