"""Quantities of point contacts by their names.

A tangent in the voltage holds the magnetic potential, one in the magnetic potential the voltage; those of open circuits
hold both charges.
"""

import numpy as np

from solver.arrays import Array
from solver.point.pressed import Contact, Pressed
from solver.point.pressure import finite
from solver.point.rim import Rim
from solver.point.sliding import Rubbed
from solver.point.slidingpressure import largest_pressure

_INTENSITIES = ("electric_edge_intensity", "magnetic_edge_intensity")
_ENDS = tuple((f"{name}_trailing", f"{name}_leading") for name in _INTENSITIES)
#: Of each field: potential, per force, charge per force at zero potential, stroke, blocked force, store.
RESPONSES = (
    (
        "voltage", "voltage_per_force", "charge_per_force", "stroke_per_volt", "blocked_force_per_volt",
        "capacitance",
    ),
    (
        "magnetic_potential", "magnetic_potential_per_force", "flux_per_force", "stroke_per_ampere",
        "blocked_force_per_ampere", "permeance",
    ),
)  # fmt: skip


def quantities(pressed: Pressed) -> dict[str, Array]:
    """Quantities of ``solver.names`` that every case has, SI; (case,) each."""
    contact = pressed.charged
    tangent = contact.tangent
    out = {"contact_radius": contact.radius}
    if finite(pressed.body.shape):
        out["peak_pressure"] = contact.peak_pressure
    out |= {
        "depth": -contact.displacement[:, 0],
        "contact_stiffness": tangent[:, 0, 0],
        "contact_stiffness_open": _open(tangent),
    }
    for field in (0, 1):
        if np.all(pressed.conducts[..., field]):
            out[_INTENSITIES[field]] = contact.intensities[:, 1 + field]
            out |= dict(zip(RESPONSES[field], _responses(pressed, contact, tangent, field), strict=True))
    return out


def sliding_quantities(pressed: Pressed, rim: Rim | None) -> dict[str, Array]:
    """What friction adds to them, those of ``solver.names.POINT_SLIDING``, SI; (case,) each."""
    contact = pressed.charged
    if pressed.body.shape.flat:  # it stays where it is, and its edge has a logarithm
        return {}
    rubbed = Rubbed(contact)
    out = {"contact_offset": rubbed.offset}
    if finite(pressed.body.shape) and pressed.friction is not None:
        out["peak_pressure"] = largest_pressure(contact, pressed.friction)
    size = np.sqrt(np.pi * contact.radius)
    for field in (0, 1):
        if np.all(pressed.conducts[..., field]):
            own, more = contact.intensities[:, 1 + field], size * rubbed.strengths[:, 1 + field]
            out |= dict(zip(_ENDS[field], (own + more, own - more), strict=True))
    return out | ({} if rim is None else {"trailing_tension": rubbed.tension(rim)})


def _responses(pressed: Pressed, contact: Contact, tangent: Array, field: int) -> tuple[Array, ...]:
    j = 1 + field
    free = np.linalg.inv(_scaled(pressed.uncharged.tangent))
    units = _sizes(pressed.uncharged.tangent)
    return (
        contact.displacement[:, j],
        -free[:, j, 0] * units[:, j] * units[:, 0],
        pressed.grounded.loads[:, j] / pressed.force,
        tangent[:, 0, j] / tangent[:, 0, 0],
        -tangent[:, 0, j],
        -contact.fixed[:, field, field],
    )


def _open(tangent: Array) -> Array:
    """dP / d depth at fixed charges [N/m]; (case,)."""
    units = _sizes(tangent)
    return np.asarray(1 / (np.linalg.inv(_scaled(tangent))[:, 0, 0] * units[:, 0] ** 2))


def _sizes(tangent: Array) -> Array:
    """Inverse roots of the diagonal, by which rows and columns are brought to order one; (case, 3)."""
    return np.asarray(1 / np.sqrt(np.abs(np.diagonal(tangent, axis1=-2, axis2=-1))))


def _scaled(tangent: Array) -> Array:
    sizes = _sizes(tangent)
    return np.asarray(tangent * sizes[:, :, None] * sizes[:, None, :])
