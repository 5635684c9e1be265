"""The punch of every case: rigid, a material by name, or isotropic by modulus and Poisson's ratio."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from solver.arrays import Array, shown
from solver.face.cases import Cases
from solver.face.filmfactors import absent
from solver.face.refusal import FactorError
from solver.halfplane.sliding import RIGID_PUNCH, Punch
from solver.material.constants import Material, MaterialError
from solver.material.library import find
from solver.material.punches import RIGID_PUNCH as RIGID
from solver.material.punches import find_punch, punches
from solver.names import OF_A_PUNCH

_SAME = 1e-9  # relative difference up to which two stiffnesses are one
_COUPLINGS = ("e31", "e33", "e15", "f31", "f33", "f15")
_MODULUS_OF_RIGID, _POISSON_OF_RIGID = np.inf, 0.0


def punch_of(cases: Cases) -> Punch:
    """The elasticity of the punch, over the case axes."""
    return Punch.isotropic(*elasticity_of(cases)) if _given(cases) else RIGID_PUNCH


def elasticity_of(cases: Cases) -> tuple[Array, Array]:
    """Young's modulus [Pa], infinite of a rigid punch, and Poisson's ratio; (...)."""
    if not _given(cases):
        return np.array(_MODULUS_OF_RIGID), np.array(_POISSON_OF_RIGID)
    which = cases.values.get("punch", np.array(None, dtype=object))
    modulus, poisson = _elasticity(cases, which.flat).reshape(2, *which.shape)
    if "punch_modulus" in cases.values:
        by_modulus = cases.values["punch_modulus"], cases.values["punch_poisson"]
        has_modulus = ~np.isnan(by_modulus[0])
        modulus, poisson = np.where(has_modulus, by_modulus[0], modulus), np.where(has_modulus, by_modulus[1], poisson)
    return modulus, poisson


def punch_datum(cases: Cases) -> Array | None:
    """Distance [m] where an elastic punch does not move: its radius or width, else the datum; (...).

    None of cases that say nothing of their punch.
    """
    if not _given(cases):
        return None
    return cases.number(next((name for name in ("radius", "width") if name in cases.outline.needs), "datum"))


def _given(cases: Cases) -> bool:
    return not cases.values.keys().isdisjoint(OF_A_PUNCH)


def _elasticity(cases: Cases, which: Iterable[Any]) -> Array:
    """Modulus and Poisson's ratio of named punches; (2, case). Every name is found once."""
    named = list(which)
    punches = {fromkey: _isotropic(cases, fromkey) for fromkey in dict.fromkeys(named)}
    return np.array([punches[name] for name in named]).T


def _isotropic(cases: Cases, which: object) -> tuple[float, float]:
    """Modulus and Poisson's ratio of one punch: of the punches' own library, or of a material."""
    if absent(which) or which == RIGID:
        return _MODULUS_OF_RIGID, _POISSON_OF_RIGID
    if isinstance(which, Material):
        return _of_material(which)
    if not isinstance(which, str):
        raise FactorError(f"punch: {shown(which)} is no punch; must be {RIGID!r} or a material's name")
    if which not in cases.materials and which in punches():
        known = find_punch(which)
        return known.modulus, known.poisson
    try:
        return _of_material(find(which, cases.materials))
    except MaterialError as error:
        if not str(error).startswith("punch: "):
            find_punch(which)  # whose message names the punches
        raise


def _of_material(material: Material) -> tuple[float, float]:
    """Modulus and Poisson's ratio of a material."""
    c11, c13, c33, c44, c12 = (np.asarray(getattr(material, name)) for name in ("c11", "c13", "c33", "c44", "c12"))
    if c11.shape:
        raise FactorError(f"punch: {material.name!r} holds arrays; a factor takes one material a value")
    differ = [c33 - c11, np.nan_to_num(c12 - c13), 2 * c44 - (c11 - c13)]
    if np.max(np.abs(differ)) > _SAME * c11 or any(np.any(getattr(material, name) != 0) for name in _COUPLINGS):
        raise MaterialError(
            f"punch: {shown(material.name)} is not isotropic and elastic alone; must be {RIGID}, "
            f"{', '.join(punches())}, another isotropic material, or punch_modulus and punch_poisson"
        )
    poisson = float(c13 / (c11 + c13))
    return float(c11 - c13) * (1 + poisson), poisson
