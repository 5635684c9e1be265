"""Quantities of point contacts by their names; derivatives by one potential hold the other potential."""

import numpy as np

from solver.arrays import Array
from solver.point.contact import Pressed
from solver.point.friction import Rim
from solver.point.profile import finite
from solver.point.sliding import Rubbed
from solver.point.slidingpressure import largest_pressure
from solver.twoport import Stiffness

_INTENSITIES = ("electric_edge_intensity", "magnetic_edge_intensity")
_ENDS = tuple((f"{name}_trailing", f"{name}_leading") for name in _INTENSITIES)
#: By field: potential, potential per force, charge per force at zero potential, stroke, blocked force, capacitance.
RESPONSES = (
    ("voltage", "voltage_per_force", "charge_per_force", "stroke_per_volt", "blocked_force_per_volt", "capacitance"),
    ("magnetic_potential", "magnetic_potential_per_force", "flux_per_force", "stroke_per_ampere",
     "blocked_force_per_ampere", "permeance"),
)  # fmt: skip


def quantities(pressed: Pressed) -> dict[str, Array]:
    """Quantities of ``solver.names`` that every case has, SI; (case,) each."""
    contact = pressed.charged
    port = Stiffness(contact.tangent)
    out = {"contact_radius": contact.radius}
    if finite(pressed.body.shape):
        out["peak_pressure"] = contact.peak_pressure
    out |= {
        "depth": -contact.displacement[:, 0],
        "contact_stiffness": port.closed,
        "contact_stiffness_open": port.open,
    }
    for field in (0, 1):
        if np.all(pressed.conducts[..., field]):
            out[_INTENSITIES[field]] = contact.intensities[:, 1 + field]
            j = 1 + field
            responses = (
                contact.displacement[:, j], Stiffness(pressed.uncharged.tangent).potential_per_force(j),
                pressed.grounded.loads[:, j] / pressed.force, port.stroke(j), port.blocked_force(j),
                -contact.fixed[:, field, field],
            )  # fmt: skip
            out |= dict(zip(RESPONSES[field], responses, strict=True))
    return out


def sliding_quantities(pressed: Pressed, rim: Rim | None) -> dict[str, Array]:
    """Quantities of ``solver.names.POINT_SLIDING``, SI; (case,) each."""
    contact = pressed.charged
    if pressed.body.shape.flat:  # a disc does not shift, and its edge has a logarithm
        return {}
    slid = Rubbed(contact)
    out = {"contact_offset": slid.offset}
    if finite(pressed.body.shape) and pressed.friction is not None:
        out["peak_pressure"] = largest_pressure(contact, pressed.friction)
    size = np.sqrt(np.pi * contact.radius)
    for field in (0, 1):
        if np.all(pressed.conducts[..., field]):
            at_rest, sliding = contact.intensities[:, 1 + field], size * slid.strengths[:, 1 + field]
            out |= dict(zip(_ENDS[field], (at_rest + sliding, at_rest - sliding), strict=True))
    return out | ({} if rim is None else {"trailing_tension": slid.tension(rim)})
