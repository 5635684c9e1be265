"""Finite elements for the half-plane (scikit-fem): equations (1)-(3) of the paper as they stand.

Weak form: int S(G(v)) . G(u) = int t . v over the surface, with G = (eps_xx, eps_yy, 2 eps_xy, grad phi, grad psi) and
the fluxes S = (sigma_xx, sigma_yy, sigma_xy, D_x, D_y, B_x, B_y) = M G. Triangles on confocal ellipses: the foci may be
the edges of the contact, where the elements shrink with the distance from the edge, and the rings grow geometrically,
so that the clamped outer ellipse lies a million half-widths away and disturbs the gradients by a millionth.

Coordinates of a mesh are in units of a length, mostly the half-width of the contact: X = (x - c)/h.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import kron
from scipy.sparse.linalg import SuperLU, splu
from skfem import Basis, BilinearForm, ElementTriP1, ElementTriP2, ElementTriP4, FacetBasis, LinearForm, MeshTri

from verification.oracles.surface_response import STIFFNESS, UNITS, Array

FIELDS = (
    "stress_xx",
    "stress_yy",
    "stress_xy",
    "electric_displacement_x",
    "electric_displacement_y",
    "magnetic_induction_x",
    "magnetic_induction_y",
)
FAR = 1e6  # distance of the clamped ellipse
# G = ALONG u,x + DOWN u,y with u = (u_x, u_y, phi, psi): equations (2)
ALONG = np.zeros((7, 4))
ALONG[[0, 2, 3, 5], [0, 1, 2, 3]] = 1.0
DOWN = np.zeros((7, 4))
DOWN[[2, 1, 4, 6], [0, 1, 2, 3]] = 1.0
_ELEMENTS = {1: ElementTriP1, 2: ElementTriP2, 4: ElementTriP4}
_GAUSS = np.polynomial.legendre.leggauss(16)


def constitutive_matrix(material: Mapping[str, float]) -> Array:
    """M of the fluxes, equations (1a)-(1c); shape (7, 7), SI units."""
    m = material
    M = np.zeros((7, 7))
    M[:3, :3] = [[m["c11"], m["c13"], 0], [m["c13"], m["c33"], 0], [0, 0, m["c44"]]]
    for row, (k31, k33, k15) in ((3, ("e31", "e33", "e15")), (5, ("f31", "f33", "f15"))):
        coupling = np.array([[0, 0, m[k15]], [m[k31], m[k33], 0]])
        M[row : row + 2, :3], M[:3, row : row + 2] = coupling, coupling.T
    M[3:5, 3:5] = -np.diag([m["eps11"], m["eps33"]])
    M[3:5, 5:], M[5:, 3:5] = (-np.diag([m["g11"], m["g33"]]),) * 2
    M[5:, 5:] = -np.diag([m["mu11"], m["mu33"]])
    return M


def elliptic_mesh(theta: Array, xi: Array) -> MeshTri:
    """Triangles between x + iy = cosh(xi - i theta).

    theta: (n,), from 0 to pi; xi: (m,), from 0.
    """
    wide, deep = np.meshgrid(theta, xi, indexing="ij")
    x, y = np.cosh(deep) * np.cos(wide), -np.sinh(deep) * np.sin(wide)
    y[[0, -1]] = 0.0  # sin(pi) is not zero in floating point
    numbers = np.arange(wide.size).reshape(wide.shape)
    corners = np.stack([numbers[:-1, :-1], numbers[1:, :-1], numbers[1:, 1:], numbers[:-1, 1:]]).reshape(4, -1)
    points = np.stack([x.ravel(), y.ravel()])
    middle = points.size // 2 + np.arange(corners.shape[1])
    points = np.concatenate([points, points[:, corners].mean(axis=1)], axis=1)
    # crossed: alike in both directions, and sound at a focus, where a square between the ellipses is a triangle
    triangles = np.concatenate([[corners[k], corners[k - 3], middle] for k in range(4)], axis=1)
    return MeshTri(points, triangles).with_boundaries(
        {"contact": lambda p: (p[1] == 0) & (np.abs(p[0]) < 1), "far": lambda p: p[1] < 0}
    )


def contact_mesh(cells: int) -> MeshTri:
    """Mesh with its foci at the edges of the contact, ``cells`` elements under it, fine towards the edges."""
    theta = np.pi * (1 - np.cos(np.pi * np.linspace(0, 1, cells + 1))) / 2
    return elliptic_mesh(theta, np.arccosh(FAR) * np.linspace(0, 1, 3 * cells // 2 + 1) ** 2)


@dataclass(frozen=True, eq=False)
class Body:
    """A meshed half-plane."""

    material: Mapping[str, float]  # Constants as for ``surface_response``
    mesh: MeshTri
    order: int = 4  # Of the polynomials of an element: 1, 2 or 4

    @cached_property
    def basis(self) -> Basis:
        """One scalar basis, for each of (u_x, u_y, phi, psi)."""
        return Basis(self.mesh, _ELEMENTS[self.order]())

    @cached_property
    def _free(self) -> NDArray[np.int64]:
        """Scalar degrees of freedom that are not clamped."""
        return np.setdiff1d(np.arange(self.basis.N), self.basis.get_dofs("far").all())

    @cached_property
    def _factors(self) -> "SuperLU[np.float64]":
        """LU factors of the scaled stiffness matrix without the clamped part."""

        def product(i: int, j: int) -> Any:  # scikit-fem has no types
            return BilinearForm(lambda u, v, w: v.grad[i] * u.grad[j]).assemble(self.basis)[self._free][:, self._free]

        M, sides = constitutive_matrix(self.material), (ALONG, DOWN)
        scale = UNITS[:, None] * UNITS / STIFFNESS
        parts: list[Any] = [
            kron(scale * (flux.T @ M @ strain), product(i, j), format="csc")
            for i, flux in enumerate(sides)
            for j, strain in enumerate(sides)
        ]
        return splu(
            parts[0] + parts[1] + parts[2] + parts[3],
            permc_spec="MMD_AT_PLUS_A",
            options={"SymmetricMode": True},
            diag_pivot_thresh=0.01,
        )

    def solve(self, load: Array) -> Array:
        """u = (u_x, u_y, phi, psi) under nodal loads; both (4, degrees of freedom, ...), SI units."""
        units = UNITS.reshape(4, *(1,) * (load.ndim - 1))
        scaled = (units * load / STIFFNESS)[:, self._free]
        out = np.zeros_like(load)
        out[:, self._free] = units * self._factors.solve(scaled.reshape(-1, *load.shape[2:])).reshape(scaled.shape)
        return out

    def fluxes(self, u: Array, points: Array, length: float) -> dict[str, Array]:
        """``FIELDS`` at points within the body; SI units.

        u: (4, nodes), displacements and potentials; points: (2, n), X and Y over `length`.
        """
        cells = self.mesh.element_finder(mapping=self.basis.mapping)(*points)
        local = self.basis.mapping.invF(points[:, :, None], tind=cells)
        gradient = np.zeros((2, 4, points.shape[1]))
        for k in range(self.basis.Nbfun):
            shape = self.basis.elem.gbasis(self.basis.mapping, local, k, tind=cells)[0].grad[:, :, 0]
            gradient += shape[:, None, :] * u[:, self.basis.element_dofs[k, cells]]
        G = (ALONG @ gradient[0] + DOWN @ gradient[1]) / length
        return dict(zip(FIELDS, constitutive_matrix(self.material) @ G, strict=True))


def surface_angles(body: Body) -> Array:
    """Gauss angles theta, X = cos theta, of every edge of the contact; shape (edges, 16)."""
    low, high = np.arccos(_ends(body.mesh))[::-1]
    return np.asarray(((low + high) / 2)[:, None] + ((high - low) / 2)[:, None] * _GAUSS[0])


def surface_load(body: Body, regular: Array, half_width: float) -> Array:
    """Nodal loads (4, degrees of freedom) [N/m, C/m, Wb/m] of tractions on the contact, -1 < X < 1.

    A traction times sqrt(1 - X^2) is smooth over the angle: its moments over an edge are found there, and with them its
    projection on the polynomials of an element, which does the same work on the elements as the traction itself.

    regular: (4, edges, 16).
    """
    ends = _ends(body.mesh)
    facets = FacetBasis(body.mesh, body.basis.elem, facets=body.mesh.boundaries["contact"], intorder=2 * body.order)
    positions = _along(facets.global_coordinates()[0], ends)
    s = _along(np.cos(surface_angles(body)), ends)
    weight = _GAUSS[1] * (np.ptp(np.arccos(ends), axis=0) / np.ptp(ends, axis=0) / 2)[:, None]  # dX = sin(theta) dtheta
    out = np.zeros((4, body.basis.N))
    for i, samples in enumerate(regular):
        projection = np.zeros_like(positions)
        for k in range(body.order + 1):
            legendre = np.polynomial.Legendre.basis(k, domain=[0, 1])
            moment = np.sum(weight * samples * legendre(s), axis=1, keepdims=True)
            projection += (2 * k + 1) * moment * legendre(positions)
        out[i] = half_width * LinearForm(lambda v, w: w["traction"] * v).assemble(facets, traction=projection)
    return out


def _ends(mesh: MeshTri) -> Array:
    """X of both ends of every edge of the contact, ascending; shape (2, edges)."""
    return np.asarray(np.sort(mesh.p[0, mesh.facets[:, mesh.boundaries["contact"]]], axis=0))


def _along(X: Array, ends: Array) -> Array:
    """Place 0 to 1 of X (edges, n) on its edge."""
    return np.asarray((X - ends[0][:, None]) / np.ptp(ends, axis=0)[:, None])
