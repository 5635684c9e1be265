"""Cases of point contacts on films, by the film and what the punch is: the tables that they share."""

from functools import cached_property

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, distinct_rows
from solver.face.electrodes import electroded, reading_of
from solver.face.filmbodies import Bodies, films_of, refuse_charge
from solver.face.point import OnPoints
from solver.face.punches import punch_of
from solver.line.windows import Kind
from solver.point.body import Film
from solver.point.contact import Friction, Pressed
from solver.point.electrodes import electrode_quantities
from solver.point.friction import Rim, contact_coupling
from solver.point.inside import Inside
from solver.point.table import PointKind
from solver.stack.electroded import surface
from solver.stack.layers import Stack


class OnPointFilm(OnPoints):
    """Points on films; all cases of one film and conduction share the same tables."""

    def quantities(self) -> dict[str, Array]:
        """Quantities of a half-space, and the nominal field."""

        def solved(pressed: Pressed, places: Indices) -> dict[str, Array]:
            body, reading, collected = pressed.body, pressed.reading, dict[str, Array]()
            # first: a patch too far is refused before sliding is solved
            if isinstance(body, Film) and reading is not None:
                collected = electrode_quantities(pressed.charged, body, reading)
            return with_nominal_field(self._quantities(pressed, places), pressed) | collected

        return self._of_parts(solved)

    def _pressed(self) -> list[tuple[Indices, Pressed]]:
        bodies, conducts, elastic = self._bodies, self.cases.conducts, punch_of(self.cases)
        punches = conducts[..., 0], conducts[..., 1], elastic.compliance, elastic.coupling, electroded(self.cases)
        columns = [self._flat(column) for column in (*bodies.columns, *punches)]
        kinds, which = distinct_rows(np.stack(columns, -1))
        thickness, reading, pressed = self._flat(bodies.thickness), reading_of(self.cases), []
        for number, (*row, electric, magnetic, punch, coupling, covered) in enumerate(kinds.tolist()):
            film = Kind(*bodies.film(row), 0.0, (True, True), (True, True), 1, electroded=bool(covered))
            if metal := film.electroded or film.stack().conductors[0]:
                refuse_charge(self.cases)
            held = bool(electric) and not metal, bool(magnetic)
            for alike, shape, coefficient in self._by_exponent(np.flatnonzero(which == number)):
                kind = PointKind(film, held, shape, punch)
                body = Film(kind, thickness[alike])
                part_of_reading = None if reading is None else reading.part(alike)
                friction = self._rubbing(kind, alike, coupling)
                loads = self._loads(alike)
                pressed.append(
                    (alike, Pressed(body, kind.scale, coefficient, *loads, np.array(held), part_of_reading, friction))
                )
        return pressed

    def _rubbing(self, kind: PointKind, places: Indices, punch: float) -> Friction | None:
        """Friction of some cases; None where no factor gives it."""
        if "friction" not in self.cases.values:
            return None
        stack = kind.film.stack()
        k = -surface(stack)[0, 1:]
        coupling = contact_coupling(k, stack.scale, np.array(punch), np.array(kind.conducts))
        return Friction(self._friction[places], np.broadcast_to(coupling, (places.size, 3)), punch)

    @cached_property
    def _bodies(self) -> Bodies:
        return films_of(self.cases)

    @property
    def _lacks_c12(self) -> str | None:
        return self._bodies.lacks_c12

    def _rim(self, places: Indices) -> Rim | None:
        """Rim of the top of cases of one body; None below an electrode or without c12."""
        stack = next(_stack(pressed) for part, pressed in self._parts if part is places)
        is_known = self._lacks_c12 is None and not stack.electroded
        return Rim.of(stack.media[0].halfplane) if is_known else None

    def _within(self, places: Indices, pressed: Pressed) -> Inside:
        self._refuse_electroded("fields")
        return self._inside(places, pressed)

    def _inside(self, places: Indices, pressed: Pressed) -> Inside:
        return Inside(_stack(pressed))


def _stack(pressed: Pressed) -> Stack:
    """Stack of contacts on a film."""
    if not isinstance(pressed.body, Film):
        raise TypeError("a half-space is no stack")
    return pressed.body.kind.film.stack()


def with_nominal_field(out: dict[str, Array], pressed: Pressed) -> dict[str, Array]:
    """Quantities of a body, with the nominal field where it is a film."""
    body = pressed.body
    if isinstance(body, Film) and "voltage" in out:
        out["nominal_field"] = np.abs(out["voltage"]) / (body.thickness * body.kind.film.above_ground)
    return out
