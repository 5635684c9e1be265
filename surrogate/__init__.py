"""Statistics that know no physics: Gaussian processes on labelled data, their validation, sensitivity and files."""

from importlib import import_module
from typing import TYPE_CHECKING

from surrogate.inputs import Input, chebyshev_levels
from surrogate.points import OutOfBoxError
from surrogate.sealed import FormatError

if TYPE_CHECKING:
    from surrogate.gridgp import GridGP
    from surrogate.model import GaussianProcess
    from surrogate.persistence import load
    from surrogate.scattergp import ScatterGP

__all__ = [
    "FormatError",
    "GaussianProcess",
    "GridGP",
    "Input",
    "OutOfBoxError",
    "ScatterGP",
    "chebyshev_levels",
    "load",
]

# imported when asked for: scikit-learn, on which they stand, takes longer to import than most jobs take for their work
_MODELS = {"GaussianProcess": "model", "GridGP": "gridgp", "ScatterGP": "scattergp", "load": "persistence"}


def __getattr__(name: str) -> object:
    if name not in _MODELS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_MODELS[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
