"""Materials of cases: of the body (by name, of the user, or a composite), of its base and of the punch."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array, shown
from solver.cache import cached
from solver.face.cases import Cases, factorized
from solver.face.factorvalues import absent
from solver.face.refusal import FactorError
from solver.halfplane.sliding import RIGID_PUNCH, Punch
from solver.halfplane.surface import HalfPlane
from solver.material.composite import compose
from solver.material.constants import Material, MaterialError, combined
from solver.material.cuts import of_family
from solver.material.library import find
from solver.material.punches import find_punch, punches
from solver.names import CHOICES, COMPOSITES, OF_A_PUNCH, OF_MATERIAL
from solver.stack.layers import RIGID

#: Half-planes of the distinct materials of the tables that are being solved.
_DISTINCT: WeakKeyDictionary[Cases, HalfPlane] = WeakKeyDictionary()
_SAME = 1e-9  # largest relative difference of equal stiffnesses
_COUPLINGS = ("e31", "e33", "e15", "f31", "f33", "f15")
_MODULUS_OF_RIGID, _POISSON_OF_RIGID = np.inf, 0.0


def material_of(cases: Cases) -> Material:
    """Return the material of cases, with constants over their axes."""
    phases = phases_of(cases.phases, cases.materials)
    if "material" in cases.values:
        return _chosen(cases.values["material"], cases.materials)
    kinds = cases.values.get("composite", np.array(CHOICES["composite"][0]))
    composites = {
        str(kind): compose(str(kind), phases, cases.values[COMPOSITES[kind]]) for kind in dict.fromkeys(kinds.flat)
    }
    if len(composites) == 1:
        return next(iter(composites.values()))
    masks = [kinds == kind for kind in composites]
    return combined(lambda *values: np.select(masks, values), composites.values(), "composite")


def half_plane_of(cases: Cases) -> HalfPlane:
    """Return the half-plane of cases; neighbouring rows of a table with equal material and speed share its tensors."""
    if cases.distinct is not None:
        if cases.distinct not in _DISTINCT:
            _DISTINCT[cases.distinct] = half_plane_of(cases.distinct)
        distinct = _DISTINCT[cases.distinct]
        return distinct if cases.case_index is None else distinct.repeated(cases.case_index)
    names = [name for name in (*OF_MATERIAL, "speed") if name in cases.values and cases.values[name].size > 1]
    if len(cases.sizes) == 1 and names:
        ((dim, count),) = cases.sizes.items()
        changes = np.full(count, True)
        changes[1:] = np.any([cases.values[name][1:] != cases.values[name][:-1] for name in names], axis=0)
        if not changes.all():
            return half_plane_of(cases.selected(dim, np.flatnonzero(changes))).repeated(np.cumsum(changes) - 1)
    speed = cases.number("speed")
    return HalfPlane(material_of(cases), speed) if np.any(speed) else HalfPlane(material_of(cases))


def phases_of(phases: Sequence[str | Material], materials: Mapping[str, Material]) -> tuple[Material, Material]:
    """Return phase one and phase two of a composite."""
    if len(phases) != 2:
        raise FactorError(f"phases: {len(phases)} given; a composite has two")
    first, second = (one_material("phases", phase, materials) for phase in phases)
    return first, second


def _chosen(which: NDArray[Any], materials: Mapping[str, Material]) -> Material:
    """Return the material of cases from its names or materials (...), each of which is looked up and checked once."""
    codes, values = factorized(which)
    distinct = [one_material("material", value, materials) for value in values]
    name = distinct[0].name if len(distinct) == 1 else "material"
    return combined(lambda *constants: np.array(constants)[codes.reshape(which.shape)], distinct, name)


def one_material(factor: str, which: object, materials: Mapping[str, Material]) -> Material:
    """Return the checked material that a value of a factor is or names."""
    if not isinstance(which, str | Material):
        raise FactorError(f"{factor}: {shown(which)} is no material; give the name of one, or a Material")
    material = material_named(which, materials)
    if material.shape:
        raise FactorError(f"{factor}: {material.name!r} holds arrays; a factor takes one material a value")
    material.check()
    return material


def one_of_case(
    case: Mapping[str, Any], materials: Mapping[str, Material], phases: Sequence[str | Material]
) -> Material:
    """Return the material of a case of single factors, with its cut."""
    if "material" in case:
        material = one_material("material", case["material"], materials)
    else:
        kind = str(case.get("composite", CHOICES["composite"][0]))
        material = _composed(kind, phases_of(phases, materials), float(case[COMPOSITES[kind]]))
    if "cut" not in case:
        return material
    cut = of_family(str(case["cut"]), float(case.get("cut_angle", 0.0)))
    if material.cut:
        raise FactorError(f"cut: {cut!r} beside {material.name}, which has the cut {material.cut}")
    return replace(material, cut=cut)


@cached
def _composed(kind: str, phases: tuple[Material, Material], fraction: float) -> Material:
    """Return the composite of one fraction, one object for all cases."""
    return compose(kind, phases, fraction)


def material_named(which: str | Material, materials: Mapping[str, Material]) -> Material:
    """Return a material, or the one of a name, the user's before the built-in ones."""
    return which if isinstance(which, Material) else find(str(which), materials)  # str: numpy has texts of its own


def punch_of(cases: Cases) -> Punch:
    """Return the elasticity of the punch over the case axes."""
    return Punch.isotropic(*elasticity_of(cases)) if _given(cases) else RIGID_PUNCH


def elasticity_of(cases: Cases) -> tuple[Array, Array]:
    """Young's modulus [Pa], infinite for a rigid punch, and Poisson's ratio; (...) each."""
    if not _given(cases):
        return np.array(_MODULUS_OF_RIGID), np.array(_POISSON_OF_RIGID)
    which = cases.values.get("punch", np.array(None, dtype=object))
    known = {punch: _elastic(cases, punch) for punch in dict.fromkeys(which.flat)}  # each name is looked up once
    modulus, poisson = np.array([known[punch] for punch in which.flat]).T.reshape(2, *which.shape)
    if "punch_modulus" in cases.values:
        by_modulus = cases.values["punch_modulus"], cases.values["punch_poisson"]
        has_modulus = ~np.isnan(by_modulus[0])
        modulus, poisson = np.where(has_modulus, by_modulus[0], modulus), np.where(has_modulus, by_modulus[1], poisson)
    return modulus, poisson


def punch_datum(cases: Cases) -> Array | None:
    """Distance at which an elastic punch is at rest (radius, width or datum) [m], or None without a punch; (...)."""
    if not _given(cases):
        return None
    return cases.number(next((name for name in ("radius", "width") if name in cases.outline.needs), "datum"))


def _given(cases: Cases) -> bool:
    """Return whether the cases have factors of the punch's material."""
    return not cases.values.keys().isdisjoint(OF_A_PUNCH)


def _elastic(cases: Cases, which: object) -> tuple[float, float]:
    """Modulus [Pa] and Poisson's ratio of one punch, from the library of punches or a material."""
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
    """Modulus [Pa] and Poisson's ratio of an isotropic material without coupling."""
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
