"""Scenarios of a design: nodes of ranges and tolerances, and draws of distributions."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import reduce
from itertools import product

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from approximation.arrays import Array
from approximation.sobol import sobol_points
from workflow.design.question.risk import Term
from workflow.study.target import Target

#: Nodes a factor of a tensor of ranges, by the number of factors, while searching and while judging the outcome.
SEARCHED = {0: 1, 1: 9, 2: 7, 3: 5}
JUDGED = {0: 1, 1: 201, 2: 31, 3: 11}
JUDGED_FILMS = JUDGED | {1: 31}
#: Draws of the distributions: powers of two, as Sobol' sequences want.
DRAWN, DRAWN_TO_JUDGE = 256, 4096
#: Nodes a worst-case factor beside draws.
GROUPS = {0: 1, 1: 5}
_FEW = 9  # nodes of a range up to which a tolerance has three, and five beyond
_GAUSS = 512  # points by which a distribution's moments are integrated


@dataclass(frozen=True)
class Scenarios:
    """Values of the factors that a design does not choose."""

    values: dict[str, Array]  # by factor, (groups * draws,) each; the draws of a group follow each other
    groups: int  # number of cases of the ranges
    draws: int  # number of draws in each group
    terms: dict[int, Term] = field(default_factory=dict)  # of a question, which count over them, by place
    offsets: dict[str, Array] = field(default_factory=dict)  # in tolerances, -1 to 1, by variable, (groups * draws,)

    @property
    def count(self) -> int:
        """Number of scenarios."""
        return self.groups * self.draws

    def only(self, columns: NDArray[np.intp]) -> "Scenarios":
        """Return some of the scenarios, each as a group."""
        values = {name: levels[columns] for name, levels in self.values.items()}
        offsets = {name: levels[columns] for name, levels in self.offsets.items()}
        return replace(self, values=values, offsets=offsets, groups=len(columns), draws=1)


def corners(target: Target, nodes: Mapping[int, int]) -> Scenarios:
    """Return a tensor of Chebyshev-Lobatto nodes over worst cases, tolerances and supports of distributions."""
    return _scenarios(target, _tensor(_levels(target, nodes)), 1)


def along(target: Target, names: tuple[str, ...], nodes: Mapping[int, int]) -> Scenarios:
    """Return `corners` in groups: the draws of a group are the nodes of some names."""
    levels = _levels(target, nodes)
    groups = _tensor({name: values for name, values in levels.items() if name not in names})
    inner = _tensor({name: levels[name] for name in names})
    return _scenarios(target, _crossed(groups, inner), len(inner[names[0]]))


def weights(target: Target, names: tuple[str, ...], nodes: Mapping[int, int]) -> Array:
    """Return the weights of draws of `along` in a mean over the distributions of its names, (draws,).

    Worst cases and tolerances count as uniform. The weights integrate the polynomial through the nodes: for a uniform
    distribution those of C. W. Clenshaw and A. R. Curtis, Numer. Math. 2 (1960) 197.
    """
    all_levels, parts = _levels(target, nodes), list[Array]()
    for name in names:
        levels = all_levels[name]
        low, high = levels[0], levels[-1]
        if len(levels) == 1:
            parts.append(np.ones(1))
            continue
        gauss, share = np.polynomial.legendre.leggauss(_GAUSS)
        middle = (gauss + 1) / 2
        distribution = target.uncertain.get(name)
        points = low + (high - low) * middle if distribution is None else distribution.quantile(middle)
        moments = chebyshev.chebvander(2 * (points - low) / (high - low) - 1, len(levels) - 1).T @ (share / 2)
        nodal = chebyshev.chebvander(2 * (levels - low) / (high - low) - 1, len(levels) - 1)
        parts.append(np.asarray(np.linalg.solve(nodal.T, moments), dtype=np.float64))
    return np.asarray(reduce(np.multiply.outer, parts)).ravel()


def draws(target: Target, count: int) -> Scenarios:
    """Return Sobol' draws of the distributions, uniform within tolerances, at a few nodes of worst-case ranges."""
    count_of_nodes = GROUPS.get(len(target.worst_case), 3)
    groups = _tensor({name: _nodes(low, high, count_of_nodes) for name, (low, high) in target.worst_case.items()})
    # the middle of its cell instead of the corner: no draw is an end of a support
    shares = (np.floor(sobol_points(count, len(target.random), None) * count) + 0.5) / count
    drawn = {
        name: target.uncertain[name].quantile(share) if name in target.uncertain else 2 * share - 1
        for name, share in zip(target.random, shares.T, strict=True)
    }
    return _scenarios(target, _crossed(groups, drawn), count)


def _crossed(groups: Mapping[str, Array], inner: Mapping[str, Array]) -> dict[str, Array]:
    """Return every group with every one of the inner cases, which follow each other."""
    size = len(next(iter(inner.values())))
    count = len(next(iter(groups.values()))) if groups else 1
    whole = {name: np.repeat(values, size) for name, values in groups.items()}
    return whole | {name: np.tile(values, count) for name, values in inner.items()}


def _scenarios(target: Target, levels: dict[str, Array], draws: int) -> Scenarios:
    """Return scenarios of levels of factors and of offsets in tolerances, all of one length."""
    values = {name: values for name, values in levels.items() if name not in target.tolerance}
    offsets = {name: values for name, values in levels.items() if name in target.tolerance}
    count = len(next(iter(levels.values()))) if levels else 1
    return Scenarios(values, count // draws, draws, offsets=offsets)


def _levels(target: Target, nodes: Mapping[int, int]) -> dict[str, Array]:
    """Return the nodes of worst cases, of supports of distributions, and of tolerances, which need few."""
    ranges = target.ranges
    count = nodes.get(len(ranges) + len(target.tolerance), 3)
    levels = {name: _nodes(low, high, count) for name, (low, high) in ranges.items()}
    return levels | dict.fromkeys(target.tolerance, _nodes(-1.0, 1.0, 3 if count <= _FEW else 5))


def _nodes(low: float, high: float, count: int) -> Array:
    return np.unique(low + (high - low) * (1 - np.cos(np.pi * np.arange(count) / max(count - 1, 1))) / 2)


def _tensor(levels: Mapping[str, Array]) -> dict[str, Array]:
    """Return every combination of the levels of some names, (cases,) each; empty without names."""
    cases = np.array(list(product(*levels.values())), dtype=np.float64)
    return {name: cases[:, column] for column, name in enumerate(levels)}
