"""Class that solves the cases of each kind of body."""

from collections.abc import Callable
from importlib import import_module
from typing import cast

from solver.described import Contact
from solver.face.body import Body
from solver.face.cases import Cases

#: Module and class by contact, by layers of the body, and by charge in the air around the contact. A module is imported
#: with the first case of its kind: cases on a half-plane never load the films.
_BODIES: dict[tuple[Contact, bool, bool], tuple[str, str]] = {
    ("line", False, False): ("halfplane", "OnHalfPlane"),
    ("line", True, False): ("film", "OnFilm"),
    ("line", False, True): ("air", "HalfPlaneInAir"),
    ("line", True, True): ("air", "FilmInAir"),
    ("point", False, False): ("halfspace", "OnHalfSpace"),
    ("point", True, False): ("pointfilm", "OnPointFilm"),
    ("point", False, True): ("airpoint", "HalfSpaceInAir"),
    ("point", True, True): ("airpoint", "PointFilmInAir"),
}


def body_of(cases: Cases) -> Body:
    """The body of cases of one kind."""
    kind = cases.kind
    module, name = _BODIES[kind.contact, kind.layered, kind.air]
    solved_by = cast(Callable[[Cases], Body], getattr(import_module(f"solver.face.{module}"), name))
    return solved_by(cases)
