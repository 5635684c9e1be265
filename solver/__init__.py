"""Exact sliding contact of a rigid punch on a magneto-electro-elastic half-plane."""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from solver.composite import fibrous, laminate
    from solver.factors import FactorError
    from solver.labelled import solve
    from solver.labelled_interior import solve_interior
    from solver.library import find, materials
    from solver.material import Material, MaterialError
    from solver.precision import PrecisionWarning
    from solver.profile import Profile
    from solver.speed import limiting_speed

__all__ = [
    "FactorError",
    "Material",
    "MaterialError",
    "PrecisionWarning",
    "Profile",
    "fibrous",
    "find",
    "laminate",
    "limiting_speed",
    "materials",
    "solve",
    "solve_interior",
]

# imported when asked for: a job that needs only `solver.names` is often shorter than the imports of the solution
_MODULES = {
    "FactorError": "factors",
    "Material": "material",
    "MaterialError": "material",
    "PrecisionWarning": "precision",
    "Profile": "profile",
    "fibrous": "composite",
    "find": "library",
    "laminate": "composite",
    "limiting_speed": "speed",
    "materials": "library",
    "solve": "labelled",
    "solve_interior": "labelled_interior",
}


def __getattr__(name: str) -> object:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
