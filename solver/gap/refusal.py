"""Limits of the theory of air, and the messages that refuse other contacts."""

import numpy as np

from solver.arrays import BoolArray
from solver.halfplane.pressing import ContactError
from solver.line.windows import Kind
from solver.material.constants import MaterialError
from solver.point.body import Film, HalfSpace
from solver.point.profile import Shape

_IDLE = "the punch conducts no field, so that no charge lies beside it; must be insulated"
_CORNER = "the punch has a corner, beside which no narrow gap opens; must be insulated"
_SIDEWAYS = "the film's base has no normal induction, so that flux leaves sideways without end; must be insulated"
_ALL_TOUCHES = (
    "a disc's face touches all over, so that no gap lies beside the contact, only air around the punch's side; must be "
    "insulated"
)


class SurroundingsError(MaterialError):
    """A punch or a body beside which air has no meaning here."""


class GapError(ContactError):
    """A punch that touches the surface beside the contact, or a gap that nothing converges for."""


def lacking(kind: Kind) -> str | None:
    """Why a kind of contact cannot have air beside it; none if it can."""
    if not any(kind.conducts):
        return _IDLE
    if not all(kind.smooth):
        return _CORNER
    if kind.conducts[1] and kind.stack.insulated:
        return _SIDEWAYS
    return None


def lacking_at_point(body: HalfSpace | Film, conducts: BoolArray) -> str | None:
    """Why point contacts of a conduction (case, 2) cannot have air beside them; none if they can."""
    shape: Shape = body.shape
    if not np.all(np.any(conducts, -1)):
        return _IDLE
    if shape.flat:
        return _ALL_TOUCHES
    if isinstance(body, Film) and body.kind.conducts[1] and body.kind.film.insulated:
        return _SIDEWAYS
    return None


def require(why: str | None) -> None:
    """Refuse a contact that cannot have air beside it, for the reason from `lacking` or `lacking_at_point`."""
    if why is not None:
        raise SurroundingsError(f"surroundings: 'air' is not allowed: {why}")
