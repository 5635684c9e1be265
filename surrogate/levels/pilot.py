"""Pilots that make themselves: small factorials, one an input, refined until they show what is to be known."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
import xarray as xr

from approximation.arrays import Array
from surrogate.data.inputs import Input
from surrogate.levels.counts import LevelChoice, choose, decays
from surrogate.levels.decay import Decay

#: Levels of a pilot along the input that it is for: every refinement halves the spacing.
LEVELS = (9, 17, 33, 65)
#: Levels of all other inputs, the most that the share of the budget allows.
OTHERS = (5, 4, 3, 2)

Solve = Callable[[dict[str, Array]], xr.Dataset]


@dataclass(frozen=True)
class Pilot:
    """Result of the pilots."""

    choice: LevelChoice  # The level counts and the evidence for them
    levels: dict[str, int]  # Levels of the finest pilot along every input
    cases: int  # Cases of all pilots together


def explore(
    solve: Solve,
    inputs: Sequence[Input],
    tolerance: float,
    budget: int,
    outputs: Sequence[str] | None = None,
    fixed: Mapping[str, int] = MappingProxyType({}),
) -> Pilot:
    """Choose level counts from pilots along one input at a time.

    A pilot has many levels of one input and few of the others, so that the largest coefficient over its lines is that
    over the box, nearly. It is refined while the chosen count exceeds its levels or an output looks kinked along it, as
    long as all pilots together stay within the budget.
    """
    judged: dict[str, dict[str, Decay]] = {}
    fineness = dict.fromkeys((input_.name for input_ in inputs), 0)
    waiting, spent = [input_.name for input_ in inputs], 0
    while waiting:
        for name in waiting:
            axes = _levels(inputs, name, LEVELS[fineness[name]], budget)
            spent += int(np.prod([len(axis) for axis in axes.values()]))
            for output, along in decays(solve(axes), inputs, outputs).items():
                judged.setdefault(output, {})[name] = along[name]
        waiting = []
        for name in _unsettled(judged, tolerance, fixed):
            finer = fineness[name] + 1
            lines = _others(len(inputs), budget) ** (len(inputs) - 1)
            if finer < len(LEVELS) and spent + LEVELS[finer] * lines <= budget:
                fineness[name] = finer
                waiting.append(name)
    ordered = {output: {input_.name: along[input_.name] for input_ in inputs} for output, along in judged.items()}
    choice = choose(ordered, tolerance, budget, fixed)
    return Pilot(choice, {name: LEVELS[fine] for name, fine in fineness.items()}, spent)


def _levels(inputs: Sequence[Input], along: str, count: int, budget: int) -> dict[str, Array]:
    others = _others(len(inputs), budget)
    return {input_.name: input_.levels(count if input_.name == along else others) for input_ in inputs}


def _others(inputs: int, budget: int) -> int:
    """Levels of the inputs that a pilot is not for: all first pilots together take at most half of the budget."""
    room = budget / (2 * inputs * LEVELS[0])
    return next((n for n in OTHERS if n ** (inputs - 1) <= room), OTHERS[-1])


def _unsettled(judged: Mapping[str, Mapping[str, Decay]], tolerance: float, fixed: Mapping[str, int]) -> list[str]:
    """Inputs of whose decay more must be seen: a kink is suspected, or more levels are needed than were seen."""
    names = list(next(iter(judged.values())))
    unsettled = []
    for name in names:
        decays_along = [along[name] for along in judged.values()]
        seen = max(len(decay.coefficients) for decay in decays_along)
        unclear = name not in fixed and max(decay.error(seen) for decay in decays_along) > tolerance / len(names)
        if unclear or any(decay.algebraic for decay in decays_along):
            unsettled.append(name)
    return unsettled
