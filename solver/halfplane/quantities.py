"""Every quantity of ``solver.names.QUANTITIES`` that a contact has, from its closed forms."""

from solver.arrays import Array
from solver.halfplane.contact import Contact
from solver.halfplane.response import Response


def quantities(contact: Contact, datum: Array, punch_datum: Array | None = None) -> dict[str, Array]:
    """Each quantity in the smallest shape that it needs.

    A quantity that means nothing for some of the cases is left out for all: the response of a field that a punch does
    not conduct, and what is infinite at a corner (the pressure, edge intensities and edge stresses).

    Parameters
    ----------
    contact
        The solved contact.
    datum, punch_datum
        Reference lengths of the body and of an elastic punch [m], as :class:`Response` takes them.
    """
    response = Response(contact, datum, punch_datum)
    out = {
        "contact_trailing": contact.trailing,
        "contact_leading": contact.leading,
        "pressure_exponent": contact.exponent,
        "depth": response.depth,
    }
    smooth = contact.profile.smooth
    if all(smooth):
        out["peak_pressure"] = contact.peak_pressure
    if smooth[0]:
        out["trailing_tension"] = contact.edge_stress(1.0)
    if smooth[1]:
        out["leading_compression"] = contact.edge_stress(-1.0)
    for name, edge, is_smooth in (("trailing", 1.0, smooth[0]), ("leading", -1.0, smooth[1])):
        if is_smooth:
            intensity = contact.edge_intensity(edge)
            out[f"electric_edge_intensity_{name}"] = intensity[..., 0]
            out[f"magnetic_edge_intensity_{name}"] = intensity[..., 1]
    if contact.sliding.conducts[..., 0].all():
        out["voltage"] = response.potential(0)
        out["voltage_sensitivity"] = response.sensitivity(0)
        out["charge_sensitivity"] = response.short_circuit(0)
        out["stroke_per_volt"] = response.stroke(0)
        out["blocked_load_per_volt"] = response.blocked_load(0)
    if contact.sliding.conducts[..., 1].all():
        out["magnetic_potential"] = response.potential(1)
        out["magnetic_sensitivity"] = response.sensitivity(1)
        out["flux_sensitivity"] = response.short_circuit(1)
        out["stroke_per_ampere"] = response.stroke(1)
        out["blocked_load_per_ampere"] = response.blocked_load(1)
    return out
