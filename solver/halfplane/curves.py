"""Stresses of the body below depth 0.1 h on panels tied to the edges of the contact: what the peaks are searched in.

The coordinate s across is X up to the edges; beyond, X = 1 + (s - 1)/(2 - s), so that s = 2 at infinity. The coordinate
of the depth, from 0 to 1, is even in the logarithm from 0.1 h to 2 h. No largest von Mises stress lies deeper, and no
tension as large as one at the least depth.
"""

import numpy as np

from solver.arrays import Array
from solver.curves import REGIONS
from solver.halfplane.contact import Contact
from solver.halfplane.interior import interior_parts
from solver.halfplane.peaks import DEPTH

_DEEPEST = 2.0
_REGION = REGIONS["body"]
_STRESSES = _REGION.fields[:4]


def body_curves(contact: Contact) -> dict[str, Array]:
    """Fields of the region ``body`` by name; (..., point), SI."""
    X, depth = (_REGION.panels.by_panel(whole) for whole in np.meshgrid(*lines()))
    stresses = interior_parts(contact, X, -depth, _STRESSES).whole(contact)
    return named(stresses, contact.half_width, depth)


def named(stresses: Array, half_width: Array, depth: Array) -> dict[str, Array]:
    """Fields of the region by name, SI, from stresses (..., 4, point) [Pa] at depths over h (point,)."""
    curves = {f"body_{name}": stresses[..., k, :] for k, name in enumerate(_STRESSES)}
    return curves | {"body_depth": half_width[..., None] * depth}


def lines() -> tuple[Array, Array]:
    """X of the points across, and depths over h of those down."""
    across, down = _REGION.lines()
    size = np.abs(across)
    X = np.where(size < 1, across, np.sign(across) * (1 + (size - 1) / (2 - size)))
    return X, DEPTH * (_DEEPEST / DEPTH) ** down
