"""Cases of point contacts: from their factors to punches on half-spaces and films, and to outputs by name."""

from abc import abstractmethod
from collections.abc import Callable, Collection, Sequence, Set
from functools import cached_property
from math import prod

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, column, distinct_rows, fields_by_name, outer
from solver.face.body import Body
from solver.face.cases import Cases
from solver.face.electrodes import reading_of
from solver.face.filmbodies import Bodies, films_of, refuse_charge
from solver.face.materials import half_plane_of, punch_of
from solver.face.refusal import CaseError, FactorError
from solver.fields import POINT_NEED_C12, POINT_SINGULAR
from solver.halfplane.interior import POTENTIALS
from solver.halfplane.precision import warn_of_rounding
from solver.halfplane.pressing import ContactError
from solver.halfplane.surface import HalfPlane
from solver.point.body import Film, HalfSpace
from solver.point.contact import Friction, Pressed
from solver.point.electrodes import electrode_quantities
from solver.point.friction import Rim, contact_coupling
from solver.point.inside import Inside, whole
from solver.point.peaks import peaks
from solver.point.profile import DISC, Shape
from solver.point.quantities import quantities, sliding_quantities
from solver.point.sliding import Rubbed, warn_of_order
from solver.point.state import conducted
from solver.point.surface import surface_fields
from solver.point.table import PointKind
from solver.stack.electroded import surface
from solver.stack.layers import Stack

#: Surface fields of sliding contacts, and the fields inside whose values at the surface they are.
SURFACE = {
    "contact_pressure": "stress_yy", "electric_displacement": "electric_displacement_y",
    "magnetic_induction": "magnetic_induction_y", "radial_stress": "stress_xx", "hoop_stress": "stress_zz",
}  # fmt: skip


class OnPoints(Body):
    """Contacts at points of half-spaces and films."""

    _need_c12 = POINT_NEED_C12
    _singular = POINT_SINGULAR

    def __init__(self, cases: Cases) -> None:
        super().__init__(cases)
        try:
            self._parts = self._pressed()
        except ContactError as error:
            raise CaseError(str(error)) from None

    @cached_property
    def _bodies(self) -> Bodies:
        """Films of the cases, where half-spaces are films of one material."""
        return films_of(self.cases)

    @abstractmethod
    def _pressed(self) -> list[tuple[Indices, Pressed]]:
        """Return the indices of cases that are solved together, and their contacts."""

    def quantities(self) -> dict[str, Array]:
        """Quantities of ``solver.names.POINT_QUANTITIES`` that every case has; (...)."""
        return self._of_parts(self._quantities)

    def _quantities(self, pressed: Pressed, index: Indices) -> dict[str, Array]:
        """Quantities of contacts, to the first order in friction; (case,) each."""
        out = quantities(pressed)
        if pressed.friction is not None:
            warn_of_order(pressed)
            out |= sliding_quantities(pressed, self._rim(index, pressed))
        return out

    @abstractmethod
    def _rim(self, index: Indices, pressed: Pressed) -> Rim | None:
        """Return the surface just outside the contacts, None if a c12 is missing."""

    def peaks(self, requested: Set[str]) -> dict[str, Array]:
        """Requested peaks of ``solver.names.PEAKS`` or ``FILM_PEAKS`` that every case has; (...)."""
        self._require_c12("largest stresses under a point need")
        self._refuse_electroded("fields")
        return self._of_parts(lambda pressed, index: self._peaks(pressed, index, requested), self._apart())

    def curves(self, regions: Sequence[str]) -> dict[str, Array]:
        """Refuse the request: peaks of points are searched for, not learnt from curves."""
        raise FactorError("curves: of a body under a point contact are not given; ask for peaks")

    def _surface(self, positions: Array, regular: bool) -> dict[str, Array]:
        values = self._of_parts(lambda pressed, index: surface_fields(pressed, positions, self._rim(index, pressed)))
        if np.any(self._friction):
            values |= self._slid(positions)
        return self._with_regular(values, positions) if regular else values

    def _slid(self, positions: Array, charged: Collection[str] = ()) -> dict[str, Array]:
        """Surface fields of sliding contacts, 0 outside except tractions in ``charged``; (..., position) each."""
        names = [name for name in SURFACE if self._lacks_c12 is None or SURFACE[name] not in POINT_NEED_C12]
        values = self._at_surface(positions, names)
        for name in names:
            if SURFACE[name] not in POINT_NEED_C12 and name not in charged:
                values[name] = np.where(np.abs(positions) < 1, values[name], 0.0)
        return values | {"contact_pressure": 0.0 - values["contact_pressure"]}

    def _at_surface(self, positions: Array, names: Collection[str]) -> dict[str, Array]:
        """Fields of ``SURFACE`` from the fields inside at the surface; (..., position) each."""
        inside = self.interior(positions, np.zeros(1), [SURFACE[name] for name in names])
        return {name: inside[SURFACE[name]][..., 0, :] for name in names}

    def _interior(self, x: Array, y: Array, names: tuple[str, ...]) -> dict[str, Array]:
        self._refuse_electroded("fields")
        return self._of_parts(
            lambda pressed, index: fields_by_name(names, self._fields(pressed, index, x, y, names)), self._apart()
        )

    # -- overridden for contacts in air --------------------------------------------------------------------------------
    def _peaks(self, pressed: Pressed, index: Indices, requested: Set[str]) -> dict[str, Array]:
        return peaks(pressed, self._inside(index, pressed), requested)

    def _fields(self, pressed: Pressed, index: Indices, x: Array, y: Array, names: tuple[str, ...]) -> Array:
        """Fields of ``LINEAR`` and potentials; (case, field, y, x)."""
        values = self._inside(index, pressed).fields(Rubbed(pressed.charged).tractions, x, y, names)
        potentials = [number for number, name in enumerate(names) if name in POTENTIALS]
        values[:, potentials] *= pressed.length[:, None, None, None]
        return values

    def _apart(self) -> list[tuple[Indices, Pressed]]:
        """Return indices and contacts of cases with one body each."""
        return self._parts

    @abstractmethod
    def _inside(self, index: Indices, pressed: Pressed) -> Inside:
        """Return the body that all indexed cases share."""

    def _of_parts(
        self,
        output: Callable[[Pressed, Indices], dict[str, Array]],
        parts: Sequence[tuple[Indices, Pressed]] | None = None,
    ) -> dict[str, Array]:
        """Join outputs of parts of the cases, by default those that are solved together."""
        return self._put_together((index, output(pressed, index)) for index, pressed in parts or self._parts)

    def _by_exponent(self, index: Indices) -> list[tuple[Indices, Shape, Array]]:
        """Group cases by the exponent of their profile, with its coefficient or the radius of a disc."""
        exponent, coefficient = self._profile()
        exponents = self._flat(exponent)[index]
        return [
            (group := index[exponents == e], Shape(e), self._flat(coefficient)[group])
            for e in np.unique(exponents).tolist()
        ]

    def _profile(self) -> tuple[Array, Array]:
        """Exponent of the profile that all cases share, and its coefficient or the radius of a disc; (...) each."""
        number = self.cases.number
        match self.cases.values["profile"].flat[0]:
            case "sphere":
                return np.array(2.0), 1 / (2 * number("radius"))
            case "cone":
                return np.array(1.0), number("slope")
            case "disc":
                return np.array(DISC), number("width") / 2
            case _:
                return number("exponent"), number("coefficient")

    @property
    def _friction(self) -> Array:
        return self._flat(self.cases.number("friction"))

    def _loads(self, index: Indices) -> tuple[Array, Array]:
        """Forces P (case,) [N] and charges T, J (case, 2) [C, Wb]."""
        return self._flat(self.cases.force)[index], self._flat(self.cases.charges, 2)[index]


class OnHalfSpace(OnPoints):
    """Contacts at points of half-spaces."""

    def _pressed(self) -> list[tuple[Indices, Pressed]]:
        warn_of_rounding(self._half.distinct)
        return self._of(np.arange(prod(self.shape)))

    def _apart(self) -> list[tuple[Indices, Pressed]]:
        which = self._flat(self._bodies.which)
        return [part for number in np.unique(which) for part in self._of(np.flatnonzero(which == number))]

    @cached_property
    def _half(self) -> HalfPlane:
        return half_plane_of(self.cases)

    @cached_property
    def _compliances(self) -> tuple[Array, Array, Array]:
        """N (case, 3, 3) and k (case, 3) of the contacts in their units, and the units (case, 4)."""
        half, punch, conducts = self._half, punch_of(self.cases), self.cases.conducts
        units = half.scale[..., 1:]
        N = half.compliance + column(punch.compliance) * np.diag([1.0, 0.0, 0.0])
        N = conducted(N / outer(units), conducts)
        k = contact_coupling(
            half.friction_coupling / (half.scale[..., :1] * units), half.scale, punch.coupling, conducts
        )
        return self._flat(N, 3, 3), self._flat(k, 3), self._flat(half.scale, 4)

    def _of(self, cases: Indices) -> list[tuple[Indices, Pressed]]:
        """Return indices and contacts of the indexed cases, those of one exponent together."""
        (N, k, units), conducts, parts = self._compliances, self._flat(self.cases.conducts, 2), []
        for index, shape, coefficient in self._by_exponent(cases):
            friction = Friction(self._friction[index], k[index]) if "friction" in self.cases.values else None
            body, loads = HalfSpace(N[index], shape), self._loads(index)
            parts.append((index, Pressed(body, units[index], coefficient, *loads, conducts[index], friction=friction)))
        return parts

    @property
    def _lacks_c12(self) -> str | None:
        material = self._half.material
        return material.name if np.any(np.isnan(material.c12)) else None

    @cached_property
    def _rims(self) -> Rim:
        """Surface just outside the contacts of all cases."""
        rim = Rim.of(self._half)
        stiffness, shear, *compliances = map(self._flat, (rim.stiffness, rim.shear, rim.tangential, rim.transverse))
        return Rim(self._flat(rim.coupling, 3), stiffness, shear, self._flat(rim.share, 3), *compliances)

    def _rim(self, index: Indices, pressed: Pressed) -> Rim | None:
        return self._rims.part(index) if self._lacks_c12 is None else None

    def _inside(self, index: Indices, pressed: Pressed) -> Inside:
        return whole(self._bodies.films[int(self._flat(self._bodies.which)[index[0]])].top.material)


class OnPointFilm(OnPoints):
    """Contacts at points of films; cases with one film and conduction share tables."""

    def quantities(self) -> dict[str, Array]:
        """Quantities of a half-space, the nominal field and quantities of electrodes; (...)."""

        def solved(pressed: Pressed, index: Indices) -> dict[str, Array]:
            body, reading, collected = pressed.body, pressed.reading, dict[str, Array]()
            # first, so that a patch too far away is refused before sliding is solved
            if isinstance(body, Film) and reading is not None:
                collected = electrode_quantities(pressed.charged, body, reading)
            return with_nominal_field(self._quantities(pressed, index), pressed) | collected

        return self._of_parts(solved)

    def _pressed(self) -> list[tuple[Indices, Pressed]]:
        bodies, conducts, elastic = self._bodies, self.cases.conducts, punch_of(self.cases)
        punches = conducts[..., 0], conducts[..., 1], elastic.compliance, elastic.coupling
        columns = [self._flat(column) for column in (bodies.which, *punches)]
        kinds, which = distinct_rows(np.stack(columns, -1))
        thickness, reading, pressed = self._flat(bodies.thickness), reading_of(self.cases), []
        for number, (body_number, electric, magnetic, punch, coupling) in enumerate(kinds.tolist()):
            film = bodies.films[int(body_number)]
            if metal := film.electroded or film.conductors[0]:
                refuse_charge(self.cases)
            conducting = bool(electric) and not metal, bool(magnetic)
            for group, shape, coefficient in self._by_exponent(np.flatnonzero(which == number)):
                kind = PointKind(film, conducting, shape, punch)
                contact = Pressed(
                    Film(kind, thickness[group]), kind.scale, coefficient, *self._loads(group), np.array(conducting),
                    None if reading is None else reading.part(group), self._friction_of(kind, group, coupling),
                )  # fmt: skip
                pressed.append((group, contact))
        return pressed

    def _friction_of(self, kind: PointKind, index: Indices, punch: float) -> Friction | None:
        """Return the friction of indexed cases, None without the factor."""
        if "friction" not in self.cases.values:
            return None
        stack = kind.film
        k = -surface(stack)[0, 1:]
        coupling = contact_coupling(k, stack.scale, np.array(punch), np.array(kind.conducts))
        return Friction(self._friction[index], np.broadcast_to(coupling, (index.size, 3)), punch)

    @property
    def _lacks_c12(self) -> str | None:
        return self._bodies.lacks_c12

    def _rim(self, index: Indices, pressed: Pressed) -> Rim | None:
        """Return the surface just outside the contacts, None under an electrode or without c12."""
        stack = _stack(pressed)
        is_known = self._lacks_c12 is None and not stack.electroded
        return Rim.of(stack.media[0].halfplane) if is_known else None

    def _inside(self, index: Indices, pressed: Pressed) -> Inside:
        return Inside(_stack(pressed))


def _stack(pressed: Pressed) -> Stack:
    """Return the stack of contacts on a film."""
    if not isinstance(pressed.body, Film):
        raise TypeError("a half-space is no stack")
    return pressed.body.kind.film


def with_nominal_field(out: dict[str, Array], pressed: Pressed) -> dict[str, Array]:
    """Return quantities of a body, with the nominal field of a film."""
    body = pressed.body
    if isinstance(body, Film) and "voltage" in out:
        out["nominal_field"] = np.abs(out["voltage"]) / (body.thickness * body.kind.film.above_ground)
    return out
