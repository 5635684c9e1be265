"""Quantities of films by name, both those that half-planes have and those of films alone."""

from collections.abc import Iterator, Sequence, Set
from dataclasses import replace

import numpy as np

from approximation.arrays import Indices, blocks
from solver.arrays import Array, joined
from solver.halfplane.peakpressure import largest
from solver.halfplane.quantities import at_edges
from solver.line.contact import FilmContact
from solver.line.outputs import PRESSURE, pressure_series
from solver.line.peaks import PEAKS_OF, PeakTable
from solver.line.similar import Films
from solver.line.stressnets import regions as regions_of
from solver.line.stressnets import require_depth
from solver.line.windows import peak_window
from solver.names import RESPONSES
from solver.twoport import Compliance

_SHORT_STEPS = 20
_PRESSURES = 4096  # cases at a time: bounded memory
_CHARGE_CLOSE = 1e-9  # of a charge: the next step is of its square

#: Cases, the table of their stresses, and their half-lengths and causes in it.
PeakTables = Iterator[tuple[Indices, PeakTable, Array, Array]]


def quantities(films: Films) -> dict[str, Array]:
    """Quantities of ``solver.names.QUANTITIES`` and ``FILM_QUANTITIES`` that the cases have; (case,) each."""
    films.require_one_length()
    h, gather = films.thickness, films.gather
    out = edges(h * gather(lambda c: c.half_width), gather(lambda c: c.centre)) | {
        "pressure_exponent": gather(lambda c: np.full(c.load.shape, c.exponent)),
        "depth": h * gather(lambda c: c.response[:, 0]),
    }
    smooth = films.kind.smooth
    if all(smooth):
        out["peak_pressure"] = gather(_peak_pressure)
    out |= at_edges(
        smooth,
        None if films.kind.stack.electroded else lambda edge: gather(lambda c: c.edge_stress(edge)),
        lambda edge: np.sqrt(h)[:, None] * gather(lambda c: c.edge_intensity(edge)),
    )
    for field, conducts in enumerate(films.kind.conducts):
        if conducts:
            out |= _responses(films, field)
    if "voltage" in out:
        out["nominal_field"] = np.abs(out["voltage"]) / (h * films.kind.stack.above_ground)
    return out


def edges(half: Array, centre: Array) -> dict[str, Array]:
    """Trailing edge x = a, leading edge x = -b and offset of contacts of half-length [m] and c/h; (case,) each."""
    return {
        "contact_trailing": half * (1 + centre),
        "contact_leading": half * (1 - centre),
        "contact_offset": half * centre,
    }


def _peak_pressure(contact: FilmContact) -> Array:
    """Largest contact pressure [Pa] between two smooth edges; (case,)."""
    series = pressure_series(contact.table.series[:, PRESSURE])
    peaks = np.empty(contact.load.size)
    for block in blocks(peaks.size, _PRESSURES):
        log_half, causes = np.log(contact.half_width[block]), contact.causes.values[block]
        peaks[block] = largest(contact.table.interval.read(log_half, series, causes), contact.exponent)
    return np.asarray(peaks / contact.scale[1])


def _responses(films: Films, field: int) -> dict[str, Array]:
    """Quantities of ``solver.names.RESPONSES`` of a field that the punch conducts; (case,) each."""
    j = 1 + field
    port = Compliance.of(films.gather(lambda c: c.tangents), field)
    uncharged = films.with_charges(np.zeros_like(films.charges)) if np.any(films.charges) else films
    values = (
        films.thickness * films.gather(lambda c: c.response[:, j]),
        uncharged.gather(lambda c: c.tangents[:, j, 0]),
        _short_circuit(uncharged, field),
        port.stroke,
        port.blocked_force,
        1 / films.gather(lambda c: c.at_fixed_contact[:, j, field]),
    )
    return dict(zip(RESPONSES[field], values, strict=True))


def _short_circuit(uncharged: Films, field: int) -> Array:
    """Charge per load [C/N or Wb/N] at zero potential, without the other charge; (case,)."""
    j, state = 1 + field, uncharged
    for _ in range(_SHORT_STEPS):
        potential = state.thickness * state.gather(lambda c: c.response[:, j])
        step = potential / state.gather(lambda c: c.tangents[:, j, j])
        charges = np.array(state.charges)
        charges[:, field] -= step
        state = state.with_charges(charges)
        if np.all(np.abs(step) <= _CHARGE_CLOSE * np.abs(charges[:, field])):
            break
    return np.asarray(state.charges[:, field] / state.load)


def peaks(films: Films, requested: Set[str], tables: PeakTables | None = None) -> dict[str, Array]:
    """Requested quantities of ``solver.names.FILM_PEAKS`` in the regions that the film has; (case,) each."""
    regions = [region for region in regions_of(films.kind.stack) if requested & set(PEAKS_OF[region])]
    if not regions:
        return {}
    parts = [
        (cases, {name: peak for region in regions for name, peak in table.peaks(half, causes, region).items()})
        for cases, table, half, causes in tables or _peak_tables(films)
    ]
    return {name: values for name, values in joined(parts, films.load.size).items() if name in requested}


def curves(films: Films, regions: Sequence[str], tables: PeakTables | None = None) -> dict[str, Array]:
    """Sizes of the contacts, and the curves (``solver.curves``) of regions that the film has; (case, ...) each."""
    films.require_one_length()
    parts = []
    for cases, table, half_width, causes in tables or _peak_tables(films):
        load, thickness = films.load[cases], films.thickness[cases]
        half_length = thickness * half_width
        out = {"mean_pressure": load / (2 * half_length), "half_length": half_length}
        out["load_over_thickness"] = load / thickness
        for region in regions:
            if region in regions_of(films.kind.stack):
                out |= table.curves(half_width, causes, region)
        parts.append((cases, out))
    return joined(parts, films.load.size)


def _peak_tables(films: Films) -> PeakTables:
    """Yield the cases of each window with its table of stresses."""
    for cases, number, contact in films.parts:
        require_depth(contact.half_width / films.kind.stack.thickness, "half-length")
        table = peak_window(films.kind, number)
        contact = replace(contact, table=table.table)
        yield cases, table, contact.half_width, contact.causes.values
