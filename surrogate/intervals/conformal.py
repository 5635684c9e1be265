"""Calibration of predictive distributions on held-out cases, in five steps.

1. Maximum likelihood gives the weights of the variance's parts and a floor.
2. A local scale is the exponential of a polynomial of the scaled inputs, additive but for the two inputs in which the
   errors are waves. Quantile regression of the errors' logarithms puts the nominal share of the errors within it.
3. A guard (module `guard`) widens slabs and corners of the box in which cross-fitted scores exceed this share.
4. The distribution of the scores (module `distribution`) has as standard deviation half of the central 68 %.
5. A copula describes how scores of outputs and of near points depend on each other (module `copula`).

Sources: J. Lei et al., J. Am. Stat. Assoc. 113 (2018) 1094 (locally weighted split conformal prediction); V. Vovk, Ann.
Math. Artif. Intell. 74 (2015) 9 (cross-conformal). Cross-fitting and guard make the guarantee approximate;
`use.validation.validate` measures it on fresh cases.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np
import scipy  # scipy.special, slow to import, and not every job asks for intervals

from approximation import products
from approximation.arrays import Array, Flags, Indices
from approximation.products import additive, pairwise
from surrogate.intervals.calibration import Calibration
from surrogate.intervals.copula import Copula
from surrogate.intervals.distribution import NOMINAL, ONE_STD, PROBABILITIES, Normal, Tabulated
from surrogate.intervals.guard import fill, places, unguarded

FOLDS = 5
# Number of cases and highest degree of the local scale along an input. Further degrees, up to HIGHEST, need so many
# distinct values of the input per degree and input: a correction leaves some twenty nodes along an input of ten levels.
DEGREES = ((100, 2), (300, 4), (1000, 6))
PLACES_A_DEGREE, HIGHEST = 125, 16
PAIRWISE = 3000  # cases from which on the local scale has the product of every two inputs
WAVES = 5000  # cases from which on it may have products of two inputs up to the total degree TOTAL
TOTAL, TELLING = 8, 3.0  # these must explain TELLING times what they would explain by chance
DEPTH = 20.0  # depth below the largest at which logarithms of errors are cut off: exact hits carry no information
BANDWIDTH = 0.1  # share of the residuals' upper spread at which the smoothing ends, as its bias no longer matters
FAR = 4.0  # widths beyond which cases are left out of the curvature, which only steers the steps; the gradient has all
RIDGE = 1.0  # bounds coefficients in sparse parts of the box, where arbitrarily large ones would hold the share


def calibrate(
    errors: Array,
    parts: Sequence[Array],
    t: Array,
    groups: Indices,
    even: Flags | None = None,
    outer: Array | None = None,
) -> Calibration:
    """Calibrate on held-out errors and parts of their variances, (p, n) each, at scaled coordinates t, (d, n).

    groups: (n,), of cases that share coordinates; even: (n,), marks cases drawn evenly; outer: (e, n), scaled inputs of
    a wrapping model.
    """
    even = np.ones(t.shape[1], dtype=bool) if even is None else even
    weights, floor, logarithms = _sizes(errors, parts)
    known = np.flatnonzero(np.isfinite(logarithms).all(axis=1))
    degrees, trend = _fitted(logarithms[known], t, groups)
    A = products.values(degrees, t).T
    whole = np.zeros((len(degrees), len(errors)))
    whole[:, known] = trend
    logarithms[known] = _cross_fitted(A, logarithms[known], trend, groups)
    allowed = {int(p): float(np.quantile(logarithms[p, even], NOMINAL)) for p in known}
    guards = []
    for inputs in (t,) if outer is None else (t, outer):
        guard = unguarded(len(inputs), len(errors), pooled=inputs is outer)
        for p, level in allowed.items():
            fill(guard, p, logarithms[p], level, inputs, groups, even)
        logarithms -= guard.at(inputs).T
        guards.append(guard)
    scores = (np.sign(errors) * np.exp(logarithms))[:, even]
    distribution = _distribution(scores)
    # from here on scores are in standard deviations
    size = np.ptp(distribution.ends(ONE_STD), axis=0) / 2
    size = np.where(size > 0, size, 1.0)
    whole[0] += np.log(size)
    fitted = A @ whole
    within = np.stack([fitted.min(axis=0), fitted.max(axis=0)])
    table = replace(distribution, quantiles=distribution.quantiles / size)
    guard, outer_guard = guards[0], guards[1] if len(guards) > 1 else None
    return Calibration(weights, floor, whole, degrees, within, guard, table, outer_guard, Copula.of(scores, t[:, even]))


def _sizes(errors: Array, parts: Sequence[Array]) -> tuple[Array, Array, Array]:
    """Return weights (k, p), floors (p,) and logarithms of errors over deviations, (p, n), NaN without any error."""
    weights, floor = np.ones((len(parts), len(errors))), np.zeros(len(errors))
    logarithms = np.full_like(errors, np.nan)
    for p, error in enumerate(errors):
        squares = error**2
        if not squares.any():
            continue
        variances = np.stack([part[p] for part in parts] + [np.full(len(error), squares.mean())])
        shares = _components(variances, squares)
        weights[:, p], floor[p] = shares[:-1], shares[-1] * squares.mean()
        with np.errstate(divide="ignore"):
            ratio = 0.5 * (np.log(squares) - np.log(shares @ variances))
        logarithms[p] = np.maximum(ratio, ratio.max() - DEPTH)
    return weights, floor, logarithms


def _fitted(logarithms: Array, t: Array, groups: Indices) -> tuple[Indices, Array]:
    """Return the degrees of the local scale's terms, (m, d), and its coefficients, (m, p), from logarithms (p, n)."""
    distinct, (d, cases) = places(t, groups), t.shape
    few = max((degree for least, degree in DEGREES if cases >= least), default=0)
    degrees = additive([max(few, min(int(count) // (PLACES_A_DEGREE * d), HIGHEST)) for count in distinct])
    pairs = [pair for pair in combinations(range(d), 2) if distinct[list(pair)].min() >= PAIRWISE]
    degrees = np.concatenate([degrees, *(pairwise(d, pair, 2) for pair in pairs)])
    A = products.values(degrees, t).T
    trend = np.reshape([quantile_regression(A, row, NOMINAL) for row in logarithms], (-1, len(degrees))).T
    waves = _waves(A, logarithms, trend, t, pairs) if cases >= WAVES else None
    if waves is None:
        return degrees, trend
    degrees = np.concatenate([degrees, waves])
    A = products.values(degrees, t).T
    starts = np.pad(trend, ((0, len(waves)), (0, 0))).T
    fits = [quantile_regression(A, values, NOMINAL, start) for values, start in zip(logarithms, starts, strict=True)]
    return degrees, np.array(fits).T


def _waves(A: Array, logarithms: Array, trend: Array, t: Array, pairs: Sequence[tuple[int, int]]) -> Indices | None:
    """Return degrees of products of the two inputs that best explain which errors exceed the scale; None if little."""
    # score test of the exceedances, whose statistic is by chance as large as the number of products:
    # C. R. Rao, Math. Proc. Cambridge Philos. Soc. 44 (1948) 50
    beyond = NOMINAL - (logarithms <= (A @ trend).T)
    best, most = None, TELLING
    for pair in pairs:
        degrees = pairwise(len(t), pair, TOTAL, 3)
        features = products.values(degrees, t).T
        basis = np.linalg.qr(features - A @ np.linalg.lstsq(A, features)[0])[0]
        strength = ((beyond @ basis) ** 2).sum(axis=1) / (NOMINAL * (1 - NOMINAL) * len(degrees))
        if len(strength) and (share := float(strength.max())) > most:
            best, most = degrees, share
    return best


def _distribution(scores: Array) -> Tabulated:
    """Return the distribution of scores, (p, n), normal for an output without any error, whose scores are NaN."""
    exact = np.asarray(np.isnan(scores).any(axis=1))
    distribution = Tabulated.of(np.where(exact[:, None], 0.0, scores))
    ends = np.clip(PROBABILITIES, 0.5 / scores.shape[1], 1 - 0.5 / scores.shape[1])
    return replace(distribution, quantiles=np.where(exact, Normal().quantile(ends), distribution.quantiles))


def _components(variances: Array, squares: Array) -> Array:
    """Return weights w >= 0 (k,) of greatest likelihood for zero-mean Gaussian errors with variances w @ (k, n)."""
    # majorise-minimise iteration: no step increases the cost or leaves the positive orthant
    # (D. R. Hunter and K. Lange, Am. Stat. 58 (2004) 30)
    size = variances.mean(axis=1)
    size[size == 0] = 1.0
    unit = variances / size[:, None]
    weights = np.full(len(unit), squares.mean() / len(unit))
    for _ in range(60):
        total = weights @ unit
        up, down = unit @ (squares / total**2), unit @ (1 / total)
        weights *= np.sqrt(np.divide(up, down, out=np.zeros_like(up), where=down > 0))
        weights = np.maximum(weights, 1e-12 * weights.max())
    return np.asarray(weights / size)


def _cross_fitted(A: Array, logarithms: Array, trend: Array, groups: Indices) -> Array:
    """Return residuals of trends (m, p), each fold's from a fit to the other folds: (p, n)."""
    _, number = np.unique(groups, return_inverse=True)
    fold = np.random.default_rng(0).permutation(number.max() + 1)[number] % FOLDS
    scores = np.empty_like(logarithms)
    for k in range(FOLDS):
        test, fitting = fold == k, fold != k
        A_test, A_fitting = A[test], A[fitting]
        for score, values, start in zip(scores, logarithms, trend.T, strict=True):
            score[test] = values[test] - A_test @ quantile_regression(A_fitting, values[fitting], NOMINAL, start)
    return scores


def quantile_regression(A: Array, y: Array, level: float, start: Array | None = None) -> Array:
    """Fit coefficients b, (k,), so that a share `level` of y, (n,), lies below A b, A being (n, k).

    Minimises the check function of R. Koenker and G. Bassett, Econometrica 46 (1978) 33, convolved with a Gaussian (M.
    Fernandes, E. Guerre and E. Horta, J. Bus. Econ. Stat. 39 (2021) 338), whose width shrinks as the fit improves.
    """
    A = np.ascontiguousarray(A)  # rows are selected below
    b = _least_squares(A, y, level) if start is None else start
    width = BANDWIDTH * _spread(y - A @ b, level)
    while width > 0:
        b = _newton(A, y, level, width, b)
        spread = _spread(y - A @ b, level)
        if width <= BANDWIDTH * spread or spread == 0:
            break
        width = max(width / 2.5, 0.9 * BANDWIDTH * spread)
    return b


def _least_squares(A: Array, y: Array, level: float) -> Array:
    """Return coefficients (k,) of penalised least squares, raised until a share `level` of y lies below, as a start."""
    b = np.linalg.solve(A.T @ A + RIDGE * np.eye(A.shape[1]), A.T @ y)
    b[0] += np.quantile(y - A @ b, level)
    return np.asarray(b)


def _spread(residual: Array, level: float) -> float:
    return float(np.quantile(residual, (1 + level) / 2) - np.quantile(residual, 0.5))


def _newton(A: Array, y: Array, level: float, width: float, b: Array) -> Array:
    penalty = np.full(A.shape[1], RIDGE)
    penalty[0] = 0
    residual = y - A @ b

    def cost(residual: Array, b: Array) -> float:
        z = residual / width
        return float(np.sum(residual * (level - scipy.special.ndtr(-z)) + width * _density(z)) + 0.5 * penalty @ b**2)

    value = cost(residual, b)
    for _ in range(30):
        z = residual / width
        near = np.abs(z) < FAR
        density = _density(z[near])
        if density.sum() < 1e-9:  # no case is near: two clusters, with the quantile between them
            break
        slope = penalty * b - A.T @ (level - scipy.special.ndtr(-z))
        root = A[near] * np.sqrt(density / width)[:, None]
        curvature = root.T @ root + np.diag(penalty)
        curvature[np.diag_indices_from(curvature)] += 1e-6 * np.trace(curvature) / len(b)
        step = np.linalg.solve(curvature, slope)
        gain, length = A @ step, 1.0  # the residual grows by the gain where b falls by the step
        reached = cost(residual + gain, b - step)
        while reached > value - 1e-4 * length * float(slope @ step) and length > 1e-8:
            length /= 2
            reached = cost(residual + length * gain, b - length * step)
        b, residual = b - length * step, residual + length * gain
        before, value = value, reached
        if before - value < 1e-5 * abs(value):
            break
    return b


def _density(z: Array) -> Array:
    return np.asarray(np.exp(-0.5 * z * z) / np.sqrt(2 * np.pi))
