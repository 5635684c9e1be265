"""Statistics that know no physics: Gaussian processes on labelled data, their validation, sensitivity and files."""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from storage.sealed import FormatError
    from surrogate.data.inputs import Input, chebyshev_levels
    from surrogate.data.points import OutOfBoxError
    from surrogate.face.model import GaussianProcess
    from surrogate.face.persistence import load, save
    from surrogate.gp.crossgp import CrossGP
    from surrogate.gp.gridgp import GridGP
    from surrogate.gp.scattergp import ScatterGP
    from surrogate.transforms.curves.curvegp import CurveGP
    from surrogate.transforms.groupedgp import GroupedGP
    from surrogate.transforms.groups import Group, Grouping, Scaling
    from surrogate.use.estimator import FactorialRegressor

__all__ = [
    "CrossGP",
    "CurveGP",
    "FactorialRegressor",
    "FormatError",
    "GaussianProcess",
    "GridGP",
    "Group",
    "GroupedGP",
    "Grouping",
    "Input",
    "OutOfBoxError",
    "Scaling",
    "ScatterGP",
    "chebyshev_levels",
    "load",
    "save",
]

# imported when asked for: most of a small job's time is imports
_NAMES = {
    "storage.sealed": ("FormatError",),
    "surrogate.data.inputs": ("Input", "chebyshev_levels"),
    "surrogate.data.points": ("OutOfBoxError",),
    "surrogate.face.model": ("GaussianProcess",),
    "surrogate.face.persistence": ("load", "save"),
    "surrogate.gp.crossgp": ("CrossGP",),
    "surrogate.gp.gridgp": ("GridGP",),
    "surrogate.gp.scattergp": ("ScatterGP",),
    "surrogate.transforms.curves.curvegp": ("CurveGP",),
    "surrogate.transforms.groupedgp": ("GroupedGP",),
    "surrogate.transforms.groups": ("Group", "Grouping", "Scaling"),
    "surrogate.use.estimator": ("FactorialRegressor",),
}
_MODULES = {name: module for module, names in _NAMES.items() for name in names}


def __getattr__(name: str) -> object:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_MODULES[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
