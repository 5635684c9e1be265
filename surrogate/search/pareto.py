"""Pareto fronts of several objectives under limits, non-convex ones too.

From references between the best of every objective alone, all objectives rise together as far as possible (A.
Pascoletti and P. Serafini, J. Optim. Theory Appl. 42 (1984) 499). Two objectives have references on the segment between
their anchors (I. Das and J. E. Dennis, SIAM J. Optim. 8 (1998) 631). Between neighbours the front is interpolated.
"""

from dataclasses import dataclass

import numpy as np

from approximation.arrays import Array, Flags
from approximation.sobol import sobol_points
from surrogate.search.optimise import Problem, improve, maximise

_FEASIBLE = 1e-9  # largest excess of a feasible design


@dataclass(frozen=True)
class Front:
    """Non-dominated designs, sorted by the first objective."""

    x: Array  # shape (m, d); the designs
    values: Array  # shape (m, k); their objectives, larger is better
    reference: Array  # shape (k,); least value of every objective over the front
    weights: Array  # shape (k,); its range


def front(problem: Problem, objectives: int, *, points: int = 33, fill: int = 8, scan: int = 4096) -> Front | None:
    """Return the front of a problem whose rows are its objectives' scenarios in turn; None if nothing is feasible."""
    X = 2 * sobol_points(scan, problem.dimension) - 1
    anchors = np.array([maximise(_only(problem, k, objectives), scan=min(scan, 1024)).x for k in range(objectives)])
    X = np.concatenate([_feasible(problem, X), _feasible(problem, anchors)])
    if not len(X):
        return None
    values = _worst(problem, X, objectives)
    ends = values[-len(anchors) :] if len(X) > len(anchors) else values
    low, high = ends.min(0), ends.max(0)
    weights = np.where(high > low, high - low, 1.0)
    starts = [X[values[:, k].argmax()] for k in range(objectives)]
    for reference in _references(values, ends, points):
        start = X[((values - reference) / weights).min(1).argmax()]
        starts.append(improve(scalarised(problem, objectives, reference, weights), start, 1.0).x)
    designs = np.array(starts)
    designs = designs[np.argsort(_worst(problem, designs, objectives)[:, 0])]
    between = _between(designs, _worst(problem, designs, objectives), fill * len(designs))
    designs = _feasible(problem, np.concatenate([designs, between]))
    values = _worst(problem, designs, objectives)
    best = non_dominated(values)
    order = np.argsort(values[best, 0])
    x, values = designs[best][order], values[best][order]
    span = np.ptp(values, axis=0)
    return Front(x, values, values.min(0), np.where(span > 0, span, 1.0))


def scalarised(problem: Problem, objectives: int, reference: Array, weights: Array) -> Problem:
    """Return the problem of maximising the least ``(f_k - reference_k) / weights_k``, weights > 0, (k,) each."""

    def value(X: Array) -> tuple[Array, Array]:
        rows, excess = problem.value(X)
        by_objective = rows.reshape(len(X), objectives, -1)
        return ((by_objective - reference[:, None]) / weights[:, None]).reshape(len(X), -1), excess

    def slope(x: Array) -> tuple[Array, Array]:
        rows, excess = problem.slope(x)
        by_objective = rows.reshape(objectives, -1, len(x)) / weights[:, None, None]
        return by_objective.reshape(-1, len(x)), excess

    return Problem(problem.dimension, value, slope)


def non_dominated(values: Array) -> Flags:
    """Mark the rows of values (m, k) that no other row equals or exceeds in all columns; the first of ties stays."""
    best = np.ones(len(values), dtype=bool)
    order = np.lexsort(-values.T[::-1])
    if values.shape[1] == 2:  # in descending order of the first column, the second must rise
        second = values[order, 1]
        before = np.concatenate([[-np.inf], np.maximum.accumulate(second)[:-1]])
        best[order] = second > before
        return best
    for position, i in enumerate(order):
        better = order[:position][best[order[:position]]]
        best[i] = not np.any(np.all(values[better] >= values[i], axis=1))
    return best


def _references(values: Array, ends: Array, points: int) -> Array:
    """Return references (m, k) on the segment between two anchors, otherwise spread over the scanned front."""
    if ends.shape[1] == 2 and len(ends) == 2:
        share = np.linspace(0, 1, points)[:, None]
        return np.asarray(ends[0] * (1 - share) + ends[1] * share)
    scanned = values[non_dominated(values)]
    chosen = [int(scanned[:, 0].argmax())]
    span = np.where(np.ptp(scanned, axis=0) > 0, np.ptp(scanned, axis=0), 1.0)
    distance = np.full(len(scanned), np.inf)
    while len(chosen) < min(points, len(scanned)):
        distance = np.minimum(distance, np.linalg.norm((scanned - scanned[chosen[-1]]) / span, axis=1))
        chosen.append(int(distance.argmax()))
    return np.asarray(scanned[chosen])


def _between(designs: Array, values: Array, count: int) -> Array:
    """Return about `count` designs, (m, d), on the lines between neighbours, most where the front has wide gaps."""
    gaps = np.sqrt(np.abs(np.prod(np.diff(values[:, :2], axis=0), axis=1)))
    shares = gaps / gaps.sum() if gaps.sum() > 0 else gaps
    parts = [
        design + (other - design) * (np.arange(1, number + 1) / (number + 1))[:, None]
        for design, other, number in zip(designs[:-1], designs[1:], np.ceil(count * shares).astype(int), strict=True)
    ]
    return np.concatenate([designs[:0], *parts])


def _only(problem: Problem, k: int, objectives: int) -> Problem:
    """Return the problem with objective k only."""

    def value(X: Array) -> tuple[Array, Array]:
        rows, excess = problem.value(X)
        return rows.reshape(len(X), objectives, -1)[:, k], excess

    def slope(x: Array) -> tuple[Array, Array]:
        rows, excess = problem.slope(x)
        return rows.reshape(objectives, -1, len(x))[k], excess

    return Problem(problem.dimension, value, slope)


def _worst(problem: Problem, X: Array, objectives: int) -> Array:
    """Return every objective's worst scenario, (n, k), at points X, (n, d)."""
    return np.asarray(problem.value(X)[0].reshape(len(X), objectives, -1).min(-1))


def _feasible(problem: Problem, X: Array) -> Array:
    return np.asarray(X[problem.value(X)[1].max(1, initial=-np.inf) <= _FEASIBLE])
