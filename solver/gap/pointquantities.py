"""Every quantity of point contacts with air beside them by its name (points, 6)."""

from collections.abc import Iterator, Set
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, BoolArray, joined
from solver.cache import cached
from solver.gap.airpoint import PointStates
from solver.gap.grid import peak_of_panels
from solver.gap.newton import Frame, Settled, continued, settled, together
from solver.gap.pointtractions import AirPointTractions, SolvedPoint
from solver.gap.ringoperators import WITHIN, X_WITHIN, RingOperators, RingTable, crowded, ends_of, film_table
from solver.gap.rings import reach_of, rings
from solver.gap.slidingpoint import SlidingPoint, largest_beside, largest_within, trailing_tension, warn_of_charges
from solver.halfplane.interior import POTENTIALS
from solver.halfplane.pressing import ContactError
from solver.line.windows import FIRST, LAST, number_of
from solver.material.constants import VACUUM_PERMEABILITY, VACUUM_PERMITTIVITY
from solver.point.body import Film
from solver.point.contact import PointContact, Pressed
from solver.point.friction import Rim, require_thin
from solver.point.inside import Inside
from solver.point.kernel import shear_kernel
from solver.point.peaks import peaks_of
from solver.point.profile import SAMPLES, Shape, finite, highest_pressure
from solver.point.quantities import RESPONSES
from solver.twoport import Stiffness

_REACH = "reach"  # among the quantities of a case: of the gap's field
#: Cases that share a table, with their solutions.
_Group = tuple[Indices, Settled[PointStates]]


@cached
def _on_half_space(compliance: tuple[float, ...], fields: tuple[int, ...], shape: Shape, reach: float) -> RingTable:
    return RingTable(RingOperators(rings(reach), fields, np.reshape(compliance, (3, 3)), shape))


def quantities(pressed: Pressed, permittivity: Array, end: Array, rim: Rim | None = None) -> dict[str, Array]:
    """Quantities of ``solver.names``, those of a point without air and those that only a gap has; (case,) each.

    Edge intensities are absent: those of fields that the air carries do not exist. With friction to the first order.
    """
    if rim is not None and isinstance(pressed.body, Film):
        require_thin(pressed.body.kind.film)
    points, count = AirPoints(pressed, permittivity, end), pressed.force.size
    charged, nothing = points.solved(pressed.charged), np.zeros((count, 2))
    is_charged = bool(np.any(pressed.charged.pressed.charges))
    idle = points.solved(pressed.uncharged, nothing) if is_charged else charged
    parts = [(places, points.of_contacts(places, result, rim)) for places, result in charged]
    whole = joined(parts, count)
    whole |= joined([(places, points.of_uncharged(places, result)) for places, result in idle], count)
    whole |= joined(
        [(places, points.of_grounded(places, result)) for group in idle for places, result in points.grounded(*group)],
        count,
    )
    warn_of_charges(float(np.max(whole.pop(_REACH, nothing))))
    return whole


@dataclass(frozen=True, eq=False)
class AirPoints:
    """Cases of a body, solved under any charges or at zero potentials."""

    pressed: Pressed
    permittivity: Array  # Relative one of what fills the gaps; (case,)
    end: Array  # Where the gaps end [m]; (case,)

    @property
    def _conducts(self) -> BoolArray:
        return np.broadcast_to(self.pressed.conducts, (self.pressed.force.size, 2))

    @cached_property
    def length(self) -> Array:
        """Length of the body, the thickness of a film [m]; (case,)."""
        body, count = self.pressed.body, self.pressed.force.size
        return np.broadcast_to(body.thickness if isinstance(body, Film) else 1.0, (count,))

    @cached_property
    def medium(self) -> Array:
        """Permittivity and permeability of what fills the gaps; (case, 2)."""
        return np.stack(np.broadcast_arrays(VACUUM_PERMITTIVITY * self.permittivity, VACUUM_PERMEABILITY), 1)

    @cached_property
    def _reaches(self) -> Array:
        contacts = self.pressed.charged, self.pressed.uncharged, self.pressed.grounded
        radii = np.min([contact.radius for contact in contacts], 0)
        return np.array([reach_of(*pair) for pair in zip(radii.tolist(), self.end.tolist(), strict=True)])

    @cached_property
    def _crowded(self) -> set[int]:
        contacts = self.pressed.charged, self.pressed.uncharged, self.pressed.grounded
        return crowded(np.concatenate([contact.radius / self.length for contact in contacts]))

    def _table(self, place: int, ratio: float, *, wide: bool = False) -> RingTable:
        """Operators of a case near a radius, or over a wider range."""
        body, reach = self.pressed.body, float(self._reaches[place])
        if isinstance(body, Film):
            wide = wide or int(number_of(np.array([ratio]))[0]) in self._crowded
            return film_table(body.kind, reach, ends_of(ratio, wide=wide))
        fields = tuple(np.flatnonzero(self._conducts[place]).tolist())
        return _on_half_space(tuple(body.compliance[place].ravel().tolist()), fields, body.shape, reach)

    def _states(self, places: Indices, table: RingTable, radius: Array, charges: Array | None) -> PointStates:
        """Contacts without air; charges (case, 2) [C, Wb], None: those that make the potentials zero."""
        length, units = self.length[places], self.pressed.units[places]
        fields, e = list(table.exact.fields), table.exact.shape.exponent
        unknowns = np.zeros((places.size, 1 + len(fields) + 1 + len(fields) * table.exact.rows.nodes))
        unknowns[:, 0] = np.log(radius)
        of_fields = units[:, [1 + f for f in fields]]
        prescribed = np.zeros_like(of_fields)
        if charges is not None:
            prescribed = charges[places][:, fields] * of_fields / length[:, None] ** 2
        rows = table.exact.rows
        outputs, distance = table.outputs.solving, table.exact.rings.grid.distance
        frame = Frame(outputs, rows.edges.stop, table.exact.fields, distance, 1, 1, 2, "force", "r/a")
        return PointStates(
            frame, unknowns, (charges is None,) * len(fields), table,
            self.pressed.coefficient[places] / units[:, 0] * length ** (e - 1),
            self.pressed.force[places] * units[:, 0] / length**2, prescribed,
            self.medium[places][:, fields] * of_fields**2 / units[:, :1], self.end[places] / length,
        )  # fmt: skip

    def solved(self, contact: PointContact, charges: Array | None = None) -> list[_Group]:
        """Solutions with charges [C, Wb], from contacts without air on; by default with the charges of these."""
        charges = contact.pressed.charges if charges is None else charges
        ratio, groups = contact.radius / self.length, list[_Group]()
        by_table: dict[int, tuple[RingTable, list[int]]] = {}
        for place in np.argsort(ratio, kind="stable").tolist():  # those of like radius share tables
            table = self._table(place, float(ratio[place]))
            by_table.setdefault(id(table), (table, []))[1].append(place)
        for table, alike in by_table.values():
            count = together(self._states(np.array(alike[:1]), table, ratio[alike[:1]], charges))
            for start in range(0, len(alike), count):
                places = np.array(alike[start : start + count])
                states = self._states(places, table, ratio[places], charges)
                result = settled(states, _parameters(states))
                groups += self._within(places, result, ratio[places], charges)
        return groups

    def grounded(self, places: Indices, idle: Settled[PointStates]) -> list[_Group]:
        """Solutions at zero potentials, from those without charges on."""
        states = self._states(places, idle.states.table, idle.states.radius, None)
        return self._within(places, continued(states, idle), idle.states.radius, None)

    def _within(
        self, places: Indices, result: Settled[PointStates], start: Array, charges: Array | None
    ) -> list[_Group]:
        """Solutions, those that leave the range of their table solved again by wider ones."""
        inside = result.valid & result.states.table.holds(result.states.unknowns[:, 0])
        groups = [(places[inside], result.part(np.flatnonzero(inside)))] if np.any(inside) else []
        for case in np.flatnonzero(~inside).tolist():
            alone, radius, again = places[[case]], start[[case]], None
            for _ in range(LAST - FIRST):
                table = self._table(int(alone[0]), float(radius[0]), wide=True)
                states = self._states(alone, table, radius, charges)
                again = (settled(states, _parameters(states)) if again is None else continued(states, again)).require()
                radius = again.states.radius
                if np.all(table.holds(np.log(radius))):
                    break
            assert again is not None
            groups.append((alone, again))
        return groups

    # -- quantities ----------------------------------------------------------------------------------------------------
    def _units(self, places: Indices, states: PointStates) -> Array:
        """Units of (y, phi, psi) of the channels; (case, channel)."""
        return self.pressed.units[places][:, states.layout.channels]

    def _compliance(self, places: Indices, result: Settled[PointStates]) -> Array:
        """-d (-depth, V, Psi) / d (P, T, J) of the channels, SI; (case, channel, channel)."""
        units = self._units(places, result.states)
        return -result.tangents * units[..., None] * units[:, None] / self.length[places][:, None, None]

    def of_uncharged(self, places: Indices, result: Settled[PointStates]) -> dict[str, Array]:
        """Potentials per force; (case,) each."""
        compliance = self._compliance(places, result)
        return {RESPONSES[field][1]: -compliance[:, 1 + row, 0] for row, field in enumerate(result.states.frame.fields)}

    def of_grounded(self, places: Indices, result: Settled[PointStates]) -> dict[str, Array]:
        """Charges per force; (case,) each."""
        loads = result.states.loads / self._units(places, result.states)
        share = loads / loads[:, :1]
        return {RESPONSES[field][2]: share[:, 1 + row] for row, field in enumerate(result.states.frame.fields)}

    def of_contacts(self, places: Indices, result: Settled[PointStates], rim: Rim | None) -> dict[str, Array]:
        """Quantities of contacts with their charges; (case,) each."""
        states, units, length = result.states, self._units(places, result.states), self.length[places]
        port, displacement = Stiffness.of(self._compliance(places, result)), states.response.values * units
        size, bounded = states.size / states.radius, finite(states.operators.shape)
        inside = states.table.outputs.others.at(states.unknowns[:, 0]).times(states.columns[..., None])[0, ..., 0]
        slid = [self.slid(*pair) for pair in _solutions(places, states)]
        sliding = [solution for solution in slid if solution is not None]
        out = {
            "contact_radius": length * states.radius,
            "depth": -displacement[:, 0] * length,
            "contact_stiffness": port.closed,
            "contact_stiffness_open": port.open,
        }
        if bounded:
            out["peak_pressure"] = largest_within(slid, None, _peak_pressure(inside)) * size / units[:, 0]
        if sliding:
            out["contact_offset"] = np.array([solution.shift for solution in sliding]) * out["contact_radius"]
            out[_REACH] = np.array([solution.reach for solution in sliding])
            if rim is not None:
                out["trailing_tension"] = np.array([
                    trailing_tension(solution, rim.part(place), self.pressed.body, self.pressed.units[place])
                    for place, solution in zip(places.tolist(), sliding, strict=True)
                ])  # fmt: skip
        fixed = np.linalg.inv(result.at_fixed_contact[:, 1:])
        for row, field in enumerate(states.frame.fields):
            j, names, density = 1 + row, RESPONSES[field], size / units[:, 1 + row]
            out[names[0]] = displacement[:, j] * length
            out[names[3]], out[names[4]] = port.stroke(j), port.blocked_force(j)
            out[names[5]] = fixed[:, row, row] * length / units[:, j] ** 2
            if field == 0:
                out["capacitance_at_force"] = port.capacitance(j)
                out["gap_field"] = largest_beside(states, slid, row, gap=True) * density / self.medium[places, 0]
                if bounded:
                    within = largest_within(slid, field, _peak_within(inside, row))
                    out["peak_displacement"] = (
                        np.maximum(within, largest_beside(states, slid, row, gap=False)) * density
                    )
        return out

    def slid(self, place: int, solution: SolvedPoint) -> SlidingPoint | None:
        """First order of a solution in friction; None if the cases have no friction."""
        friction, body = self.pressed.friction, self.pressed.body
        if friction is None:
            return None
        layers = shear_kernel(body.kind.film) if isinstance(body, Film) else None
        coefficient = float(friction.coefficient[place])
        return SlidingPoint(solution, coefficient, friction.coupling[place], layers)


def _solutions(places: Indices, states: PointStates) -> Iterator[tuple[int, SolvedPoint]]:
    """Yield the place of every case with its solution."""
    for case, place in enumerate(places.tolist()):
        yield place, SolvedPoint.of(states, case)


def _parameters(states: PointStates) -> Array:
    """Logarithms of what cases differ in; (case, parameter)."""
    force = states.force[:, None]
    logarithms = np.log(np.stack([states.coefficient, states.force, states.end], 1))
    return np.concatenate([states.unknowns[:, :1], logarithms, np.log(states.media), states.charges / force], 1)


def _peak_pressure(inside: Array) -> Array:
    """Largest pressures over C a^(e-1), from the rows below the contact; (case,)."""
    samples = inside[:, : SAMPLES.size]
    series = _odd_series() @ samples.T
    return highest_pressure(
        samples, lambda x, case: np.asarray(np.polynomial.chebyshev.chebval(x, series[:, case], tensor=False))
    )


@cache
def _odd_series() -> Array:
    """Matrix from values at ``SAMPLES`` to the Chebyshev series of the odd polynomial through them."""
    positions = np.concatenate([-SAMPLES[::-1], SAMPLES])
    inverse = np.linalg.inv(np.polynomial.chebyshev.chebvander(positions, positions.size - 1))
    return inverse[:, SAMPLES.size :] - inverse[:, SAMPLES.size - 1 :: -1]


def _peak_within(inside: Array, row: int) -> Array:
    """Largest densities of a field below the contact, over C a^(e-1); (case,)."""
    first = SAMPLES.size + row * X_WITHIN.size
    densities = inside[:, first : first + X_WITHIN.size]
    panels = densities[:, :-1].reshape(len(inside), -1, WITHIN)
    return np.maximum(peak_of_panels(panels), np.abs(densities[:, -1]))


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
    result = np.empty((pressed.force.size, 3, positions.size))
    for place, case in cases:
        result[place] = case.at_rest.surface_tractions(positions) / case.units[:, None]
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
    parts = [
        (np.array([place]), peaks_of(body, case.tractions, np.array([case.radius]), names))
        for place, case in _solved_cases(pressed, permittivity, end)
    ]
    return joined(parts, pressed.force.size)


def _solved_cases(pressed: Pressed, permittivity: Array, end: Array) -> Iterator[tuple[int, _FieldCase]]:
    points = AirPoints(pressed, permittivity, end)
    for places, result in points.solved(pressed.charged):
        for place, solution in _solutions(places, result.require().states):
            radius = solution.radius * float(points.length[place])
            length = float(points.length[place]) if isinstance(pressed.body, Film) else radius
            slid = points.slid(place, solution)
            yield place, _FieldCase(solution, slid, pressed.units[place], radius, length)
