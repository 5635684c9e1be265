"""Air outside a contact, on finite elements: response of the bodies without air and to charges; the surface's nodes."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array

from verification.oracles.spectral import ELECTRIC, MAGNETIC, Body, Index, factorised, lagrange
from verification.oracles.surface_response import STIFFNESS, UNITS, Array

_STEPS = 60  # of gaps and potentials in turn, at most
_SMALL = 1e-6  # over the largest of the weights of the states: counts as nothing
_LEAST = 1e-9  # gap over the length of an element below which the potential is as good as the punch's
VACUUM = {ELECTRIC: 8.8541878128e-12, MAGNETIC: 4e-7 * np.pi}


@dataclass(frozen=True, eq=False)
class Dry:
    """Response of the bodies without air, and to unit charges on the exterior surface."""

    prescribed: Array  # shape (unknowns, states); u of the states without air
    exterior: Index  # unknowns: potentials of the exterior surface
    contact: Index  # all four unknowns of the contact's nodes
    heights: Index  # u_y of the exterior surface
    prescribed_loads: Array  # loads of the contact in the states
    flexibility: Array  # potentials on `exterior` of unit charges there
    lift: Array  # their u_y on `heights`
    pressed: Array  # their loads on `contact`

    @classmethod
    def of(
        cls, stiffness: "csr_array[np.float64]", rows: "csr_array[np.float64]", columns: "csr_array[np.float64]",
        free: NDArray[np.bool_], u: Array, exterior: Index, below: Index, heights: Index,
    ) -> "Dry":  # fmt: skip
        """Solve the assembled, joined bodies; u, (unknowns, states), is prescribed where not free, and filled in.

        exterior, heights: as the fields; below: nodes of the contact.
        """
        contact = (4 * below[:, None] + np.arange(4)).ravel()
        matrix = (rows @ stiffness @ columns)[free]
        factors = factorised(matrix[:, free])
        u[free] = -factors.solve(np.asarray(matrix @ u))
        loads = np.asarray(columns @ u)
        place = np.cumsum(free) - 1
        contact_stiffness = stiffness[contact]
        flexibility, lift, pressed = (np.empty((len(dofs), len(exterior))) for dofs in (exterior, heights, contact))
        for start in range(0, len(exterior), 64):
            block, driven = slice(start, start + 64), place[exterior[start : start + 64]]
            unit, moved = np.zeros((int(free.sum()), len(driven))), np.zeros((len(free), len(driven)))
            unit[driven, np.arange(len(driven))] = 1.0
            moved[free] = factors.solve(unit)
            moved = np.asarray(columns @ moved)
            flexibility[:, block], lift[:, block] = moved[exterior], moved[heights]
            pressed[:, block] = np.asarray(contact_stiffness @ moved)
        return cls(loads, exterior, contact, heights, contact_stiffness @ loads, flexibility, lift, pressed)

    def charged(self, air: "csr_array[np.float64]", pushed: Array) -> tuple[Array, Array]:
        """Scaled u, right-hand side and nodal loads where air is a spring on potentials; (unknown, state)."""
        contact_potentials = self.prescribed.copy()
        contact_potentials[self.exterior] = 0.0
        drive = (air @ contact_potentials - pushed)[self.exterior]
        inner = air[self.exterior][:, self.exterior].toarray()
        matrix = np.eye(len(inner)) - self.flexibility @ inner
        potentials = np.linalg.solve(matrix, self.prescribed[self.exterior] + self.flexibility @ drive)
        charges = inner @ potentials + drive
        u, loads = self.prescribed.copy(), np.zeros_like(self.prescribed)
        u[self.exterior] = potentials
        u[self.heights] += self.lift @ charges
        loads[self.exterior] = charges
        loads[self.contact] = self.prescribed_loads + self.pressed @ charges
        return u, loads


def settled(
    charged: Callable[[Array], tuple[Array, Array]],
    weighed: Callable[[Array], Array],
    opened: Callable[[Array, Array], Array],
    gap: Array,
    close: float,
) -> tuple[Array, Array, Array, Array]:
    """Return scaled u, nodal loads (node, 4), weights of the states, and gaps; an infinite gap has no air.

    charged: u and loads of the states at a gap; weighed: weights from loads; opened: gap from u and weights; close:
    largest relative change of the weights in the last step.
    """
    last = np.zeros(1)
    for _ in range(_STEPS):
        states, loads = charged(gap)
        weights = weighed(loads)
        u, size = states @ weights, np.abs(weights)
        change = np.max(np.abs(weights - last) / np.maximum(size, _SMALL * size.max()))
        if np.all(np.isinf(gap)) or change < close:
            return u, loads @ weights, weights, gap
        gap, last = opened(u, weights), weights
    raise ArithmeticError(f"the punch's place and potentials still change by {change:.1e} after {_STEPS} steps")


@dataclass(frozen=True, eq=False)
class Gap:
    """The exterior surface, by elements' sides and Gauss points on them."""

    body: Body
    points: int  # number of points of a side

    @cached_property
    def nodes(self) -> Index:
        """Nodes by rising x; (side, order + 1)."""
        return sides(self.body)

    @cached_property
    def shapes(self) -> Array:
        """Shape functions of the nodes at the points; (point, node)."""
        return lagrange(self.body.line, np.polynomial.legendre.leggauss(self.points)[0])[0]

    @cached_property
    def rule(self) -> tuple[Array, Array]:
        """x and weights; (side, point)."""
        points, weights = np.polynomial.legendre.leggauss(self.points)
        ends = self.body.places[self.nodes][:, [0, -1], 0]
        half = (ends[:, 1] - ends[:, 0])[:, None] / 2
        return ends.mean(axis=1)[:, None] + half * points, half * weights

    def at(self, values: Array) -> Array:
        """Values of nodes at the points; (side, point)."""
        return np.asarray(values[self.nodes] @ self.shapes.T)

    def spring(self, potential: int, medium: float | Array, gap: Array, size: int) -> "csr_array[np.float64]":
        """Scaled charges per potential, int medium/gap N N over unknowns; (size, size)."""
        weights, scale = self.rule[1], UNITS[potential] ** 2 / STIFFNESS
        strength = medium * weights / np.maximum(gap, _LEAST * weights.sum(axis=1, keepdims=True))
        blocks = scale * np.einsum("sp,pi,pj->sij", strength, self.shapes, self.shapes)
        dofs = 4 * self.nodes + potential
        rows, columns = np.broadcast_arrays(dofs[:, :, None], dofs[:, None, :])
        return csr_array(coo_array((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=(size, size)))


def sides(body: Body) -> Index:
    """Nodes of elements' sides on y = 0 with |x| >= 1, by rising x."""
    p, nodes = body.order, body.nodes
    parts = []
    for side in range(4):
        inner = nodes[:, 4 + side * (p - 1) : 4 + (side + 1) * (p - 1)]
        whole = np.concatenate([nodes[:, [side]], inner, nodes[:, [(side + 1) % 4]]], axis=1)
        x, y = np.moveaxis(body.places[whole], -1, 0)
        parts.append(whole[np.all(y == 0, axis=1) & np.all(np.abs(x) >= 1, axis=1)])
    sorted_nodes = np.concatenate(parts)
    order = np.argsort(body.places[sorted_nodes, 0], axis=1)
    return np.take_along_axis(sorted_nodes, order, axis=1)


def along(body: Body, values: Array, x: Array) -> Array:
    """Values between nodes of the surface, by the elements' polynomials."""
    node_rows = sides(body)
    ends = body.places[node_rows][:, [0, -1], 0]
    interpolated = np.empty_like(x)
    for nodes, (low, high) in zip(node_rows, ends, strict=True):
        within = (x >= low) & (x <= high)
        interpolated[within] = lagrange(body.line, (2 * x[within] - low - high) / (high - low))[0] @ values[nodes]
    outside = np.abs(x) > ends.max()
    interpolated[outside] = 0.0
    return interpolated
