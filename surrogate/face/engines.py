"""The kinds of models that files hold, by name; each is imported when it is asked for."""

from collections.abc import Sequence
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from surrogate.face.model import GaussianProcess

#: Module and class of every kind. A kind that is made of other models is made of kinds that stand before it.
ENGINES = {
    "grid": ("gp.gridgp", "GridGP"),
    "scatter": ("gp.scattergp", "ScatterGP"),
    "grouped": ("transforms.groupedgp", "GroupedGP"),
    "curves": ("transforms.curves.curvegp", "CurveGP"),
    "bounded": ("transforms.boundedgp", "BoundedGP"),
    "corrected": ("transforms.measured.corrected", "CorrectedGP"),
}


def engine(name: str, known: Sequence[str]) -> "type[GaussianProcess]":
    """Return the class of a kind."""
    if name not in known:
        raise ValueError(f"unknown engine {name!r}; known are {', '.join(known)}")
    module, kind = ENGINES[name]
    made: type[GaussianProcess] = getattr(import_module(f"surrogate.{module}"), kind)
    return made


def members_of(name: str) -> tuple[str, ...]:
    """Return the names of the kinds that a kind may be made of."""
    return tuple(ENGINES)[: list(ENGINES).index(name)]
