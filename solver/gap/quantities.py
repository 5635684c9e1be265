"""Every quantity of contacts with air beside them by its name (theory section 10)."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from solver.arrays import Array
from solver.cache import cached
from solver.gap.airline import AirContact, State
from solver.gap.grid import peak_of_panels
from solver.gap.operators import ANGLES, EDGE, FIRST, PRESSURE, WITHIN, AirTable, farthest, grid_of
from solver.gap.refusal import lacking, require
from solver.line.peakpressure import largest
from solver.line.similar import Films
from solver.line.system import SAMPLES
from solver.line.windows import Kind, window
from solver.material.constants import VACUUM_PERMEABILITY, VACUUM_PERMITTIVITY
from solver.names import RESPONSES
from solver.twoport import Compliance


def peak_pressure(state: State) -> float:
    """Largest contact pressure [Pa]."""
    samples = state.outputs[PRESSURE]
    series = np.polynomial.chebyshev.chebfit(SAMPLES, samples, SAMPLES.size // 2)
    contact = state.problem.contact
    return float(largest(np.asarray(series[None], dtype=np.float64), contact.exponent)[0] / contact.scale[1])


def peak_density(state: State, field: int) -> float:
    """Largest abs(D_y) [C/m2] or abs(B_y) [T] on the contact and beside it."""
    place = state.problem.fields.index(field)
    start = FIRST + state.problem.nodes * (1 + len(state.problem.fields)) + place * ANGLES.size
    within = state.outputs[start : start + ANGLES.size]
    return max(peak_of_panels(within.reshape(-1, WITHIN)), _exterior(state, place)) / float(
        state.problem.contact.scale[2 + field]
    )


def gap_field(state: State, field: int) -> float:
    """Largest field in the gap [V/m, A/m]."""
    density = _exterior(state, state.problem.fields.index(field)) / float(state.problem.contact.scale[2 + field])
    return density / float(state.problem.permittivity[field])


def _exterior(state: State, place: int) -> float:
    grid = state.problem.table.operators.grid
    nodes = grid.count // grid.panels
    densities = state.densities[place].reshape(-1, grid.panels, nodes)
    at_edge = densities[:, 0] @ grid.edge[:nodes]
    return max(peak_of_panels(densities[:, :-1].reshape(-1, nodes)), float(np.max(np.abs(at_edge))))


_AIR_NODES = 12  # half-lengths of a window: 1e-7 between them


@cached
def _air_window(kind: Kind, number: int, reach: float) -> AirTable:
    whole = window(kind, number)
    return AirTable(type(whole)(whole.system, whole.lower, whole.upper, _AIR_NODES), reach)


def quantities(films: Films, permittivity: Array) -> dict[str, Array]:
    """Quantities by the names of ``solver.names``, as without air, with those that only a gap has; (case,) each.

    Edge intensities are absent: those of fields that the air carries do not exist, those of others are 0.
    """
    uncharged, out = films, dict[str, Array]()
    if np.any(films.charges):
        uncharged = films.with_charges(np.zeros_like(films.charges))
    bare = dict(_in_air(uncharged, permittivity))
    for place, contact in bare.items() if uncharged is films else _in_air(films, permittivity):
        for name, value in _of_case(films, place, contact.state, bare[place]).items():
            out.setdefault(name, np.empty(films.load.size))[place] = value
    return out


def states(films: Films, permittivity: Array) -> Iterator[tuple[int, State]]:
    """Every case with its solution; arguments and refusals of :func:`quantities`."""
    for place, contact in _in_air(films, permittivity):
        yield place, contact.state


def _in_air(films: Films, permittivity: Array) -> Iterator[tuple[int, AirContact]]:
    """Every case, on a film of unit thickness, with the table of its window."""
    require(lacking(films.kind))
    films.require_one_length()
    for places, number, contacts in films.parts:
        table = window(films.kind, number)
        ends = table.system, table.lower, table.upper
        for k, place in enumerate(places.tolist()):
            air = np.array([VACUUM_PERMITTIVITY * permittivity[place], VACUUM_PERMEABILITY])
            contact = contacts.part(k)
            reach = farthest(contact, air)
            wider = grid_of(*ends, reach).panels > grid_of(*ends).panels  # else all contacts of a window share a table
            yield place, AirContact(_air_window(films.kind, number, reach if wider else 0.0), contact, air)


def _of_case(films: Films, place: int, state: State, bare: AirContact) -> dict[str, float]:
    h, scale = float(films.thickness[place]), state.problem.contact.scale
    half, centre = h * state.half, state.centre
    out = {
        "contact_trailing": half * (1 + centre),
        "contact_leading": half * (1 - centre),
        "contact_offset": half * centre,
        "pressure_exponent": state.problem.contact.exponent,
        "depth": h * float(state.response[0] * scale[1]),
        "peak_pressure": peak_pressure(state),
        "trailing_tension": float(state.outputs[EDGE][0] / scale[1]),
        "leading_compression": float(state.outputs[EDGE][1] / scale[1]),
    }
    idle = bare.state
    for field, conducts in enumerate(films.kind.conducts):
        if conducts:
            out |= dict(zip(RESPONSES[field], _responses(h, field, state, idle, bare), strict=True))
    if films.kind.conducts[0]:
        out["nominal_field"] = abs(out["voltage"]) / (h * films.kind.above_ground)
        out["capacitance_at_load"] = float(Compliance.of(state.tangents, 0).capacitance)
        out["peak_displacement"] = peak_density(state, 0)
        out["gap_field"] = gap_field(state, 0)
    return out


def _responses(h: float, field: int, state: State, idle: State, bare: AirContact) -> tuple[float, ...]:
    j, scale = 1 + field, state.problem.contact.scale
    port = Compliance.of(state.tangents, field)
    short = replace(bare, held=(field == 0, field == 1), idle=idle).state
    return (
        h * float(state.response[j] * scale[j + 1]),
        float(idle.tangents[j, 0]),
        float(short.loads[j] / short.loads[0] * scale[1] / scale[j + 1]),
        float(port.stroke),
        float(port.blocked_force),
        1 / float(state.at_fixed_contact[j, field]),
    )
