"""Cases of point contacts: from their factors to punches on half-spaces and films, and their outputs by name."""

from collections.abc import Callable, Sequence, Set
from dataclasses import fields
from functools import cached_property
from typing import Any

import numpy as np

from solver.arrays import Array, column
from solver.face.cases import Cases
from solver.face.electrodes import electroded, reading_of
from solver.face.filmbodies import Bodies, films_of, refuse_charge
from solver.face.materials import material_of
from solver.face.punches import punch_of
from solver.face.refusal import FactorError
from solver.film.powerlaw import material_from
from solver.film.stack import Stack
from solver.film.windows import Indices, Kind
from solver.halfplane.interior import LINEAR, principal_tension, von_mises
from solver.halfplane.potentials import POTENTIALS
from solver.halfplane.precision import warn_of_rounding
from solver.halfplane.pressing import ContactError
from solver.halfplane.surface import HalfPlane
from solver.material.constants import UNITS, MaterialError
from solver.names import INTERIOR, POINT_NEED_C12, POINT_SINGULAR
from solver.point.body import Film, HalfSpace, Stretch
from solver.point.electrodes import electrode_quantities
from solver.point.halfspace import conducted
from solver.point.inside import Inside, whole
from solver.point.peaks import peaks
from solver.point.pressed import Friction, Pressed
from solver.point.profile import DISC, Shape
from solver.point.quantities import quantities, sliding_quantities
from solver.point.sliding import Rim, Rubbed, contact_coupling, warn_of_order
from solver.point.surface import surface_fields
from solver.point.table import PointKind

#: Surface fields as fields inside, which have what friction adds.
SURFACE = {
    "contact_pressure": "stress_yy", "electric_displacement": "electric_displacement_y",
    "magnetic_induction": "magnetic_induction_y", "radial_stress": "stress_xx", "hoop_stress": "stress_zz",
}  # fmt: skip
STRESSES = LINEAR[:4]
DERIVED = {"von_mises": von_mises, "principal_tension": principal_tension}


class OnPoints:
    """What half-spaces and films under points have in common: their punches, and how outputs are put together."""

    #: A rigid base has no fields inside.
    hollow = True

    def __init__(self, cases: Cases) -> None:
        self.cases = cases
        self.shape = tuple(cases.sizes.values())
        try:
            self._parts = self._pressed()
        except ContactError as error:
            raise FactorError(str(error)) from None

    def _pressed(self) -> list[tuple[Indices, Pressed]]:
        raise NotImplementedError

    @np.errstate(all="ignore")  # what is not finite is named in the outputs
    def quantities(self) -> dict[str, Array]:
        """Those of ``solver.names.POINT_QUANTITIES`` that every case has; (...)."""
        return self.put_together(self._quantities)

    def _quantities(self, pressed: Pressed, places: Indices) -> dict[str, Array]:
        out = quantities(pressed)
        if pressed.friction is not None:
            warn_of_order(pressed)
            out |= sliding_quantities(pressed, self._rim(places))
        return out

    def _rim(self, places: Indices) -> Rim | None:
        """The surface beside the contacts; None where a c12 is missing."""
        raise NotImplementedError

    @np.errstate(all="ignore")
    def peaks(self, asked: Set[str]) -> dict[str, Array]:
        """Those of ``solver.names.PEAKS`` or ``FILM_PEAKS`` that are asked for and every case has; (...)."""
        if (lacks := self._lacks_c12) is not None:
            raise MaterialError(f"{lacks}: c12: missing; largest stresses under a point need it [Pa]")
        return self.put_together(
            lambda pressed, places: peaks(pressed, self._inside(places, pressed), asked), self._apart()
        )

    def curves(self, regions: Sequence[str]) -> dict[str, Array]:
        """Refused: peaks of points are searched for, not learned from curves."""
        raise FactorError("curves: of a body under a point contact are not given; ask for peaks")

    @np.errstate(all="ignore")
    def surface(self, positions: Array, *, regular: bool) -> dict[str, Array]:
        """Fields of ``solver.names.POINT_FIELDS`` at r/a that every case has, as those of a line; (..., position)."""
        found = self.put_together(lambda pressed, _: surface_fields(pressed, positions))
        if np.any(self._friction):
            inside = np.abs(positions) < 1
            names = [name for name in SURFACE if self._lacks_c12 is None or SURFACE[name] not in POINT_NEED_C12]
            slid = self.interior(positions, np.zeros(1), [SURFACE[name] for name in names])
            for name in names:
                values = slid[SURFACE[name]][..., 0, :]
                found[name] = values if SURFACE[name] in POINT_NEED_C12 else np.where(inside, values, 0.0)
            found["contact_pressure"] = 0.0 - found["contact_pressure"]
        root = np.sqrt(np.abs((1 - positions) * (1 + positions)))
        return found | {f"{name}_regular": found[name] * root for name in POINT_SINGULAR if regular and name in found}

    @np.errstate(all="ignore")
    def interior(self, x: Array, y: Array, asked: Sequence[str] | None) -> dict[str, Array]:
        """The fields asked for in the plane of symmetry, by default all of ``INTERIOR`` that the materials have."""
        names = tuple(asked or [name for name in INTERIOR if name not in POINT_NEED_C12 or self._lacks_c12 is None])
        for name in names:
            if name in POTENTIALS:
                raise FactorError(f"fields: {name!r} is not given inside a body under a point contact")
            if name in POINT_NEED_C12 and self._lacks_c12 is not None:
                raise MaterialError(f"{self._lacks_c12}: c12: missing; {name} needs it [Pa]")
        needed = [name for name in names if name in LINEAR]
        needed += STRESSES if any(name in DERIVED for name in names) else ()
        linear = tuple(dict.fromkeys(needed))

        def found(pressed: Pressed, places: Indices) -> dict[str, Array]:
            tractions = Rubbed(pressed.charged).tractions
            whole = self._inside(places, pressed).fields(tractions, x, y, linear)
            values = {name: whole[:, number] for number, name in enumerate(linear)}
            for name in set(names) & DERIVED.keys():
                values[name] = DERIVED[name](*(values[stress] for stress in STRESSES))
            return {name: values[name] for name in names}

        return self.put_together(found, self._apart())

    @property
    def _lacks_c12(self) -> str | None:
        """The name of a material without c12."""
        raise NotImplementedError

    def _apart(self) -> list[tuple[Indices, Pressed]]:
        """Cases of one body each, lengths apart."""
        return self._parts

    def _inside(self, places: Indices, pressed: Pressed) -> Inside:
        """The body of cases of one body."""
        raise NotImplementedError

    def put_together(
        self,
        output: Callable[[Pressed, Indices], dict[str, Array]],
        parts: Sequence[tuple[Indices, Pressed]] | None = None,
    ) -> dict[str, Array]:
        """Outputs of every part and its places among the cases, in one; (...)."""
        try:
            found = [(places, output(pressed, places)) for places, pressed in parts or self._parts]
        except ContactError as error:
            raise FactorError(str(error)) from None
        out: dict[str, Array] = {}
        for name in found[0][1]:
            if all(name in values for _, values in found):
                whole = np.empty((int(np.prod(self.shape)), *found[0][1][name].shape[1:]))
                for places, values in found:
                    whole[places] = values[name]
                out[name] = whole.reshape((*self.shape, *whole.shape[1:]))
        return out

    def _by_exponent(self, places: Indices) -> list[tuple[Indices, Shape, Array]]:
        """Cases by the exponent of their profile, with its coefficient, or the radius of a disc."""
        exponent, coefficient = self._profile()
        exponents = self.flat(exponent)[places]
        return [
            (own := places[exponents == e], Shape(e), self.flat(coefficient)[own])
            for e in np.unique(exponents).tolist()
        ]

    def _profile(self) -> tuple[Array, Array]:
        """Exponent and coefficient of the one profile of the cases."""
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
        return self.flat(self.cases.number("friction"))

    def flat(self, values: Any) -> Array:
        """Values of all cases in a row; (case,)."""
        return np.asarray(np.broadcast_to(values, self.shape).ravel(), dtype=np.float64)

    def _loads(self, places: Indices) -> tuple[Array, Array]:
        """P (case,) and T, J (case, 2)."""
        charges = np.stack([self.flat(self.cases.charges[..., field])[places] for field in (0, 1)], -1)
        return self.flat(self.cases.force)[places], charges


class OnHalfSpace(OnPoints):
    """Points on half-spaces.

    Raises
    ------
    FactorError, MaterialError
        An inadmissible material.

    Warns
    -----
    PrecisionWarning
        Rounding costs digits.
    """

    def _pressed(self) -> list[tuple[Indices, Pressed]]:
        warn_of_rounding(self._half)
        return [(own, self._of(own, shape, coefficient)) for own, shape, coefficient in self._by_exponent(self._every)]

    def _apart(self) -> list[tuple[Indices, Pressed]]:
        _, which = np.unique(np.stack(self._constants, -1), axis=0, return_inverse=True)
        return [
            (own[some], self._of(own[some], shape, coefficient[some]))
            for own, shape, coefficient in self._by_exponent(self._every)
            for number in np.unique(which.ravel()[own])
            if (some := np.flatnonzero(which.ravel()[own] == number)).size
        ]

    @property
    def _every(self) -> Indices:
        return np.arange(int(np.prod(self.shape)))

    @cached_property
    def _half(self) -> HalfPlane:
        return HalfPlane(material_of(self.cases))

    @cached_property
    def _constants(self) -> list[Array]:
        """Those of the materials, infinite where unknown; (case,) each."""
        return [self.flat(np.nan_to_num(getattr(self._half.material, key), nan=np.inf)) for key in UNITS]

    @cached_property
    def _compliances(self) -> tuple[Array, Array, Array]:
        """N and k of the contacts in their units, and these; (case, 3, 3), (case, 3) and (case, 4)."""
        half, punch, conducts = self._half, punch_of(self.cases), self.cases.conducts
        units = half.scale[..., 1:]
        N = half.compliance + column(punch.compliance) * np.diag([1.0, 0.0, 0.0])
        N = conducted(N / (units[..., :, None] * units[..., None, :]), conducts)
        k = contact_coupling(
            half.friction_coupling / (half.scale[..., :1] * units), half.scale, punch.coupling, conducts
        )
        sizes = ((N, (3, 3)), (k, (3,)), (half.scale, (4,)))
        N, k, units = (np.broadcast_to(v, (*self.shape, *own)).reshape(-1, *own) for v, own in sizes)
        return N, k, units

    def _of(self, own: Indices, shape: Shape, coefficient: Array) -> Pressed:
        """Some cases of one exponent."""
        N, k, units = self._compliances
        conducts = np.broadcast_to(self.cases.conducts, (*self.shape, 2)).reshape(-1, 2)
        friction = Friction(self._friction[own], k[own]) if "friction" in self.cases.values else None
        body = HalfSpace(N[own], shape, self._stretch(own))
        return Pressed(body, units[own], coefficient, *self._loads(own), conducts[own], friction=friction)

    @property
    def _lacks_c12(self) -> str | None:
        material = self._half.material
        return material.name if np.any(np.isnan(material.c12)) else None

    @cached_property
    def _rims(self) -> Rim:
        rim = Rim.of(self._half)
        flat = (self.flat(value) for value in (rim.stiffness, rim.shear, rim.tangential, rim.transverse))
        return Rim(np.broadcast_to(rim.coupling, (*self.shape, 3)).reshape(-1, 3), *flat)

    def _rim(self, places: Indices) -> Rim | None:
        if self._lacks_c12 is not None:
            return None
        return Rim(*(getattr(self._rims, one.name)[places] for one in fields(Rim)))

    def _stretch(self, own: Indices) -> Stretch | None:
        """What the surfaces of some cases do along themselves; nothing is known without c12."""
        if self._lacks_c12 is not None:
            return None
        share = np.broadcast_to(self._half.in_plane_share, (*self.shape, 3)).reshape(-1, 3)
        rim = self._rims
        return Stretch(rim.coupling[own], rim.stiffness[own], rim.shear[own], share[own])

    def _inside(self, places: Indices, pressed: Pressed) -> Inside:
        own = [float(values[places[0]]) for values in self._constants]
        dielectric = 0.0  # the last of the constants: a half-space of metal, too, is one
        return whole(material_from((*(None if np.isinf(value) else value for value in own), dielectric), "half-space"))


class OnPointFilm(OnPoints):
    """Points on films, all cases of one film and conduction from the same tables.

    Raises
    ------
    FactorError, MaterialError
        An unknown base, an interface that a base does not have, inadmissible materials.
    """

    def quantities(self) -> dict[str, Array]:
        """Those of a half-space, and the nominal field."""
        return self.put_together(lambda pressed, places: with_nominal_field(self._quantities(pressed, places), pressed))

    def _pressed(self) -> list[tuple[Indices, Pressed]]:
        bodies, conducts, elastic = self._bodies, self.cases.conducts, punch_of(self.cases)
        punches = conducts[..., 0], conducts[..., 1], elastic.compliance, elastic.coupling, electroded(self.cases)
        columns = [self.flat(column) for column in (*bodies.columns, *punches)]
        kinds, which = np.unique(np.stack(columns, -1), axis=0, return_inverse=True)
        thickness, reading, found = self.flat(bodies.thickness), reading_of(self.cases), []
        for number, (*row, electric, magnetic, punch, coupling, covered) in enumerate(kinds.tolist()):
            film = Kind(*bodies.film(row), 0.0, (True, True), (True, True), 1, electroded=bool(covered))
            if metal := film.electroded or film.stack().conductors[0]:
                refuse_charge(self.cases)
            held = bool(electric) and not metal, bool(magnetic)
            for own, shape, coefficient in self._by_exponent(np.flatnonzero(which.ravel() == number)):
                kind = PointKind(film, held, shape, punch)
                body = Film(kind, thickness[own])
                read = None if reading is None else reading.part(own)
                friction = self._rubbing(kind, own, coupling)
                loads = self._loads(own)
                found.append((own, Pressed(body, kind.scale, coefficient, *loads, np.array(held), read, friction)))
        return found

    def _refuse_electroded(self, what: str) -> None:
        if any(pressed.body.kind.film.electroded for _, pressed in self._parts if isinstance(pressed.body, Film)):
            raise FactorError(f"electrode: 'top': {what} under it are not given; ask for quantities alone")

    def _rubbing(self, kind: PointKind, own: Indices, punch: float) -> Friction | None:
        """What slides; None where nothing is said of it, and on an electrode, where nothing may."""
        if "friction" not in self.cases.values:
            return None
        if kind.film.electroded:
            if np.any(self._friction[own]):
                raise FactorError("friction: of a point contact on an electrode is not solved; must be 0")
            return None
        stack = kind.film.stack()
        k = -stack.media[0].compliance[0, 1:]
        coupling = contact_coupling(k, stack.scale, np.array(punch), np.array(kind.conducts))
        return Friction(self._friction[own], np.broadcast_to(coupling, (own.size, 3)), punch)

    @cached_property
    def _bodies(self) -> Bodies:
        return films_of(self.cases)

    @property
    def _lacks_c12(self) -> str | None:
        return self._bodies.lacks_c12

    def _rim(self, places: Indices) -> Rim | None:
        if self._lacks_c12 is not None:
            return None
        return Rim.of(next(_stack(one).media[0].halfplane for own, one in self._parts if own is places))

    def _inside(self, places: Indices, pressed: Pressed) -> Inside:
        self._refuse_electroded("fields")
        return Inside(_stack(pressed))


def _stack(pressed: Pressed) -> Stack:
    if not isinstance(pressed.body, Film):
        raise TypeError("a half-space is no stack")
    return pressed.body.kind.film.stack()


def with_nominal_field(out: dict[str, Array], pressed: Pressed) -> dict[str, Array]:
    """Quantities of a body, and the nominal field where it is a film."""
    body = pressed.body
    if isinstance(body, Film) and "voltage" in out:
        out["nominal_field"] = np.abs(out["voltage"]) / (body.thickness * body.kind.film.above_ground)
    if isinstance(body, Film) and pressed.reading is not None:
        out |= electrode_quantities(pressed.charged, body, pressed.reading)
    return out
