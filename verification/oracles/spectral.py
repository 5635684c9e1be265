"""Spectral elements in plane strain: quadrilaterals of any polynomial order, their inner nodes condensed.

Weak form: int S(G(v)) . G(u) = int t . v over the surface, with G = (eps_xx, eps_yy, 2 eps_xy, grad phi, grad psi) and
the fluxes S = (sigma_xx, sigma_yy, sigma_xy, D_x, D_y, B_x, B_y) = M G. The shapes are Lagrange polynomials on the
Gauss-Lobatto-Legendre points of a bilinear quadrilateral. A matrix depends on the shape of an element, not on its size,
so that rings of similar elements about a singular point, however many, cost as much as one ring.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.linalg import SuperLU, splu

from verification.oracles.surface_response import ALONG, DOWN, STIFFNESS, UNITS, Array, constitutive_matrix

Index = NDArray[np.int64]
ELECTRIC, MAGNETIC = 2, 3  # numbers of the potentials in u = (u_x, u_y, phi, psi)
#: N/m, N/m, C/m, Wb/m of a scaled nodal load.
FORCES = STIFFNESS / UNITS
FIELDS = (
    "stress_xx",
    "stress_yy",
    "stress_xy",
    "electric_displacement_x",
    "electric_displacement_y",
    "magnetic_induction_x",
    "magnetic_induction_y",
)
_SIGNS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])  # corners in the reference square, in their order
_CLOSE = 1e-9  # to an element, in its own size
_PLACE_STEPS = 9  # of Newton's method at most: one finds a place in a rectangle


@dataclass(frozen=True, eq=False)
class Quadrilaterals:
    """A mesh of quadrilaterals."""

    vertices: Index  # shape (elements, 4); numbers of the corners, anticlockwise from 0 without gaps
    origin: Array  # shape (elements, 2)
    corners: Array  # shape (elements, 4, 2); relative to the origin, so that small elements near a point keep digits
    layer: Index  # shape (elements,); number of the material


@dataclass(frozen=True, eq=False)
class Body:
    """Elements filled with materials."""

    mesh: Quadrilaterals
    materials: Sequence[Mapping[str, float]]  # By the mesh's layers, constants as for ``surface_response``
    order: int  # Of the polynomials

    @cached_property
    def line(self) -> Array:
        """Gauss-Lobatto-Legendre points."""
        inner = np.polynomial.Legendre.basis(self.order).deriv().roots()
        return np.concatenate([[-1.0], np.real(inner), [1.0]])

    @cached_property
    def _places(self) -> tuple[Index, Index]:
        """Local numbers of the nodes on the border (corners, then sides in their direction), and of the inner ones."""
        p = self.order
        grid = np.arange((p + 1) ** 2).reshape(p + 1, p + 1)
        sides = [grid[1:-1, 0], grid[-1, 1:-1], grid[-2:0:-1, -1], grid[0, -2:0:-1]]
        return np.concatenate([[grid[0, 0], grid[-1, 0], grid[-1, -1], grid[0, -1]], *sides]), grid[1:-1, 1:-1].ravel()

    @cached_property
    def nodes(self) -> Index:
        """Numbers of the border's nodes of every element, as ``_places`` lists them; shape (elements, 4 order)."""
        corners = self.mesh.vertices
        ends = np.stack([corners, np.roll(corners, -1, axis=1)], axis=-1)
        _, side = np.unique(np.sort(ends, axis=-1).reshape(-1, 2), axis=0, return_inverse=True)
        step = np.arange(self.order - 1)
        along = np.where((ends[..., :1] < ends[..., 1:]), step, step[::-1])
        inner = corners.max() + 1 + side.reshape(corners.shape)[..., None] * (self.order - 1) + along
        return np.concatenate([corners, inner.reshape(len(corners), -1)], axis=1)

    @cached_property
    def places(self) -> Array:
        """Coordinates of the nodes of the borders, shape (nodes, 2)."""
        border = self._places[0]
        grid = np.stack(np.meshgrid(self.line, self.line, indexing="ij"), axis=-1).reshape(-1, 2)[border]
        places = np.empty((self.nodes.max() + 1, 2))
        places[self.nodes] = self.mesh.origin[:, None] + np.einsum("na,eai->eni", bilinear(grid), self.mesh.corners)
        return places

    @cached_property
    def _shapes(self) -> tuple[Index, Index]:
        """One element of each shape and material, and the number among them of every element's."""
        corners = self.mesh.corners - self.mesh.corners[:, :1]
        size = np.abs(corners).max(axis=(1, 2))[:, None, None]
        key = np.column_stack([self.mesh.layer, np.round(corners / size, 10).reshape(len(corners), -1)])
        _, first, shape_index = np.unique(key, axis=0, return_index=True, return_inverse=True)
        return first, shape_index.ravel()

    def _gradients(self, element: int, local: Array) -> tuple[Array, Array]:
        """Derivatives of the shapes by x and y at places (n, 2) of the reference square, and the Jacobian."""
        values, slopes = zip(*(lagrange(self.line, local[:, i]) for i in (0, 1)), strict=True)
        by_first = (slopes[0][:, :, None] * values[1][:, None, :]).reshape(len(local), -1)
        by_second = (values[0][:, :, None] * slopes[1][:, None, :]).reshape(len(local), -1)
        corners = self.mesh.corners[element]
        (x1, y1), (x2, y2) = (np.einsum("na,ai->in", s, corners) for s in _bilinear_slopes(local))
        jacobian = x1 * y2 - x2 * y1
        gradient = np.stack([y2[:, None] * by_first - y1[:, None] * by_second,
                             x1[:, None] * by_second - x2[:, None] * by_first]) / jacobian[:, None]  # fmt: skip
        return gradient, jacobian

    def _stiffness(self, element: int) -> Array:
        """Scaled matrix over node and field, shape (4 (order + 1)^2,) * 2."""
        points, weights = np.polynomial.legendre.leggauss(self.order + 2)
        local = np.stack(np.meshgrid(points, points, indexing="ij"), axis=-1).reshape(-1, 2)
        parts, measure = self._parts(element, local)
        weight = (np.outer(weights, weights).ravel() * measure)[:, None]
        moduli = self._moduli(self.materials[self.mesh.layer[element]]) * UNITS[:, None] * UNITS / STIFFNESS
        n = parts.shape[2]
        total = np.zeros((n, 4, n, 4))
        for row, column in np.ndindex(moduli.shape[:2]):
            if np.any(moduli[row, column]):
                total += (parts[row].T @ (weight * parts[column]))[:, None, :, None] * moduli[row, column][:, None, :]
        return total.reshape(4 * n, 4 * n)

    def _parts(self, element: int, local: Array) -> tuple[Array, Array]:
        """Return the parts of the strain by shape, (part, place, node), and the measure of an element's area."""
        return self._gradients(element, local)

    def _moduli(self, material: Mapping[str, float]) -> Array:
        """Stiffness in (d/dx, d/dy) of (u_x, u_y, phi, psi); shape (2, 2, 4, 4)."""
        strains = np.stack([ALONG, DOWN])
        return np.asarray(np.einsum("iaj,ab,kbl->ikjl", strains, constitutive_matrix(material), strains))

    def _split(self, element: int) -> tuple[Array, Array]:
        """Return the condensed matrix of the border, and the response of the inner nodes to the border's."""
        matrix = self._stiffness(element)
        border, inner = (_dofs(places) for places in self._places)
        answer = np.asarray(-np.linalg.solve(matrix[np.ix_(inner, inner)], matrix[np.ix_(inner, border)]), dtype=float)
        return matrix[np.ix_(border, border)] + matrix[np.ix_(border, inner)] @ answer, answer

    @cached_property
    def _inside(self) -> Callable[[int], Array]:
        """Return the response of the inner nodes of a shape, by its number; cached, as points come in lines."""
        return lru_cache(maxsize=128)(lambda shape: self._split(int(self._shapes[0][shape]))[1])

    def matrix(self) -> "csr_array[np.float64]":
        """Scaled stiffness over node and field of the borders, assembled anew."""
        first, shape_index = self._shapes
        dofs = _dofs(self.nodes).astype(np.int32)  # half the memory
        shape = (*dofs.shape, dofs.shape[1])
        rows, columns = np.broadcast_to(dofs[:, :, None], shape), np.broadcast_to(dofs[:, None, :], shape)
        entries = np.stack([self._split(element)[0] for element in first])[shape_index]
        size = 4 * len(self.places)
        return csr_array((entries.ravel(), (rows.ravel(), columns.ravel())), shape=(size, size))

    def fluxes(self, u: Array, points: Array, layer: int) -> Array:
        """The fluxes ``FIELDS`` times the unit of length, (7, point), at points of a layer by u, (node, 4)."""
        out = np.empty((7, len(points)))
        M, (border, inner) = constitutive_matrix(self.materials[layer]), self._places
        elements, local = zip(*(self._find(point, layer) for point in points), strict=True)
        for element in set(elements):
            chosen = np.flatnonzero(np.array(elements) == element)
            full = np.empty((len(border) + len(inner), 4))
            full[border] = u[self.nodes[element]] / UNITS
            full[inner] = (self._inside(int(self._shapes[1][element])) @ full[border].ravel()).reshape(-1, 4)
            along, down = self._gradients(element, np.stack(local)[chosen])[0] @ (full * UNITS)
            out[:, chosen] = M @ (ALONG @ along.T + DOWN @ down.T)
        return out

    def _find(self, point: Array, layer: int) -> tuple[int, Array]:
        """Return the element of a layer that contains the point, and its place there."""
        mesh = self.mesh
        low, high = (mesh.origin + end for end in (mesh.corners.min(axis=1), mesh.corners.max(axis=1)))
        slack = _CLOSE * (high - low)
        around = np.all((low - slack <= point) & (point <= high + slack), axis=1) & (mesh.layer == layer)
        for element in np.flatnonzero(around):
            local, corners = np.zeros((1, 2)), mesh.corners[element]
            for _ in range(_PLACE_STEPS):
                miss = bilinear(local)[0] @ corners + mesh.origin[element] - point
                by = np.stack([slopes[0] @ corners for slopes in _bilinear_slopes(local)], axis=1)
                step = np.linalg.solve(by, miss)
                local = local - step
                if np.all(np.abs(step) < _CLOSE**2):
                    break
            if np.all(np.abs(local) <= 1 + _CLOSE):
                return int(element), local[0]
        raise ValueError(f"no element of layer {layer} holds {point}")


def factorised(matrix: "csr_array[np.float64]") -> "SuperLU[np.float64]":
    """LU factors of a stiffness whose structure is symmetric."""
    options = {"SymmetricMode": True}
    return splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.001, options=options)


def _dofs(nodes: Index) -> Index:
    """Numbers of the unknowns of nodes (..., n), four each."""
    return (4 * nodes[..., None] + np.arange(4)).reshape(*nodes.shape[:-1], -1)


def bilinear(local: Array) -> Array:
    """Weights of the corners at places (n, 2)."""
    return np.asarray((1 + _SIGNS[:, 0] * local[:, :1]) * (1 + _SIGNS[:, 1] * local[:, 1:]) / 4)


def _bilinear_slopes(local: Array) -> tuple[Array, Array]:
    return (
        _SIGNS[:, 0] * (1 + _SIGNS[:, 1] * local[:, 1:]) / 4,
        (1 + _SIGNS[:, 0] * local[:, :1]) * _SIGNS[:, 1] / 4,
    )


def lagrange(line: Array, x: Array) -> tuple[Array, Array]:
    """Values and slopes at places x, (n,), of Lagrange's polynomials on points of a line, (count,); (n, count) each."""
    n = len(line)
    legendre = np.linalg.inv(np.polynomial.legendre.legvander(line, n - 1))
    slopes = np.polynomial.legendre.legder(np.eye(n)) @ legendre
    values = np.polynomial.legendre.legvander(x, n - 1)
    return np.asarray(values @ legendre), np.asarray(values[:, :-1] @ slopes)
