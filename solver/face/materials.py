"""Materials of every case: of its body, by name, own or of a composite's fraction, of its base and of its punch."""

from collections.abc import Iterable, Mapping
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array, BoolArray, shown
from solver.face.cases import Cases
from solver.face.factorvalues import absent
from solver.face.refusal import FactorError
from solver.halfplane.sliding import RIGID_PUNCH, Punch
from solver.halfplane.surface import HalfPlane
from solver.material.composite import compose
from solver.material.constants import Material, MaterialError, combined
from solver.material.library import find
from solver.material.punches import find_punch, punches
from solver.names import CHOICES, COMPOSITES, OF_A_PUNCH, OF_MATERIAL
from solver.stack.layers import RIGID

#: Half-planes of the distinct materials of the tables that are solved now.
_DISTINCT: WeakKeyDictionary[Cases, HalfPlane] = WeakKeyDictionary()
_SAME = 1e-9  # relative difference up to which two stiffnesses are one
_COUPLINGS = ("e31", "e33", "e15", "f31", "f33", "f15")
_MODULUS_OF_RIGID, _POISSON_OF_RIGID = np.inf, 0.0


def material_of(cases: Cases) -> Material:
    """The material of cases, constants over their axes."""
    phases = phases_of(cases)
    if "material" in cases.values:
        return _chosen(cases.values["material"], cases.materials)
    kinds = cases.values.get("composite", np.array(CHOICES["composite"][0]))
    composites = {
        str(kind): compose(str(kind), phases, cases.values[COMPOSITES[kind]]) for kind in dict.fromkeys(kinds.flat)
    }
    if len(composites) == 1:
        return next(iter(composites.values()))
    places = [kinds == kind for kind in composites]
    return combined(lambda *values: np.select(places, values), composites.values(), "composite")


def half_plane_of(cases: Cases) -> HalfPlane:
    """The half-plane of cases; neighbours in a table that have one material and speed share its tensors."""
    if cases.distinct is not None:
        if cases.distinct not in _DISTINCT:
            _DISTINCT[cases.distinct] = half_plane_of(cases.distinct)
        whole = _DISTINCT[cases.distinct]
        return whole if cases.case_index is None else whole.repeated(cases.case_index)
    names = [name for name in (*OF_MATERIAL, "speed") if name in cases.values and cases.values[name].size > 1]
    if len(cases.sizes) == 1 and names:
        ((dim, count),) = cases.sizes.items()
        changes = np.full(count, True)
        changes[1:] = np.any([cases.values[name][1:] != cases.values[name][:-1] for name in names], axis=0)
        if not changes.all():
            return half_plane_of(cases.selected(dim, np.flatnonzero(changes))).repeated(np.cumsum(changes) - 1)
    speed = cases.number("speed")
    return HalfPlane(material_of(cases), speed) if np.any(speed) else HalfPlane(material_of(cases))


def phases_of(cases: Cases) -> tuple[Material, Material]:
    """Phase one and phase two of a composite."""
    if len(cases.phases) != 2:
        raise FactorError(f"phases: {len(cases.phases)} given; a composite has two")
    first, two = (material_named(phase, cases.materials) for phase in _named("phases", cases.phases))
    return first, two


def base_of(cases: Cases) -> tuple[Material, BoolArray]:
    """The base of every case, and where it is rigid: the constants of a rigid one have no meaning."""
    if "base" not in cases.values:
        return _isotropic(cases), np.array(False)
    which = cases.values["base"]
    rigid = np.array([value == RIGID for value in which.flat], dtype=bool).reshape(which.shape)
    named = np.array([not absent(value) for value in which.flat], dtype=bool).reshape(which.shape) & ~rigid
    filled = np.empty(which.shape, dtype=object)
    filled[...] = "steel"  # stands where a base is rigid or given by its modulus
    filled[named] = which[named]
    try:
        base = _chosen(filled, cases.materials)
    except MaterialError as error:
        _, _, reason = str(error).partition("material: ")
        also = f", {RIGID}" if "known are" in reason else ""
        raise FactorError(f"base: {reason}{also}" if reason else f"base: {error}") from None
    if "base_modulus" not in cases.values:
        return base, rigid
    return combined(lambda *values: np.where(named | rigid, *values), (base, _isotropic(cases)), "base"), rigid


def _isotropic(cases: Cases) -> Material:
    """Isotropic bases by modulus and Poisson's ratio; any where these are absent."""
    modulus, poisson = cases.values["base_modulus"], cases.values["base_poisson"]
    modulus, poisson = (np.where(np.isnan(v), standing, v) for v, standing in ((modulus, 1e11), (poisson, 0.3)))
    return Material.isotropic(modulus, poisson, name="base", any_size=True)


def _chosen(which: NDArray[Any], materials: Mapping[str, Material]) -> Material:
    """Materials by case; each is found and checked once, however many cases it has."""
    named = _named("material", which.flat)
    place = {m: k for k, m in enumerate(dict.fromkeys(named))}
    chosen = [material_named(m, materials) for m in place]
    for material in chosen:
        if material.shape:
            raise FactorError(f"material: {material.name!r} holds arrays; a factor takes one material a value")
        material.check()
    of_case = np.array([place[m] for m in named], dtype=np.intp).reshape(which.shape)
    name = chosen[0].name if len(chosen) == 1 else "material"
    return combined(lambda *values: np.array(values)[of_case], chosen, name)


def _named(factor: str, values: Iterable[object]) -> list[str | Material]:
    """Values that are names or materials, and nothing else."""
    named: list[str | Material] = []
    for value in values:
        if not isinstance(value, str | Material):
            raise FactorError(f"{factor}: {shown(value)} is no material; give the name of one, or a Material")
        named.append(value if isinstance(value, Material) else str(value))  # a text of numpy is a plain one
    return named


def material_named(which: str | Material, materials: Mapping[str, Material]) -> Material:
    """The material of a name, a user's own before the built-in ones; a material as it is."""
    return which if isinstance(which, Material) else find(which, materials)


def punch_of(cases: Cases) -> Punch:
    """The elasticity of the punch, over the case axes."""
    return Punch.isotropic(*elasticity_of(cases)) if _given(cases) else RIGID_PUNCH


def elasticity_of(cases: Cases) -> tuple[Array, Array]:
    """Young's modulus [Pa], infinite of a rigid punch, and Poisson's ratio; (...)."""
    if not _given(cases):
        return np.array(_MODULUS_OF_RIGID), np.array(_POISSON_OF_RIGID)
    which = cases.values.get("punch", np.array(None, dtype=object))
    known = {punch: _elastic(cases, punch) for punch in dict.fromkeys(which.flat)}  # every name is found once
    modulus, poisson = np.array([known[punch] for punch in which.flat]).T.reshape(2, *which.shape)
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


def _elastic(cases: Cases, which: object) -> tuple[float, float]:
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
