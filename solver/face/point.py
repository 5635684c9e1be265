"""Cases of point contacts: from their factors to punches on half-spaces and films, and their outputs by name."""

from collections.abc import Callable, Sequence, Set
from typing import Any, NoReturn

import numpy as np

from solver.arrays import Array, column
from solver.face.cases import Cases
from solver.face.filmbodies import films_of
from solver.face.materials import material_of
from solver.face.punches import punch_of
from solver.face.refusal import FactorError
from solver.film.windows import Indices, Kind
from solver.halfplane.precision import warn_of_rounding
from solver.halfplane.pressing import ContactError
from solver.halfplane.surface import HalfPlane
from solver.names import POINT_SINGULAR
from solver.point.body import Film, HalfSpace, Stretch
from solver.point.halfspace import conducted
from solver.point.pressed import Pressed
from solver.point.profile import DISC, Shape
from solver.point.quantities import quantities
from solver.point.surface import surface_fields
from solver.point.table import PointKind


class OnPoints:
    """What half-spaces and films under points have in common: their punches, and how outputs are put together."""

    #: No fields are given.
    hollow = False

    def __init__(self, cases: Cases) -> None:
        self.cases = cases
        self.shape = tuple(cases.sizes.values())
        self._parts = self._pressed()

    def _pressed(self) -> list[tuple[Indices, Pressed]]:
        raise NotImplementedError

    @np.errstate(all="ignore")  # what is not finite is named in the outputs
    def quantities(self) -> dict[str, Array]:
        """Those of ``solver.names.POINT_QUANTITIES`` that every case has; (...)."""
        return self.put_together(lambda pressed, _: quantities(pressed))

    def peaks(self, asked: Set[str]) -> dict[str, Array]:
        """None: what is inside a body under a point is not given."""
        return {}

    def curves(self, regions: Sequence[str]) -> dict[str, Array]:
        """None: as the peaks."""
        _refuse("curves")

    @np.errstate(all="ignore")
    def surface(self, positions: Array, *, regular: bool) -> dict[str, Array]:
        """Fields of ``solver.names.POINT_FIELDS`` at r/a that every case has, as those of a line; (..., position)."""
        found = self.put_together(lambda pressed, _: surface_fields(pressed, positions))
        root = np.sqrt(np.abs((1 - positions) * (1 + positions)))
        return found | {f"{name}_regular": found[name] * root for name in POINT_SINGULAR if regular and name in found}

    def interior(self, x: Array, y: Array, asked: Sequence[str] | None) -> dict[str, Array]:
        """Refused: fields inside are not given."""
        _refuse("fields")

    def put_together(self, output: Callable[[Pressed, Indices], dict[str, Array]]) -> dict[str, Array]:
        """Outputs of every part and its places among the cases, in one; (...)."""
        try:
            parts = [(places, output(pressed, places)) for places, pressed in self._parts]
        except ContactError as error:
            raise FactorError(str(error)) from None
        out: dict[str, Array] = {}
        for name in parts[0][1]:
            if all(name in values for _, values in parts):
                whole = np.empty((int(np.prod(self.shape)), *parts[0][1][name].shape[1:]))
                for places, values in parts:
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
        half = HalfPlane(material_of(self.cases))
        warn_of_rounding(half)
        units = np.broadcast_to(half.scale, (*self.shape, 4)).reshape(-1, 4)
        N = half.compliance + column(punch_of(self.cases).compliance) * np.diag([1.0, 0.0, 0.0])
        N = N / (half.scale[..., 1:, None] * half.scale[..., None, 1:])
        N = np.broadcast_to(conducted(N, self.cases.conducts), (*self.shape, 3, 3)).reshape(-1, 3, 3)
        conducts = np.broadcast_to(self.cases.conducts, (*self.shape, 2)).reshape(-1, 2)
        stretch = self._stretch(half)
        return [
            (
                own,
                Pressed(
                    HalfSpace(N[own], shape, stretch(own)), units[own], coefficient, *self._loads(own), conducts[own]
                ),
            )
            for own, shape, coefficient in self._by_exponent(np.arange(int(np.prod(self.shape))))
        ]

    def _stretch(self, half: HalfPlane) -> Callable[[Indices], Stretch | None]:
        """What the surfaces of some cases do along themselves; nothing is known without c12."""
        shear = self.flat(half.material.c11 - half.material.c12)
        stiffness = self.flat(half.in_plane_stiffness)
        coupling, share = (
            np.broadcast_to(rows, (*self.shape, 3)).reshape(-1, 3)
            for rows in (half.friction_coupling, half.in_plane_share)
        )
        if np.any(np.isnan(shear)):
            return lambda own: None
        return lambda own: Stretch(coupling[own], stiffness[own], shear[own], share[own])


class OnPointFilm(OnPoints):
    """Points on films, all cases of one film and conduction from the same tables.

    Raises
    ------
    FactorError, MaterialError
        An unknown base, an interface that a base does not have, inadmissible materials.
    """

    def quantities(self) -> dict[str, Array]:
        """Those of a half-space, and the nominal field."""
        return self.put_together(lambda pressed, _: with_nominal_field(quantities(pressed), pressed))

    def _pressed(self) -> list[tuple[Indices, Pressed]]:
        bodies, conducts, compliance = films_of(self.cases), self.cases.conducts, punch_of(self.cases).compliance
        columns = [self.flat(column) for column in (*bodies.columns, conducts[..., 0], conducts[..., 1], compliance)]
        kinds, which = np.unique(np.stack(columns, -1), axis=0, return_inverse=True)
        thickness, found = self.flat(bodies.thickness), []
        for number, (*row, electric, magnetic, punch) in enumerate(kinds.tolist()):
            film, held = Kind(*bodies.film(row), 0.0, (True, True), (True, True), 1), (bool(electric), bool(magnetic))
            for own, shape, coefficient in self._by_exponent(np.flatnonzero(which.ravel() == number)):
                kind = PointKind(film, held, shape, punch)
                body = Film(kind, thickness[own])
                found.append((own, Pressed(body, kind.scale, coefficient, *self._loads(own), np.array(held))))
        return found


def with_nominal_field(out: dict[str, Array], pressed: Pressed) -> dict[str, Array]:
    """Quantities of a body, and the nominal field where it is a film."""
    body = pressed.body
    if isinstance(body, Film) and "voltage" in out:
        out["nominal_field"] = np.abs(out["voltage"]) / (body.thickness * body.kind.film.above_ground)
    return out


def _refuse(name: str) -> NoReturn:
    raise FactorError(f"{name}: inside a body under a point contact are not given; ask for quantities or positions")
