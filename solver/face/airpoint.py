"""Cases of point contacts with air beside them: bodies and punches are those without."""

from collections.abc import Sequence, Set

import numpy as np

from solver.arrays import Array
from solver.face.air import refuse_fields
from solver.face.cases import Cases
from solver.face.point import OnHalfSpace, OnPointFilm, OnPoints, with_nominal_field
from solver.face.refusal import FactorError
from solver.film.windows import Indices
from solver.names import OF_A_GAP
from solver.point.pressed import Pressed
from solver.surroundings.pointquantities import quantities


class _InAir(OnPoints):
    """What half-spaces and films have in common.

    Raises
    ------
    FactorError, MaterialError
        As without air; a punch or a body that the theory of air does not cover.
    """

    def __init__(self, cases: Cases) -> None:
        if np.any(cases.number("friction")):
            raise FactorError("friction: of points with air beside them is not solved; must be 0")
        super().__init__(cases)

    @np.errstate(all="ignore")  # what is not finite is named in the outputs
    def quantities(self) -> dict[str, Array]:
        """Those of the kind that every case has; (...)."""
        permittivity, end = self.flat(self.cases.number(OF_A_GAP)), self.flat(self.cases.number("radius"))

        def solved(pressed: Pressed, places: Indices) -> dict[str, Array]:
            return with_nominal_field(quantities(pressed, permittivity[places], end[places]), pressed)

        return self.put_together(solved)

    def peaks(self, asked: Set[str]) -> dict[str, Array]:
        """None: fields of contacts with air beside them are not given."""
        return {}

    def curves(self, regions: Sequence[str]) -> dict[str, Array]:
        """None: fields of contacts with air beside them are not given."""
        refuse_fields("curves")

    def surface(self, positions: Array, *, regular: bool) -> dict[str, Array]:
        """Refused: as the curves."""
        refuse_fields("positions")

    def interior(self, x: Array, y: Array, asked: Sequence[str] | None) -> dict[str, Array]:
        """Refused: as the curves."""
        refuse_fields("fields")


class HalfSpaceInAir(_InAir, OnHalfSpace):
    """Points on half-spaces with air beside them."""


class PointFilmInAir(_InAir, OnPointFilm):
    """Points on films with air beside them."""
