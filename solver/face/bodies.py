"""Which body cases lie on: the door through which another kind of body joins.

A body is made of :class:`Cases` of one kind and answers ``quantities``, ``peaks``, ``surface`` and ``interior`` with
arrays by the names of ``solver.names``; what comes before and after is the same for all.
"""

from solver.face.cases import Cases
from solver.face.film import OnFilm
from solver.face.halfplane import OnHalfPlane


def body_of(cases: Cases) -> OnHalfPlane | OnFilm:
    """The body of cases of one kind, by their factors: without a ``thickness``, a half-plane."""
    return OnFilm(cases) if cases.on_films.any() else OnHalfPlane(cases)
