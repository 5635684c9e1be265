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
    from solver.material.alloy import aluminium_scandium_nitride
    from solver.material.composite import fibrous, laminate
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

# imported when asked for: a job that needs only `solver.names` is often shorter than the imports of the solution
_MODULES = {
    "CaseError": "face.refusal",
    "FactorError": "face.refusal",
    "Layer": "stack.layers",
    "Material": "material.constants",
    "MaterialError": "material.constants",
    "PrecisionWarning": "halfplane.precision",
    "Profile": "halfplane.profile",
    "SmallStrainWarning": "face.refusal",
    "Stack": "stack.layers",
    "aluminium_scandium_nitride": "material.alloy",
    "fibrous": "material.composite",
    "find": "material.library",
    "laminate": "material.composite",
    "limiting_speed": "halfplane.speed",
    "materials": "material.library",
    "solve": "face.solution",
    "solve_curves": "face.solution",
    "solve_interior": "face.solution",
    "solve_map": "face.surface",
    "table": "face.table",
}


def __getattr__(name: str) -> object:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
