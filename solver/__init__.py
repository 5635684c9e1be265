"""Exact sliding contact of a rigid punch on a magneto-electro-elastic half-plane."""

from solver.composite import fibrous, laminate
from solver.factors import FactorError
from solver.labelled import solve
from solver.labelled_interior import solve_interior
from solver.library import find, materials
from solver.material import Material, MaterialError
from solver.profile import Profile
from solver.speed import limiting_speed

__all__ = [
    "FactorError",
    "Material",
    "MaterialError",
    "Profile",
    "fibrous",
    "find",
    "laminate",
    "limiting_speed",
    "materials",
    "solve",
    "solve_interior",
]
