"""Allowables of a study's body: limits of its materials with their sources."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from solver import Material, find
from solver.material.composite import compose
from solver.names import CHOICES, MIXTURES
from solver.stack.layers import RIGID
from workflow.language.constants import of_the_base, plain

#: Entries of a layer, or factors, that name its material.
MADE_OF = ("material", "composite", "volume_fraction")


@dataclass(frozen=True)
class Allowable:
    """Largest stress or field that a material may be exposed to."""

    value: float  # in SI
    material: str  # name of the material, and of phases whose limit is unknown
    source: str


def allowable(
    name: str, factors: Mapping[str, Any], materials: Mapping[str, Material], phases: Sequence[str]
) -> Allowable:
    """Return the allowable of the top material or of the base of one body; of a composite that of its weaker phase."""
    limit = plain(name)
    if of_the_base(name):
        base = factors.get("base")
        if base is None or base == RIGID:
            modulus = "a base of given modulus" if "base_modulus" in factors else "a half-plane, without a base,"
            raise ValueError(f"{name}: {'a rigid base' if base else modulus} has none")
        return _least(limit, [find(str(base), materials)])
    if "material" in factors:
        return _least(limit, [find(str(factors["material"]), materials)])
    kind = str(factors.get("composite", CHOICES["composite"][0]))
    if kind not in MIXTURES:
        return _least(limit, [compose(kind, (), 0.0)])
    first, second = (find(phase, materials) for phase in phases)
    fraction = factors.get("volume_fraction")
    parts = [first] if fraction == 1 else [second] if fraction == 0 else [first, second]
    return _least(limit, parts)


def _least(limit: str, parts: Sequence[Material]) -> Allowable:
    """Return the least of the known allowables of materials; a phase without one is not known to bear more."""
    known = [part for part in parts if limit in part.limits]
    if not known:
        names = " and ".join(part.name for part in parts)
        wanted = "give a number with a unit in its place, or limits in the material's file"
        raise ValueError(f"{limit}: none is known of {names}; {wanted}")
    weakest = min(known, key=lambda material: material.limits[limit].value)
    unknown = ", ".join(part.name for part in parts if part not in known)
    words = weakest.name
    if len(parts) > 1:
        words += f" ({unknown}: none known)" if unknown else ", the weaker phase"
    return Allowable(weakest.limits[limit].value, words, weakest.limits[limit].source)
