"""Every quantity of point contacts with air beside them by its name (points, 6)."""

from collections.abc import Iterator, Set
from dataclasses import dataclass, replace

import numpy as np

from solver.arrays import Array
from solver.cache import cached
from solver.gap.airpoint import AirPoint, PointState
from solver.gap.grid import peak_of_panels
from solver.gap.pointtractions import AirPointTractions, SolvedPoint
from solver.gap.refusal import lacking_at_point, require
from solver.gap.ringoperators import WITHIN, RingOperators, RingsByRadius, RingsOnHalfSpace, RingWindows
from solver.gap.rings import reach_of, rings
from solver.gap.slidingpoint import SlidingPoint, largest_beside, largest_within, trailing_tension, warn_of_charges
from solver.halfplane.potentials import POTENTIALS
from solver.halfplane.pressing import ContactError
from solver.line.windows import FIRST, LAST
from solver.material.constants import VACUUM_PERMEABILITY, VACUUM_PERMITTIVITY
from solver.point.body import Film, HalfSpace
from solver.point.contact import PointContact, Pressed
from solver.point.friction import Rim, require_thin
from solver.point.inside import Inside
from solver.point.kernel import shear_kernel
from solver.point.peaks import peaks_of
from solver.point.profile import SAMPLES, Shape, climbed, finite
from solver.point.quantities import RESPONSES
from solver.twoport import Stiffness

_REACH = "reach"  # among the quantities of a case: of the gap's field


@cached
def _on_half_space(
    compliance: tuple[float, ...], fields: tuple[int, ...], shape: Shape, reach: float
) -> RingsOnHalfSpace:
    return RingsOnHalfSpace(RingOperators(rings(reach), fields, np.reshape(compliance, (3, 3)), shape))


def quantities(pressed: Pressed, permittivity: Array, end: Array, rim: Rim | None = None) -> dict[str, Array]:
    """Quantities of ``solver.names``, those of a point without air and those that only a gap has; (case,) each.

    Edge intensities are absent: those of fields that the air carries do not exist. With friction to the first order.
    """
    if rim is not None and isinstance(pressed.body, Film):
        require_thin(pressed.body.kind.film.stack())
    ratio = pressed.charged.radius / pressed.length
    # those of like radius share tables
    by_radius = sorted(_cases(pressed, permittivity, end), key=lambda pair: float(ratio[pair[0].place]))
    cases = [_of_case(case, contacts, rim) for case, contacts in by_radius]
    warn_of_charges(max(case.pop(_REACH, 0.0) for case in cases))
    names = [name for name in cases[0] if all(name in case for case in cases)]
    back = np.argsort([case.place for case, _ in by_radius])
    return {name: np.array([case[name] for case in cases])[back] for name in names}


def solved(pressed: Pressed, permittivity: Array, end: Array) -> Iterator[tuple["Case", PointState, RingOperators]]:
    """Yield every case with its solution and operators; arguments and refusals of :func:`quantities`."""
    for case, contacts in _cases(pressed, permittivity, end):
        state = case.charged(contacts)
        yield case, state, case.operators(state.radius).exact


class Case:
    """One case of a body: its units, and its contacts under any charges or potentials."""

    def __init__(
        self, pressed: Pressed, windows: RingWindows | None, place: int, fields: tuple[int, ...],
        permittivity: float, end: float, reach: float,
    ) -> None:  # fmt: skip
        body = pressed.body
        self.body, self.fields, self._pressed, self.place = body, fields, pressed, place
        self._windows = windows
        self.units = pressed.units[place]
        self.layered = isinstance(body, Film)
        self.length = float(body.thickness[place]) if isinstance(body, Film) else 1.0
        e = body.shape.exponent
        self._coefficient = float(pressed.coefficient[place] / self.units[0] * self.length ** (e - 1))
        self._force = float(pressed.force[place] * self.units[0] / self.length**2)
        vacuum = np.array([VACUUM_PERMITTIVITY * permittivity, VACUUM_PERMEABILITY])
        self.permittivity = vacuum
        self._media = (vacuum * self.units[1:] ** 2 / self.units[0])[list(fields)]
        self._end, self._reach = end / self.length, reach

    @property
    def charge_units(self) -> Array:
        """Units of the charges of the fields [C, Wb]; (field,)."""
        return np.asarray(self.length**2 / self.units[[1 + f for f in self.fields]])

    def charged(self, contacts: dict[str, PointContact]) -> PointState:
        """With its own charges."""
        start = contacts["charged"]
        return self.state(start.pressed.charges[self.place], False, float(start.radius[self.place]))

    def slid(self, state: PointState) -> SlidingPoint | None:
        """First order of a solution in friction; None if the case has no friction."""
        friction = self._pressed.friction
        if friction is None:
            return None
        layers = shear_kernel(self.body.kind.film.stack()) if isinstance(self.body, Film) else None
        on = SolvedPoint(state, self.operators(state.radius).exact)
        return SlidingPoint(on, float(friction.coefficient[self.place]), friction.coupling[self.place], layers)

    def state(self, charges: Array, held: bool, start: float, near: PointState | None = None) -> PointState:
        """With charges [C, Wb], or with all potentials at zero, from a radius [m] or from another state on.

        charges: (2,), C and Wb.
        """
        prescribed = np.zeros(len(self.fields)) if held else charges[list(self.fields)] / self.charge_units
        radius, begin = (start / self.length, None) if near is None else (near.radius, near.unknowns)
        problem = AirPoint(self.operators(radius), self._coefficient, self._force, prescribed,
                           (held,) * len(self.fields), self._media, self._end, radius, begin)  # fmt: skip
        if result := problem.within:
            return result
        for _ in range(LAST - FIRST):
            problem = replace(problem, operators=self.operators(radius, wide=True), start=radius, near=begin)
            state = problem.state
            if problem.operators.holds(np.log(state.radius)):
                break
            radius, begin = state.radius, state.unknowns
        return state

    def operators(self, ratio: float, *, wide: bool = False) -> RingsByRadius:
        """Operators near a radius, or over a wider range."""
        if self._windows is not None:
            return (self._windows.wide if wide else self._windows.narrow)(ratio, self._reach)
        assert isinstance(self.body, HalfSpace)
        compliance = tuple(self.body.compliance[self.place].ravel().tolist())
        return _on_half_space(compliance, self.fields, self.body.shape, self._reach)


def _cases(pressed: Pressed, permittivity: Array, end: Array) -> Iterator[tuple[Case, dict[str, PointContact]]]:
    conducts, body, windows = np.broadcast_to(pressed.conducts, (pressed.force.size, 2)), pressed.body, None
    require(lacking_at_point(body, conducts))
    contacts = {"charged": pressed.charged, "uncharged": pressed.uncharged, "grounded": pressed.grounded}
    if isinstance(body, Film):
        radii = np.concatenate([contact.radius / body.thickness for contact in contacts.values()])
        windows = RingWindows.of(body.kind, radii)
    for place in range(pressed.force.size):
        fields = tuple(np.flatnonzero(conducts[place]).tolist())
        reach = reach_of(min(float(contact.radius[place]) for contact in contacts.values()), float(end[place]))
        yield Case(pressed, windows, place, fields, float(permittivity[place]), float(end[place]), reach), contacts


def _of_case(case: Case, contacts: dict[str, PointContact], rim: Rim | None) -> dict[str, float]:
    place, nothing = case.place, np.zeros(2)
    charges = contacts["charged"].pressed.charges[place]
    state = case.charged(contacts)
    idle = state if not np.any(charges) else case.state(nothing, False, float(contacts["uncharged"].radius[place]))
    short = case.state(nothing, True, float(contacts["grounded"].radius[place]), idle)
    port, size = Stiffness.of(_compliance(case, state)), state.size / state.radius
    out = {
        "contact_radius": case.length * state.radius,
        "depth": -float(state.displacement[0] * state.size) * case.length * float(case.units[0]),
        "contact_stiffness": float(port.closed),
        "contact_stiffness_open": float(port.open),
    }
    bounded, slid = finite(state.problem.shape), case.slid(state)
    if bounded:
        out["peak_pressure"] = largest_within(slid, None, _peak_pressure(state)) * size / float(case.units[0])
    if slid is not None:
        out |= {"contact_offset": slid.shift * out["contact_radius"], _REACH: slid.reach}
        if rim is not None:
            out["trailing_tension"] = trailing_tension(slid, rim.part(case.place), case.body, case.units)
    fixed = np.linalg.inv(state.at_fixed_contact)
    for row, field in enumerate(case.fields):
        j, unit = 1 + row, float(case.units[1 + field])
        values = (
            float(state.displacement[j] * state.size) * case.length * unit,
            -float(_compliance(case, idle)[j, 0]),
            float(short.loads[j] / short.loads[0] * case.units[0] / unit),
            float(port.stroke(j)),
            float(port.blocked_force(j)),
            float(fixed[row, row]) * case.length / unit**2,
        )
        out |= dict(zip(RESPONSES[field], values, strict=True))
        if field == 0:
            density, gap = size / unit, largest_beside(state, slid, row, gap=True)
            out |= {
                "capacitance_at_force": float(port.capacitance(j)),
                "gap_field": gap * density / float(case.permittivity[0]),
            }
            if bounded:
                within = largest_within(slid, field, _peak_within(state, row))
                out["peak_displacement"] = max(within, largest_beside(state, slid, row, gap=False)) * density
    return out


def _compliance(case: Case, state: PointState) -> Array:
    """-d (-depth, V, Psi) / d (P, T, J) of the channels, SI; (channel, channel)."""
    units = case.units[[0, *(1 + f for f in case.fields)]]
    return np.asarray(-state.flexibility * units[:, None] * units / case.length)


def _peak_pressure(state: PointState) -> float:
    """Largest pressure over C a^(e-1)."""
    samples = state.inside[: SAMPLES.size]
    positions, values = np.concatenate([-SAMPLES[::-1], SAMPLES]), np.concatenate([-samples[::-1], samples])
    series = np.polynomial.chebyshev.chebfit(positions, values, 2 * SAMPLES.size - 1)
    best = int(np.argmax(samples))
    if best == SAMPLES.size - 1:
        return float(samples[best])
    return float(climbed(lambda x, _: np.asarray(np.polynomial.chebyshev.chebval(x, series)), np.array([best]))[0])


def _peak_within(state: PointState, row: int) -> float:
    first, count = SAMPLES.size, (state.inside.size - SAMPLES.size) // len(state.problem.rows.fields)
    densities = state.inside[first + row * count : first + (row + 1) * count]
    return max(peak_of_panels(densities[:-1].reshape(-1, WITHIN)), abs(float(densities[-1])))


_FIELDS = ("contact_pressure", "electric_displacement", "magnetic_induction")


@dataclass(frozen=True, eq=False)
class _FieldCase:
    """One case: surface tractions, units, contact radius and the unit of its body's lengths [m]."""

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
    cases = _solved_cases(pressed, permittivity, end)
    result = np.stack([case.at_rest.surface_tractions(positions) / case.units[:, None] for _, case in cases])
    result[:, 0] = 0.0 - result[:, 0]
    return {name: result[:, number] for number, name in enumerate(_FIELDS)}


def inside(
    pressed: Pressed, permittivity: Array, end: Array, body: Inside, x: Array, y: Array, names: tuple[str, ...]
) -> Array:
    """Fields of ``solver.halfplane.interior.LINEAR`` and potentials, SI, NaN in a rigid base; (case, field, y, x)."""
    out = np.empty((pressed.force.size, len(names), y.size, x.size))
    potentials = [number for number, name in enumerate(names) if name in POTENTIALS]
    for place, case in _solved_cases(pressed, permittivity, end):
        out[place] = body.fields(case.tractions, x, y, names)[0]
        out[place, potentials] *= case.length
    return out


def peaks(pressed: Pressed, permittivity: Array, end: Array, body: Inside, names: Set[str]) -> dict[str, Array]:
    """Quantities of ``solver.names.PEAKS`` or ``FILM_PEAKS`` that are asked for and the cases have; (case,) each."""
    result = [
        peaks_of(body, case.tractions, np.array([case.radius]), names)
        for _, case in _solved_cases(pressed, permittivity, end)
    ]
    return {name: np.concatenate([part[name] for part in result]) for name in result[0]}


def _solved_cases(pressed: Pressed, permittivity: Array, end: Array) -> Iterator[tuple[int, _FieldCase]]:
    for case, state, operators in solved(pressed, permittivity, end):
        radius = state.radius * case.length
        length = case.length if case.layered else radius
        yield case.place, _FieldCase(SolvedPoint(state, operators), case.slid(state), case.units, radius, length)
