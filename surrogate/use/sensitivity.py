"""Exact sensitivity indices of a surrogate by contraction of its tensor train, without sampling.

Sources: I. M. Sobol', Math. Comput. Simul. 55 (2001) 271; R. Ballester-Ripoll et al., SIAM/ASA J. Uncertain. Quantif. 7
(2019) 1109 (indices of tensor trains).
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from itertools import combinations
from types import MappingProxyType

import numpy as np
import xarray as xr
from numpy.polynomial.legendre import leggauss

from approximation.arrays import Array
from approximation.chebyshev import coefficients, gauss_points
from approximation.sobol import sobol_points
from surrogate.data.inputs import Input, physical_points
from surrogate.face.model import GaussianProcess
from surrogate.gp.gridgp import GridGP
from surrogate.transforms.curves.curvegp import CurveGP
from surrogate.transforms.groupedgp import GroupedGP

Quantile = Callable[[Array], Array]  # from probabilities, any shape, to values of an input
NODES_A_LEVEL = 2  # Gauss-Legendre nodes: exact for the Chebyshev kernel, whose features have two modes per level
FEWEST_NODES = 64
POSITIONS = 41
SAMPLE = 1024  # quasi-random points over which the predictive variance is averaged
# Most grid points of the expansion of other models than `GridGP`, error of its train, and lines that give its levels
EXPANDED, COMPRESSION, LINES = 2**16, 1e-8, 16


def sobol(model: GaussianProcess, quantiles: Mapping[str, Quantile] = MappingProxyType({})) -> xr.Dataset:
    """Return Sobol' indices and main effects of every output of a fitted `GridGP`, `GroupedGP` or `CurveGP`.

    Inputs are independent: those in `quantiles` have these quantile functions, all others are uniform on their scale.

    The data set has `first_order` and `total` over (`output`, `input`), each with `_low` and `_high`; `second_order`
    over (`output`, `input`, `other_input`), symmetric, zero on the diagonal; `mean` and `variance` over `output`;
    `main_effect`, the mean of the output given one input less `mean`, and its root-mean-square error
    `main_effect_std` over (`output`, `input`, `position`); `value`, of the input at a position.

    Indices are shares of the variance of the tensor train, without the correction of the mean, which counts as an error
    besides the calibrated standard deviation. Grouped models and curves have the train of their mean on a grid of at
    most `EXPANDED` points, whose error counts too. The root-mean-square error bounds the change of the norm of a
    projection, since projections do not lengthen; `_low` and `_high` follow.
    """
    if not isinstance(model, GridGP | GroupedGP | CurveGP):
        known = "GridGP, GroupedGP or CurveGP"
        raise TypeError(f"exact sensitivity indices need a {known}, got {type(model).__name__}")
    names, d = list(model.box), len(model.box)
    train = model.uncalibrated() if isinstance(model, GridGP) else _expanded(model)
    places = _places(model, quantiles)
    moments = _Moments(train, places)
    mean = moments.mean()
    variance = moments.explained(range(d))
    first = np.stack([moments.explained({i}) for i in range(d)])
    total = np.stack([variance - moments.explained(set(range(d)) - {i}) for i in range(d)])
    second = np.zeros((d, d, len(model.outputs_)))
    for i, j in combinations(range(d), 2):
        second[i, j] = second[j, i] = np.maximum(moments.explained({i, j}) - first[i] - first[j], 0)
    positions = np.linspace(-1, 1, POSITIONS)
    effect = np.stack([moments.effect(i, positions) for i in range(d)], axis=1) - mean[:, None, None]
    error, spread = _errors(model, train, positions, places)

    # the shares of an output without variance are zero
    whole = np.where(variance > 0, variance, 1.0)
    table = {
        "mean": ("output", mean),
        "variance": ("output", variance),
        "second_order": (("output", "input", "other_input"), (second / whole).transpose(2, 0, 1)),
        "main_effect": (("output", "input", "position"), effect),
        "main_effect_std": (("output", "input", "position"), spread),
        "value": (("input", "position"), np.stack([input_.from_unit(positions) for input_ in model.inputs_])),
    }
    for name, part in (("first_order", first), ("total", np.maximum(total, 0))):
        low, high = _bounds(np.maximum(part, 0), whole, error)
        for key, share in ((name, part / whole), (f"{name}_low", low), (f"{name}_high", high)):
            table[key] = (("output", "input"), np.maximum(share, 0).T)
    coords = {"output": list(model.outputs_), "input": names, "other_input": names, "position": positions}
    return xr.Dataset(table, coords=coords)


def _places(model: GaussianProcess, quantiles: Mapping[str, Quantile]) -> list[Callable[[Array], Array]]:
    """Return functions from every input's probability, mapped to [-1, 1], to its scaled coordinate."""

    def placed(input_: Input) -> Callable[[Array], Array]:
        quantile = quantiles.get(input_.name)
        if quantile is None:
            return np.asarray
        return lambda share: np.clip(input_.to_unit(quantile((share + 1) / 2)), -1, 1)

    return [placed(input_) for input_ in model.inputs_]


class _Moments:
    """Means of the prediction and its products over the box, from the moments of the features in contraction order."""

    def __init__(self, model: GridGP, places: Sequence[Callable[[Array], Array]]) -> None:
        self._model = model
        self._order = model.order_
        self._means, self._squares = [], []
        for k, core in zip(self._order, model.train_.cores, strict=True):
            factor, modes = model.factors_[k], core.shape[1]
            nodes, weights = leggauss(max(FEWEST_NODES, NODES_A_LEVEL * len(factor.t)))
            features = factor.features(places[k](nodes), modes).mean
            self._means.append(np.einsum("rms,m->rs", core, features @ (weights / 2)))
            # contract the core with a root of the moments' matrix, so that sums of squares give the variances
            self._squares.append(np.einsum("rms,mq->qrs", core, _root((features * (weights / 2)) @ features.T)))

    def mean(self) -> Array:
        """Return the mean of every output over the box, (p,)."""
        state = np.ones((1, 1))
        for mean in self._means:
            state = state @ mean
        return np.asarray(self._model.offset_ + self._model.scale_ * state[0])

    def explained(self, inputs: Collection[int]) -> Array:
        """Return the variance of the conditional mean given some inputs, (p,), with all interactions among them."""
        state, plain = np.ones((1, 1)), np.ones((1, 1))
        for k, mean, square in zip(self._order, self._means, self._squares, strict=True):
            parts = square if k in inputs else mean[None]
            state = np.einsum("qrs,rt,qtu->su", parts, state, parts, optimize=True)
            plain = plain @ mean
        return np.asarray((np.diag(state) - plain[0] ** 2) * self._model.scale_**2)

    def effect(self, factor: int, positions: Array) -> Array:
        """Return the conditional mean of every output given one input at scaled positions, (p, positions)."""
        state = np.ones((1, len(positions)))
        for k, core, mean in zip(self._order, self._model.train_.cores, self._means, strict=True):
            if k == factor:
                features = self._model.factors_[k].features(positions, core.shape[1]).mean
                state = np.einsum("rb,rms,mb->sb", state, core, features, optimize=True)
            else:
                state = mean.T @ state
        return np.asarray(self._model.offset_[:, None] + self._model.scale_[:, None] * state)


def _root(matrix: Array) -> Array:
    values, vectors = np.linalg.eigh(matrix)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0)))


def _expanded(model: GaussianProcess) -> GridGP:
    """Return the mean of any model as a grid process over its inputs with at most `EXPANDED` points."""
    inputs, tails = model.inputs_, _tails(model.uncalibrated())
    for allowed in 10.0 ** np.arange(-9, 1):
        counts = [max(2, int(np.count_nonzero(tail > allowed))) for tail in tails]
        if np.prod(counts) <= EXPANDED:
            break
    axes = {input_.name: input_.levels(count) for input_, count in zip(inputs, counts, strict=True)}
    grid = GridGP(inputs=inputs, outputs=model.outputs_, compression=COMPRESSION)
    return grid.fit(model.uncalibrated().predict(axes, return_std=False))


def _tails(model: GaussianProcess) -> list[Array]:
    """Return for each input the largest tail sums of the means' Chebyshev coefficients over their range, by degree."""
    inputs, tails = model.inputs_, []
    points = 2 * sobol_points(LINES, len(inputs)) - 1
    for k in range(len(inputs)):
        t = np.repeat(points, FEWEST_NODES, axis=0)
        t[:, k] = np.tile(gauss_points(FEWEST_NODES), LINES)
        values = model.predict_array(physical_points(inputs, t.T)).reshape(LINES, FEWEST_NODES, -1)
        spread = np.ptp(values, axis=(0, 1))
        sizes = np.abs(coefficients(values, axis=1)) / np.where(spread > 0, spread, 1.0)
        tails.append(np.cumsum(sizes[:, ::-1], axis=1)[:, ::-1].max(axis=(0, 2)))
    return tails


def _errors(
    model: GaussianProcess, plain: GridGP, positions: Array, places: Sequence[Callable[[Array], Array]]
) -> tuple[Array, Array]:
    """Return root-mean-square errors of the train over the box, (p,), and given one input, (p, d, positions)."""
    inputs = model.inputs_
    shares = 2 * sobol_points(SAMPLE, len(inputs)).T - 1
    t = np.stack([place(share) for place, share in zip(places, shares, strict=True)], axis=1)
    over = np.empty((len(model.outputs_), len(inputs), len(positions)))
    for i in range(len(inputs)):
        for j, position in enumerate(positions):
            points = t[: SAMPLE // 4].copy()
            points[:, i] = position
            over[:, i, j] = _mean_square(model, plain, points)
    return np.sqrt(_mean_square(model, plain, t)), np.sqrt(over)


def _mean_square(model: GaussianProcess, plain: GridGP, t: Array) -> Array:
    X = physical_points(model.inputs_, t.T)
    mean, std = model.predict_array(X, return_std=True)
    shift = mean - plain.predict_array(X)
    return np.asarray((std**2 + shift**2).mean(axis=0))


def _bounds(part: Array, whole: Array, error: Array) -> tuple[Array, Array]:
    """Return bounds of part/whole, (d, p), if the roots of both have errors up to `error`, (p,)."""
    low = np.maximum(np.sqrt(part) - error, 0) / (np.sqrt(whole) + error)
    high = (np.sqrt(part) + error) / np.maximum(np.sqrt(whole) - error, np.finfo(float).tiny)
    return low**2, np.minimum(high, 1) ** 2
