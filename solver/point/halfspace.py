"""The half-space in closed form, as every contact of revolution is described here (points, 3).

A contact of the radius a has the loads ``a loads . (u0, g)`` and the edge strengths ``edges . (u0, g) / a``: columns of
u0 = (-depth, V, Psi) and of the profile g = (r/a)^exponent. Near the edge a traction is its strength over
sqrt(1 - r^2/a^2).
"""

from dataclasses import dataclass

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
