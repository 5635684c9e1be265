"""The material of every case, from names, own materials or a composite's fraction."""

from collections.abc import Iterable, Mapping
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from solver.arrays import BoolArray, shown
from solver.face.cases import Cases
from solver.face.filmfactors import absent
from solver.face.refusal import FactorError
from solver.halfplane.surface import HalfPlane
from solver.material.composite import compose
from solver.material.constants import Material, MaterialError, combined
from solver.material.library import find
from solver.names import CHOICES, COMPOSITES, OF_MATERIAL
from solver.stack.layers import RIGID

#: Half-planes of the distinct materials of the tables that are solved now.
_DISTINCT: WeakKeyDictionary[Cases, HalfPlane] = WeakKeyDictionary()


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
