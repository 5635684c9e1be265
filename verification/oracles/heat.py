"""Finite volumes for heat that enters a layered body at its surface: mean temperatures of a layer.

The one-dimensional volumes are exact in time, by the eigenvalues of their tridiagonal matrix; the axisymmetric ones
take steps of the L-stable implicit method of order two by R. Alexander. Neither knows transforms.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.linalg import eigh_tridiagonal
from scipy.sparse import block_diag, csc_array, diags_array
from scipy.sparse.linalg import splu

from approximation.arrays import Array, Indices

_DEEP = 9.0  # depth of the base and radius of the mesh over the diffusion length: what is beyond changes less than 1e-9
_AIR = 0.0257  # W/m/K
_STEPS = 6  # between a time and four times as much
_ALEXANDER = 1 - 0.5**0.5


@dataclass(frozen=True)
class Slab:
    """A layer for heat."""

    thickness: float  # [m]; of a base the value has no part
    conductivity: float  # [W/m/K]
    capacity: float  # by volume [J/m3/K]


def film_mean(slabs: Sequence[Slab], base: Slab, film: int, time: float, cells: int = 400) -> float:
    """Mean temperature of a layer after a unit step at the surface, extrapolated from two meshes."""

    def mean(cells: int) -> float:
        widths, conductivity, capacity, layer = _column(slabs, base, time, cells)
        resistance = widths / (2 * conductivity)
        between = 1 / (resistance[:-1] + resistance[1:])
        surface = 1 / resistance[0]
        diagonal = np.append(between, 0.0) + np.append(surface, between)
        root = np.sqrt(widths * capacity)
        values, vectors = eigh_tridiagonal(diagonal / root**2, -between / (root[:-1] * root[1:]))
        source = vectors.T @ np.append(surface / root[0], np.zeros(len(widths) - 1))
        temperatures = vectors @ (-np.expm1(-values * time) / values * source) / root
        inside = layer == film
        return float(widths[inside] @ temperatures[inside] / widths[inside].sum())

    coarse, fine = mean(cells), mean(2 * cells)
    return fine + (fine - coarse) / 3


def spot_heat(
    slabs: Sequence[Slab],
    base: Slab,
    film: int,
    time: float,
    radius: float,
    *,
    share: Callable[[Array], Array],
    marks: Sequence[float] = (),
    punch: Slab | None = None,
    gap: Callable[[Array], Array] | None = None,
    line: bool = False,
    cells: int = 12,
) -> float:
    """Integrate a layer's mean temperature over the surface [m2 K], of a line over its width [m K], from two meshes.

    On a disc a body that is warmer by 1 K touches the surface: a half-space of the material ``punch``, or one
    temperature. Outside is a layer of air of height ``gap``, or no heat passes. ``share`` weights the integral by the
    distance from the middle, with jumps at ``marks``.
    """

    def heat(cells: int) -> float:
        widths, conductivity, capacity, layer = _column(slabs, base, time, cells, at_faces=True)
        parts = [*slabs, base, *([punch] if punch else [])]
        reach = _DEEP * max(np.sqrt(part.conductivity / part.capacity * time) for part in parts)
        edges = _rings(sorted({radius, *(mark for mark in marks if mark > 0)}), max(radius, *marks, 0.0) + reach, cells)
        middles = (edges[1:] + edges[:-1]) / 2
        areas = 2 * np.diff(edges) if line else np.pi * np.diff(edges**2)
        crossed = np.full(len(middles) - 1, 2.0) if line else 2 * np.pi * edges[1:-1]
        inside = np.where(middles < radius, 0.0, np.inf if gap is None else gap(middles) / _AIR)
        first = widths[0] / (2 * conductivity[0])
        matrix, mass = _body(widths, conductivity, capacity, areas, crossed / np.diff(middles))
        columns, below = len(areas), len(mass)
        if punch:
            heights = _DEEP * np.sqrt(punch.conductivity / punch.capacity * time) * _rising(widths[0], reach, cells)
            above = np.full(len(heights), punch.conductivity), np.full(len(heights), punch.capacity)
            upper, mass_above = _body(heights, *above, areas, crossed / np.diff(middles))
            into = areas / (first + heights[0] / (2 * punch.conductivity) + inside)
            place = np.arange(columns)
            joints = _links(place, below + place, into, below + len(mass_above))
            matrix = block_diag([matrix, upper], format="csc") + joints
            mass, source = np.append(mass, mass_above), np.zeros(below + len(mass_above))
            temperatures = np.append(np.zeros(below), np.ones(len(mass_above)))
        else:
            source, temperatures = np.zeros(below), np.zeros(below)
            source[:columns] = areas / (first + inside)
            matrix = csc_array(matrix + diags_array(source))
        for start, end in pairwise(time * np.concatenate([[0.0], 4.0 ** np.arange(-8, 1)])):
            temperatures = _advanced(matrix, mass, source, temperatures, (end - start) / _STEPS, _STEPS)
        warm = temperatures[:below].reshape(-1, columns)[layer == film]
        return float(widths[layer == film] @ warm @ (areas * share(middles)) / widths[layer == film].sum())

    coarse, fine = heat(cells), heat(3 * cells // 2)
    return fine + 0.8 * (fine - coarse)


def _body(widths: Array, conductivity: Array, capacity: Array, areas: Array, aside: Array) -> tuple[csc_array, Array]:
    """Conductances between the volumes of a body, from the surface on, and their heat capacities."""
    number = np.arange(len(widths) * len(areas)).reshape(len(widths), -1)
    resistance = (widths / (2 * conductivity))[:, None] / areas
    down = 1 / (resistance[:-1] + resistance[1:])
    matrix = _links(number[:-1], number[1:], down, number.size)
    matrix = matrix + _links(number[:, :-1], number[:, 1:], np.outer(widths * conductivity, aside), number.size)
    return matrix, np.outer(widths * capacity, areas).ravel()


def _rising(first: float, end: float, cells: int) -> Array:
    """Widths of volumes as shares of a depth, growing from a first one [m] on."""
    stretch = np.log(end / first)
    return np.asarray(np.diff(np.expm1(stretch * np.linspace(0, 1, 3 * cells + 1)) / np.expm1(stretch)))


def _column(
    slabs: Sequence[Slab], base: Slab, time: float, cells: int, *, at_faces: bool = False
) -> tuple[Array, Array, Array, Indices]:
    """Return widths, conductivities, capacities and layers of stacked volumes, finer at both faces if `at_faces`."""
    even = np.linspace(0, 1, cells + 1)
    shares = np.diff((1 - np.cos(np.pi * even)) / 2 if at_faces else even)
    widths = [slab.thickness * shares for slab in slabs]
    depth = _DEEP * np.sqrt(base.conductivity / base.capacity * time)
    first = min(slabs[-1].thickness, depth / 4) / depth if slabs else 0.25
    widths.append(depth * _rising(first, np.e, cells))  # growing from about the last layer's on
    layer = np.repeat(np.arange(len(slabs) + 1), [len(part) for part in widths])
    parts = [*slabs, base]
    return (
        np.concatenate(widths),
        np.array([parts[k].conductivity for k in layer]),
        np.array([parts[k].capacity for k in layer]),
        layer,
    )


def _rings(marks: Sequence[float], end: float, cells: int) -> Array:
    """Return radii of rings, up to an end, that are fine on both sides of the marks."""
    points = [np.zeros(1)]
    start = 0.0
    for mark in marks:
        share = (1 - np.cos(np.pi * np.linspace(0, 1, 2 * cells + 1)[1:])) / 2
        points.append(start + (mark - start) * share)
        start = mark
    first = float(np.diff(points[-1])[-1]) if len(points[-1]) > 1 else start
    return np.concatenate([*points, start + (end - start) * np.cumsum(_rising(first / 2, end - start, cells))])


def _links(first: Indices, second: Indices, conductance: Array, size: int) -> csc_array:
    """Matrix of the heat that flows between volumes."""
    i, j, g = first.ravel(), second.ravel(), conductance.ravel()
    entries = np.concatenate([g, g, -g, -g]), (np.concatenate([i, j, i, j]), np.concatenate([i, j, j, i]))
    return csc_array(entries, shape=(size, size))


def _advanced(matrix: csc_array, mass: Array, source: Array, values: Array, step: float, count: int) -> Array:
    """Temperatures after some steps."""
    implicit = csc_array(matrix * (_ALEXANDER * step) + diags_array(mass))  # symmetric and dominant: no pivots
    solve = splu(implicit, "MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}).solve
    for _ in range(count):
        first = solve(source - matrix @ values)
        second = solve(source - matrix @ (values + (1 - _ALEXANDER) * step * first))
        values = values + step * ((1 - _ALEXANDER) * first + _ALEXANDER * second)
    return values
