"""Which contacts the theory of air covers, and what is said of the others."""

from solver.film.windows import Kind
from solver.material.constants import MaterialError


class SurroundingsError(MaterialError):
    """A punch or a body beside which air has no meaning here."""


def lacking(kind: Kind) -> str | None:
    """Why a kind of contact cannot have air beside it; none if it can."""
    if not any(kind.conducts):
        return "the punch conducts no field, so that no charge lies beside it; must be insulated"
    if not all(kind.smooth):
        return "the punch has a corner, beside which no narrow gap opens; must be insulated"
    if callable(kind.layers[0].of):
        return "the film is graded, whose displacements beside the contact are not tabulated; must be insulated"
    if kind.conducts[1] and kind.stack().insulated:
        return "the film's base has no normal induction, so that flux leaves sideways without end; must be insulated"
    return None


def require_gap(kind: Kind) -> None:
    """Refuse a kind of contact that cannot have air beside it.

    Raises
    ------
    SurroundingsError
        Saying why.
    """
    why = lacking(kind)
    if why is not None:
        raise SurroundingsError(f"surroundings: 'air' is not allowed: {why}")
