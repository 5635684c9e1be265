"""Which further measurements tell most of constants or answers: D-optimal on a posterior, greedily and by exchange.

On a linear Gaussian model what a reading will tell does not depend on what it will show, so that a plan needs no
measurement (V. V. Fedorov, Theory of Optimal Experiments (1972); one constant alone is its c-optimal case). An answer
is a reading that nobody can take: its error is infinite.
"""

from collections.abc import Sequence

import numpy as np
from scipy.linalg import solve_triangular

from approximation.arrays import Array, Indices
from approximation.sobol import sobol_points
from surrogate.transforms.measured.draws import Draw

_EXCHANGES = 3  # rounds, at most


def spread(factors: int, count: int) -> Array:
    """Return scaled places within a box, (count, factors): the first half towards its ends, the others even.

    What tells most often stands at an end; places of chance are among the others.
    """
    t = 2 * sobol_points(1 << (count - 1).bit_length(), factors)[:count] - 1
    t[: count // 2] = np.clip(1.5 * t[: count // 2], -1, 1)
    return np.asarray(t)


def joint(draw: Draw, points: Array, output: Indices, slopes: Array) -> Array:
    """Return the posterior covariance of constants and of what readings would show but for their errors.

    points: (m, d); output: (m,); slopes: (m, k); result: (k + m, k + m).
    """
    shown, m = slopes.copy(), len(points)
    own = np.zeros((m, m))
    for q, discrepancy in draw.discrepancies.items():
        at = np.flatnonzero(output == q)
        cross = discrepancy.covariance(points[at])
        shown[at] -= discrepancy.at(points[at])[1]
        away = (points[at, None] - points[at]) / discrepancy.lengths
        white = solve_triangular(discrepancy.factor, cross.T, lower=True)
        own[np.ix_(at, at)] = discrepancy.amplitude**2 * np.exp(-0.5 * (away**2).sum(axis=-1)) - white.T @ white
    across = draw.covariance @ shown.T
    return np.block([[draw.covariance, across], [across.T, shown @ across + own]])


def chosen(joints: Sequence[Array], noise: Array, wanted: Indices, count: int) -> list[int]:
    """Return the readings that shrink the volume of a posterior of constants and answers most, each once at most.

    joints: sequence of ndarray, shape (k + m, k + m) each; noise: (m,).
    """
    plan: list[int] = []
    now = list(joints)
    for _ in range(count):
        plan.append(_best(now, noise, wanted, plan))
        now = [_after(covariance, noise, plan[-1:]) for covariance in now]
    for _ in range(_EXCHANGES):
        before = list(plan)
        for place in range(count):
            others = plan[:place] + plan[place + 1 :]
            plan[place] = _best([_after(covariance, noise, others) for covariance in joints], noise, wanted, others)
        if plan == before:
            break
    return plan


def widths(joints: Sequence[Array], noise: Array, plan: Sequence[int], wanted: Indices) -> Array:
    """Return the posterior deviations of what is wanted after some readings; draws do not differ in their mean.

    joints: sequence of ndarray, shape (k + m, k + m), as `joint` gives them, one a draw; noise: (m,), variances of
    the readings' errors, infinite for what nobody can read.
    """
    variances = [np.diag(_after(covariance, noise, plan))[wanted] for covariance in joints]
    return np.asarray(np.sqrt(np.mean(variances, axis=0)))


def _best(now: Sequence[Array], noise: Array, wanted: Indices, taken: Sequence[int]) -> int:
    """The reading that takes most of the logarithm of the volume."""
    gain = np.zeros(len(noise))
    for covariance in now:
        k = len(covariance) - len(noise)
        across = covariance[wanted, k:]
        told = np.einsum("im,im->m", across, np.linalg.solve(covariance[np.ix_(wanted, wanted)], across))
        gain -= np.log1p(-np.minimum(told / (np.diag(covariance)[k:] + noise), 1 - 1e-12))
    gain[list(taken)], gain[~np.isfinite(noise)] = -np.inf, -np.inf
    return int(np.argmax(gain))


def _after(covariance: Array, noise: Array, plan: Sequence[int]) -> Array:
    """The covariance after readings."""
    if not len(plan):
        return covariance
    k = len(covariance) - len(noise)
    at = k + np.asarray(plan)
    block = covariance[np.ix_(at, at)] + np.diag(noise[list(plan)])
    return np.asarray(covariance - covariance[:, at] @ np.linalg.solve(block, covariance[at]))
