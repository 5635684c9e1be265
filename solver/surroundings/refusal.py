"""Which contacts the theory of air covers, and what is said of the others."""

import numpy as np

from solver.arrays import BoolArray
from solver.film.windows import Kind
from solver.material.constants import MaterialError
from solver.point.body import Film, HalfSpace
from solver.point.profile import Shape

_IDLE = "the punch conducts no field, so that no charge lies beside it; must be insulated"
_CORNER = "the punch has a corner, beside which no narrow gap opens; must be insulated"
_GRADED = "the film is graded, whose displacements beside the contact are not tabulated; must be insulated"
_SIDEWAYS = "the film's base has no normal induction, so that flux leaves sideways without end; must be insulated"
_ALL_TOUCHES = (
    "a disc's face touches all over, so that no gap lies beside the contact, only air around the punch's side; must be "
    "insulated"
)


class SurroundingsError(MaterialError):
    """A punch or a body beside which air has no meaning here."""


def lacking(kind: Kind) -> str | None:
    """Why a kind of contact cannot have air beside it; none if it can."""
    if not any(kind.conducts):
        return _IDLE
    if not all(kind.smooth):
        return _CORNER
    if kind.graded:
        return _GRADED
    if kind.conducts[1] and kind.stack().insulated:
        return _SIDEWAYS
    return None


def lacking_at_point(body: HalfSpace | Film, conducts: BoolArray) -> str | None:
    """The same of point contacts; conducts (case, 2).

    Parameters
    ----------
    body : HalfSpace or Film, with the punch's shape
    conducts : ndarray of bool, shape (case, 2), electric and magnetic
    """
    shape: Shape = body.shape
    if not np.all(np.any(conducts, -1)):
        return _IDLE
    if shape.flat:
        return _ALL_TOUCHES
    if isinstance(body, Film) and body.kind.film.graded:
        return _GRADED
    if isinstance(body, Film) and body.kind.conducts[1] and body.kind.film.stack().insulated:
        return _SIDEWAYS
    return None


def require_gap(kind: Kind) -> None:
    """Refuse a kind of contact that cannot have air beside it.

    Raises
    ------
    SurroundingsError
        Saying why.
    """
    _require(lacking(kind))


def require_gap_of_point(body: HalfSpace | Film, conducts: BoolArray) -> None:
    """The same of point contacts.

    Parameters
    ----------
    body, conducts : as of :func:`lacking_at_point`

    Raises
    ------
    SurroundingsError
        Saying why.
    """
    _require(lacking_at_point(body, conducts))


def _require(why: str | None) -> None:
    if why is not None:
        raise SurroundingsError(f"surroundings: 'air' is not allowed: {why}")
