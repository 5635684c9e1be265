"""Which class solves the cases of a kind of body: what comes before and after is the same for all."""

from collections.abc import Callable

from solver.body import (
    FILM,
    FILM_IN_AIR,
    HALF_PLANE,
    HALF_PLANE_IN_AIR,
    HALF_SPACE,
    HALF_SPACE_IN_AIR,
    POINT_FILM,
    POINT_FILM_IN_AIR,
    Body,
)
from solver.face.air import FilmInAir, HalfPlaneInAir
from solver.face.airpoint import HalfSpaceInAir, PointFilmInAir
from solver.face.cases import Cases
from solver.face.film import OnFilm
from solver.face.halfplane import OnHalfPlane
from solver.face.halfspace import OnHalfSpace
from solver.face.pointfilm import OnPointFilm

_BODIES: dict[str, Callable[[Cases], Body]] = {
    HALF_PLANE.name: OnHalfPlane,
    FILM.name: OnFilm,
    HALF_PLANE_IN_AIR.name: HalfPlaneInAir,
    FILM_IN_AIR.name: FilmInAir,
    HALF_SPACE.name: OnHalfSpace,
    POINT_FILM.name: OnPointFilm,
    HALF_SPACE_IN_AIR.name: HalfSpaceInAir,
    POINT_FILM_IN_AIR.name: PointFilmInAir,
}


def body_of(cases: Cases) -> Body:
    """The body of cases of one kind."""
    return _BODIES[cases.kind.name](cases)
