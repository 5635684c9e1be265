"""Quantities of contacts in space by their names; meanings are those of points.

As at a point, ``voltage`` and what is per volt belong to the contact under its charge, ``voltage_per_force`` to the
contact without charge and ``charge_per_force`` to that at zero voltage. A contact that a sharp end of the punch limits
has no ``peak_pressure``, which is infinite there.
"""

from collections.abc import Set

from solver.names import SPACE_SLOPES
from solver.surface.contact import Slopes, SurfaceContact
from solver.twoport import Stiffness


def slopes_of(names: Set[str] | None) -> Slopes:
    """Derivatives that some quantities need; None: all quantities."""
    needed = [Slopes[by] for name, by in SPACE_SLOPES.items() if names is None or name in names]
    return max(needed, default=Slopes.NONE)


def quantities(charged: SurfaceContact, slopes: Slopes) -> dict[str, float]:
    """Quantities of a contact, SI: those of its slopes, and those of the contact without charge where that is there."""
    lengths, moments = charged.lengths, charged.moments
    out = {
        "contact_area": charged.area,
        "contact_length_x": lengths[0],
        "contact_length_y": lengths[1],
        "depth": charged.depth,
        "voltage": charged.voltage,
        "charge": charged.charge,
        "force": float(charged.force[2]),
        "friction_force_x": float(charged.force[0]),
        "friction_force_y": float(charged.force[1]),
        "moment_x": float(moments[0]),
        "moment_y": float(moments[1]),
        "moment_z": float(moments[2]),
        "charge_per_force": charged.charge_per_force,
        "relative_error": charged.error,
    }
    if not charged.reaches_end:
        out["peak_pressure"] = charged.peak_pressure
    port = _port(charged)
    if slopes >= Slopes.BY_VOLTAGE:
        out["stroke_per_volt"] = float(port.stroke(1))
        out["capacitance"] = charged.fixed_capacitance
        out["capacitance_at_force"] = float(port.capacitance(1))
    if slopes >= Slopes.BY_LOAD:
        out["contact_stiffness"] = float(port.closed)
        out["contact_stiffness_open"] = float(port.open)
        out["blocked_force_per_volt"] = float(port.blocked_force(1))
        uncharged = charged if charged.charge == 0 else charged.uncharged
        if uncharged is not None:
            out["voltage_per_force"] = float(_port(uncharged).potential_per_force(1))
    return out


def _port(contact: SurfaceContact) -> Stiffness:
    """The contact as a two-port of depth and voltage."""
    return Stiffness(contact.tangent * [[-1.0], [-1.0]] * [-1.0, 1.0])
