"""Quantities and surface fields by collocation, named as in ``solver.names``."""

import numpy as np

from verification.oracles import collocation, precise
from verification.oracles.surface_response import Array, SurfaceResponse


def quantities(contact: collocation.Contact, surface: SurfaceResponse, datum: float) -> dict[str, float]:
    """Ends, response, edge values."""
    depth, voltage, magnetic_potential = contact.punch_response(datum)
    alpha, h, near = contact.problem.weights()[0][0], contact.half_width, np.array([1e-24])
    trailing, leading = (contact._tractions(*sides)[:, 0] for sides in ((near, 2 - near), (2 - near, near)))
    to_intensity = np.sqrt(2 * np.pi * h * near[0])
    edges = np.zeros((4, 2))
    edges[0] = contact.problem.friction * contact.transforms(np.array([1.0, -1.0]))[0]  # an ordinary integral there
    tension, compression = surface.along_surface(np.zeros((4, 2)), edges)[0]
    return {
        "contact_trailing": contact.trailing,
        "contact_leading": contact.leading,
        "pressure_exponent": alpha,
        "peak_pressure": -contact.tractions(np.array([1 - 2 * alpha]))[0, 0],  # where alpha/(a-x) = (1-alpha)/(x+b)
        "depth": depth,
        "voltage": voltage,
        "magnetic_potential": magnetic_potential,
        "electric_edge_intensity_trailing": to_intensity * trailing[1],
        "electric_edge_intensity_leading": to_intensity * leading[1],
        "magnetic_edge_intensity_trailing": to_intensity * trailing[2],
        "magnetic_edge_intensity_leading": to_intensity * leading[2],
        "trailing_tension": tension,
        "leading_compression": compression,
    }


def fields(contact: collocation.Contact, surface: SurfaceResponse, X: Array) -> dict[str, Array]:
    """The surface fields.

    X: (n,), places over the contact's half-width, |X| < 1.
    """
    t, transform = (
        np.vstack([contact.problem.friction * rows[0], rows]) for rows in (contact.tractions(X), contact.transforms(X))
    )
    along = surface.along_surface(t, transform)
    return dict(zip(precise.FIELDS, (-t[1], t[0], t[2], t[3], along[0], along[2], along[3]), strict=True))
