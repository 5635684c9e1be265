"""Air beside a contact, on finite elements: what bodies answer without it and to charges; the surface's nodes."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.linalg import splu

from verification.oracles.fem_film import ELECTRIC, MAGNETIC
from verification.oracles.spectral import Body, Index
from verification.oracles.surface_response import Array

VACUUM = {ELECTRIC: 8.8541878128e-12, MAGNETIC: 4e-7 * np.pi}


@dataclass(frozen=True, eq=False)
class Dry:
    """What the bodies answer without air, and to charges on the surface beside the contact.

    Attributes
    ----------
    given : ndarray, shape (unknowns, states)
        u of the states without air.
    airy, touched, raised : ndarray of int
        Unknowns: potentials beside the contact, all four of the contact, u_y beside it.
    given_there, given_loads : ndarray
        Potentials beside the contact and loads of the contact in the states.
    flexibility, lift, pressed : ndarray
        What unit charges on ``airy`` make there, of ``raised`` and of the loads on ``touched``.
    """

    given: Array
    airy: Index
    touched: Index
    raised: Index
    given_there: Array
    given_loads: Array
    flexibility: Array
    lift: Array
    pressed: Array

    @classmethod
    def of(
        cls, stiffness: "csr_array[np.float64]", rows: "csr_array[np.float64]", columns: "csr_array[np.float64]",
        free: NDArray[np.bool_], u: Array, airy: Index, touched: Index, raised: Index,
    ) -> "Dry":  # fmt: skip
        """From the assembled bodies, their joints, what is free, and the given u of the states.

        Parameters
        ----------
        stiffness : csr_array, of the assembled bodies
        rows, columns : csr_array, their joints: what sums equations, and what spreads unknowns
        free : ndarray of bool, unknowns that are free
        u : ndarray, shape (unknowns, states), given where it is not free, filled in
        airy, touched, raised : ndarray of int, as of the class
        """
        matrix = (rows @ stiffness @ columns)[free]
        factors = splu(matrix[:, free].tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.001,
                       options={"SymmetricMode": True})  # fmt: skip
        u[free] = -factors.solve(np.asarray(matrix @ u))
        given = np.asarray(columns @ u)
        place = np.cumsum(free) - 1
        contact = stiffness[touched]
        flexibility, lift, pressed = (np.empty((len(dofs), len(airy))) for dofs in (airy, raised, touched))
        for some in np.array_split(np.arange(len(airy)), max(len(airy) // 64, 1)):
            unit = np.zeros((int(free.sum()), len(some)))
            unit[place[airy[some]], np.arange(len(some))] = 1.0
            moved = np.zeros((len(free), len(some)))
            moved[free] = factors.solve(unit)
            moved = np.asarray(columns @ moved)
            flexibility[:, some], lift[:, some] = moved[airy], moved[raised]
            pressed[:, some] = np.asarray(contact @ moved)
        return cls(given, airy, touched, raised, given[airy], contact @ given, flexibility, lift, pressed)


def contact(body: Body) -> Index:
    """Nodes of the contact, by rising x."""
    x, y = body.places.T
    nodes = np.flatnonzero((y == 0) & (np.abs(x) <= 1))
    return nodes[np.argsort(x[nodes])]


def sides(body: Body) -> Index:
    """Nodes of elements' sides on y = 0 with |x| >= 1, by rising x."""
    p, nodes = body.order, body.nodes
    found = []
    for side in range(4):
        inner = nodes[:, 4 + side * (p - 1) : 4 + (side + 1) * (p - 1)]
        whole = np.concatenate([nodes[:, [side]], inner, nodes[:, [(side + 1) % 4]]], axis=1)
        x, y = np.moveaxis(body.places[whole], -1, 0)
        found.append(whole[np.all(y == 0, axis=1) & np.all(np.abs(x) >= 1, axis=1)])
    every = np.concatenate(found)
    order = np.argsort(body.places[every, 0], axis=1)
    return np.take_along_axis(every, order, axis=1)


def along(body: Body, values: Array, x: Array) -> Array:
    """Values between nodes of the surface, by the elements' polynomials.

    Parameters
    ----------
    body
        Whose surface it is.
    values
        At its nodes; (node,).
    x
        Places beside the contact, in half-lengths; beyond the mesh the values are 0.
    """
    every = sides(body)
    ends = body.places[every][:, [0, -1], 0]
    line, found = lobatto(body.order), np.empty_like(x)
    for nodes, (low, high) in zip(every, ends, strict=True):
        here = (x >= low) & (x <= high)
        found[here] = lagrange(line, (2 * x[here] - low - high) / (high - low)) @ values[nodes]
    outside = np.abs(x) > ends.max()
    found[outside] = 0.0
    return found


def lobatto(order: int) -> Array:
    """Gauss-Lobatto-Legendre points."""
    inner = np.real(np.polynomial.Legendre.basis(order).deriv().roots())
    return np.concatenate([[-1.0], inner, [1.0]])


def lagrange(line: Array, x: Array) -> Array:
    """Values of the Lagrange polynomials on a line; (n, count).

    Parameters
    ----------
    line : ndarray, shape (count,), their points, within [-1, 1]
    x : ndarray, shape (n,), places
    """
    legendre = np.linalg.inv(np.polynomial.legendre.legvander(line, len(line) - 1))
    return np.asarray(np.polynomial.legendre.legvander(x, len(line) - 1) @ legendre)
