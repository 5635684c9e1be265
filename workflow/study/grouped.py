"""Groups of a study: axes of its data set that are products of powers of its factors.

Two cases with the same groups must be similar (`solver.similarity`): otherwise a surrogate over the groups would give
one answer to two questions.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import combinations

import numpy as np
import scipy  # scipy.linalg, slow to import, and few studies have groups

from solver.similarity import Weight, weight_of
from surrogate import Input
from surrogate.data.inputs import Scale
from surrogate.transforms.groups import span
from workflow.language.expressions import Expression, Name, Number, Operation
from workflow.language.factors import FACTORS
from workflow.language.grammar import parse
from workflow.language.spelling import nearest
from workflow.study.reading import located
from workflow.study.sections import Axis, Group

_SAME = 1e-9
_LARGEST_POWER = 9
_DECADE = 10.0  # a product that spans more than this is spread in its logarithm


@dataclass(frozen=True)
class Product:
    """A product of whole powers of factors."""

    powers: Mapping[str, int]  # of every factor; the cases of the data set vary the first one
    name: str  # of the axis in files
    units: str
    text: str  # as the study has it

    @property
    def lone(self) -> bool:
        """Return True if the product is one factor to the power one."""
        return list(self.powers.values()) == [1]

    @property
    def long_name(self) -> str:
        """Meaning of the factor where the product is one; else the product as the study has it."""
        return FACTORS[self.name].long_name if self.lone else self.text


@cache
def product(text: str) -> Product:
    """Read a product as ``load * radius / thickness^2``; ValueError, in one line, for any other text."""
    for name in re.findall(r"[^\W\d]\w*\b(?!\s*\()", text):
        if name not in FACTORS:
            raise ValueError(f"groups: {text!r}: {name!r} is no factor; {nearest(name, list(FACTORS))}")
    with located("groups"):
        tree = parse(text, "point")  # where the name force is no figure of a device, but a factor
        powers = {name: power for name, power in _powers(text, tree).items() if power}
    if not powers:
        raise ValueError(f"groups: {text!r}: is 1")
    if max(map(abs, powers.values())) > _LARGEST_POWER:
        raise ValueError(f"groups: {text!r}: powers of a factor must be at most {_LARGEST_POWER}")
    above = [_called(name, power) for name, power in powers.items() if power > 0]
    below = [_called(name, -power) for name, power in powers.items() if power < 0]
    name = "_".join(above or ["one"]) + ("_per_" + "_".join(below) if below else "")
    return Product(powers, name, str(tree.unit() or 1), re.sub(r"\s+", " ", text.strip()))


def _called(name: str, power: int) -> str:
    return name if power == 1 else f"{name}{power}"


def _powers(text: str, node: Expression) -> dict[str, int]:
    if isinstance(node, Name):
        return {node.name: 1}
    if isinstance(node, Operation) and node.symbol == "^" and isinstance(exponent := node.parts[1], Number):
        return {name: power * int(exponent.value) for name, power in _powers(text, node.parts[0]).items()}
    if isinstance(node, Operation) and node.symbol in ("*", "/"):
        powers, right = (_powers(text, part) for part in node.parts)
        sign = 1 if node.symbol == "*" else -1
        for name, power in right.items():
            powers[name] = powers.get(name, 0) + sign * power
        return powers
    raise ValueError(f"{text!r}: only products and quotients of whole powers of factors make a group")


def axes(groups: Mapping[str, Group], factors: Mapping[str, Axis], fixed: Mapping[str, float]) -> dict[str, Axis]:
    """Return the axes of the data set by name, over their ranges in the box."""
    by_name: dict[str, Axis] = {}
    for text, group in groups.items():
        axis = product(text)
        _check_names(axis, factors, fixed)
        if axis.name in by_name:
            raise ValueError(f"groups: {text}: is given twice")
        try:
            low, high = span(_inputs(axis, factors, fixed), dict(axis.powers))
        except OverflowError:
            low = high = np.inf
        if not (np.isfinite([low, high]).all() and low < high):
            raise ValueError(f"groups: {text}: is beyond the range of numbers")
        scale = group.scale or _usual_scale(axis, factors, low, high)
        shown = f"{low:g} to {high:g} [{axis.units}]"
        if (scale == "log" and low <= 0) or (scale == "logit" and not 0 < low < high < 1):
            needs = "> 0" if scale == "log" else "between 0 and 1"
            raise ValueError(f"groups: {text}: scale: {scale} needs a range {needs}, this one is {shown}")
        by_name[axis.name] = Axis(low=low, high=high, levels=group.levels, scale=scale)
    return by_name


def _check_names(axis: Product, factors: Mapping[str, Axis], fixed: Mapping[str, float]) -> None:
    for name, power in axis.powers.items():
        if name not in factors and not fixed.get(name):
            raise ValueError(f"groups: {axis.text}: {name!r} is none of the factors, nor fixed at a number but 0")
        low = factors[name].low if name in factors else fixed[name]
        if low <= 0 and power < 0:
            raise ValueError(f"groups: {axis.text}: divides by {name!r}, which is from {low:g} on; must be > 0")
    if not any(name in factors for name in axis.powers):
        raise ValueError(f"groups: {axis.text}: holds none of the factors")


def _inputs(axis: Product, factors: Mapping[str, Axis], fixed: Mapping[str, float]) -> list[Input]:
    width = 1e-12  # of the range of a fixed factor, relative
    ends = {
        name: (factors[name].low, factors[name].high) if name in factors else (fixed[name], fixed[name] * (1 + width))
        for name in axis.powers
    }
    return [Input(name, min(pair), max(pair)) for name, pair in ends.items()]


def _usual_scale(axis: Product, factors: Mapping[str, Axis], low: float, high: float) -> Scale:
    """Return the default scale of a group: its factor's, or a logarithm over more than a decade."""
    if axis.lone:
        return factors[next(iter(axis.powers))].scale
    return "log" if low > 0 and high / low > _DECADE else "linear"


def leads(products: Iterable[Product], factors: Mapping[str, Axis]) -> dict[str, str]:
    """Return the factor that cases of the data set vary for each axis: the first one with a range."""
    varied: dict[str, str] = {}
    for axis in products:
        first = next(name for name in axis.powers if name in factors)
        if first in varied.values():
            raise ValueError(f"groups: {axis.text}: begins with {first!r} as another group does; begin with another")
        varied[axis.name] = first
    return varied


def unlike(products: Sequence[Product], factors: Sequence[str], fixed: Mapping[str, Weight]) -> dict[str, float] | None:
    """Return a change of the factors that no group sees and that is no similarity; None where there is none."""
    A = np.array([[axis.powers.get(name, 0) for name in factors] for axis in products], dtype=np.float64)
    A = A.reshape(-1, len(factors))
    W = np.array([[weight.size, weight.strength] for weight in map(weight_of, factors)])
    fixed_weights = np.array([[weight.size, weight.strength] for weight in fixed.values()]).reshape(-1, 2)
    similar = W @ (scipy.linalg.null_space(fixed_weights) if len(fixed_weights) else np.eye(2))
    unseen = scipy.linalg.null_space(A)
    dissimilar = unseen - similar @ np.linalg.lstsq(similar, unseen, rcond=None)[0]
    if not unseen.size or np.abs(dissimilar).max() < _SAME:
        return None
    worst = unseen[:, int(np.abs(dissimilar).max(axis=0).argmax())]
    worst = worst / worst[np.abs(worst).argmax()]
    return {name: 10.0**power for name, power in zip(factors, worst.tolist(), strict=True) if abs(power) > _SAME}


def check_signs(products: Sequence[Product], factors: Mapping[str, Axis], fixed: Mapping[str, Weight]) -> None:
    """Raise ValueError, in one line, where cases with the same groups differ in a sign, or where a factor is 0."""
    for flipped in _subsets([name for name, axis in factors.items() if axis.low < 0 < axis.high]):
        if not any(sum(axis.powers.get(name, 0) for name in flipped) % 2 for axis in products):
            raise ValueError(f"groups: the sign of {' and '.join(flipped)} is in no group; give an odd power of it")
    for zero in _subsets([name for name, axis in factors.items() if axis.low <= 0 <= axis.high]):
        nonzero = [axis for axis in products if not axis.powers.keys() & set(zero)]
        if change := unlike(nonzero, [name for name in factors if name not in zero], fixed):
            hidden = ", ".join(axis.text for axis in products if axis not in nonzero)
            raise ValueError(f"{refusal(change)}; {' = '.join(zero)} = 0 is in the box, where {hidden} tells no more")


def _subsets(names: Sequence[str]) -> list[tuple[str, ...]]:
    """Return every subset of one or more names."""
    return [subset for size in range(1, len(names) + 1) for subset in combinations(names, size)]


def refusal(change: Mapping[str, float]) -> str:
    """Return the refusal, in one line, of groups that do not distinguish a change."""
    shown = " and ".join(f"{name} x {by:.3g}" for name, by in change.items())
    return (
        f"groups: {shown} is in no group, and is another contact: under similarity lengths (also the radius and the "
        "datum) go together, and load and charges with length squared over radius, as load * radius / thickness^2"
    )
