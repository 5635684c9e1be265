"""Fields of point contacts with air beside them, on the surface and inside, case by case; their peaks (points, 7)."""

from collections.abc import Iterator, Set
from dataclasses import dataclass

import numpy as np

from solver.arrays import Array
from solver.gap.pointquantities import solved
from solver.gap.pointtractions import AirPointTractions, SolvedPoint
from solver.gap.slidingpoint import SlidingPoint
from solver.halfplane.potentials import POTENTIALS
from solver.halfplane.pressing import ContactError
from solver.point.contact import Pressed
from solver.point.inside import Inside
from solver.point.peaks import peaks_of
from solver.point.profile import finite

_FIELDS = ("contact_pressure", "electric_displacement", "magnetic_induction")


@dataclass(frozen=True, eq=False)
class _FieldCase:
    """One case: what lies on its surface, its units, its contact radius and the unit of its body's lengths [m]."""

    at_rest: SolvedPoint
    slid: SlidingPoint | None
    units: Array
    radius: float
    length: float

    @property
    def tractions(self) -> AirPointTractions:
        """On the whole surface, in the units of the body."""
        return (self.slid or self.at_rest).tractions(self.radius / self.length)


def fields(pressed: Pressed, permittivity: Array, end: Array, positions: Array) -> dict[str, Array]:
    """Tractions of ``solver.fields.POINT_FIELDS`` on the surface and beside the contact, SI; (case, position) each."""
    if not finite(pressed.body.shape) and np.any(positions == 0):
        raise ContactError(
            f"positions: the pressure of r^{pressed.body.shape.exponent:g} is infinite at 0; leave 0 out"
        )
    cases = _cases(pressed, permittivity, end)
    result = np.stack([case.at_rest.surface_tractions(positions) / case.units[:, None] for _, case in cases])
    result[:, 0] = 0.0 - result[:, 0]
    return {name: result[:, number] for number, name in enumerate(_FIELDS)}


def inside(
    pressed: Pressed, permittivity: Array, end: Array, body: Inside, x: Array, y: Array, names: tuple[str, ...]
) -> Array:
    """Fields of ``solver.halfplane.interior.LINEAR`` and potentials, SI, NaN in a rigid base; (case, field, y, x)."""
    out = np.empty((pressed.force.size, len(names), y.size, x.size))
    potentials = [number for number, name in enumerate(names) if name in POTENTIALS]
    for place, case in _cases(pressed, permittivity, end):
        out[place] = body.fields(case.tractions, x, y, names)[0]
        out[place, potentials] *= case.length
    return out


def peaks(pressed: Pressed, permittivity: Array, end: Array, body: Inside, quantities: Set[str]) -> dict[str, Array]:
    """Quantities of ``solver.names.PEAKS`` or ``FILM_PEAKS`` that are asked for and the cases have; (case,) each."""
    result = [
        peaks_of(body, case.tractions, np.array([case.radius]), quantities)
        for _, case in _cases(pressed, permittivity, end)
    ]
    return {name: np.concatenate([peaks[name] for peaks in result]) for name in result[0]}


def _cases(pressed: Pressed, permittivity: Array, end: Array) -> Iterator[tuple[int, _FieldCase]]:
    for case, state, operators in solved(pressed, permittivity, end):
        radius = state.radius * case.length
        length = case.length if case.layered else radius
        yield case.place, _FieldCase(SolvedPoint(state, operators), case.slid(state), case.units, radius, length)
