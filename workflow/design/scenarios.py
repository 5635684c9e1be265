"""The cases that a design must stand: the ends and insides of ranges, and draws of distributions."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from workflow.design.terms import Term
from workflow.study.target import Target

Array = NDArray[np.float64]

#: Nodes a factor of a tensor of ranges, by the number of factors, while searching and while judging the outcome.
SEARCHED = {0: 1, 1: 9, 2: 7, 3: 5}
JUDGED = {0: 1, 1: 201, 2: 31, 3: 11}
#: Draws of the distributions: powers of two, as Sobol' sequences want.
DRAWN, DRAWN_TO_JUDGE = 256, 4096
#: Nodes a worst-case factor beside draws.
GROUPS = {0: 1, 1: 5}


@dataclass(frozen=True)
class Scenarios:
    """Values of the factors that a design does not choose.

    Attributes
    ----------
    values
        By factor name, (groups * draws,) each; a group is one case of the ranges, its draws follow each other.
    groups, draws
        How many.
    terms
        The terms of a question that count over them, by their place in it.
    """

    values: dict[str, Array]
    groups: int
    draws: int
    terms: dict[int, Term] = field(default_factory=dict)

    @property
    def count(self) -> int:
        """Number of scenarios."""
        return self.groups * self.draws

    def only(self, columns: NDArray[np.intp]) -> "Scenarios":
        """Some of them, a group each."""
        values = {name: levels[columns] for name, levels in self.values.items()}
        return replace(self, values=values, groups=len(columns), draws=1)


def corners(target: Target, nodes: Mapping[int, int]) -> Scenarios:
    """Tensor of Chebyshev-Lobatto nodes over every range: worst cases, and the supports of distributions."""
    ranges = _ranges(target) | {name: distribution.support for name, distribution in target.uncertain.items()}
    return _tensor(ranges, nodes.get(len(ranges), 3))


def draws(target: Target, count: int) -> Scenarios:
    """Sobol' draws of the distributions at a few nodes of every worst-case range."""
    groups = _tensor(_ranges(target), GROUPS.get(len(target.worst_case), 3))
    # the middle of its cell instead of the corner: no draw is an end of a support
    shares = (np.floor(qmc.Sobol(len(target.uncertain), scramble=False).random(count) * count) + 0.5) / count
    values = {name: np.repeat(levels, count) for name, levels in groups.values.items()}
    for column, (name, distribution) in enumerate(target.uncertain.items()):
        values[name] = np.tile(distribution.quantile(shares[:, column]), groups.groups)
    return Scenarios(values, groups.groups, count)


def _ranges(target: Target) -> dict[str, tuple[float, float]]:
    return {name: (low, high) for name, (low, high) in target.worst_case.items()}


def _tensor(ranges: Mapping[str, tuple[float, float]], nodes: int) -> Scenarios:
    share = (1 - np.cos(np.pi * np.arange(nodes) / max(nodes - 1, 1))) / 2
    cases = list(product(*(np.unique(low + (high - low) * share) for low, high in ranges.values())))
    grid = np.array(cases, dtype=np.float64).reshape(len(cases), len(ranges))
    return Scenarios({name: grid[:, column] for column, name in enumerate(ranges)}, len(grid), 1)
