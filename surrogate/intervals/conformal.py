"""Predictive distributions that hold: made right on held-out cases, everywhere in the box and at every level.

Four steps, each from the errors on cases that the model was not trained on:

1. weights of the parts of the variance (what each factor leaves unknown) and a floor, by maximum likelihood;
2. a local scale, the exponential of an additive polynomial of the scaled inputs, such that the nominal share of the
   errors lies within it (quantile regression of their logarithms);
3. a guard (module `guard`): slabs and corners of the box where this share needs more, from cross-fitted scores;
4. the distribution of the scores (module `distribution`), of which the standard deviation is half of the central 68 %.

Sources: J. Lei et al., J. Am. Stat. Assoc. 113 (2018) 1094 (locally weighted split conformal prediction); V. Vovk, Ann.
Math. Artif. Intell. 74 (2015) 9 (cross-conformal).
The cross-fitting and the guard make the guarantee approximate; `use.validation.validate` measures it on fresh cases.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from surrogate.data.arrays import Array
from surrogate.intervals.distribution import NOMINAL, ONE_STD, PROBABILITIES, Normal, Tabulated
from surrogate.intervals.guard import SLABS, Guard, fill, unguarded
from surrogate.intervals.quantile import quantile_regression
from surrogate.intervals.trend import additive, pairwise

MINIMUM = 40
FOLDS = 5
# Cases from which on the local scale has products of two inputs too.
PAIRWISE = 3000
# Logarithms of errors are cut off this far below the largest: exact hits carry no further information.
DEPTH = 20.0

_DIMS = {
    "weights": ("part", "output"),
    "floor": ("output",),
    "trend": ("trend_term", "output"),
    "guard": ("input", "slab", "output"),
    "corner_guard": ("pair", "edge", "other_edge", "output"),
    "quantile": ("probability", "output"),
}


@dataclass(frozen=True)
class Calibration:
    """What turns a raw variance into a calibrated standard deviation and distribution.

    Attributes
    ----------
    weights : ndarray, shape (k, p)
        Weight of every part of the variance, for every output.
    floor : ndarray, shape (p,)
        Variance added everywhere, squared units of the output.
    trend : ndarray, shape (1 + d * degree + d * (d - 1) / 2, p)
        Coefficients of the logarithm of the local scale: a constant, T_1 .. T_degree of every scaled input, and the
        product of every two.
    guard : Guard
        Further scales in slabs and corners of the box.
    distribution : Tabulated
        Distribution of (truth - mean) / std.
    """

    weights: Array
    floor: Array
    trend: Array
    guard: Guard
    distribution: Tabulated

    def std(self, variance: Array, t: Array) -> Array:
        """Return calibrated standard deviations (p, B) from weighted variances (p, B) at scaled coordinates (d, B)."""
        return np.asarray(np.sqrt(variance + self.floor[:, None]) * self.stretch(t))

    def stretch(self, t: Array) -> Array:
        """Return what raw standard deviations are multiplied by at scaled coordinates (d, B): (p, B)."""
        inside = np.clip(t, -1, 1)
        pairs = pairwise(inside)
        count = len(self.trend) - pairs.shape[1]
        scale = additive(inside, self.trend_degree(len(t))) @ self.trend[:count]
        scale += pairs @ self.trend[count:]
        scale += self.guard.at(inside)
        return np.exp(scale, out=scale).T

    def trend_degree(self, inputs: int) -> int:
        """Return the highest degree of a single one of so many inputs in the trend."""
        return (len(self.trend) - 1 - inputs * (inputs - 1) // 2) // inputs

    def only(self, columns: Sequence[int]) -> Self:
        """Return that of some outputs."""
        chosen = list(columns)
        return replace(
            self,
            weights=self.weights[:, chosen],
            floor=self.floor[chosen],
            trend=self.trend[:, chosen],
            guard=self.guard.only(chosen),
            distribution=self.distribution.only(chosen),
        )

    def arrays(self) -> dict[str, Array]:
        """Return the arrays by name."""
        plain = {name: getattr(self, name) for name in ("weights", "floor", "trend")}
        guard = {"guard": self.guard.slabs, "corner_guard": self.guard.corners}
        return {**plain, **guard, "quantile": self.distribution.quantiles}

    def state(self) -> dict[str, tuple[tuple[str, ...], NDArray[np.generic]]]:
        """Return the arrays with their dimensions, for a file."""
        state: dict[str, tuple[tuple[str, ...], NDArray[np.generic]]] = {
            f"calibration_{name}": (_DIMS[name], array) for name, array in self.arrays().items()
        }
        return {**state, "calibration_cases": ((), np.array(self.distribution.cases))}

    @classmethod
    def restore(cls, stored: xr.Dataset, parts: int, inputs: int, outputs: int) -> Self | None:
        """Return the calibration in a file, None where it has none; ValueError names what is inconsistent."""
        if "calibration_weights" not in stored:
            return None
        arrays = {name: stored[f"calibration_{name}"].values for name in _DIMS}
        cases, pairs = int(stored["calibration_cases"]), inputs * (inputs - 1) // 2
        terms = len(arrays["trend"])
        shapes = {
            "weights": (parts, outputs),
            "floor": (outputs,),
            "trend": (terms, outputs),
            "guard": (inputs, SLABS, outputs),
            "corner_guard": (pairs, 3, 3, outputs),
            "quantile": (len(PROBABILITIES), outputs),
        }
        found = {name: array.shape for name, array in arrays.items()}
        if found != shapes or terms <= pairs or (terms - pairs - 1) % inputs or cases < MINIMUM:
            raise ValueError("the calibration does not fit the model")
        if (arrays["weights"] < 0).any() or (arrays["floor"] < 0).any():
            raise ValueError("the calibration has a negative variance")
        if (np.diff(arrays["quantile"], axis=0) < 0).any():
            raise ValueError("the calibration's quantiles do not ascend")
        guard = Guard(arrays["guard"], arrays["corner_guard"])
        return cls(arrays["weights"], arrays["floor"], arrays["trend"], guard, Tabulated(arrays["quantile"], cases))


def calibrate(errors: Array, parts: Sequence[Array], t: Array, groups: NDArray[np.intp]) -> Calibration:
    """Calibrate on held-out cases.

    Parameters
    ----------
    errors : ndarray, shape (p, n)
        True minus predicted.
    parts : sequence of ndarray, shape (p, n)
        Parts of the variance.
    t : ndarray, shape (d, n)
        Scaled coordinates of the cases.
    groups : ndarray of int, shape (n,)
        As `sharing` has them; no group is in two folds of the cross-fitting.
    """
    outputs, cases = errors.shape
    degree = 6 if cases >= 1000 else 4 if cases >= 300 else 2 if cases >= 100 else 0
    A, pairs = additive(t, degree), pairwise(t)
    trend = np.zeros((A.shape[1] + pairs.shape[1], outputs))
    if cases >= PAIRWISE:
        A = np.concatenate([A, pairs], axis=1)
    weights, floor = np.ones((len(parts), outputs)), np.zeros(outputs)
    guard, logarithms = unguarded(len(t), outputs), np.full_like(errors, np.nan)
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
        fitted = quantile_regression(A, ratio, NOMINAL)
        trend[: len(fitted), p] = fitted
        scores = _cross_fitted(A, ratio, fitted, groups)
        fill(guard, p, scores, float(np.quantile(scores, NOMINAL)), t)
        logarithms[p] = scores
    distribution = _distribution(np.sign(errors) * np.exp(logarithms - guard.at(t).T))
    # in standard deviations from here on
    one = np.ptp(distribution.ends(ONE_STD), axis=0) / 2
    one = np.where(one > 0, one, 1.0)
    trend[0] += np.log(one)
    return Calibration(weights, floor, trend, guard, replace(distribution, quantiles=distribution.quantiles / one))


def _distribution(scores: Array) -> Tabulated:
    """The distribution of scores, (p, n); of an output that has none, NaN, as good as normal."""
    exact = np.asarray(np.isnan(scores).any(axis=1))
    found = Tabulated.of(np.where(exact[:, None], 0.0, scores))
    ends = np.clip(PROBABILITIES, 0.5 / scores.shape[1], 1 - 0.5 / scores.shape[1])
    return replace(found, quantiles=np.where(exact, Normal().quantile(ends), found.quantiles))


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


def _cross_fitted(A: Array, ratio: Array, trend: Array, groups: NDArray[np.intp]) -> Array:
    """Residuals of the trend, every fold's from a fit to the others: (n,)."""
    _, number = np.unique(groups, return_inverse=True)
    fold = np.random.default_rng(0).permutation(number.max() + 1)[number] % FOLDS
    scores = np.empty(len(ratio))
    for k in range(FOLDS):
        held, rest = fold == k, fold != k
        scores[held] = ratio[held] - A[held] @ quantile_regression(A[rest], ratio[rest], NOMINAL, trend)
    return scores
