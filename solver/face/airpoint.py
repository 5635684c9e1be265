"""Cases of point contacts with air beside them."""

from collections.abc import Set

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array
from solver.face.point import SURFACE, OnHalfSpace, OnPointFilm, OnPoints, with_nominal_field
from solver.face.refusal import CaseError
from solver.fields import POINT_NEED_C12
from solver.gap.pointquantities import fields, inside, peaks, quantities
from solver.point.contact import Pressed
from solver.point.sliding import warn_of_order

#: Tractions of the surface that continue beside the contact, as charges.
_CARRIED = ("electric_displacement", "magnetic_induction")


class _InAir(OnPoints):
    """Contacts at points of half-spaces or films with air beside them."""

    def quantities(self) -> dict[str, Array]:
        """Quantities of the kind that every case has, to the first order in friction; (...)."""

        def solved(pressed: Pressed, index: Indices) -> dict[str, Array]:
            warn_of_order(pressed)
            permittivity, end = self._gap(index)
            rim = None if pressed.friction is None else self._rim(index, pressed)
            values = with_nominal_field(quantities(pressed, permittivity, end, rim), pressed)
            if "gap_radius" in self.cases.values and np.any(narrow := values["contact_radius"] > end):
                raise CaseError(
                    f"gap_radius: {end[narrow][0]:g} is less than the contact's radius "
                    f"{values['contact_radius'][narrow][0]:.4g} m: the punch is at least as wide as its contact"
                )
            return values

        return self._of_parts(solved)

    def _surface(self, positions: Array, regular: bool) -> dict[str, Array]:
        if np.any(self._friction):
            slid = self._slid(positions, _CARRIED)
            return self._with_regular(slid, positions) if regular else slid
        values = self._of_parts(lambda pressed, index: fields(pressed, *self._gap(index), positions))
        if self._lacks_c12 is None:
            values |= self._at_surface(positions, [name for name in SURFACE if SURFACE[name] in POINT_NEED_C12])
        return self._with_regular(values, positions) if regular else values

    def _peaks(self, pressed: Pressed, index: Indices, requested: Set[str]) -> dict[str, Array]:
        return peaks(pressed, *self._gap(index), self._inside(index, pressed), requested)

    def _fields(self, pressed: Pressed, index: Indices, x: Array, y: Array, names: tuple[str, ...]) -> Array:
        return inside(pressed, *self._gap(index), self._inside(index, pressed), x, y, names)

    def _gap(self, index: Indices) -> tuple[Array, Array]:
        """Relative permittivity and end [m], by default a sphere's radius, of the indexed cases' gaps; (case,) each."""
        number, radius = self.cases.number, self.cases.values.get("gap_radius", np.array(np.nan))
        end = np.where(np.isnan(radius), number("radius"), radius)
        return self._flat(number("gap_permittivity"))[index], self._flat(end)[index]


class HalfSpaceInAir(_InAir, OnHalfSpace):
    """Contacts at points of half-spaces with air beside them."""


class PointFilmInAir(_InAir, OnPointFilm):
    """Contacts at points of films with air beside them."""
