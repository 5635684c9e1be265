"""Whether intervals hold: the calibrated surrogate beside its raw process and standardised scores, on fresh cases.

Standardised scores are those of MAPIE's residual-normalised conformity score: |truth - mean| over the raw standard
deviation, whose quantile at level l of n cases is the one of rank ceil((n + 1) l) (J. Lei et al., J. Am. Stat. Assoc.
113 (2018) 1094). The worst slab is that of MAPIE's worst-slab coverage (M. Cauchois, S. Gupta and J. C. Duchi, J. Mach.
Learn. Res. 22 (2021) 81): of random directions, the tenth of one half of the cases, between two parallel planes, that
holds fewest, judged on the other half. The least of many parts falls short by chance alone: "ideal" is what intervals
would show there that hold every case with the same probability, mean of some draws.

``python -m benchmarks.intervals [STUDY ...]``
"""

import sys
from dataclasses import dataclass
from importlib.util import find_spec

import numpy as np
import xarray as xr
from sklearn.base import BaseEstimator, RegressorMixin

from approximation.arrays import Array, Flags
from benchmarks.history import printed
from benchmarks.timing import least, timed
from surrogate import GaussianProcess
from surrogate.data.inputs import unit_coordinates
from surrogate.intervals.distribution import NOMINAL, Distribution, Normal, Tabulated
from surrogate.use.validation import DECILES, LEVELS, crps, distance, pit, worst_corner
from workflow.dataset import factorial
from workflow.learning import curves, training
from workflow.study.model import Study, named

#: Levels of studies that leave them open, as their pilots choose them.
OPEN = {"precise": (35, 7, 9, 12, 5)}
DIRECTIONS = 200
SLAB = 0.1
SEED = 104_729  # of the fresh cases, never looked at before what is measured was settled
DRAWS = 5  # of ideal intervals


@dataclass(frozen=True)
class Method:
    """Predictions of fresh cases: means and standard deviations, (p, n), their distribution, and ends of intervals."""

    mean: Array
    std: Array
    distribution: Distribution
    symmetric: dict[float, Array] | None = None  # standard deviations to either side, (p,), by level

    def inside(self, true: Array, level: float) -> Flags:
        """Whether the interval of a level holds the truth, (p, n).

        true: (p, n), in the outputs' units.
        """
        lower, upper = (
            self.distribution.ends(level) if self.symmetric is None else (-self.symmetric[level], self.symmetric[level])
        )
        ends = [self.mean + np.atleast_1d(end)[:, None] * self.std for end in (lower, upper)]
        return np.asarray((ends[0] <= true) & (true <= ends[1]))


def measure(studies: tuple[str, ...] = ("quickstart", "precise", "sensor"), fresh: int = 20_000) -> dict[str, float]:
    """Coverage by level, least and largest over quantities, and in the worst parts of the box; PIT, CRPS and errors.

    Every study is calibrated on the cases of its own run.
    """
    measured: dict[str, float] = {}
    for name in studies:
        study = _closed(named(name), name)
        model = training.fit(study, factorial.exact(study, factorial.levels(study), curves=True))
        held = curves.training_data(study, factorial.cases(study, "calibration"))
        new = factorial.training_data(study, factorial.sample(study, fresh, (SEED, 0)))
        for key, value in compare(model, held, new).items():
            measured[f"{name}: {key}"] = value
    return measured


def compare(model: GaussianProcess, held: xr.Dataset, fresh: xr.Dataset) -> dict[str, float]:
    """What `measure` gives, for one raw model; calibrates it."""
    X, true = _cases(model, fresh)
    raw = Method(*_predicted(model, X), Normal())
    seconds = -least(lambda: model.interval_array(X), 7).processor
    at, known = _cases(model, held)
    mean, std = _predicted(model, at)
    methods = {"raw": raw, "standardised": _standardised(raw, (known - mean) / std)}
    measured = {}
    if find_spec("mapie"):
        measured["standardised, largest difference to MAPIE's own ends over their distance"] = _beside_mapie(
            methods["standardised"], known - mean, std
        )
    measured |= {"calibrated, seconds of the calibration": timed(lambda: model.calibrate(held))[1].seconds}
    methods["calibrated"] = Method(*_predicted(model, X), model.distribution)
    seconds += least(lambda: model.interval_array(X), 7).processor
    t, spread = unit_coordinates(model.inputs_, X), np.ptp(true, axis=1)
    over = np.where(spread > 0, spread, 1.0)
    before = crps(true, raw.mean, raw.std).mean(axis=1)
    for name, method in methods.items():
        for level in LEVELS:
            share = method.inside(true, level).mean(axis=1)
            measured[f"{name}, {100 * level:g} %, least"], measured[f"{name}, {100 * level:g} %, largest"] = (
                share.min(),
                share.max(),
            )
        inside = method.inside(true, NOMINAL)
        one_std = (np.abs(true - method.mean) <= method.std).mean(axis=1)
        error = np.abs(true - method.mean).max(axis=1) / over
        score = crps(true, method.mean, method.std, method.distribution).mean(axis=1)
        measured |= {
            f"{name}, +- one std, least": one_std.min(),
            f"{name}, +- one std, largest": one_std.max(),
            **{f"{name}, {part}": share for part, share in _worst_parts(t, inside).items()},
            f"{name}, PIT off by": float(distance(pit(true, method.mean, method.std, method.distribution)).max()),
            f"{name}, CRPS over raw, median": float(np.median(score / before)),
            f"{name}, largest error over range": error.max(),
            f"{name}, largest error over range, median": float(np.median(error)),
        }
    random = np.random.default_rng(0)
    ideal = [_worst_parts(t, random.uniform(size=true.shape) < NOMINAL) for _ in range(DRAWS)]
    measured |= {f"ideal, {part}": float(np.mean([draw[part] for draw in ideal])) for part in ideal[0]}
    measured["calibrated, more microseconds a query"] = 1e6 * seconds / len(X)
    return {key: float(value) for key, value in measured.items()}


def _worst_parts(t: Array, inside: Flags) -> dict[str, float]:
    """Least coverage of any output in deciles of an input, corners of two and slabs."""
    return {
        "worst decile": min(float(inside[:, part].mean(axis=1).min()) for x in t for part in _deciles(x)),
        "worst corner": float(np.nanmin(worst_corner(t, inside))),
        "worst slab": float(worst_slab(t, inside).min()),
    }


def worst_slab(t: Array, inside: Flags) -> Array:
    """Coverage in the worst slab of every output, (p,).

    t: (d, n), scaled coordinates of the cases; inside: (p, n), whether the interval holds the truth.
    """
    random = np.random.default_rng(0)
    half, width = t.shape[1] // 2, int(SLAB * (t.shape[1] // 2))
    least, judged = np.full(len(inside), np.inf), np.ones(len(inside))
    for direction in random.standard_normal((DIRECTIONS, len(t))):
        along = direction @ t
        order = np.argsort(along[:half])
        sums = np.cumsum(np.pad(inside[:, order].astype(np.float64), ((0, 0), (1, 0))), axis=1)
        windows = (sums[:, width:] - sums[:, :-width]) / width
        for p in np.flatnonzero(windows.min(axis=1) < least):
            k = int(windows[p].argmin())
            low, high = along[order[k]], along[order[k + width - 1]]
            least[p], judged[p] = windows[p, k], inside[p, half:][(along[half:] >= low) & (along[half:] <= high)].mean()
    return judged


class _Column(RegressorMixin, BaseEstimator):  # type: ignore[misc]  # untyped
    """A fitted estimator for MAPIE: it predicts one of its inputs."""

    def __init__(self, column: int) -> None:
        self.column = column
        self.fitted_ = True

    def fit(self, X: Array, y: Array) -> "_Column":
        """Return itself; there is nothing to fit."""
        return self

    def predict(self, X: Array) -> Array:
        """Return the column."""
        return X[:, self.column]


def _beside_mapie(method: Method, errors: Array, std: Array) -> float:
    """Largest difference of standardised intervals to those that MAPIE makes of the same cases, over their width."""
    from mapie.conformity_scores import ResidualNormalisedScore
    from mapie.regression import SplitConformalRegressor

    assert method.symmetric is not None
    worst = 0.0
    for p in np.flatnonzero(errors.any(axis=1) & (std > 0).all(axis=1)):
        unit = errors[p].std()  # MAPIE takes what is below 1e-8 for zero
        held, fresh = (
            np.stack([np.zeros_like(deviations), deviations / unit], axis=1) for deviations in (std[p], method.std[p])
        )
        score = ResidualNormalisedScore(residual_estimator=_Column(1), prefit=True, sym=True)
        theirs = SplitConformalRegressor(
            _Column(0), confidence_level=list(LEVELS), conformity_score=score, prefit=True
        ).conformalize(held, errors[p] / unit)
        ends = theirs.predict_interval(fresh)[1]
        for k, level in enumerate(LEVELS):
            ours = method.symmetric[level][p] * fresh[:, 1]
            worst = max(worst, float((np.abs(ends[:, :, k] - [[-1, 1]] * ours[:, None]) / ours[:, None]).max()))
    return worst


def _standardised(raw: Method, scores: Array) -> Method:
    ordered, cases = np.sort(np.abs(scores), axis=1), scores.shape[1]
    rank = {level: min(int(np.ceil((cases + 1) * level)), cases) for level in LEVELS}
    ends = {level: ordered[:, k - 1] for level, k in rank.items()}
    return Method(raw.mean, raw.std, Tabulated.of(scores), ends)


def _closed(study: Study, name: str) -> Study:
    if name not in OPEN:
        return study
    axes = {
        factor: axis.model_copy(update={"levels": count})
        for (factor, axis), count in zip(study.factors.items(), OPEN[name], strict=True)
    }
    return study.model_copy(update={"factors": axes})


def _cases(model: GaussianProcess, cases: xr.Dataset) -> tuple[Array, Array]:
    X = np.stack([cases[name].values for name in model.box], axis=1)
    return X, np.stack([cases[name].values for name in model.outputs_])


def _predicted(model: GaussianProcess, X: Array) -> tuple[Array, Array]:
    mean, std = model.predict_array(X, return_std=True)
    return mean.T, std.T


def _deciles(column: Array) -> list[np.ndarray[tuple[int, ...], np.dtype[np.intp]]]:
    return np.array_split(np.argsort(column, kind="stable"), DECILES)


if __name__ == "__main__":
    print(printed(measure(tuple(sys.argv[1:])) if sys.argv[1:] else measure()))
