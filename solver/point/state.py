"""Contacts of revolution at known radii: from forces and charges to displacements and potentials, and the tangents.

A contact of the radius a has the loads ``a loads . (u0, g)`` and the edge strengths ``edges . (u0, g) / a``: columns of
u0 = (-depth, V, Psi) and of the profile g = (r/a)^exponent (points, 3). Near the edge a traction is its strength over
sqrt(1 - r^2/a^2). Displacements are over C a^e and loads over C a^(e+1), C r^e the profile (1 and e = 0 of a disc): the
half-space's are constants.

The edge of a contact between curved surfaces is smooth. This condition and the charges make three linear equations.
Moving the edge at fixed displacements releases energy (Irwin), d loads / d log a = pi^2 edges^T N strengths, so that
tangents need no derivative of a table.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array, BoolArray
from solver.point.profile import Shape


@dataclass(frozen=True, eq=False)
class Stiffness:
    """What contacts of given radii answer, in the units of their bodies."""

    # N of the contact over (y, phi, psi): that of the top and of the punch; (..., 3, 3). A field that the punch does
    # not conduct has no entries but its own on the diagonal, here and in all others.
    compliance: Array
    loads: Array  # int t over a; (..., 3, 4)
    edges: Array  # Strengths times a; (..., 3, 4)
    edge_rates: Array  # Their derivatives in log a; (..., 3, 4)


def conducted(compliance: Array, conducts: BoolArray) -> Array:
    """N without what couples fields that the punch does not conduct; (..., 3, 3)."""
    there = np.concatenate([np.ones_like(conducts[..., :1]), conducts], -1)
    both = (there[..., :, None] & there[..., None, :]) | np.eye(3, dtype=bool)
    return np.asarray(np.where(both, compliance, 0.0))


def halfspace(compliance: Array, shape: Shape) -> Stiffness:
    """Contacts on a half-space of N (..., 3, 3), whatever their radius.

    compliance: (..., 3, 3), N of the contact.
    """
    inverse = np.linalg.inv(compliance)
    loads = 4 * np.concatenate([inverse, shape.mean * inverse[..., :1]], -1)
    edges = 2 / np.pi * np.concatenate([inverse, shape.rise * inverse[..., :1]], -1)
    return Stiffness(compliance, loads, edges, np.zeros_like(edges))


@dataclass(frozen=True, eq=False)
class State:
    """Contacts of given radii under charges or held potentials."""

    stiffness: Stiffness
    shape: Shape
    given: Array
    held: tuple[bool, bool] = (False, False)
    force: Array | None = None

    @cached_property
    def _rows(self) -> Array:
        """The three conditions on (u0, g); (..., 3, 4)."""
        loads, edges = self.stiffness.loads, self.stiffness.edges
        rows = np.array(loads)
        if not self.shape.flat:
            rows[..., 0, :] = edges[..., 0, :]
        for field, held in enumerate(self.held):
            if held:
                rows[..., 1 + field, :] = np.eye(4)[1 + field]
        return rows

    @cached_property
    def displacement(self) -> Array:
        """u0 = (-depth, V, Psi) over C a^e; (..., 3)."""
        normal = np.zeros(self.given.shape[:-1]) if self.force is None else self.force
        right = np.concatenate([normal[..., None], self.given], -1) - self._profile * self._rows[..., 3]
        return np.asarray(np.linalg.solve(self._rows[..., :3], right[..., None])[..., 0])

    @property
    def _profile(self) -> float:
        """1 of a curved punch: that of a disc has no part."""
        return 0.0 if self.shape.flat else 1.0

    @cached_property
    def causes(self) -> Array:
        """(u0, g); (..., 4)."""
        there = np.full((*self.displacement.shape[:-1], 1), self._profile)
        return np.concatenate([self.displacement, there], -1)

    @cached_property
    def loads(self) -> Array:
        """(P, T, J) over C a^(e+1); (..., 3)."""
        return np.asarray(-np.einsum("...ij,...j->...i", self.stiffness.loads, self.causes))

    @cached_property
    def strengths(self) -> Array:
        """Strengths of (sigma_yy, D_y, B_y) at the edge over C a^(e-1); (..., 3)."""
        found = np.einsum("...ij,...j->...i", self.stiffness.edges, self.causes)
        if not self.shape.flat:
            found[..., 0] = 0.0
        return np.asarray(found)

    @cached_property
    def _released(self) -> Array:
        """-d loads / d log a at fixed displacements, over C a^(e+1); (..., 3)."""
        own = np.einsum("...ij,...j->...i", self.stiffness.compliance, self.strengths)
        return np.asarray(np.pi**2 * np.einsum("...ji,...j->...i", self.stiffness.edges[..., :3], own))

    @cached_property
    def _opening(self) -> Array:
        """d (strength of the pressure) / d log a at fixed displacements, over C a^(e-1); (...)."""
        s = self.stiffness
        rates = np.einsum("...j,...j->...", s.edge_rates[..., 0, :], self.causes)
        return np.asarray(rates + self.shape.exponent * s.edges[..., 0, 3])

    @cached_property
    def force_rate(self) -> Array:
        """dP / d log a with the charges or potentials as they are, over C a^(e+1); (...). Not of a disc."""
        right = -np.concatenate([self._opening[..., None], np.where(self.held, 0.0, self._released[..., 1:])], -1)
        moved = np.linalg.solve(self._rows[..., :3], right[..., None])[..., 0]
        followed = np.einsum("...j,...j->...", self.stiffness.loads[..., 0, :3], moved)
        return np.asarray(-followed - self._released[..., 0])

    @cached_property
    def tangent(self) -> Array:
        """-d(P, T, J) / d(-depth, V, Psi) over a, the edge going where it must; (..., 3, 3)."""
        own = self.stiffness.loads[..., :3]
        if self.shape.flat:
            return own
        edge = self.stiffness.edges[..., None, 0, :3] / self._opening[..., None, None]
        return np.asarray(own - self._released[..., :, None] * edge)

    @cached_property
    def fixed(self) -> Array:
        """-d(T, J) / d(V, Psi) over a at a fixed radius, with a smooth edge or the force of a disc; (..., 2, 2)."""
        own = self.stiffness.loads[..., :3]
        row = own[..., 0, :] if self.shape.flat else self.stiffness.edges[..., 0, :3]
        follows = row[..., None, 1:] / row[..., :1, None]
        return np.asarray(own[..., 1:, 1:] - own[..., 1:, :1] * follows)
