"""Statistics that know no physics: Gaussian processes on labelled data, their validation, sensitivity and files."""

from surrogate.gridgp import GridGP
from surrogate.inputs import Input, chebyshev_levels
from surrogate.model import GaussianProcess
from surrogate.persistence import load
from surrogate.points import OutOfBoxError
from surrogate.scattergp import ScatterGP
from surrogate.sealed import FormatError

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
