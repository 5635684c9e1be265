"""Robust constrained optimisation on a box: the best worst case over scenarios, with limits in every scenario."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy  # scipy.optimize, slow to import, when something is searched

from approximation.arrays import Array, Flags
from approximation.sobol import sobol_points

_FEASIBLE = 1e-9  # largest excess of a feasible point, in units of the limits: SLSQP's accuracy
_NEARLY = 1e-6  # an excess that can be removed at almost no cost to the objective
_CONVERGED = 1e-14  # change of the objective, and excess, at which sequential quadratic programming ends
_BINDS = 1e-7  # margin below which a row then binds
_ROUNDING = 1e-15  # margin of a binding row that is rounding
_STALLED = 1e-9  # largest change of a variable in a search that has stalled
_SEARCH_STEPS, _ROUNDS, _STARTS = 4, 3, 6
_TIE = 1e-11  # difference of equal objectives, as a share of the range over the box
_VANISHING = 1e-100  # share of the largest slope below which a slope counts as zero


@dataclass(frozen=True)
class Problem:
    """Maximise ``min_s f_s(x)`` subject to ``g_r(x) <= 0`` for every r, over ``-1 <= x <= 1``."""

    dimension: int
    value: Callable[[Array], tuple[Array, Array]]
    slope: Callable[[Array], tuple[Array, Array]]


@dataclass(frozen=True)
class Optimum:
    """Result of a search."""

    x: Array  # shape (d,); the best point or, if none is feasible, the point whose largest excess is least
    objective: float  # ``min_s f_s`` at x
    excess: Array  # shape (m,); ``g_r`` at x
    feasible: bool


def maximise(problem: Problem, *, scan: int = 4096) -> Optimum:
    """Return the optimum by a Sobol scan and sequential quadratic programming from the best starts.

    The worst case has kinks; the epigraph form, with one constraint per scenario, is smooth. Of points with equal
    objectives, as when a variable has no effect on it, the one with the largest margins is returned.
    """
    X = 2 * sobol_points(scan, problem.dimension) - 1
    objective, excess = problem.value(X)
    worst, largest = objective.min(1), excess.max(1, initial=-np.inf)
    order = np.lexsort((-worst, np.maximum(largest, 0.0)))
    local = _Local(problem, float(np.ptp(worst)) or 1.0)
    candidates = [X[order[0]]]
    for start in _apart(X[order], _STARTS):
        feasible = local.relax(start)
        candidates += [feasible, local.climb(feasible)]
    best = _best(problem, candidates)
    return _with_widest_margins(local, best)


def improve(problem: Problem, x: Array, scale: float) -> Optimum:
    """Return the optimum that local searches reach from one point."""
    local = _Local(problem, scale)
    best = _best(problem, [x, local.climb(x)])
    if 0 < _violation(best) < _NEARLY:
        best = _best(problem, [best.x, local.widen_margins(best)])
    if not best.feasible:
        # tried second, since the least excess may be far from the best design, and a climb from there may fail
        start = local.relax(best.x)
        best = _best(problem, [best.x, start, local.climb(start)])
    return _within(problem, _with_widest_margins(local, best))


def retreat(problem: Problem, x: Array) -> Array:
    """Return a point back within the limits by shortest Newton steps along the gradients of violated limits."""
    exceeding: Flags = np.zeros(0, dtype=bool)
    for _ in range(_SEARCH_STEPS):
        rows = problem.value(x[None])[1][0]
        if not np.any(rows > 0):
            break
        exceeding = (rows > 0) | (exceeding if exceeding.size else False)
        x = x + _shortest(problem.slope(x)[1][exceeding], -rows[exceeding], x)
    return x


def _shortest(jacobian: Array, rise: Array, x: Array) -> Array:
    """Return the shortest step from x, (d,), that raises rows by `rise`; variables stop at the ends of the box."""
    # LAPACK's rotations lose their angle among subnormal numbers
    jacobian = np.where(np.abs(jacobian) > _VANISHING * np.abs(jacobian).max(initial=0.0), jacobian, 0.0)
    step, free = np.zeros(len(x)), np.ones(len(x), dtype=bool)
    while free.any():
        step[free] = np.linalg.lstsq(jacobian[:, free], rise - jacobian[:, ~free] @ step[~free], rcond=None)[0]
        ends = np.clip(x + step, -1.0, 1.0) - x
        leaving = free & (ends != step)
        if not leaving.any():
            break
        step[leaving], free = ends[leaving], free & ~leaving
    return step


def _within(problem: Problem, best: Optimum) -> Optimum:
    """Return an optimum strictly within its limits, since a verdict may not tolerate the search's excess."""
    largest = best.excess.max(initial=0.0)
    if not best.feasible or largest <= 0:
        return best
    other = _judge(problem, retreat(problem, best.x))
    return other if other.excess.max() < largest else best


def _with_widest_margins(local: "_Local", best: Optimum) -> Optimum:
    """Return the point of largest margins among those with the optimum's objective."""
    if best.feasible and best.excess.size:
        best = _best(local.problem, [best.x, local.widen_margins(best)], tie=_TIE * local.scale)
    return best


def _best(problem: Problem, candidates: list[Array], tie: float = 0.0) -> Optimum:
    """Return the candidate of least violation, then of highest objective; of ties in both, the last."""
    best = _judge(problem, candidates[0])
    for x in candidates[1:]:
        other = _judge(problem, x)
        gain = _violation(best) - _violation(other)
        if gain > 0 or (gain == 0 and other.objective >= best.objective - tie):
            best = other
    return best


def _violation(optimum: Optimum) -> float:
    return 0.0 if optimum.feasible else float(optimum.excess.max())


def _judge(problem: Problem, x: Array) -> Optimum:
    objective, excess = (rows[0] for rows in problem.value(x[None]))
    return Optimum(x, float(objective.min()), excess, bool(np.all(excess <= _FEASIBLE)))


def _apart(ranked: Array, count: int) -> Array:
    """Return the first of the ranked points (n, d) that keep a distance from each other, (count, d) at most."""
    chosen = [ranked[0]]
    for x in ranked[1:]:
        if len(chosen) == count:
            break
        if min(np.linalg.norm(x - other) for other in chosen) > 0.2:
            chosen.append(x)
    return np.array(chosen)


@dataclass(frozen=True)
class _Local:
    """Local searches over z = (x, level), where level is a lower bound of the objective or an upper one of excesses."""

    problem: Problem
    scale: float

    def relax(self, start: Array) -> Array:
        """Return the point of least largest excess near an infeasible start, or a feasible start itself."""
        excess = self.problem.value(start[None])[1].max(initial=-np.inf)
        return start if excess <= 0 else self._search(start, float(excess), rise=False, floor=None)

    def climb(self, start: Array) -> Array:
        """Return the point of the best worst case within the limits near a start."""
        value = float(self.problem.value(start[None])[0].min()) / self.scale
        return self._search(start, value, rise=True, floor=None)

    def widen_margins(self, best: Optimum) -> Array:
        """Return the point of the largest margins that the best objective allows."""
        return self._search(best.x, float(best.excess.max()), rise=False, floor=best.objective / self.scale - _TIE)

    def _search(self, x: Array, level: float, *, rise: bool, floor: float | None) -> Array:
        d = self.problem.dimension
        direction = np.zeros(d + 1)
        direction[d] = -1.0 if rise else 1.0

        def height(z: Array) -> float:
            return float(direction @ z)

        def height_slope(_: Array) -> Array:
            return direction

        def margins(z: Array) -> Array:
            objective, excess = (rows[0] for rows in self.problem.value(z[None, :d]))
            objective = objective / self.scale
            above = [objective - z[d]] if rise else [] if floor is None else [objective - floor]
            return np.concatenate([*above, -excess if rise else z[d] - excess])

        def margins_slope(z: Array) -> Array:
            slope, limits = self.problem.slope(z[:d])
            above = [slope / self.scale] if rise or floor is not None else []
            limits = -limits
            level_slope = [np.full(len(slope), -1.0 if rise else 0.0)] if above else []
            level_slope += [np.full(len(limits), 0.0 if rise else 1.0)]
            return np.column_stack([np.vstack([*above, limits]), np.concatenate(level_slope)])

        z: Array = np.append(x, level)
        for _ in range(_ROUNDS):
            last, stalled = z, False

            def check(xk: Array) -> None:
                """Stop a program whose iterates stall, or it may never end; the next round has new curvature."""
                nonlocal last, stalled
                stalled, last = bool(np.abs(xk - last).max() <= _STALLED), xk.copy()
                if stalled:
                    raise StopIteration

            search = scipy.optimize.minimize(
                height,
                z,
                jac=height_slope,
                method="SLSQP",
                bounds=[(-1.0, 1.0)] * d + [(None, None)],
                constraints=scipy.optimize.NonlinearConstraint(margins, 0.0, np.inf, jac=margins_slope),
                callback=check,
                options={"maxiter": 100, "ftol": _CONVERGED},
            )
            before, z = z, _settled(np.asarray(search.x), d, margins, margins_slope)
            if np.abs(z - before).max() <= _STALLED or not stalled:
                break
        return np.asarray(z[:d])


def _settled(z: Array, d: int, margins: Callable[[Array], Array], slope: Callable[[Array], Array]) -> Array:
    """Return z after shortest Newton steps that bring all binding rows to zero.

    They save the many evaluations that sequential quadratic programming needs below `_CONVERGED`. Where as many rows
    bind as there are variables, as at a kink, they reach rounding; elsewhere they hardly change the objective.
    """
    z = np.append(np.clip(z[:d], -1.0, 1.0), z[d])
    rows = margins(z)
    for _ in range(_SEARCH_STEPS):
        near = rows < _BINDS
        if not near.any() or np.abs(rows[near]).max() <= _ROUNDING:
            break
        free = np.append(np.abs(z[:d]) < 1, True)
        jacobian = slope(z)[near][:, free]
        moved = z.copy()
        moved[free] -= np.linalg.lstsq(jacobian, rows[near], rcond=None)[0]
        moved[:d] = np.clip(moved[:d], -1.0, 1.0)
        after = margins(moved)
        if not np.abs(after[near]).max() < np.abs(rows[near]).max():
            break
        z, rows = moved, after
    return z
