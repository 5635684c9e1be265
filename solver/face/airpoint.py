"""Cases of point contacts with air beside them: bodies and punches are those without."""

from collections.abc import Sequence, Set

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array
from solver.face.air import refuse
from solver.face.halfspace import OnHalfSpace
from solver.face.point import OnPoints
from solver.face.pointfilm import OnPointFilm, with_nominal_field
from solver.face.refusal import CaseError
from solver.point.pressed import Pressed
from solver.point.sliding import warn_of_order
from solver.surroundings.pointquantities import quantities

_FIELDS = "fields of point contacts with air beside them"
_BESIDE = ("peak_displacement", "gap_field")


class _InAir(OnPoints):
    """What half-spaces and films have in common.

    Raises
    ------
    FactorError, MaterialError
        As without air; a punch or a body that the theory of air does not cover.
    """

    @np.errstate(all="ignore")  # what is not finite is named in the outputs
    def quantities(self) -> dict[str, Array]:
        """Those of the kind that every case has, to the first order in friction; (...).

        Friction moves what lies around the contact by its first order, which is not solved: largest values beside the
        edge are then left out.
        """
        slides = bool(np.any(self._friction))
        permittivity, end = self.flat(self.cases.number("gap_permittivity")), self.flat(self._end)

        def solved(pressed: Pressed, places: Indices) -> dict[str, Array]:
            warn_of_order(pressed)
            found = with_nominal_field(quantities(pressed, permittivity[places], end[places]), pressed)
            if "gap_radius" in self.cases.values and np.any(narrow := found["contact_radius"] > end[places]):
                raise CaseError(
                    f"gap_radius: {end[places][narrow][0]:g} is less than the contact's radius "
                    f"{found['contact_radius'][narrow][0]:.4g} m: the punch is at least as wide as its contact"
                )
            return {name: value for name, value in found.items() if not (slides and name in _BESIDE)}

        return self.put_together(solved)

    @property
    def _end(self) -> Array:
        """Where the gaps end; a sphere's at its radius, unless said otherwise."""
        said = self.cases.values.get("gap_radius", np.array(np.nan))
        return np.asarray(np.where(np.isnan(said), self.cases.number("radius"), said))

    def peaks(self, asked: Set[str]) -> dict[str, Array]:
        """None: fields of contacts with air beside them are not given."""
        return {}

    def curves(self, regions: Sequence[str]) -> dict[str, Array]:
        """None: fields of contacts with air beside them are not given."""
        refuse("curves", _FIELDS)

    def surface(self, positions: Array, *, regular: bool) -> dict[str, Array]:
        """Refused: as the curves."""
        refuse("positions", _FIELDS)

    def interior(self, x: Array, y: Array, asked: Sequence[str] | None) -> dict[str, Array]:
        """Refused: as the curves."""
        refuse("fields", _FIELDS)


class HalfSpaceInAir(_InAir, OnHalfSpace):
    """Points on half-spaces with air beside them."""


class PointFilmInAir(_InAir, OnPointFilm):
    """Points on films with air beside them."""
