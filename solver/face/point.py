"""Cases of point contacts: from their factors to punches on half-spaces and films, and their outputs by name."""

from abc import abstractmethod
from collections.abc import Callable, Collection, Sequence, Set

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array
from solver.face.body import Body
from solver.face.cases import Cases
from solver.face.refusal import CaseError, FactorError
from solver.fields import POINT_NEED_C12, POINT_SINGULAR
from solver.halfplane.potentials import POTENTIALS
from solver.halfplane.pressing import ContactError
from solver.point.contact import Pressed
from solver.point.friction import Rim
from solver.point.inside import Inside
from solver.point.peaks import peaks
from solver.point.profile import DISC, Shape
from solver.point.quantities import quantities, sliding_quantities
from solver.point.sliding import Rubbed, warn_of_order
from solver.point.surface import surface_fields

#: Surface fields of sliding contacts by the fields inside that equal them at the surface.
SURFACE = {
    "contact_pressure": "stress_yy", "electric_displacement": "electric_displacement_y",
    "magnetic_induction": "magnetic_induction_y", "radial_stress": "stress_xx", "hoop_stress": "stress_zz",
}  # fmt: skip


class OnPoints(Body):
    """Half-spaces and films under points: their punches, and their outputs put together."""

    _need_c12 = POINT_NEED_C12
    _singular = POINT_SINGULAR

    def __init__(self, cases: Cases) -> None:
        super().__init__(cases)
        try:
            self._parts = self._pressed()
        except ContactError as error:
            raise CaseError(str(error)) from None

    @abstractmethod
    def _pressed(self) -> list[tuple[Indices, Pressed]]:
        """Indices among the cases, and the contacts there."""

    def quantities(self) -> dict[str, Array]:
        """Quantities of ``solver.names.POINT_QUANTITIES`` that every case has; (...)."""
        return self._of_parts(self._quantities)

    def _quantities(self, pressed: Pressed, places: Indices) -> dict[str, Array]:
        out = quantities(pressed)
        if pressed.friction is not None:
            warn_of_order(pressed)
            out |= sliding_quantities(pressed, self._rim(places))
        return out

    @abstractmethod
    def _rim(self, places: Indices) -> Rim | None:
        """Surface just outside the contacts; None where a c12 is missing."""

    def peaks(self, requested: Set[str]) -> dict[str, Array]:
        """Requested peaks of ``solver.names.PEAKS`` or ``FILM_PEAKS`` that every case has; (...)."""
        self._require_c12("largest stresses under a point need")
        return self._of_parts(lambda pressed, places: self._peaks(pressed, places, requested), self._apart())

    def curves(self, regions: Sequence[str]) -> dict[str, Array]:
        """Refused: peaks of points are searched for, not learnt from curves."""
        raise FactorError("curves: of a body under a point contact are not given; ask for peaks")

    def _surface(self, positions: Array, regular: bool) -> dict[str, Array]:
        values = self._of_parts(lambda pressed, places: surface_fields(pressed, positions, self._rim(places)))
        if np.any(self._friction):
            values |= self._slid(positions)
        return self._with_regular(values, positions) if regular else values

    def _slid(self, positions: Array, charged: Collection[str] = ()) -> dict[str, Array]:
        """Fields on the surface of sliding contacts, as those inside that end there; (..., position) each.

        ``charged``: tractions that the surface carries outside the contact, too.
        """
        names = [name for name in SURFACE if self._lacks_c12 is None or SURFACE[name] not in POINT_NEED_C12]
        values = self._at_surface(positions, names)
        for name in names:
            if SURFACE[name] not in POINT_NEED_C12 and name not in charged:
                values[name] = np.where(np.abs(positions) < 1, values[name], 0.0)
        return values | {"contact_pressure": 0.0 - values["contact_pressure"]}

    def _at_surface(self, positions: Array, names: Collection[str]) -> dict[str, Array]:
        """Fields of ``SURFACE`` from those inside, at the surface; (..., position) each."""
        inside = self.interior(positions, np.zeros(1), [SURFACE[name] for name in names])
        return {name: inside[SURFACE[name]][..., 0, :] for name in names}

    def _interior(self, x: Array, y: Array, names: tuple[str, ...]) -> dict[str, Array]:
        return self._of_parts(
            lambda pressed, places: dict(
                zip(names, np.moveaxis(self._fields(pressed, places, x, y, names), 1, 0), strict=True)
            ),
            self._apart(),
        )

    # -- overridden for contacts in air --------------------------------------------------------------------------------
    def _peaks(self, pressed: Pressed, places: Indices, requested: Set[str]) -> dict[str, Array]:
        return peaks(pressed, self._within(places, pressed), requested)

    def _fields(self, pressed: Pressed, places: Indices, x: Array, y: Array, names: tuple[str, ...]) -> Array:
        """Fields of ``LINEAR`` and potentials; (case, field, y, x)."""
        values = self._within(places, pressed).fields(Rubbed(pressed.charged).tractions, x, y, names)
        potentials = [number for number, name in enumerate(names) if name in POTENTIALS]
        values[:, potentials] *= pressed.length[:, None, None, None]
        return values

    def _apart(self) -> list[tuple[Indices, Pressed]]:
        """Cases of one body each, lengths not shared."""
        return self._parts

    def _within(self, places: Indices, pressed: Pressed) -> Inside:
        """The body whose fields are solved."""
        return self._inside(places, pressed)

    @abstractmethod
    def _inside(self, places: Indices, pressed: Pressed) -> Inside:
        """Body of cases of one body."""

    def _of_parts(
        self,
        output: Callable[[Pressed, Indices], dict[str, Array]],
        parts: Sequence[tuple[Indices, Pressed]] | None = None,
    ) -> dict[str, Array]:
        """Outputs of parts of the cases, by default those that are pressed together."""
        return self._put_together((places, output(pressed, places)) for places, pressed in parts or self._parts)

    def _by_exponent(self, places: Indices) -> list[tuple[Indices, Shape, Array]]:
        """Cases by the exponent of their profile, with its coefficient, or the radius of a disc."""
        exponent, coefficient = self._profile()
        exponents = self._flat(exponent)[places]
        return [
            (alike := places[exponents == e], Shape(e), self._flat(coefficient)[alike])
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
        return self._flat(self.cases.number("friction"))

    def _loads(self, places: Indices) -> tuple[Array, Array]:
        """Forces P (case,) and charges T, J (case, 2)."""
        return self._flat(self.cases.force)[places], self._flat(self.cases.charges, 2)[places]
