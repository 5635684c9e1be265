"""Quantities of line contacts in air by their names (theory section 10)."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, joined
from solver.cache import cached
from solver.gap.airline import AirContacts, LineSolution
from solver.gap.grid import peak_of_panels
from solver.gap.newton import together
from solver.gap.operators import WITHIN, AirTable, farthest, grid_of
from solver.halfplane.peakpressure import largest
from solver.line.outputs import pressure_series
from solver.line.quantities import edges
from solver.line.similar import Films
from solver.line.system import SAMPLES
from solver.line.windows import Kind, window
from solver.material.constants import VACUUM_PERMEABILITY, VACUUM_PERMITTIVITY
from solver.names import RESPONSES
from solver.twoport import Compliance

_WINDOW_NODES, _PART_NODES = 12, 6  # half-lengths of a window, 3e-7 between them, and of a part of it, 1e-9
_PART, _OVERLAP = 0.1, 0.015  # length of a part in log h, and its overlap with the next: air moves a contact less


@cached
def _air_window(kind: Kind, number: int, reach: float, part: int | None = None) -> AirTable:
    """Table of a window, or of a part of its range, for charges up to the distance ``reach``."""
    whole = window(kind, number)
    if part is None:
        return AirTable(replace(whole, nodes=_WINDOW_NODES), reach)
    lower, upper = np.exp([part * _PART - _OVERLAP, (part + 1) * _PART + _OVERLAP]).tolist()
    # zero potentials move a contact by a hundredth: polynomials of low degree extrapolate that far without loss
    return AirTable(replace(whole, lower=lower, upper=upper, nodes=_PART_NODES), reach, clipped=False)


def quantities(films: Films, permittivity: Array) -> dict[str, Array]:
    """Quantities by the names of ``solver.names``, (case,) each; contacts in air have no edge intensities."""
    is_charged = bool(np.any(films.charges))
    uncharged = films.with_charges(np.zeros_like(films.charges)) if is_charged else films
    parts = [
        (cases, _of_uncharged(contacts) | ({} if is_charged else _of_contacts(films.part(cases), contacts)))
        for cases, contacts in _in_air(uncharged, permittivity)
    ]
    whole = joined(parts, films.load.size)
    if is_charged:
        charged = _in_air(films, permittivity)
        parts = [(cases, _of_contacts(films.part(cases), contacts)) for cases, contacts in charged]
        whole |= joined(parts, films.load.size)
    return whole


def solutions(films: Films, permittivity: Array) -> Iterator[tuple[int, LineSolution]]:
    """Yield every case with its solution, or refuse as :func:`quantities` does."""
    for cases, contacts in _in_air(films, permittivity):
        yield from zip(cases.tolist(), contacts.solutions(), strict=True)


def _in_air(films: Films, permittivity: Array) -> Iterator[tuple[Indices, AirContacts]]:
    """Yield groups of cases that are solved at once, with contacts on films of unit thickness that share a table."""
    films.require_one_length()
    air = np.stack([VACUUM_PERMITTIVITY * permittivity, np.full_like(permittivity, VACUUM_PERMEABILITY)], 1)
    for cases, number, contact in films.parts:
        ends = contact.table.system, contact.table.lower, contact.table.upper
        usual, reaches = grid_of(*ends).panels, farthest(contact, air[cases])
        for reach in np.unique(reaches).tolist():
            members = np.flatnonzero(reaches == reach)
            # all contacts of a window share a table if they can
            farther = reach if grid_of(*ends, reach).panels > usual else 0.0
            members = members[np.argsort(contact.half_width[members], kind="stable")]
            first, last = np.floor(np.log(contact.half_width[members[[0, -1]]]) / _PART).astype(int).tolist()
            if first == last:
                table = _air_window(films.kind, number, farther, first)
                contacts = AirContacts(table, contact.part(members), air[cases[members]])
                if members.size <= together(contacts.states()) and contacts.within:
                    yield cases[members], contacts
                    continue
            table = _air_window(films.kind, number, farther)
            count = together(AirContacts(table, contact.part(members), air[cases[members]]).states())
            for start in range(0, members.size, count):
                block = members[start : start + count]
                yield cases[block], AirContacts(table, contact.part(block), air[cases[block]])


def _of_uncharged(contacts: AirContacts) -> dict[str, Array]:
    """Potentials per load, and charges per load at zero potential, of contacts without charges; (case,) each."""
    uncharged, scale, out = contacts.solved, contacts.contact.scale, dict[str, Array]()
    for field in uncharged.states.frame.fields:
        j = 1 + field
        loads = contacts.held((field == 0, field == 1), uncharged).states.loads
        out[RESPONSES[field][1]] = uncharged.tangents[:, j, 0] * scale[1 + j] * scale[1]
        out[RESPONSES[field][2]] = loads[:, j] / loads[:, 0] * scale[1] / scale[1 + j]
    return out


def _of_contacts(films: Films, contacts: AirContacts) -> dict[str, Array]:
    """Quantities of contacts with their charges; (case,) each."""
    result, h, scale = contacts.solved, films.thickness, contacts.contact.scale
    states, table = result.states, contacts.table
    reported = table.outputs.reported.at(states.unknowns[:, 0]).times(states.columns[..., None])[0, ..., 0]
    half, exponent = h * states.half, contacts.contact.exponent
    stresses, pressures, within = np.split(reported, [2, 2 + SAMPLES.size], 1)
    out = edges(half, states.centre) | {
        "pressure_exponent": np.full_like(half, exponent),
        "depth": h * states.response.values[:, 0] * scale[1],
        "peak_pressure": largest(pressure_series(pressures), exponent) / scale[1],
        "trailing_tension": stresses[:, 0] / scale[1],
        "leading_compression": stresses[:, 1] / scale[1],
    }
    tangents = result.tangents * scale[1:, None] * scale[1:]
    for field in states.frame.fields:
        j, port, names = 1 + field, Compliance.of(tangents, field), RESPONSES[field]
        out[names[0]] = h * states.response.values[:, j] * scale[1 + j]
        out[names[3]], out[names[4]] = port.stroke, port.blocked_force
        out[names[5]] = 1 / (result.at_fixed_contact[:, j, field] * scale[1 + j] ** 2)
    if 0 in states.frame.fields:
        electric = states.frame.fields.index(0)
        densities = within.reshape(half.size, len(states.frame.fields), -1, WITHIN)[:, electric]
        exterior = _largest_exterior(contacts, electric)
        out["nominal_field"] = np.abs(out["voltage"]) / (h * films.kind.stack.above_ground)
        out["capacitance_at_load"] = Compliance.of(tangents, 0).capacitance
        out["peak_displacement"] = np.maximum(peak_of_panels(densities), exterior) / scale[2]
        out["gap_field"] = exterior / scale[2] / contacts.permittivity[:, 0]
    return out


def _largest_exterior(contacts: AirContacts, row: int) -> Array:
    """Largest exterior density of the conducted field number ``row``, in the units of the stack; (case,)."""
    states, grid = contacts.solved.states, contacts.table.operators.grid
    nodes = grid.count // grid.panels
    densities = (states.over_size[:, row] * contacts.table.size).reshape(states.half.size, -1, grid.panels, nodes)
    at_edge = np.max(np.abs(densities[:, :, 0] @ grid.edge[:nodes]), 1)
    finite = densities[:, :, :-1].reshape(states.half.size, -1, nodes)
    return np.asarray(np.maximum(peak_of_panels(finite), at_edge))
