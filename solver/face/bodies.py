"""Class that solves the cases of each kind of body."""

from collections.abc import Callable

from solver.described import Contact
from solver.face.air import FilmInAir, HalfPlaneInAir
from solver.face.airpoint import HalfSpaceInAir, PointFilmInAir
from solver.face.body import Body
from solver.face.cases import Cases
from solver.face.film import OnFilm
from solver.face.halfplane import OnHalfPlane
from solver.face.halfspace import OnHalfSpace
from solver.face.pointfilm import OnPointFilm

#: By contact, by whether the body is layered, and by whether air beside the contact carries charge.
_BODIES: dict[tuple[Contact, bool, bool], Callable[[Cases], Body]] = {
    ("line", False, False): OnHalfPlane,
    ("line", True, False): OnFilm,
    ("line", False, True): HalfPlaneInAir,
    ("line", True, True): FilmInAir,
    ("point", False, False): OnHalfSpace,
    ("point", True, False): OnPointFilm,
    ("point", False, True): HalfSpaceInAir,
    ("point", True, True): PointFilmInAir,
}


def body_of(cases: Cases) -> Body:
    """The body of cases of one kind."""
    kind = cases.kind
    return _BODIES[kind.contact, kind.layered, kind.air](cases)
