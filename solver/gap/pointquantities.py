"""Quantities, surface fields, fields inside and peaks of point contacts in air (points, 6)."""

from collections.abc import Iterator, Set
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, joined
from solver.cache import cached
from solver.gap.airpoint import PointStates
from solver.gap.grid import peak_of_panels
from solver.gap.newton import Frame, Settled, continued, settled, together
from solver.gap.pointtractions import AirPointTractions, SolvedPoint
from solver.gap.ringoperators import WITHIN, X_WITHIN, RingOperators, RingTable, crowded, ends_of, film_table
from solver.gap.rings import reach_of, rings
from solver.gap.slidingpoint import SlidingPoint, largest_exterior, largest_within, trailing_tension, warn_of_charges
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

_REACH = "reach"  # key of ``SlidingPoint.reach`` among the quantities
#: Cases that share a table, with their solutions.
_Group = tuple[Indices, Settled[PointStates]]


@cached
def _on_half_space(compliance: tuple[float, ...], fields: tuple[int, ...], shape: Shape, reach: float) -> RingTable:
    return RingTable(RingOperators(rings(reach), fields, np.reshape(compliance, (3, 3)), shape))


def quantities(pressed: Pressed, permittivity: Array, end: Array, rim: Rim | None = None) -> dict[str, Array]:
    """Quantities by the names of ``solver.names``, (case,) each; conductors in air have no edge intensities."""
    if rim is not None and isinstance(pressed.body, Film):
        require_thin(pressed.body.kind.film)
    points, count = AirPoints(pressed, permittivity, end), pressed.force.size
    charged, no_charges = points.solved(pressed.charged, pressed.charges), np.zeros((count, 2))
    uncharged = points.solved(pressed.uncharged, no_charges) if np.any(pressed.charges) else charged
    grounded = [group for groups in uncharged for group in points.grounded(*groups)]
    whole = joined([(cases, points.of_contacts(cases, result, rim)) for cases, result in charged], count)
    whole |= joined([(cases, points.of_uncharged(cases, result)) for cases, result in uncharged], count)
    whole |= joined([(cases, points.of_grounded(cases, result)) for cases, result in grounded], count)
    warn_of_charges(float(np.max(whole.pop(_REACH, no_charges))))
    return whole


@dataclass(frozen=True, eq=False)
class AirPoints:
    """Cases of a body, solved under any charges or at zero potentials."""

    pressed: Pressed
    permittivity: Array  # Relative permittivity of the gas in the gaps; (case,)
    end: Array  # Distance at which the gaps end [m]; (case,)

    @cached_property
    def length(self) -> Array:
        """Length of the body, the thickness of a film [m]; (case,)."""
        body, count = self.pressed.body, self.pressed.force.size
        return np.broadcast_to(body.thickness if isinstance(body, Film) else 1.0, (count,))

    @cached_property
    def medium(self) -> Array:
        """Permittivity and permeability of the gas in the gaps; (case, 2)."""
        return np.stack(np.broadcast_arrays(VACUUM_PERMITTIVITY * self.permittivity, VACUUM_PERMEABILITY), 1)

    @property
    def _airless_radii(self) -> Array:
        """Radii of the contacts without air, with charges, without and at zero potentials [m]; (3, case)."""
        return np.stack([self.pressed.charged.radius, self.pressed.uncharged.radius, self.pressed.grounded.radius])

    @cached_property
    def _reaches(self) -> Array:
        narrowest = np.min(self._airless_radii, 0).tolist()
        return np.array([reach_of(*pair) for pair in zip(narrowest, self.end.tolist(), strict=True)])

    @cached_property
    def _crowded(self) -> set[int]:
        return crowded((self._airless_radii / self.length).ravel())

    def _table(self, case: int, ratio: float, *, wide: bool = False) -> RingTable:
        """Operators of a case near a ratio of radius to length, or over a wider range."""
        body, reach = self.pressed.body, float(self._reaches[case])
        if isinstance(body, Film):
            wide = wide or int(number_of(np.array([ratio]))[0]) in self._crowded
            return film_table(body.kind, reach, ends_of(ratio, wide=wide))
        conducts = np.broadcast_to(self.pressed.conducts, self.pressed.charges.shape)[case]
        fields = tuple(np.flatnonzero(conducts).tolist())
        return _on_half_space(tuple(body.compliance[case].ravel().tolist()), fields, body.shape, reach)

    def _states(self, cases: Indices, table: RingTable, radius: Array, charges: Array | None) -> PointStates:
        """Contacts without air under charges (case, 2) [C, Wb], or at zero potentials if None."""
        length, units = self.length[cases], self.pressed.units[cases]
        layout, fields, e = table.exact.layout, list(table.exact.fields), table.exact.shape.exponent
        unknowns = np.zeros((cases.size, layout.columns))  # log a takes the place of the profile g
        unknowns[:, 0] = np.log(radius)
        field_units = units[:, [1 + f for f in fields]]
        prescribed = np.zeros_like(field_units)
        if charges is not None:
            prescribed = charges[cases][:, fields] * field_units / length[:, None] ** 2
        outputs, distance = table.outputs.solving, table.exact.rings.grid.distance
        frame = Frame(outputs, layout.edges.stop, table.exact.fields, distance, 1, 1, 2, "force", "r/a")
        return PointStates(
            frame, unknowns, (charges is None,) * len(fields), table,
            self.pressed.coefficient[cases] / units[:, 0] * length ** (e - 1),
            self.pressed.force[cases] * units[:, 0] / length**2, prescribed,
            self.medium[cases][:, fields] * field_units**2 / units[:, :1], self.end[cases] / length,
        )  # fmt: skip

    def solved(self, contact: PointContact, charges: Array) -> list[_Group]:
        """Solutions under ``charges`` (case, 2) [C, Wb], from contacts without air."""
        ratio, groups = contact.radius / self.length, list[_Group]()
        by_table: dict[int, tuple[RingTable, list[int]]] = {}
        for case in np.argsort(ratio, kind="stable").tolist():  # cases of similar radius share tables
            table = self._table(case, float(ratio[case]))
            by_table.setdefault(id(table), (table, []))[1].append(case)
        for table, members in by_table.values():
            count = together(self._states(np.array(members[:1]), table, ratio[members[:1]], charges))
            for start in range(0, len(members), count):
                cases = np.array(members[start : start + count])
                states = self._states(cases, table, ratio[cases], charges)
                result = settled(states, _parameters(states))
                groups += self._within_tables(cases, result, ratio[cases], charges)
        return groups

    def grounded(self, cases: Indices, uncharged: Settled[PointStates]) -> list[_Group]:
        """Solutions at zero potentials, continued from those without charges."""
        states = self._states(cases, uncharged.states.table, uncharged.states.radius, None)
        return self._within_tables(cases, continued(states, uncharged), uncharged.states.radius, None)

    def _within_tables(
        self, cases: Indices, result: Settled[PointStates], start: Array, charges: Array | None
    ) -> list[_Group]:
        """Solutions; cases that leave the range of their table are solved again by wider tables."""
        inside = result.valid & result.states.table.holds(result.states.unknowns[:, 0])
        groups = [(cases[inside], result.part(np.flatnonzero(inside)))] if np.any(inside) else []
        for number in np.flatnonzero(~inside).tolist():
            case, radius, solution = cases[[number]], start[[number]], None
            for _ in range(LAST - FIRST):
                table = self._table(int(case[0]), float(radius[0]), wide=True)
                states = self._states(case, table, radius, charges)
                solution = settled(states, _parameters(states)) if solution is None else continued(states, solution)
                radius = solution.require().states.radius
                if np.all(table.holds(np.log(radius))):
                    break
            assert solution is not None
            groups.append((case, solution))
        return groups

    # -- quantities ----------------------------------------------------------------------------------------------------
    def _units(self, cases: Indices, states: PointStates) -> Array:
        """Units of (y, phi, psi) of the channels; (case, channel)."""
        return self.pressed.units[cases][:, states.layout.channels]

    def _compliance(self, cases: Indices, result: Settled[PointStates]) -> Array:
        """Return -d (-depth, V, Psi) / d (P, T, J) of the channels, SI; (case, channel, channel)."""
        units = self._units(cases, result.states)
        return -result.tangents * units[..., None] * units[:, None] / self.length[cases][:, None, None]

    def of_uncharged(self, cases: Indices, result: Settled[PointStates]) -> dict[str, Array]:
        """Potentials per force; (case,) each."""
        compliance = self._compliance(cases, result)
        return {RESPONSES[field][1]: -compliance[:, 1 + row, 0] for row, field in enumerate(result.states.frame.fields)}

    def of_grounded(self, cases: Indices, result: Settled[PointStates]) -> dict[str, Array]:
        """Charges per force at zero potentials; (case,) each."""
        loads = result.states.loads / self._units(cases, result.states)
        per_force = loads / loads[:, :1]
        return {RESPONSES[field][2]: per_force[:, 1 + row] for row, field in enumerate(result.states.frame.fields)}

    def of_contacts(self, cases: Indices, result: Settled[PointStates], rim: Rim | None) -> dict[str, Array]:
        """Quantities of contacts with their charges; (case,) each."""
        states, units, length = result.states, self._units(cases, result.states), self.length[cases]
        port, displacement = Stiffness.of(self._compliance(cases, result)), states.response.values * units
        size, bounded = states.size / states.radius, finite(states.operators.shape)
        inside = states.table.outputs.reported.at(states.unknowns[:, 0]).times(states.columns[..., None])[0, ..., 0]
        sliding = [slid for pair in _solutions(cases, states) if (slid := self.slid(*pair))]
        out = {
            "contact_radius": length * states.radius,
            "depth": -displacement[:, 0] * length,
            "contact_stiffness": port.closed,
            "contact_stiffness_open": port.open,
        }
        if bounded:
            out["peak_pressure"] = largest_within(sliding, None, _peak_pressure(inside)) * size / units[:, 0]
        if sliding:
            out["contact_offset"] = np.array([solution.shift for solution in sliding]) * out["contact_radius"]
            out[_REACH] = np.array([solution.reach for solution in sliding])
            if rim is not None:
                out["trailing_tension"] = np.array([
                    trailing_tension(solution, rim.part(case), self.pressed.body, self.pressed.units[case])
                    for case, solution in zip(cases.tolist(), sliding, strict=True)
                ])  # fmt: skip
        fixed = np.linalg.inv(result.at_fixed_contact[:, 1:])
        for row, field in enumerate(states.frame.fields):
            j, names, density = 1 + row, RESPONSES[field], size / units[:, 1 + row]
            out[names[0]] = displacement[:, j] * length
            out[names[3]], out[names[4]] = port.stroke(j), port.blocked_force(j)
            out[names[5]] = fixed[:, row, row] * length / units[:, j] ** 2
            if field == 0:
                out["capacitance_at_force"] = port.capacitance(j)
                out["gap_field"] = largest_exterior(states, sliding, row, gap=True) * density / self.medium[cases, 0]
                if bounded:
                    within = largest_within(sliding, field, _peak_within(inside, row))
                    exterior = largest_exterior(states, sliding, row, gap=False)
                    out["peak_displacement"] = np.maximum(within, exterior) * density
        return out

    def slid(self, case: int, solution: SolvedPoint) -> SlidingPoint | None:
        """First-order change of a solution by friction; None if the cases have no friction."""
        friction, body = self.pressed.friction, self.pressed.body
        if friction is None:
            return None
        layers = shear_kernel(body.kind.film) if isinstance(body, Film) else None
        return SlidingPoint(solution, float(friction.coefficient[case]), friction.coupling[case], layers)

    # -- fields --------------------------------------------------------------------------------------------------------
    def solutions(self) -> Iterator[tuple[int, SolvedPoint]]:
        """Yield every case with its solution under its charges."""
        for cases, result in self.solved(self.pressed.charged, self.pressed.charges):
            yield from _solutions(cases, result.require().states)

    def tractions(self, case: int, solution: SolvedPoint) -> AirPointTractions:
        """Tractions on the whole surface, in the units of the body."""
        ratio = solution.radius if isinstance(self.pressed.body, Film) else 1.0
        return (self.slid(case, solution) or solution).tractions(ratio)

    def radius(self, case: int, solution: SolvedPoint) -> float:
        """Contact radius [m]."""
        return solution.radius * float(self.length[case])


def _solutions(cases: Indices, states: PointStates) -> Iterator[tuple[int, SolvedPoint]]:
    """Yield every case with its solution."""
    for row, case in enumerate(cases.tolist()):
        yield case, SolvedPoint.of(states, row)


def _parameters(states: PointStates) -> Array:
    """Parameters of :func:`settled`: logarithms of radius, profile, force, end and media, and charges per force."""
    force = states.force[:, None]
    logarithms = np.log(np.stack([states.coefficient, states.force, states.end], 1))
    return np.concatenate([states.unknowns[:, :1], logarithms, np.log(states.media), states.charges / force], 1)


def _peak_pressure(inside: Array) -> Array:
    """Largest pressures over C a^(e-1), from the outputs below the contact; (case,)."""
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
    """Largest densities below the contact of the conducted field number ``row``, over C a^(e-1); (case,)."""
    first = SAMPLES.size + row * X_WITHIN.size
    densities = inside[:, first : first + X_WITHIN.size]
    panels = densities[:, :-1].reshape(len(inside), -1, WITHIN)
    return np.maximum(peak_of_panels(panels), np.abs(densities[:, -1]))


_FIELDS = ("contact_pressure", "electric_displacement", "magnetic_induction")


def fields(pressed: Pressed, permittivity: Array, end: Array, positions: Array) -> dict[str, Array]:
    """Surface tractions by the names of ``solver.fields.POINT_FIELDS`` at r/a, SI; (case, position) each."""
    if not finite(pressed.body.shape) and np.any(positions == 0):
        raise ContactError(
            f"positions: the pressure of r^{pressed.body.shape.exponent:g} is infinite at 0; leave 0 out"
        )
    result = np.empty((pressed.force.size, 3, positions.size))
    for case, solution in AirPoints(pressed, permittivity, end).solutions():
        result[case] = solution.surface_tractions(positions) / pressed.units[case][:, None]
    result[:, 0] = 0.0 - result[:, 0]
    return {name: result[:, number] for number, name in enumerate(_FIELDS)}


def inside(
    pressed: Pressed, permittivity: Array, end: Array, body: Inside, x: Array, y: Array, names: tuple[str, ...]
) -> Array:
    """Fields of ``solver.halfplane.interior.LINEAR`` and potentials, SI, NaN in a rigid base; (case, field, y, x)."""
    out = np.empty((pressed.force.size, len(names), y.size, x.size))
    potentials = [number for number, name in enumerate(names) if name in POTENTIALS]
    points = AirPoints(pressed, permittivity, end)
    for case, solution in points.solutions():
        tractions = points.tractions(case, solution)
        out[case] = body.fields(tractions, x, y, names)[0]
        out[case, potentials] *= points.radius(case, solution) / tractions.ratio
    return out


def peaks(pressed: Pressed, permittivity: Array, end: Array, body: Inside, names: Set[str]) -> dict[str, Array]:
    """Requested quantities of ``solver.names.PEAKS`` or ``FILM_PEAKS`` that the cases have; (case,) each."""
    points = AirPoints(pressed, permittivity, end)
    parts = []
    for case, solution in points.solutions():
        radius = np.array([points.radius(case, solution)])
        parts.append((np.array([case]), peaks_of(body, points.tractions(case, solution), radius, names)))
    return joined(parts, pressed.force.size)
