"""Contacts beyond small strain: too wide for their punch's radius, or too deep for their film."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from solver.arrays import Array
from solver.face.cases import Cases
from solver.face.filmbodies import stacks_of
from solver.names import BODY
from solver.stack.layers import Stack

WIDE, DEEP = 0.2, 0.1  # largest half-width over radius, and depth over thickness, as in designs
_STIFF = 10.0  # c44 of a base over its film's, above which the depth is that of the film


@dataclass(frozen=True)
class Excess:
    """Cases whose size exceeds a limit, and the worst of them."""

    words: str  # Template for size, share and reference
    limit: float
    count: int
    size: float  # [m]
    reference: float  # [m]

    @property
    def share(self) -> float:
        """Ratio of the size to its reference."""
        return self.size / self.reference

    def __str__(self) -> str:
        words = self.words.format(f"{self.size:.3g} m", f"{self.share:.2g}", f"{self.reference:.3g} m")
        return f"{words} (at most {self.limit:g})"


def excesses(cases: Cases, values: Mapping[str, Array]) -> list[Excess]:
    """Return the sizes beyond small strain among the solved cases of one kind."""
    strains: list[Excess | None] = []
    names = cases.kind.ends
    if "radius" in cases.outline.takes and all(name in values for name in names):
        width = (values[names[0]] + values[names[1]]) / (2 if cases.kind.space else 1)
        words = "a half-width of {} is {} of the punch radius {}"
        strains.append(_excess(words, WIDE, width / 2, cases.values["radius"]))
    if cases.kind.layered and cases.kind.datum != "relative" and "depth" in values:
        thickness = _thickness(cases)
        if np.max(values["depth"]) > DEEP * np.min(thickness):
            stacks, which = stacks_of(cases)
            is_on_stiff = np.array([_is_on_stiff(stack) for stack in stacks])[which]
            depth = np.where(is_on_stiff, values["depth"], 0.0)
            strains.append(_excess("a depth of {} is {} of the thickness {}", DEEP, depth, thickness))
    return [excess for excess in strains if excess]


def _excess(words: str, limit: float, size: Array, reference: Array) -> Excess | None:
    """Return the excess of sizes over a limit times a reference, None if there is none; (...) each."""
    if np.max(size) <= limit * np.min(reference):  # the usual case in one pass
        return None
    share = size / reference
    count = int(np.count_nonzero(share > limit))
    if not count:
        return None
    worst = np.unravel_index(int(np.nanargmax(share)), share.shape)
    return Excess(words, limit, count, *(float(np.broadcast_to(v, share.shape)[worst]) for v in (size, reference)))


def _thickness(cases: Cases) -> Array:
    """Thickness of all layers of every case [m]; (...)."""
    if BODY not in cases.values:
        return np.asarray(cases.values["thickness"])
    stacks: list[Stack] = list(cases.values[BODY].flat)
    return np.array([stack.thickness for stack in stacks]).reshape(cases.values[BODY].shape)


def _is_on_stiff(stack: Stack) -> bool:
    """Return whether the base is rigid or much stiffer than a layer; otherwise the depth is the base's."""
    softest = min(float(layer.material.c44) for layer in stack.layers)
    return isinstance(stack.base, str) or float(stack.base.c44) > _STIFF * softest


def sentence(strains: Iterable[Excess], cases: int) -> str:
    """Return one line with the number of cases and the worst of each kind of excess; empty if there is none."""
    joined: dict[str, Excess] = {}
    for excess in strains:
        worse = max(joined.get(excess.words, excess), excess, key=lambda candidate: candidate.share)
        count = excess.count + (joined[excess.words].count if excess.words in joined else 0)
        joined[excess.words] = replace(worse, count=count)
    parts = [
        f"in {excess.count} of {cases} cases, at worst {excess}" if cases > 1 else str(excess)
        for excess in joined.values()
    ]
    return f"contact: beyond small strain: {'; '.join(parts)}" if parts else ""
