"""Every quantity of ``solver.names.QUANTITIES`` that a contact has, from its closed forms."""

from solver.arrays import Array
from solver.halfplane.contact import Contact
from solver.halfplane.response import Response
from solver.names import RESPONSES


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
    answers = response.potential, response.sensitivity, response.short_circuit, response.stroke, response.blocked_load
    for field, names in enumerate(RESPONSES):
        if contact.sliding.conducts[..., field].all():
            out |= {name: answer(field) for name, answer in zip(names, answers, strict=False)}
    return out
