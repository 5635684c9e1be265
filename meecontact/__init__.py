"""Everything public under one name: the exact solver and the surrogate.

Examples
--------
>>> import meecontact as mee
>>> case = {"volume_fraction": 0.5, "composite": "fibrous", "friction": 0.3, "radius": 0.05, "load": 5e4}
>>> round(float(mee.solve(case)["voltage_sensitivity"]), 4)
-0.0472
"""

from importlib.metadata import version
from typing import TYPE_CHECKING

import solver
import surrogate

if TYPE_CHECKING:
    from solver import *  # noqa: F403
    from surrogate import *  # noqa: F403

__version__ = version("meecontact")
__all__ = [*solver.__all__, *surrogate.__all__]


def __getattr__(name: str) -> object:
    for room in (solver, surrogate):
        if name in room.__all__:
            return getattr(room, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
