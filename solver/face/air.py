"""Cases with air beside the contact: a film's as without, a half-plane's as a film bonded to its own material."""

from collections.abc import Sequence, Set
from typing import NoReturn

import numpy as np

from solver.arrays import Array
from solver.body import HALF_PLANE_IN_AIR
from solver.face.film import OnFilm
from solver.face.filmbodies import Bodies, HalfPlanes
from solver.face.halfplane import contact_of
from solver.face.refusal import FactorError
from solver.surroundings.quantities import quantities


class FilmInAir(OnFilm):
    """Contact of cases of one kind of punch on films, with air beside it.

    Raises
    ------
    FactorError, MaterialError
        As without air; a punch or a film that the theory of air does not cover.
    """

    #: No fields are given.
    hollow = False

    def quantities(self) -> dict[str, Array]:
        """Those of ``solver.body.FILM_IN_AIR`` that every case has; (...)."""
        permittivity = self.cases.number("gap_permittivity")
        return self._put_together(lambda films, places: quantities(films, self._chosen(permittivity, places)))

    def peaks(self, asked: Set[str]) -> dict[str, Array]:
        """None: what is inside a body with air beside the contact is not given."""
        return {}

    def curves(self, regions: Sequence[str]) -> dict[str, Array]:
        """None: as the peaks."""
        refuse_fields("curves")

    def surface(self, positions: Array, *, regular: bool) -> dict[str, Array]:
        """Refused: fields of contacts with air beside them are not given."""
        refuse_fields("positions")

    def interior(self, x: Array, y: Array, asked: Sequence[str] | None) -> dict[str, Array]:
        """Refused, as those on the surface."""
        refuse_fields("fields")


class HalfPlaneInAir(FilmInAir):
    """The same on half-planes.

    Its half-length is that of the closed form: a half-plane's pressure does not know what charges lie beside it.
    """

    def _made(self) -> Bodies:
        contact = contact_of(self.cases)
        with np.errstate(all="ignore"):
            return HalfPlanes(self.cases, contact.halfplane.material, contact.half_width)

    def quantities(self) -> dict[str, Array]:
        """Those of a half-plane in air that every case has; (...)."""
        return {name: value for name, value in super().quantities().items() if name in HALF_PLANE_IN_AIR.quantities}


def refuse_fields(name: str) -> NoReturn:
    """Refuse fields of contacts with air beside them, by the argument that asks for them.

    Raises
    ------
    FactorError
        Always.
    """
    raise FactorError(f"{name}: fields of contacts with air beside them are not given; ask for quantities alone")
