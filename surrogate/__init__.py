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
_MODULES = {
    "CrossGP": "surrogate.gp.crossgp",
    "CurveGP": "surrogate.transforms.curves.curvegp",
    "FactorialRegressor": "surrogate.use.estimator",
    "FormatError": "storage.sealed",
    "GaussianProcess": "surrogate.face.model",
    "GridGP": "surrogate.gp.gridgp",
    "Group": "surrogate.transforms.groups",
    "GroupedGP": "surrogate.transforms.groupedgp",
    "Grouping": "surrogate.transforms.groups",
    "Input": "surrogate.data.inputs",
    "OutOfBoxError": "surrogate.data.points",
    "Scaling": "surrogate.transforms.groups",
    "ScatterGP": "surrogate.gp.scattergp",
    "chebyshev_levels": "surrogate.data.inputs",
    "load": "surrogate.face.persistence",
    "save": "surrogate.face.persistence",
}


def __getattr__(name: str) -> object:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_MODULES[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
