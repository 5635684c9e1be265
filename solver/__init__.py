"""Exact contact of a punch that slides or presses on magneto-electro-elastic half-planes, half-spaces and films."""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from solver.face.refusal import CaseError, FactorError, SmallStrainWarning
    from solver.face.solution import solve, solve_curves, solve_interior
    from solver.face.surface import solve_map
    from solver.face.table import table
    from solver.halfplane.precision import PrecisionWarning
    from solver.halfplane.profile import Profile
    from solver.halfplane.speed import limiting_speed
    from solver.material.composite import aluminium_scandium_nitride, fibrous, laminate
    from solver.material.constants import Material, MaterialError
    from solver.material.library import find, materials
    from solver.stack.layers import Layer, Stack

__all__ = [
    "CaseError",
    "FactorError",
    "Layer",
    "Material",
    "MaterialError",
    "PrecisionWarning",
    "Profile",
    "SmallStrainWarning",
    "Stack",
    "aluminium_scandium_nitride",
    "fibrous",
    "find",
    "laminate",
    "limiting_speed",
    "materials",
    "solve",
    "solve_curves",
    "solve_interior",
    "solve_map",
    "table",
]

# imported at first use: a job that needs only `solver.names` is often shorter than the imports of the solution
_NAMES = {
    "face.refusal": ("CaseError", "FactorError", "SmallStrainWarning"),
    "face.solution": ("solve", "solve_curves", "solve_interior"),
    "face.surface": ("solve_map",),
    "face.table": ("table",),
    "halfplane.precision": ("PrecisionWarning",),
    "halfplane.profile": ("Profile",),
    "halfplane.speed": ("limiting_speed",),
    "material.composite": ("aluminium_scandium_nitride", "fibrous", "laminate"),
    "material.constants": ("Material", "MaterialError"),
    "material.library": ("find", "materials"),
    "stack.layers": ("Layer", "Stack"),
}
_MODULES = {name: module for module, names in _NAMES.items() for name in names}


def __getattr__(name: str) -> object:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
