"""Exact sliding contact of a rigid conducting punch on a magneto-electro-elastic half-plane."""

from solver.composite import fibrous, laminate
from solver.labelled import FactorError, solve
from solver.library import find, materials
from solver.material import Material, MaterialError

__all__ = ["FactorError", "Material", "MaterialError", "fibrous", "find", "laminate", "materials", "solve"]
