"""A rigid sphere pressed on layers with air beside the contact, by axisymmetric spectral finite elements.

Written from the equations: the weak form of (1a)-(1c) about an axis, hoop stretch u_r/r, and in the gap
D_y (1 + r^2/end^2) = -eps0 (V - phi)/g. The air is a spring on the potentials of the exterior surface; gaps and
potentials are iterated in turn. The contact radius is given, its edge has no singular pressure, and the force follows.
Lengths of the mesh are in contact radii.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csr_array, eye_array

from verification.oracles.fem_film import Layer, clamped, contact
from verification.oracles.film_mesh import FAR, assemble, depths, growing
from verification.oracles.gap_response import VACUUM, Dry, Gap, settled
from verification.oracles.spectral import ELECTRIC, FORCES, Body, Index, Quadrilaterals, bilinear, lagrange
from verification.oracles.surface_response import ALONG, DOWN, UNITS, Array, constitutive_matrix

_GROWTH, _SIZE = 2.5, 0.25  # of elements: far away, and beside the edge


@dataclass(frozen=True, eq=False)
class Revolved(Body):
    """Elements of revolution about x = 0, filled with materials whose c12 counts."""

    @cached_property
    def _shapes(self) -> tuple[Index, Index]:
        elements = np.arange(len(self.mesh.vertices))
        return elements, elements

    def _parts(self, element: int, local: Array) -> tuple[Array, Array]:
        """d/dr, d/dy and 1/r of the shapes, and the area per radian."""
        gradient, jacobian = self._gradients(element, local)
        first, second = (lagrange(self.line, local[:, axis])[0] for axis in (0, 1))
        values = (first[:, :, None] * second[:, None, :]).reshape(1, len(local), -1)
        r = self.mesh.origin[element][0] + bilinear(local) @ self.mesh.corners[element][:, 0]
        return np.concatenate([gradient, values / r[:, None]]), jacobian * r

    def _moduli(self, material: Mapping[str, float]) -> Array:
        """Stiffness in (d/dr, d/dy, 1/r) of (u_r, u_y, phi, psi); shape (3, 3, 4, 4)."""
        m = material
        stiffness, strains = np.zeros((8, 8)), np.zeros((3, 8, 4))  # the last strain is the hoop's
        stiffness[:7, :7] = constitutive_matrix(m)
        stiffness[7] = stiffness[:, 7] = m["c12"], m["c13"], 0, 0, m["e31"], 0, m["f31"], m["c11"]
        strains[0, :7], strains[1, :7], strains[2, 7, 0] = ALONG, DOWN, 1.0
        return np.asarray(np.einsum("iaj,ab,kbl->ikjl", strains, stiffness, strains))


def _mesh(thicknesses: Sequence[float], rigid: bool) -> Quadrilaterals:
    """Mesh of layers from the top down, and of a half-space below them unless the base is rigid."""
    size = _SIZE * min(1.0, thicknesses[0])
    count = int(np.ceil((1 - size) / (2 * size)))
    r = np.concatenate([
        np.linspace(0, 1 - size, count + 1), 1 + np.array([-0.3, 0, 0.3, 1]) * size, 1 + growing(size, FAR, _GROWTH)
    ])  # fmt: skip
    return assemble(r, *depths(thicknesses, rigid, size, _GROWTH), [int(np.flatnonzero(r == 1)[0])])


@dataclass(frozen=True, eq=False)
class PointContact:
    """The contact of a given radius under a rigid sphere."""

    layers: Sequence[Layer]  # From the top down; constants with c12
    base: Mapping[str, float] | None  # Constants of the half-space below them; None: rigid
    sphere: float  # Radius of the punch [m], at which its gap ends
    radius: float  # Of the contact [m]
    charge: float = 0.0  # T [C]
    air: bool = True  # In the gap; False: D_y = 0 beside the contact
    order: int = 8  # Of the polynomials of an element

    @cached_property
    def body(self) -> Revolved:
        """The meshed layers and base."""
        mesh = _mesh([layer.thickness / self.radius for layer in self.layers], self.base is None)
        materials = [layer.material for layer in self.layers]
        return Revolved(mesh, materials if self.base is None else [*materials, self.base], self.order)

    @cached_property
    def _below(self) -> Index:
        return contact(self.body)

    @cached_property
    def _exterior(self) -> Gap:
        """The surface beside the contact."""
        return Gap(self.body, self.order + 8)

    @cached_property
    def _dry(self) -> Dry:
        below, r = self._below, self.body.places[:, 0]
        held = clamped(self.body, self.layers, self.radius, rigid=self.base is None)
        held[:, 3] = True
        held[r == 0, 0] = True
        held[below, 1:3] = True
        u = np.zeros((4 * len(r), 3))
        u[4 * below + 1, :2] = r[below, None] ** [0, 2]
        u[4 * below + ELECTRIC, 2] = 1.0
        nodes = self._exterior.nodes
        potentials, heights = 4 * np.setdiff1d(nodes, below) + ELECTRIC, 4 * np.unique(nodes) + 1
        identity = csr_array(eye_array(u.shape[0]))
        return Dry.of(self.body.matrix(), identity, identity, ~held.ravel(), u, potentials, below, heights)

    def _charged(self, gap: Array) -> tuple[Array, Array]:
        """Scaled u and nodal loads of the states u_y = 1, r^2 and phi = 1 under the punch; (node, 4, state) each."""
        r, pushed = self._exterior.rule[0], np.zeros_like(self._dry.prescribed)
        medium = VACUUM[ELECTRIC] * r / (1 + (r * self.radius / self.sphere) ** 2)
        spring = self._exterior.spring(ELECTRIC, medium, gap, len(pushed))
        pushed[:, 2] = spring.sum(axis=1)
        u, loads = self._dry.charged(spring, pushed)
        return u.reshape(-1, 4, 3), loads.reshape(-1, 4, 3)

    def _strength(self, forces: Array) -> Array:
        """Return the strength of the singular pressure at the edge, from nodal forces (nodes, states)."""
        r = self.body.places[self._below, 0]
        orders = 2 * np.arange(self.order + 4)
        at_edge = np.polynomial.legendre.legvander(np.zeros(1), orders[-1])[0, ::2]
        tests = np.polynomial.legendre.legvander(np.sqrt((1 - r) * (1 + r)), orders[-1])[:, ::2]
        return np.asarray(((2 * orders + 1) * at_edge) @ (tests.T @ forces))

    @cached_property
    def _solved(self) -> tuple[Array, Array, Array, Array]:
        """Scaled u, nodal loads, weights of the states, gaps over a (side, point)."""
        r, curved = self._exterior.rule[0], self.radius**2 / (2 * self.sphere)
        gap = (r**2 - 1) ** 1.5 / r * curved / self.radius if self.air else np.full_like(r, np.inf)

        def weighed(loads: Array) -> Array:
            rows = np.array([self._strength(loads[self._below, 1]), -loads[:, ELECTRIC].sum(axis=0)])
            right = np.array([0.0, self.charge / self._per_load(ELECTRIC)]) - rows[:, 1] * curved
            return np.insert(np.linalg.solve(rows[:, [0, 2]], right), 1, curved)

        def opened(u: Array, weights: Array) -> Array:
            return np.asarray((weights[0] + curved * r**2 - self._exterior.at(u[:, 1])) / self.radius)

        return settled(self._charged, weighed, opened, gap, 1e-8)

    def _per_load(self, field: int) -> float:
        """SI per scaled nodal load, over the whole circle."""
        return float(2 * np.pi * FORCES[field] * self.radius)

    # -- outputs -------------------------------------------------------------------------------------------------------
    @property
    def force(self) -> float:
        """P [N]."""
        return float(-self._solved[1][self._below, 1].sum() * self._per_load(1))

    @property
    def depth(self) -> float:
        """[m]."""
        return float(-self._solved[2][0])

    @property
    def voltage(self) -> float:
        """V [V]."""
        return float(self._solved[2][2] * UNITS[ELECTRIC])

    def exterior(self, which: int) -> tuple[Array, Array]:
        """r/a of nodes beside the contact, and phi [V] (``ELECTRIC``); (node,) each."""
        nodes = np.setdiff1d(self._exterior.nodes, self._below)
        return self.body.places[nodes, 0], self._solved[0].reshape(-1, 4)[nodes, which] * UNITS[which]
