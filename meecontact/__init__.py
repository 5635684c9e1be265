"""Public names of the exact solver and the surrogate, and all rooms: ``meecontact.solver`` is ``solver``, not a copy.

Examples
--------
>>> import meecontact as mee
>>> case = {"volume_fraction": 0.5, "composite": "fibrous", "friction": 0.3, "radius": 0.05, "load": 5e4}
>>> round(float(mee.solve(case)["voltage_per_load"]), 4)
-0.0472
>>> import meecontact.solver.names, solver
>>> meecontact.solver.names is solver.names
True
"""

import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

_ROOMS = ("approximation", "solver", "storage", "surrogate", "verification", "workflow")


def _check_rooms() -> None:
    """Refuse foreign modules under the names of the rooms, such as a user's own file `solver.py`."""
    root = Path(__file__).parents[1]
    for room in _ROOMS:
        spec = find_spec(room)
        origin = None if spec is None else spec.origin
        if origin is None or not Path(origin).is_relative_to(root):
            raise ImportError(
                f"meecontact: the module {room!r} that Python finds is {origin or 'none'}, not that of {root}; "
                "rename that file, or give meecontact an environment of its own"
            )


_check_rooms()

import solver  # noqa: E402
import surrogate  # noqa: E402

if TYPE_CHECKING:
    from solver import *  # noqa: F403
    from surrogate import *  # noqa: F403

__version__ = version("meecontact")
__all__ = [*solver.__all__, *surrogate.__all__]


class _Same(Loader):
    """Loads a module under a second name without changing it."""

    def __init__(self, name: str) -> None:
        self.module = import_module(name)
        self.spec = self.module.__spec__

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        return self.module

    def exec_module(self, module: ModuleType) -> None:
        module.__spec__ = self.spec  # the import system has just replaced it


class _Rooms(MetaPathFinder):
    """Finds ``meecontact.<room>.<module>`` as the module ``<room>.<module>``."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        first, _, name = fullname.partition(".")
        if first != __name__ or name.partition(".")[0] not in _ROOMS:
            return None
        return ModuleSpec(fullname, _Same(name))


sys.meta_path.insert(0, _Rooms())


def __getattr__(name: str) -> object:
    for room in (solver, surrogate):
        if name in room.__all__:
            return getattr(room, name)
    if name in _ROOMS:
        return import_module(name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
