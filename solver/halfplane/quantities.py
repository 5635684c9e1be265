"""Every quantity of ``solver.names.QUANTITIES`` that a contact has, from its closed forms."""

from collections.abc import Callable

from solver.arrays import Array
from solver.halfplane.contact import Contact
from solver.halfplane.response import Response
from solver.names import RESPONSES


def quantities(contact: Contact, datum: Array, punch_datum: Array | None = None) -> dict[str, Array]:
    """Each quantity in the smallest shape that it needs.

    A quantity that means nothing for some of the cases is left out for all: the response of a field that a punch does
    not conduct, and what is infinite at a corner (the pressure, edge intensities and edge stresses).
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
    out |= at_edges(smooth, contact.edge_stress, contact.edge_intensity)
    answers = response.potential, response.sensitivity, response.short_circuit, response.stroke, response.blocked_load
    for field, names in enumerate(RESPONSES):
        if contact.sliding.conducts[..., field].all():
            out |= {name: answer(field) for name, answer in zip(names, answers, strict=False)}
    return out


def at_edges(
    smooth: tuple[bool, bool], stress: Callable[[float], Array] | None, intensity: Callable[[float], Array]
) -> dict[str, Array]:
    """Stresses and edge intensities at the smooth edges of a contact, by name; (...) each."""
    out = {}
    for end, stretch, edge, is_smooth in (
        ("trailing", "trailing_tension", 1.0, smooth[0]), ("leading", "leading_compression", -1.0, smooth[1]),
    ):  # fmt: skip
        if is_smooth:
            if stress is not None:
                out[stretch] = stress(edge)
            intensities = intensity(edge)
            out[f"electric_edge_intensity_{end}"], out[f"magnetic_edge_intensity_{end}"] = (
                intensities[..., 0],
                intensities[..., 1],
            )
    return out
