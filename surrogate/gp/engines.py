"""The kinds of models that files hold, by name; each is imported when it is asked for."""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from surrogate.gp.model import GaussianProcess

#: Module and class of every kind.
ENGINES = {
    "grid": ("gp.gridgp", "GridGP"),
    "grouped": ("gp.groupedgp", "GroupedGP"),
    "curves": ("curves.curvegp", "CurveGP"),
    "corrected": ("measured.corrected", "CorrectedGP"),
    "scatter": ("scattered.scattergp", "ScatterGP"),
}


def engine(name: str) -> "type[GaussianProcess]":
    """Return the class of a kind; ValueError for one that is not known."""
    if name not in ENGINES:
        raise ValueError(f"unknown engine {name!r}; known are {', '.join(ENGINES)}")
    module, kind = ENGINES[name]
    found: type[GaussianProcess] = getattr(import_module(f"surrogate.{module}"), kind)
    return found
