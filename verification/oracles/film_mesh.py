"""Meshes of layers below a contact, -1 < X < 1: rings about both edges, rectangles elsewhere."""

from collections.abc import Sequence

import numpy as np

from verification.oracles.spectral import Index, Quadrilaterals
from verification.oracles.surface_response import Array

_RING = 0.2  # size of a ring over that of the one around it
_SIZE = 1 / 3  # of the rings, at most, over half-length and top layer
_RINGS = 12
_NARROW = 0.3  # place of a ray between the edge's vertical and the corner of a ring: some fields are that steep
_NEAR, _GROWTH = 10.0, 6.0  # of what lies farther away than some half-lengths
FAR = 1e8  # distance of the clamped ends on a half-plane
_WIDE = 300.0  # the same on a rigid base, in thicknesses: more than layers far apart in permittivity need


def layered_mesh(thicknesses: Sequence[float], rigid: bool) -> Quadrilaterals:
    """Mesh of layers from the top down, and of a half-plane below them unless the base is rigid."""
    far = _WIDE * (1 + sum(thicknesses)) if rigid else FAR
    size = _SIZE * min(1.0, thicknesses[0])
    near = np.array([-1, -_NARROW, 0, _NARROW, 1]) * size
    middle = np.linspace(size - 1, 1 - size, int(np.ceil(2 * (1 - size) / size)) + 1)[1:-1]
    outward = 1 + np.append(growing(size, _NEAR, 3), growing(_NEAR, far, _GROWTH))
    x = np.concatenate([-outward[::-1], near - 1, middle, near + 1, outward])
    return assemble(
        x, *depths(thicknesses, rigid, size, _GROWTH), [int(np.flatnonzero(x == edge)[0]) for edge in (-1.0, 1.0)]
    )


def depths(thicknesses: Sequence[float], rigid: bool, size: float, growth: float) -> tuple[Array, Index]:
    """Lines y of a mesh from the surface down, and the number of the layer between each two."""
    lines, depth = [np.array([0.0, size])], 0.0
    for thickness in thicknesses:
        depth += thickness
        lines.append(growing(lines[-1][-1], depth, 2))
    if not rigid:
        lines.append(depth + np.insert(growing(size, FAR, growth), 0, size))
    y = np.concatenate(lines)
    return -y, np.searchsorted(np.cumsum([*thicknesses, np.inf]), (y[1:] + y[:-1]) / 2)


def growing(start: float, end: float, growth: float) -> Array:
    """Return places beyond start up to end, each at most ``growth`` times as far as the previous one."""
    count = int(np.ceil(np.log(end / start) / np.log(growth) - 1e-9))
    return np.append(start * (end / start) ** (np.arange(1, count) / count), end)


def assemble(x: Array, y: Array, layer: Index, edges: list[int]) -> Quadrilaterals:
    """Mesh rectangles between lines x, (n,), and y, (m,), with rings about the columns ``edges``; layer: (m - 1,)."""
    numbering = np.arange(len(x) * len(y)).reshape(len(x), len(y))
    vertices, origin, corners, layers = [], [], [], []

    def add(ids: list[int], centre: tuple[float, float], offsets: Array, material: int) -> None:
        vertices.append(ids)
        origin.append(centre)
        corners.append(offsets)
        layers.append(material)

    for i in range(len(x) - 1):
        for j in range(len(y) - 1):
            if j == 0 and any(edge - 2 <= i < edge + 2 for edge in edges):
                continue
            ids = [numbering[i, j + 1], numbering[i + 1, j + 1], numbering[i + 1, j], numbering[i, j]]
            wide, deep = x[i + 1] - x[i], y[j] - y[j + 1]
            add(ids, (x[i], y[j]), np.array([[0, -deep], [wide, -deep], [wide, 0], [0, 0]]), layer[j])
    count = numbering.size
    for edge in edges:
        centre = (x[edge], 0.0)
        columns = slice(edge - 2, edge + 3)
        rim = np.column_stack([x[columns] - x[edge], np.full(5, y[1])])
        rim = np.concatenate([[[rim[0, 0], 0]], rim, [[rim[-1, 0], 0]]])
        outer = [numbering[edge - 2, 0], *numbering[columns, 1], numbering[edge + 2, 0]]
        for ring in range(_RINGS):
            inner = list(range(count, count + 7))
            count += 7
            big, small = rim * _RING**ring, rim * _RING ** (ring + 1)
            for k in range(6):
                ids = [outer[k], outer[k + 1], inner[k + 1], inner[k]]
                add(ids, centre, np.stack([big[k], big[k + 1], small[k + 1], small[k]]), layer[0])
            outer = inner
        top = [outer[0], count, count + 1, count + 2, outer[6]]
        count += 3
        for k in range(4):
            left, right = small[k + 1], small[k + 2]
            offsets = np.stack([left, right, right * [1, 0], left * [1, 0]])
            add([outer[k + 1], outer[k + 2], top[k + 1], top[k]], centre, offsets, layer[0])
    numbers = np.unique(np.array(vertices), return_inverse=True)[1]
    return Quadrilaterals(numbers.reshape(-1, 4), np.array(origin), np.stack(corners), np.array(layers))
