"""Intervals that hold: the standard deviation made right on held-out cases, everywhere in the box.

Three steps, each from the errors on cases that the model was not trained on:

1. weights of the parts of the variance (what each factor leaves unknown) and a floor, by maximum likelihood;
2. a local scale, the exponential of an additive polynomial of the scaled inputs, such that the nominal share of the
   errors lies within the interval (quantile regression of their logarithms);
3. the conformal quantile of cross-fitted scores, of all cases and, as a guard at a lower level, of every slab of every
   input.

Sources: J. Lei et al., J. Am. Stat. Assoc. 113 (2018) 1094 (locally weighted split conformal prediction); V. Vovk, Ann.
Math. Artif. Intell. 74 (2015) 9 (cross-conformal); V. Vovk, Proc. Mach. Learn. Res. 25 (2012) 475 (coverage by class).
The cross-fitting and the guard make the guarantee approximate; `use.validation.validate` measures it on fresh cases.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Self

import numpy as np
import xarray as xr
from numpy.polynomial.chebyshev import chebder, chebval, chebvander
from numpy.typing import NDArray
from scipy.stats import norm

from surrogate.data.arrays import Array
from surrogate.gp.quantile import quantile_regression

NOMINAL = 0.95
# Calibrated standard deviations from the mean to the ends of the nominal interval.
HALF_WIDTH = float(norm.ppf((1 + NOMINAL) / 2))
# Share that every slab of every input holds, before its own sampling error.
GUARD = 0.92
# Share that level and guard hold together on the cases that they were fitted to: a little is lost on fresh ones.
TARGET = 0.955
SLABS = 10
# Below this many cases in a slab its own quantile says too little.
SLAB_CASES = 20
MINIMUM = 40
FOLDS = 5
# Logarithms of errors are cut off this far below the largest: exact hits carry no further information.
DEPTH = 20.0


@dataclass(frozen=True)
class Calibration:
    """What turns a raw variance into a calibrated standard deviation.

    Attributes
    ----------
    weights : ndarray, shape (k, p)
        Weight of every part of the variance, for every output.
    floor : ndarray, shape (p,)
        Variance added everywhere, squared units of the output.
    trend : ndarray, shape (1 + d * degree, p)
        Coefficients of the logarithm of the local scale: a constant, then T_1 .. T_degree of every scaled input.
    guard : ndarray, shape (d, slabs, p)
        Logarithm of the further scale, >= 0, in every slab of equal width of every scaled input.
    """

    weights: Array
    floor: Array
    trend: Array
    guard: Array

    def std(self, variance: Array, t: Array) -> Array:
        """Return calibrated standard deviations (p, B) from weighted variances (p, B) at scaled coordinates (d, B)."""
        inside = np.clip(t, -1, 1)
        slabs = _slab(inside, self.guard.shape[1])
        scale = _additive(inside, (len(self.trend) - 1) // len(t)) @ self.trend
        extra = np.max([guard[slab] for guard, slab in zip(self.guard, slabs, strict=True)], axis=0)
        return np.asarray(np.sqrt(variance + self.floor[:, None]) * np.exp(scale + extra).T)

    def std_slopes(self, variance: Array, variance_slopes: Array, t: Array) -> Array:
        """Return the derivatives of `std` with respect to t, (d, p, B), given those of the weighted variances."""
        std = self.std(variance, t)
        # a standard deviation of zero is a kink: zero is one of its slopes
        total = np.where(std > 0, variance + self.floor[:, None], np.inf)
        degree = (len(self.trend) - 1) // len(t)
        trend = self.trend[1:].reshape(len(t), degree, -1)
        inside = np.abs(t) <= 1
        slopes = [chebval(x, chebder(np.vstack([np.zeros_like(c[:1]), c]))) for x, c in zip(t, trend, strict=True)]
        drift = np.stack(slopes) * inside[:, None] if degree else 0.0
        return np.asarray(std * (variance_slopes / (2 * total) + drift))

    def only(self, columns: Sequence[int]) -> Self:
        """Return that of some outputs."""
        return replace(self, **{part.name: getattr(self, part.name)[..., list(columns)] for part in fields(self)})

    def state(self) -> dict[str, tuple[tuple[str, ...], Array]]:
        """Return the arrays with their dimensions, for a file."""
        dims = {
            "weights": ("part", "output"),
            "floor": ("output",),
            "trend": ("trend_term", "output"),
            "guard": ("input", "slab", "output"),
        }
        return {f"calibration_{part.name}": (dims[part.name], getattr(self, part.name)) for part in fields(self)}

    @classmethod
    def restore(cls, stored: xr.Dataset, parts: int, inputs: int, outputs: int) -> Self | None:
        """Return the calibration in a file, None where it has none; ValueError names what is inconsistent."""
        if "calibration_weights" not in stored:
            return None
        found = cls(**{part.name: stored[f"calibration_{part.name}"].values for part in fields(cls)})
        terms, slabs = found.trend.shape[0], found.guard.shape[1]
        shapes = [(parts, outputs), (outputs,), (terms, outputs), (inputs, slabs, outputs)]
        if [getattr(found, part.name).shape for part in fields(cls)] != shapes or (terms - 1) % inputs or not slabs:
            raise ValueError("the calibration does not fit the model")
        if (found.weights < 0).any() or (found.floor < 0).any():
            raise ValueError("the calibration has a negative variance")
        return found


def calibrate(errors: Array, parts: Sequence[Array], t: Array) -> Calibration:
    """Calibrate on held-out cases.

    Parameters
    ----------
    errors : ndarray, shape (p, n)
        Predicted minus true.
    parts : sequence of ndarray, shape (p, n)
        Parts of the variance.
    t : ndarray, shape (d, n)
        Scaled coordinates of the cases.

    Raises
    ------
    ValueError
        Fewer than 40 cases, too few for a 95 % interval.
    """
    outputs, cases = errors.shape
    if cases < MINIMUM:
        raise ValueError(f"calibration needs at least {MINIMUM} cases, got {cases}; about 3,000 make it local")
    degree = 6 if cases >= 1000 else 4 if cases >= 300 else 2 if cases >= 100 else 0
    A, slabs = _additive(t, degree), _slab(t, SLABS)
    weights, floor = np.ones((len(parts), outputs)), np.zeros(outputs)
    trend, guard = np.zeros((A.shape[1], outputs)), np.zeros((len(t), SLABS, outputs))
    for p, error in enumerate(errors):
        squares = error**2
        if not squares.any():
            continue
        variances = np.stack([part[p] for part in parts] + [np.full(cases, squares.mean())])
        shares = _components(variances, squares)
        weights[:, p], floor[p] = shares[:-1], shares[-1] * squares.mean()
        with np.errstate(divide="ignore"):
            ratio = 0.5 * (np.log(squares) - np.log(shares @ variances))
        ratio = np.maximum(ratio, ratio.max() - DEPTH)
        trend[:, p] = quantile_regression(A, ratio, NOMINAL)
        level, guard[:, :, p] = _level_and_guard(_cross_fitted(A, ratio, trend[:, p]), slabs)
        trend[0, p] += level - np.log(HALF_WIDTH)
    return Calibration(weights, floor, trend, guard)


def _components(variances: Array, squares: Array) -> Array:
    """Weights w >= 0 (k,) that maximise the likelihood of zero-mean Gaussian errors with variances w @ (k, n).

    A majorise-minimise iteration: every step multiplies by the root of a ratio of gradients' parts, so none
    increases the cost and none leaves the positive orthant (D. R. Hunter and K. Lange, Am. Stat. 58 (2004) 30).
    """
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


def _cross_fitted(A: Array, ratio: Array, trend: Array) -> Array:
    """Residuals of the trend, every fold's from a fit to the others: (n,)."""
    order = np.random.default_rng(0).permutation(len(ratio))
    scores = np.empty(len(ratio))
    for k in range(FOLDS):
        held = order[k::FOLDS]
        rest = np.setdiff1d(order, held)
        scores[held] = ratio[held] - A[held] @ quantile_regression(A[rest], ratio[rest], NOMINAL, trend)
    return scores


def _level_and_guard(scores: Array, slabs: NDArray[np.intp]) -> tuple[float, Array]:
    """Return the level of all scores and what every slab needs beyond it, (d, slabs).

    The guard widens intervals, so the level is lowered as long as level and guard together hold `TARGET`.
    """
    needed = np.array([[_slab_quantile(scores[slab == number]) for number in range(SLABS)] for slab in slabs])

    def beyond(level: float) -> float:
        guard = np.max([np.maximum(own - level, 0)[slab] for own, slab in zip(needed, slabs, strict=True)], axis=0)
        return _conformal_quantile(scores - level - guard, TARGET)

    high = _conformal_quantile(scores, NOMINAL)
    low = min(float(_conformal_quantile(scores, GUARD)), high)
    for _ in range(30):
        middle = (low + high) / 2
        low, high = (middle, high) if beyond(middle) > 0 else (low, middle)
    return high, np.maximum(needed - high, 0)


def _conformal_quantile(scores: Array, level: float) -> float:
    """Return the smallest score that is not exceeded by a share `level` of n + 1 exchangeable ones."""
    rank = int(np.ceil((len(scores) + 1) * level))
    return float(np.sort(scores)[min(rank, len(scores)) - 1])


def _slab_quantile(scores: Array) -> float:
    return _conformal_quantile(scores, GUARD) if len(scores) >= SLAB_CASES else -np.inf


def _additive(t: Array, degree: int) -> Array:
    """A constant and T_1 .. T_degree of every scaled input: (d, n) -> (n, 1 + d * degree)."""
    return np.concatenate([np.ones((t.shape[1], 1)), *(chebvander(x, degree)[:, 1:] for x in t)], axis=1)


def _slab(t: Array, slabs: int) -> NDArray[np.intp]:
    """Index of the slab of equal width: any shape."""
    return np.clip(((t + 1) / 2 * slabs).astype(np.intp), 0, slabs - 1)
