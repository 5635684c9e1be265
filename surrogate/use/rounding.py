"""Rounded surrogates: each output's mean as a short tensor train of rounded numbers, within an error."""

from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Self, cast

import numpy as np
from typing_extensions import override

from approximation.arrays import Array
from approximation.chebyshev import polynomials, slopes
from surrogate.data.inputs import physical_points
from surrogate.face.model import GaussianProcess
from surrogate.gp.correction import Correction
from surrogate.gp.gridgp import GridGP
from surrogate.gp.tensortrain import TensorTrain, compress
from surrogate.transforms.curves.curvegp import CurveGP
from surrogate.transforms.groupedgp import GroupedGP

Precision = type[np.floating[Any]]  # float32 or float64
# Fresh points that judge the rounding, share of points that guide it, and share of coordinates at an end of the box.
POINTS, TRIED, AT_ENDS = 20_000, 0.1, 0.25
FRESH = 1  # seed of the fresh points
FIRST, FINER, TRIALS = 4.0, 0.6, 60  # first allowed error of the train over the requested one, and its factor per trial
PATIENCE = 10  # trials without a smaller error after which none is expected
ROUNDING = 0.1  # share of a precision's last digit below which an allowed error has no effect
NEGLIGIBLE = 0.25  # share of the train's error that omitted terms of the correction may add up to


class RoundedGP(GridGP):
    """A grid process whose mean is a train over plain Chebyshev polynomials, in numbers of one precision."""

    chebyshev_: TensorTrain
    arithmetic: Precision

    @classmethod
    def of(cls, grid: GridGP, train: TensorTrain, storage: Precision, arithmetic: Precision) -> Self:
        """Return a grid's process with another mean, `train` in units of the output plus the grid's offset."""
        part = cls()
        part.__dict__.update(grid.__dict__)
        stored: list[Any] = [core.astype(storage).astype(arithmetic) for core in train.cores]
        part.chebyshev_, part.arithmetic, part.correction_ = TensorTrain(tuple(stored)), arithmetic, None
        return part

    @override
    def mean_variance(self, t: Array, weights: Array | None) -> tuple[Array, Array]:
        sizes = dict(zip(self.order_, self.chebyshev_.modes, strict=True))
        features = [_polynomials(t[k].astype(self.arithmetic), sizes[k]) for k in self.order_]
        mean = self.chebyshev_.evaluate(features) + self.offset_[:, None].astype(self.arithmetic)
        variance = np.zeros(mean.shape) if weights is None else super().mean_variance(t, weights)[1]
        return mean.astype(np.float64), variance

    @override
    def slopes(self, t: Array) -> Array:
        T, S = [], []
        for k, size in zip(self.order_, self.chebyshev_.modes, strict=True):
            whole = polynomials(t[k], max(2, size))
            T.append(whole[:size])
            S.append(slopes(t[k], whole)[:size])
        return self.chebyshev_.gradient(T, S)[np.argsort(self.order_)]


@dataclass(frozen=True)
class Rounded:
    """One output of a model, rounded."""

    exact: GaussianProcess  # of this output alone
    model: GaussianProcess  # the same with a `RoundedGP` inside
    storage: Precision  # of its coefficients
    error: float  # largest error of its means on fresh points, over the output's range
    size: float  # that range

    @property
    def room(self) -> float:
        """The error in units of the output."""
        return self.error * self.size

    @property
    def name(self) -> str:
        """Name of the output."""
        return self.model.outputs_[0]

    @property
    def numbers(self) -> int:
        """Number of coefficients of its mean."""
        return sum(core.size for core in self.grid.chebyshev_.cores)

    @property
    def grid(self) -> RoundedGP:
        """The process inside."""
        return cast(RoundedGP, grid_of(self.model))


def rounded(
    model: GaussianProcess,
    outputs: Sequence[str],
    error: float,
    arithmetic: Precision,
    *,
    points: int = POINTS,
    absolute: Mapping[str, float] = MappingProxyType({}),
) -> list[Rounded]:
    """Return rounded outputs with as few numbers as the error allows, a share of the range or `absolute` in units."""
    if isinstance(model, CurveGP) and (largest := [name for name in outputs if name in model.largest]):
        smooth = ", ".join(name for name in model.outputs_ if name not in model.largest) or "none"
        raise ValueError(f"{', '.join(largest)}: largest values of curves have no short form; exported are {smooth}")
    tried, fresh = points_of_box(model, 0, int(TRIED * points)), points_of_box(model, FRESH, points)
    parts = []
    for name in outputs:
        alone = _alone(model, name)
        grid_of(alone)
        exact = alone.all_mean_std(tried, False)[0]
        size = float(np.ptp(exact)) or float(np.abs(exact).max()) or 1.0
        allowed = absolute[name] / size if name in absolute else error
        parts.append(_output(alone, allowed, size, arithmetic, (tried, exact), fresh))
    return parts


def _alone(model: GaussianProcess, name: str) -> GaussianProcess:
    """Return the model of one output; for a smooth output of a `CurveGP`, its process."""
    alone = model.only([name])
    if not (isinstance(alone, CurveGP) and isinstance(alone.smooth_, GridGP)):
        return alone
    smooth = copy(alone.smooth_)
    smooth.calibration_, smooth.level_ = alone.calibration_, alone.level_
    return smooth


def grid_of(model: GaussianProcess) -> GridGP:
    """Return the grid process inside a model; ValueError if there is none."""
    if isinstance(model, GridGP):
        return model
    if isinstance(model, GroupedGP):
        return grid_of(model.reduced_)
    raise ValueError(
        f"the surrogate is a {type(model).__name__} (engine {model.engine!r}); exported are GridGP, GroupedGP"
    )


def _over(model: GaussianProcess, grid: GridGP) -> GaussianProcess:
    """Return the model with another grid process inside."""
    if isinstance(model, GridGP):
        return grid
    return model.over({name: _over(member, grid) for name, member in model.members.items()})


def points_of_box(model: GaussianProcess, seed: int, count: int) -> Array:
    """Return random points of the box, (n, d), with a quarter of the coordinates at an end."""
    random = np.random.default_rng(seed)
    t = random.uniform(-1, 1, (len(model.inputs_), count))
    t = np.where(random.uniform(size=t.shape) < AT_ENDS, np.sign(t), t)
    return physical_points(model.inputs_, t)


def _output(
    model: GaussianProcess,
    error: float,
    size: float,
    arithmetic: Precision,
    tried: tuple[Array, Array],
    fresh: Array,
) -> Rounded:
    """Round a model of one output; size: its range; tried: points and exact means that guide the rounding."""
    grid, name, (points, exact) = grid_of(model), model.outputs_[0], tried
    learnt = grid.means(model.calibrated_at(points))  # over the axes
    spread = float(np.ptp(learnt)) or 1.0
    storages: list[Precision] = [np.float32] if arithmetic == np.float32 else [np.float32, np.float64]
    least, since = np.inf, 0
    for trial in range(TRIALS):
        allowed = FIRST * FINER**trial * error * spread
        train = _cut(_series(grid, NEGLIGIBLE * allowed), allowed)
        since += 1
        for storage in storages:
            part = _over(model, RoundedGP.of(grid, train, storage, arithmetic))
            off = float(np.abs(part.all_mean_std(points, False)[0] - exact).max()) / size
            if off < 0.9 * least:
                least, since = off, 0
            if off > error:
                continue
            judged = part.all_mean_std(fresh, False)[0] - model.all_mean_std(fresh, False)[0]
            off = max(off, float(np.abs(judged).max()) / size)
            if off <= error:
                return Rounded(model, part, storage, off, size)
        if since == PATIENCE or allowed < ROUNDING * np.finfo(storages[-1]).eps * spread:
            break
    precision = "single" if arithmetic == np.float32 else "double"
    raise ValueError(f"error {error:g} is not reached for {name!r} in {precision} precision: at best {least:.2g}")


def _polynomials(t: Array, count: int) -> Array:
    """Return T_0 .. T_{count-1} at t, (B,), in its precision by the operations of the exported code: (count, B)."""
    T = np.ones((count, len(t)), dtype=t.dtype)
    if count > 1:
        T[1] = t
    for m in range(2, count):
        T[m] = 2 * t * T[m - 1] - T[m - 2]
    return T


def _series(grid: GridGP, negligible: float) -> TensorTrain:
    """Return the mean of a grid's single output, less its offset, as a train over plain Chebyshev polynomials."""
    cores = []
    for k, core in zip(grid.order_, grid.train_.cores, strict=True):
        factor, modes = grid.factors_[k], core.shape[1]
        plain = np.zeros((core.shape[0], 2 * factor.levels, core.shape[2]))
        plain[:, :modes] = core * (1 - factor.damping[:modes, None])
        for m in range(1, modes):  # T_m - s_m (T_m + T_{2n-m})
            plain[:, 2 * factor.levels - m] -= core[:, m] * factor.damping[m]
        cores.append(plain)
    cores[-1] = cores[-1] * grid.scale_
    if grid.correction_ is not None:
        for others in _terms(grid, grid.correction_, negligible):
            cores = _added(cores, others)
    return TensorTrain(tuple(cores))


def _terms(grid: GridGP, correction: Correction, negligible: float) -> Iterator[list[Array]]:
    """Yield the cores of every part of a correction, T_n of a factor times a polynomial of low degrees."""
    allowed = negligible / len(grid.order_)
    for factor, coefficients in enumerate(correction.coefficients[..., 0]):
        if np.abs(coefficients).sum() <= allowed:
            continue
        tensor = np.zeros(1 + correction.indices.max(axis=0))
        tensor[tuple(correction.indices.T)] = coefficients
        cores = list(compress(tensor.transpose(grid.order_)[..., None], allowed).cores)
        position, n = grid.order_.index(factor), correction.levels[factor]
        low = cores[position]
        nodal = np.zeros((low.shape[0], n + low.shape[1], low.shape[2]))
        for degree in range(low.shape[1]):  # T_n T_a = (T_{n+a} + T_|n-a|) / 2
            nodal[:, n + degree] += low[:, degree] / 2
            nodal[:, abs(n - degree)] += low[:, degree] / 2
        cores[position] = nodal
        yield cores


def _added(cores: Sequence[Array], others: Sequence[Array]) -> list[Array]:
    """Return the cores of the sum of two trains of one output."""
    summed = []
    last = len(cores) - 1
    for k, (a, b) in enumerate(zip(cores, others, strict=True)):
        rows, columns = (max, sum)[k > 0], (max, sum)[k < last]
        before, modes, behind = zip(a.shape, b.shape, strict=True)
        core = np.zeros((rows(before), max(modes), columns(behind)))
        core[: a.shape[0], : a.shape[1], : a.shape[2]] += a
        core[-b.shape[0] :, : b.shape[1], -b.shape[2] :] += b
        summed.append(core)
    return summed


def _cut(series: TensorTrain, error: float) -> TensorTrain:
    """Return a train with ranks and modes cut to a root-mean-square error over Chebyshev points."""
    norms = [np.where(np.arange(size) > 0, np.sqrt(0.5), 1.0) for size in series.modes]
    cut = series.scaled(norms).only([0], error)
    narrowed = []
    for core, gram in zip(cut.cores, cut.grams(), strict=True):
        beyond = np.sqrt(np.cumsum(np.diag(gram[0])[::-1])[::-1])
        narrowed.append(core[:, : max(1, int(np.count_nonzero(beyond > error / np.sqrt(len(cut.cores)))))])
    return TensorTrain(tuple(narrowed)).scaled(
        [1 / norm[: core.shape[1]] for norm, core in zip(norms, narrowed, strict=True)]
    )
