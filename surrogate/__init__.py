"""Statistics that know no physics: Gaussian processes on labelled data, their validation, sensitivity and files."""

from importlib import import_module
from typing import TYPE_CHECKING

from storage.sealed import FormatError
from surrogate.data.inputs import Input, chebyshev_levels
from surrogate.data.points import OutOfBoxError

if TYPE_CHECKING:
    from surrogate.face.model import GaussianProcess
    from surrogate.face.persistence import load, save
    from surrogate.gp.crossgp import CrossGP
    from surrogate.gp.gridgp import GridGP
    from surrogate.gp.scattergp import ScatterGP
    from surrogate.transforms.boundedgp import BoundedGP
    from surrogate.transforms.curves.curvegp import CurveGP
    from surrogate.transforms.groupedgp import GroupedGP
    from surrogate.transforms.groups import Grouping
    from surrogate.transforms.inputs import Group
    from surrogate.transforms.outputs import Scaling
    from surrogate.use.estimator import FactorialRegressor

__all__ = [
    "BoundedGP",
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

# imported when asked for: scikit-learn, on which they stand, takes longer to import than most jobs take for their work
_MODELS = {
    "BoundedGP": "transforms.boundedgp",
    "CrossGP": "gp.crossgp",
    "CurveGP": "transforms.curves.curvegp",
    "FactorialRegressor": "use.estimator",
    "GaussianProcess": "face.model",
    "GridGP": "gp.gridgp",
    "Group": "transforms.inputs",
    "GroupedGP": "transforms.groupedgp",
    "Grouping": "transforms.groups",
    "Scaling": "transforms.outputs",
    "ScatterGP": "gp.scattergp",
    "load": "face.persistence",
    "save": "face.persistence",
}


def __getattr__(name: str) -> object:
    if name not in _MODELS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_MODELS[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
