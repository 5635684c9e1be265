"""The contact itself by finite elements: a rigid conducting punch without friction, unilateral, its extent unknown.

The nodes below the punch answer to nodal forces, charges and fluxes with a flexibility matrix. Active set: a node
touches while it is pressed, and then has the punch's height and potentials; it is free while the punch is above it. The
nodes stand no closer than a hundredth or so of the contact, until the elements are concentrated about the ends found.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from verification.oracles.fem import FAR, Body, elliptic_mesh
from verification.oracles.surface_response import Array

_ROUNDS = 50
_MARGIN = 1.05  # of the surface with nodes over the contact found
DATUM = 1e3  # distance of the datum, in units of the mesh
_UNITS = np.array([1e5, 1e-5, 1e-3])  # N/m, C/m, Wb/m: make energies of loads comparable


@dataclass(frozen=True, eq=False)
class Found:
    """A contact found."""

    # shape (n,); Nodes that touch [m] and the pressure there [Pa]
    x: Array
    pressure: Array
    half_width: float  # Where the pressure vanishes [m]
    # Relative to the surface at the distance ``datum`` on both sides [m, V, A]
    depth: float
    voltage: float
    magnetic_potential: float
    datum: float  # [m]


def solve(material: Mapping[str, float], radius: float, totals: Array, cells: int, start: float) -> Found:
    """Contact of a cylinder.

    totals: (3,), P, T, J [N/m, C/m, Wb/m].
    """
    coarse = _solve(material, radius, totals, cells // 2, start)
    return _solve(material, radius, totals, cells, _MARGIN * coarse.half_width)


def _solve(material: Mapping[str, float], radius: float, totals: Array, cells: int, length: float) -> Found:
    mesh = elliptic_mesh(np.linspace(0, np.pi, cells + 1), np.arccosh(FAR) * np.linspace(0, 1, cells + 1) ** 2)
    surface = np.flatnonzero(mesh.p[1] == 0)
    below = surface[np.abs(mesh.p[0, surface]) <= 1]
    below = below[np.argsort(mesh.p[0, below])]
    exterior = surface[np.argsort(np.abs(np.abs(mesh.p[0, surface]) - DATUM))[:2]]  # one on each side
    answers, far = _flexibility(Body(material, mesh, order=1), below, exterior)

    x = length * mesh.p[0, below]
    height = x**2 / (2 * radius)
    touching = np.abs(x) < length / 2
    for _ in range(_ROUNDS):
        loads, rigid = _held(answers, touching, height, totals)
        penetrates = np.einsum("ajb,jb->a", answers[0], loads) > height - rigid[0]
        settled, touching = touching, np.where(touching, loads[0] < 0, penetrates)
        if np.array_equal(settled, touching):
            break
    else:
        raise ArithmeticError("the set of touching nodes does not settle")

    pressure = -loads[0, touching] / np.gradient(x)[touching]
    far_values = np.einsum("ijb,jb->i", far, loads)
    return Found(
        x=x[touching],
        pressure=pressure,
        half_width=_end(x[touching], pressure),
        depth=rigid[0] + far_values[0],
        voltage=-rigid[1] - far_values[1],
        magnetic_potential=-rigid[2] - far_values[2],
        datum=float(length * np.abs(mesh.p[0, exterior[0]])),
    )


def _flexibility(body: Body, below: NDArray[np.int64], exterior: NDArray[np.int64]) -> tuple[Array, Array]:
    """(u_y, phi, psi) of the nodes below, mean of those beside, by kind and node loaded: (3, n, 3, n), (3, 3, n)."""
    n = len(below)
    answers, far = np.empty((3, n, 3, n)), np.empty((3, 3, n))
    for kind in range(3):
        load = np.zeros((4, body.basis.N, n))
        load[1 + kind, body.basis.nodal_dofs[0, below], np.arange(n)] = 1.0
        u = body.solve(load)[1:]
        answers[:, :, kind], far[:, kind] = u[:, below], u[:, exterior].mean(axis=1)
    return answers, far


def _held(answers: Array, touching: Array, height: Array, totals: Array) -> tuple[Array, Array]:
    """Nodal loads (3, n) and (depth, -voltage, -magnetic potential) of the punch that holds the touching nodes."""
    n = int(touching.sum())
    block = answers[:, touching][:, :, :, touching].reshape(3 * n, 3 * n)
    rigid = np.kron(np.eye(3), np.ones((n, 1)))
    matrix = np.block([[block, rigid], [rigid.T, np.zeros((3, 3))]])
    scale = np.append(np.repeat(_UNITS, n), 1 / _UNITS)
    right = np.concatenate([height[touching], np.zeros(2 * n), -totals])
    solution = scale * np.linalg.solve(scale[:, None] * matrix * scale, scale * right)
    loads = np.zeros((3, len(touching)))
    loads[:, touching] = solution[:-3].reshape(3, n)
    return loads, solution[-3:]


def _end(x: Array, pressure: Array) -> float:
    """Half the distance of the zeros of p^2, which is smooth at an edge that the surface leaves smoothly."""
    inner = np.abs(x - x.mean()) < 0.95 * np.ptp(x) / 2
    return float(np.abs(np.subtract(*np.polynomial.Polynomial.fit(x[inner], pressure[inner] ** 2, 2).roots()))) / 2
