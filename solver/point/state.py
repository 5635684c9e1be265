"""Point contacts of known radii: displacements and potentials from forces and charges, and tangents (points, 3).

Causes are u0 = (-depth, V, Psi) over C a^e and the profile g = (r/a)^e, with C a^e = 1 for a disc.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array, BoolArray
from solver.point.profile import Shape


@dataclass(frozen=True, eq=False)
class Stiffness:
    """Loads and edge strengths of contacts of given radii, in the units of their bodies."""

    # N of the contact over (y, phi, psi), of the top and of the punch; (..., 3, 3). A field that the punch does not
    # conduct has a diagonal entry only, here and in the other arrays.
    compliance: Array
    loads: Array  # int t over a; (..., 3, 4)
    edges: Array  # Strengths times a; (..., 3, 4)
    edge_rates: Array  # Their derivatives in log a; (..., 3, 4)


def conducted(compliance: Array, conducts: BoolArray) -> Array:
    """Return N without the entries that couple fields which the punch does not conduct; (..., 3, 3)."""
    is_active = np.concatenate([np.ones_like(conducts[..., :1]), conducts], -1)
    is_coupled = (is_active[..., :, None] & is_active[..., None, :]) | np.eye(3, dtype=bool)
    return np.asarray(np.where(is_coupled, compliance, 0.0))


def halfspace(compliance: Array, shape: Shape) -> Stiffness:
    """Contacts on a half-space of N (..., 3, 3), whatever their radius."""
    inverse = np.linalg.inv(compliance)
    loads = 4 * np.concatenate([inverse, shape.mean * inverse[..., :1]], -1)
    edges = 2 / np.pi * np.concatenate([inverse, shape.rise * inverse[..., :1]], -1)
    return Stiffness(compliance, loads, edges, np.zeros_like(edges))


@dataclass(frozen=True, eq=False)
class PressedState:
    """Contacts of given radii under charges or at zero potentials, over C a^e and C a^(e+1)."""

    stiffness: Stiffness
    shape: Shape
    charges: Array  # Over the load's unit; zero if ``grounded``; (..., 2)
    grounded: bool = False  # Whether both potentials are held at zero
    force: Array | None = None  # -P of a disc over the load's unit; None: the edge is smooth

    @cached_property
    def _rows(self) -> Array:
        """Rows of the three conditions on (u0, g); (..., 3, 4)."""
        loads, edges = self.stiffness.loads, self.stiffness.edges
        rows = np.array(loads)
        if not self.shape.flat:
            rows[..., 0, :] = edges[..., 0, :]
        if self.grounded:
            rows[..., 1:, :] = np.eye(4)[1:3]
        return rows

    @cached_property
    def displacement(self) -> Array:
        """Return u0 = (-depth, V, Psi) over C a^e; (..., 3)."""
        normal = np.zeros(self.charges.shape[:-1]) if self.force is None else self.force
        right = np.concatenate([normal[..., None], self.charges], -1) - self._profile * self._rows[..., 3]
        return np.asarray(np.linalg.solve(self._rows[..., :3], right[..., None])[..., 0])

    @property
    def _profile(self) -> float:
        """Return 1 for a curved punch, 0 for a disc, which has no profile."""
        return 0.0 if self.shape.flat else 1.0

    @cached_property
    def causes(self) -> Array:
        """Causes (u0, g); (..., 4)."""
        profile = np.full((*self.displacement.shape[:-1], 1), self._profile)
        return np.concatenate([self.displacement, profile], -1)

    @cached_property
    def loads(self) -> Array:
        """Loads (P, T, J) over C a^(e+1); (..., 3)."""
        return np.asarray(-np.einsum("...ij,...j->...i", self.stiffness.loads, self.causes))

    @cached_property
    def strengths(self) -> Array:
        """Strengths of (sigma_yy, D_y, B_y) at the edge over C a^(e-1); (..., 3)."""
        strengths = np.einsum("...ij,...j->...i", self.stiffness.edges, self.causes)
        if not self.shape.flat:
            strengths[..., 0] = 0.0
        return np.asarray(strengths)

    @cached_property
    def _released(self) -> Array:
        """Return -d loads / d log a at fixed displacements by (P3.4), over C a^(e+1); (..., 3)."""
        displaced = np.einsum("...ij,...j->...i", self.stiffness.compliance, self.strengths)
        return np.asarray(np.pi**2 * np.einsum("...ji,...j->...i", self.stiffness.edges[..., :3], displaced))

    @cached_property
    def _opening(self) -> Array:
        """Return d (strength of the pressure) / d log a at fixed displacements, over C a^(e-1); (...)."""
        s = self.stiffness
        rates = np.einsum("...j,...j->...", s.edge_rates[..., 0, :], self.causes)
        return np.asarray(rates + self.shape.exponent * s.edges[..., 0, 3])

    @cached_property
    def force_rate(self) -> Array:
        """Return dP / d log a at fixed charges or at zero potentials, over C a^(e+1); (...). Not for a disc."""
        right = -np.concatenate([self._opening[..., None], np.where(self.grounded, 0.0, self._released[..., 1:])], -1)
        displacement_rates = np.linalg.solve(self._rows[..., :3], right[..., None])[..., 0]
        by_displacement = np.einsum("...j,...j->...", self.stiffness.loads[..., 0, :3], displacement_rates)
        return np.asarray(-by_displacement - self._released[..., 0])

    @cached_property
    def tangent(self) -> Array:
        """Return -d(P, T, J) / d(-depth, V, Psi) over a, with a moving edge; (..., 3, 3)."""
        loads = self.stiffness.loads[..., :3]
        if self.shape.flat:
            return loads
        edge = self.stiffness.edges[..., None, 0, :3] / self._opening[..., None, None]
        return np.asarray(loads - self._released[..., :, None] * edge)

    @cached_property
    def fixed(self) -> Array:
        """Return -d(T, J) / d(V, Psi) over a at a fixed radius, edge smooth or a disc's force fixed; (..., 2, 2)."""
        loads = self.stiffness.loads[..., :3]
        row = loads[..., 0, :] if self.shape.flat else self.stiffness.edges[..., 0, :3]
        follows = row[..., None, 1:] / row[..., :1, None]
        return np.asarray(loads[..., 1:, 1:] - loads[..., 1:, :1] * follows)
