"""Allowables of a study's body: strength, depoling, coercive and breakdown field of its materials, with sources."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from solver import Material, find
from solver.material.composite import compose
from solver.names import CHOICES, MIXTURES
from solver.stack.layers import RIGID
from workflow.language.constants import of_the_base, plain

#: Entries of a layer, or factors, that say what it is made of.
MADE_OF = ("material", "composite", "volume_fraction")


@dataclass(frozen=True)
class Allowable:
    """The most that a material may be exposed to, by its own data."""

    value: float  # In SI
    material: str  # name of the material, with what is unknown of its phases
    source: str  # Where it comes from


def allowable(
    name: str, factors: Mapping[str, Any], materials: Mapping[str, Material], phases: Sequence[str]
) -> Allowable:
    """The allowable of the top material, or of the base, of one body.

    Of a composite it is what its weaker phase bears, of those whose figure is known: a phase that is not known to bear
    anything is not known to bear more. A volume fraction of 0 or 1 leaves one phase.
    """
    limit = plain(name)
    if of_the_base(name):
        base = factors.get("base")
        if base is None or base == RIGID:
            modulus = "a base of given modulus" if "base_modulus" in factors else "a half-plane, without a base,"
            raise ValueError(f"{name}: {'a rigid base' if base else modulus} has none")
        return _least(limit, [find(str(base), materials)], "")
    if "material" in factors:
        return _least(limit, [find(str(factors["material"]), materials)], "")
    kind = str(factors.get("composite", CHOICES["composite"][0]))
    if kind not in MIXTURES:
        return _least(limit, [compose(kind, (), 0.0)], "")
    first, second = (find(phase, materials) for phase in phases)
    fraction = factors.get("volume_fraction")
    parts = [first] if fraction == 1 else [second] if fraction == 0 else [first, second]
    return _least(limit, parts, kind)


def _least(limit: str, parts: Sequence[Material], composite: str) -> Allowable:
    """The least allowable of some materials."""
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
