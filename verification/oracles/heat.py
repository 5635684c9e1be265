"""Finite volumes for heat that enters a layered body at its surface: mean temperatures of a layer.

The one-dimensional volumes are exact in time, by the eigenvalues of their tridiagonal matrix; the axisymmetric ones
take steps of the L-stable implicit method of order two by R. Alexander. Neither knows transforms.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from scipy.linalg import eigh_tridiagonal
from scipy.sparse import csc_array, diags_array
from scipy.sparse.linalg import splu

from approximation.arrays import Array, Indices

_DEEP = 9.0  # depth of the base and radius of the mesh over the diffusion length: what is beyond changes less than 1e-9
_ALEXANDER = 1 - 0.5**0.5


@dataclass(frozen=True)
class Slab:
    """A layer for heat."""

    thickness: float  # [m]; of a base the value has no part
    conductivity: float  # [W/m/K]
    capacity: float  # by volume [J/m3/K]


def film_mean(slabs: Sequence[Slab], base: Slab, film: int, time: float, cells: int = 400) -> float:
    """Mean temperature of a layer after a unit step at the surface, extrapolated from two meshes."""
    coarse, fine = (_film_mean(slabs, base, film, time, count) for count in (cells, 2 * cells))
    return fine + (fine - coarse) / 3


def _film_mean(slabs: Sequence[Slab], base: Slab, film: int, time: float, cells: int) -> float:
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


def spot_heat(
    slabs: Sequence[Slab],
    base: Slab,
    film: int,
    time: float,
    radius: float,
    collecting: float,
    *,
    outside: Literal["held", "insulated"] = "held",
    cells: int = 24,
    steps: int = 60,
) -> float:
    """Integral of a layer's mean temperature over a disc [m2 K] after a unit step on a disc-shaped spot.

    ``radius`` is the spot's, ``collecting`` the disc's; outside the spot the surface is held at zero or insulated.
    """
    widths, conductivity, capacity, layer = _column(slabs, base, time, cells)
    reach = _DEEP * max(np.sqrt(part.conductivity / part.capacity * time) for part in (*slabs, base))
    edges = _rings(sorted({radius, collecting}), max(radius, collecting) + reach, cells)
    middles, areas = (edges[1:] + edges[:-1]) / 2, np.pi * np.diff(edges**2)
    rows, columns = len(widths), len(areas)
    number = np.arange(rows * columns).reshape(rows, columns)
    resistance = (widths / (2 * conductivity))[:, None] / areas
    down = 1 / (resistance[:-1] + resistance[1:])
    aside = np.outer(widths * conductivity, 2 * np.pi * edges[1:-1] / np.diff(middles))
    matrix = _links(number[:-1], number[1:], down) + _links(number[:, :-1], number[:, 1:], aside)
    spot = middles < radius
    entering = np.zeros((rows, columns))
    entering[0] = np.where(spot, 1 / resistance[0], 0.0)
    held = entering.copy()
    if outside == "held":
        held[0] = 1 / resistance[0]
    matrix = csc_array(matrix + diags_array(held.ravel()))
    mass, source = np.outer(widths * capacity, areas).ravel(), entering.ravel()
    temperatures = np.zeros(rows * columns)
    ends = time * np.concatenate([[0.0], 4.0 ** np.arange(-5, 1)])
    for start, end in pairwise(ends):
        temperatures = _advanced(matrix, mass, source, temperatures, (end - start) / steps, steps)
    inside = temperatures.reshape(rows, columns)[layer == film][:, middles < collecting]
    weights = np.outer(widths[layer == film], areas[middles < collecting])
    return float((weights * inside).sum() / widths[layer == film].sum())


def _column(slabs: Sequence[Slab], base: Slab, time: float, cells: int) -> tuple[Array, Array, Array, Indices]:
    """Widths, conductivities, capacities and layers of the volumes below each other, the base's last."""
    widths = [np.full(cells, slab.thickness / cells) for slab in slabs]
    depth = _DEEP * np.sqrt(base.conductivity / base.capacity * time)
    first = min(slabs[-1].thickness, depth / 4) / depth if slabs else 0.25
    stretch = np.log(1 / first) + 1  # volumes of the base grow from about the last layer's on
    widths.append(depth * np.diff(np.expm1(stretch * np.linspace(0, 1, 3 * cells + 1)) / np.expm1(stretch)))
    layer = np.repeat(np.arange(len(slabs) + 1), [len(part) for part in widths])
    parts = [*slabs, base]
    return (
        np.concatenate(widths),
        np.array([parts[k].conductivity for k in layer]),
        np.array([parts[k].capacity for k in layer]),
        layer,
    )


def _rings(marks: Sequence[float], end: float, cells: int) -> Array:
    """Radii of rings that are fine on both sides of some marks."""
    points = [np.zeros(1)]
    start = 0.0
    for mark in marks:
        share = (1 - np.cos(np.pi * np.linspace(0, 1, 2 * cells + 1)[1:])) / 2
        points.append(start + (mark - start) * share)
        start = mark
    share = np.expm1(5 * np.linspace(0, 1, 3 * cells + 1)[1:]) / np.expm1(5)
    return np.concatenate([*points, start + (end - start) * share])


def _links(first: Indices, second: Indices, conductance: Array) -> csc_array:
    """Matrix of the heat that flows between volumes."""
    i, j, g = first.ravel(), second.ravel(), conductance.ravel()
    size = int(max(i.max(), j.max())) + 1
    entries = np.concatenate([g, g, -g, -g]), (np.concatenate([i, j, i, j]), np.concatenate([i, j, j, i]))
    return csc_array(entries, shape=(size, size))


def _advanced(matrix: csc_array, mass: Array, source: Array, values: Array, step: float, count: int) -> Array:
    """Temperatures after some steps."""
    solve = splu(csc_array(matrix * (_ALEXANDER * step) + diags_array(mass))).solve
    for _ in range(count):
        first = solve(source - matrix @ values)
        second = solve(source - matrix @ (values + (1 - _ALEXANDER) * step * first))
        values = values + step * ((1 - _ALEXANDER) * first + _ALEXANDER * second)
    return values
