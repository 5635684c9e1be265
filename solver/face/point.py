"""Cases of point contacts: from their factors to punches on half-spaces and films, and their outputs by name."""

from collections.abc import Callable, Collection, Sequence, Set
from typing import Any

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array
from solver.face.cases import Cases
from solver.face.refusal import CaseError, FactorError
from solver.fields import INTERIOR, POINT_NEED_C12, POINT_SINGULAR
from solver.halfplane.interior import LINEAR, principal_tension, von_mises
from solver.halfplane.potentials import POTENTIALS
from solver.halfplane.pressing import ContactError
from solver.material.constants import MaterialError
from solver.point.gradedinside import GradedInside
from solver.point.inside import Inside
from solver.point.peaks import peaks
from solver.point.pressed import Pressed
from solver.point.profile import DISC, Shape
from solver.point.quantities import quantities, sliding_quantities
from solver.point.rim import Rim
from solver.point.sliding import Rubbed, warn_of_order
from solver.point.surface import surface_fields

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
            raise CaseError(str(error)) from None

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
        return self.put_together(lambda pressed, places: self._peaks(pressed, places, asked), self._apart())

    def curves(self, regions: Sequence[str]) -> dict[str, Array]:
        """Refused: peaks of points are searched for, not learnt from curves."""
        raise FactorError("curves: of a body under a point contact are not given; ask for peaks")

    @np.errstate(all="ignore")
    def surface(self, positions: Array, *, regular: bool) -> dict[str, Array]:
        """Fields of ``solver.fields.POINT_FIELDS`` that every case has, as those of a line; (..., position).

        Parameters
        ----------
        positions : ndarray, shape (position,), r/a, of sliding punches x/a
        regular : bool, whether the singular ones are wanted in regular form too
        """
        found = self.put_together(lambda pressed, own: surface_fields(pressed, positions, self._rim(own)))
        if np.any(self._friction):
            found |= self.slid(positions)
        return self.with_regular(found, positions) if regular else found

    def slid(self, positions: Array, charged: Collection[str] = ()) -> dict[str, Array]:
        """Fields on the surface with what friction adds, as those inside that end there; (..., position) each.

        Parameters
        ----------
        positions : ndarray, shape (position,), x/a
        charged : collection of str, tractions that the surface carries beside the contact, too
        """
        names = [name for name in SURFACE if self._lacks_c12 is None or SURFACE[name] not in POINT_NEED_C12]
        inside = self.interior(positions, np.zeros(1), [SURFACE[name] for name in names])
        found = {name: inside[SURFACE[name]][..., 0, :] for name in names}
        for name in names:
            if SURFACE[name] not in POINT_NEED_C12 and name not in charged:
                found[name] = np.where(np.abs(positions) < 1, found[name], 0.0)
        return found | {"contact_pressure": 0.0 - found["contact_pressure"]}

    def with_regular(self, found: dict[str, Array], positions: Array) -> dict[str, Array]:
        """Fields, and those that are singular at the edge times its root; (..., position) each.

        Parameters
        ----------
        found : dict of str to ndarray, shape (..., position), the fields
        positions : ndarray, shape (position,), r/a
        """
        root = np.sqrt(np.abs((1 - positions) * (1 + positions)))
        return found | {f"{name}_regular": found[name] * root for name in POINT_SINGULAR if name in found}

    @np.errstate(all="ignore")
    def interior(self, x: Array, y: Array, asked: Sequence[str] | None) -> dict[str, Array]:
        """The fields inside, in the plane of symmetry, (..., y, x).

        Parameters
        ----------
        x, y : ndarray, shape (x,), (y,), places over the contact's radius
        asked : sequence of str, their names; None: all of ``INTERIOR`` that the materials have
        """
        names = tuple(asked or [name for name in INTERIOR if name not in POINT_NEED_C12 or self._lacks_c12 is None])
        for name in names:
            if name in POINT_NEED_C12 and self._lacks_c12 is not None:
                raise MaterialError(f"{self._lacks_c12}: c12: missing; {name} needs it [Pa]")
        needed = [name for name in names if name in LINEAR or name in POTENTIALS]
        needed += STRESSES if any(name in DERIVED for name in names) else ()
        linear = tuple(dict.fromkeys(needed))

        def found(pressed: Pressed, places: Indices) -> dict[str, Array]:
            whole = self._fields(pressed, places, x, y, linear)
            values = {name: whole[:, number] for number, name in enumerate(linear)}
            for name in set(names) & DERIVED.keys():
                values[name] = DERIVED[name](*(values[stress] for stress in STRESSES))
            return {name: values[name] for name in names}

        return self.put_together(found, self._apart())

    # -- what is beside the contact has its part in ------------------------------------------------------------------
    def _peaks(self, pressed: Pressed, places: Indices, asked: Set[str]) -> dict[str, Array]:
        return peaks(pressed, self._within(places, pressed), asked)

    def _fields(self, pressed: Pressed, places: Indices, x: Array, y: Array, names: tuple[str, ...]) -> Array:
        """Fields of ``LINEAR`` and potentials; (case, field, y, x)."""
        values = self._within(places, pressed).fields(Rubbed(pressed.charged).tractions, x, y, names)
        potentials = [number for number, name in enumerate(names) if name in POTENTIALS]
        values[:, potentials] *= pressed.length[:, None, None, None]
        return values

    @property
    def _lacks_c12(self) -> str | None:
        """The name of a material without c12."""
        raise NotImplementedError

    def _apart(self) -> list[tuple[Indices, Pressed]]:
        """Cases of one body each, lengths apart."""
        return self._parts

    def _within(self, places: Indices, pressed: Pressed) -> Inside | GradedInside:
        """What fields are asked of: the body, or what stands for one that is graded."""
        return self._inside(places, pressed)

    def _inside(self, places: Indices, pressed: Pressed) -> Inside:
        """The body of cases of one body."""
        raise NotImplementedError

    def put_together(
        self,
        output: Callable[[Pressed, Indices], dict[str, Array]],
        parts: Sequence[tuple[Indices, Pressed]] | None = None,
    ) -> dict[str, Array]:
        """Outputs of every part and its places among the cases, in one; (...).

        Parameters
        ----------
        output : callable, gives the outputs of contacts that are pressed and of their places among the cases
        parts : sequence of (ndarray of int, Pressed), places and contacts; None: those of all cases
        """
        try:
            solved = [(places, output(pressed, places)) for places, pressed in parts or self._parts]
        except ContactError as error:
            raise CaseError(str(error)) from None
        out: dict[str, Array] = {}
        for name in solved[0][1]:
            if all(name in values for _, values in solved):
                whole = np.empty((int(np.prod(self.shape)), *solved[0][1][name].shape[1:]))
                for places, values in solved:
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
