"""Gaussian process on a grid whose factorial is too large: a tensor train by cross approximation from few cases.

An entry of the tensor is a block of values. A sweep goes from the first mode to the last. At each mode it samples the
rows kept of the modes before, every index of the mode, and a few indices of the modes behind; few are enough, since the
rows must interpolate all values of the blocks. QR with pivoting chooses the rows, so that ranks follow from the
tolerance. Fresh entries judge the train, and the next sweep also samples where its error is largest.

Sources: I. V. Oseledets and E. Tyrtyshnikov, Linear Algebra Appl. 432 (2010) 70 (TT-cross); H. Cheng et al., SIAM J.
Sci. Comput. 26 (2005) 1389 (interpolation from rows chosen by QR).
"""

from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import xarray as xr
from scipy.linalg import qr, solve_triangular

from approximation.arrays import Array, Indices
from surrogate.data.factorial import LEVEL_TOLERANCE, output_names, text_attrs
from surrogate.data.inputs import Input
from surrogate.gp.factors import cosine_basis
from surrogate.gp.gridgp import GridGP
from surrogate.gp.tensortrain import TensorTrain, compress

PLACE = "place"  # dimension of the requested places
SMALL = 0.1  # error of the compressed train over the outputs' ranges, as a share of `compression`
#: An approximation yields indices (n, d), is sent their blocks (n, b, p), and returns the result.
Steps = Generator[Indices, Array, "Crossed"]

FRESH = 24  # entries that judge a sweep
BEHIND, BEHIND_FEW, MANY = 2, 4, 100  # first indices of the modes behind, and for blocks of fewer values than MANY
LEFT, FINER = 0.1, 0.5  # interpolation error of the first sweep's rows over the tolerance, and its factor per sweep


@dataclass(frozen=True)
class Crossed:
    """Result of a cross approximation."""

    # core k has shape (r_k, n_k, r_{k+1}), the last one (r_d, n_d, b, p), of values less `offset`, over `scale`
    cores: tuple[Array, ...]
    offset: Array  # shape (p,); mean of the first fresh entries
    scale: Array  # shape (p,); their range
    error: Array  # shape (p,); largest error on the last fresh entries, over `scale`
    entries: int  # number of requested entries, fresh ones included


def approximation(sizes: Sequence[int], tolerance: float, most: int = 10_000) -> Steps:
    """Approximate a tensor (n_1, ..., n_d) of blocks; yield batches of indices, the same ones for equal blocks.

    tolerance: largest error over an output's range at fresh entries; most: entries after which no sweep begins.
    """
    random = np.random.default_rng(0)
    fresh = _fresh(random, sizes, {})
    requested = dict.fromkeys(map(tuple, fresh.tolist()))
    blocks = yield fresh
    offset, scale = blocks.mean(axis=(0, 1)), np.ptp(blocks, axis=(0, 1))
    scale[scale == 0] = 1.0
    count = BEHIND if blocks[0].size >= MANY else BEHIND_FEW
    behind = [_spread(random, sizes[k:], count) for k in range(1, len(sizes))] + [np.zeros((1, 0), dtype=np.intp)]
    rows: list[Indices | None] = [None] * len(sizes)
    left = LEFT * tolerance
    while True:
        cores: list[Array] = []
        before = np.zeros((1, 0), dtype=np.intp)
        for k, size in enumerate(sizes):
            candidates = _pairs(before, np.arange(size)[:, None])
            wanted = _pairs(candidates, behind[k])
            requested |= dict.fromkeys(map(tuple, wanted.tolist()))
            values = ((yield wanted) - offset) / scale
            if k == len(sizes) - 1:
                cores.append(values.reshape(len(before), size, *values.shape[1:]))
                break
            matrix = values.reshape(len(candidates), -1)
            chosen, weights = interpolation(matrix, left, _places(candidates, rows[k]))
            cores.append(weights.reshape(len(before), size, -1))
            rows[k] = before = candidates[chosen]
        errors = np.abs(_at(cores, fresh) - (blocks - offset) / scale).max(axis=1)
        if errors.max() <= tolerance or len(requested) >= most:
            return Crossed(tuple(cores), offset, scale, errors.max(axis=0), len(requested))
        worst = fresh[errors.max(axis=1).argmax()]
        behind = [np.unique(np.vstack([old, worst[None, k + 1 :]]), axis=0) for k, old in enumerate(behind)]
        left *= FINER
        fresh = _fresh(random, sizes, requested)
        requested |= dict.fromkeys(map(tuple, fresh.tolist()))
        blocks = yield fresh


def _spread(random: np.random.Generator, sizes: Sequence[int], count: int) -> Indices:
    """Return at most `count` random indices of modes, (n, d), with distinct indices along every mode if possible."""
    columns = [np.resize(random.permutation(size), count) for size in sizes]
    return np.unique(np.stack(columns, axis=1), axis=0)


def _fresh(random: np.random.Generator, sizes: Sequence[int], requested: Mapping[tuple[int, ...], None]) -> Indices:
    """Return at most FRESH random indices, (n, d), that were not requested, or requested ones if none are left."""
    candidates = np.unique(random.integers(sizes, size=(2 * FRESH, len(sizes))), axis=0)
    candidates = random.permutation(candidates)
    fresh = [index for index in candidates.tolist() if tuple(index) not in requested]
    return np.array((fresh or candidates.tolist())[:FRESH], dtype=np.intp)


def run(steps: Steps, known: Mapping[tuple[int, ...], Array]) -> Indices | Crossed:
    """Run an approximation on known blocks; return its result or the next indices, (n, d), without a block.

    It always starts from its first step, which costs little beside the blocks, so that an interrupted one can resume.
    """
    wanted = next(steps)
    while True:
        missing = [index for index in map(tuple, wanted.tolist()) if index not in known]
        if missing:
            return np.array(missing, dtype=np.intp)
        try:
            wanted = steps.send(np.stack([known[index] for index in map(tuple, wanted.tolist())]))
        except StopIteration as end:
            crossed: Crossed = end.value
            return crossed


def interpolation(matrix: Array, left: float, first: Sequence[int] = ()) -> tuple[Indices, Array]:
    """Return rows, (r,), beginning with `first`, and weights, (m, r), that interpolate a matrix (m, n) to an error."""
    rows, residual = list(first), matrix
    if rows:
        basis = qr(matrix[rows].T, mode="economic")[0]
        residual = matrix - (matrix @ basis) @ basis.T
    triangle, order = qr(residual.T, mode="r", pivoting=True)
    size = np.abs(np.diagonal(triangle)) > left * np.sqrt(matrix.shape[1])
    size[min(len(size), matrix.shape[1] - len(rows)) :] = False
    additional = [row for row in order[: int(np.count_nonzero(size))].tolist() if row not in rows]
    rows += additional or ([] if rows else [int(order[0])])
    basis, triangle = qr(matrix[rows].T, mode="economic")
    weights = solve_triangular(triangle, basis.T @ matrix.T).T
    weights[rows] = np.eye(len(rows))
    return np.array(rows, dtype=np.intp), weights


def _at(cores: Sequence[Array], indices: Indices) -> Array:
    """Return the values, (n, b, p), of a train of cores at indices (n, d)."""
    state = np.ones((len(indices), 1))
    for core, index in zip(cores, indices.T, strict=True):
        state = np.einsum("nr,rn...->n...", state, core[:, index])
    return state


def _pairs(before: Indices, behind: Indices) -> Indices:
    """Return every row of `before` followed by every row of `behind`."""
    return np.hstack([np.repeat(before, len(behind), axis=0), np.tile(behind, (len(before), 1))])


def _places(candidates: Indices, rows: Indices | None) -> list[int]:
    """Return the positions of the last sweep's rows among the candidates, in the order of the rows."""
    number = {row: place for place, row in enumerate(map(tuple, candidates.tolist()))}
    return [] if rows is None else [number[row] for row in map(tuple, rows.tolist())]


class CrossGP(GridGP):
    """Gaussian process on a grid that is fitted to few cases of the factorial by cross approximation.

    Some inputs are *crossed*: `ask` returns the places, of their levels, to be solved next. At every place all levels
    of the other inputs are solved, which should be cheap. The fitted and saved model is a `GridGP`.

    Parameters
    ----------
    inputs : sequence of Input
        The box.
    levels : mapping
        Chebyshev-Gauss levels of every input by name.
    crossed : sequence of str
        Names of the crossed inputs, those of the most levels first: the last have the largest ranks.
    tolerance : float
        Largest error of an output over its range at fresh places, on levels.
    outputs : sequence of str, optional
        Outputs to model, by default every variable.
    compression : float
        As of `GridGP`.
    most : int
        Number of places after which no sweep begins, whatever the error.

    Attributes
    ----------
    error_ : dict of str to float
        Largest error of every output over its range at the last fresh places, on levels.
    places_ : int
        Number of requested places.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> from surrogate import CrossGP, Input
    >>> box = [Input(name, 0, 1) for name in "xyz"]
    >>> model = CrossGP(box, {"x": 8, "y": 7, "z": 6}, ["x", "y"], tolerance=1e-6)
    >>> def truth(places):
    ...     z = xr.DataArray(box[2].levels(6), dims="z", name="z")
    ...     return places.assign(f=np.exp(places.x * places.y + z) / (2 + places.x), z=z)
    >>> data, places = None, model.ask(None)
    >>> while "place" in places.sizes:
    ...     data = xr.concat([truth(places)] if data is None else [data, truth(places)], "place", data_vars="all")
    ...     places = model.ask(data)
    >>> float(model.fit(data).predict({"x": 0.3, "y": 0.8, "z": 0.5})["f"].round(4))
    0.9113
    >>> model.whole, len(model.blocks(data)) == model.places_
    (('z',), True)
    """

    def __init__(
        self,
        inputs: Sequence[Input],
        levels: Mapping[str, int],
        crossed: Sequence[str],
        tolerance: float,
        outputs: Sequence[str] | None = None,
        compression: float = 1e-9,
        most: int = 10_000,
    ) -> None:
        super().__init__(inputs, outputs, compression=compression)
        names = [input_.name for input_ in inputs]
        unknown = [name for name in (*crossed, *levels) if name not in names]
        if unknown or not crossed or set(levels) != set(names):
            raise ValueError(f"crossed and levels must name inputs, {', '.join(names)}, got {', '.join(unknown)}")
        self.levels, self.crossed, self.tolerance, self.most = dict(levels), tuple(crossed), tolerance, most
        self._box = dict(zip(names, inputs, strict=True))

    @property
    def whole(self) -> tuple[str, ...]:
        """Names of the inputs whose levels are all solved at every place."""
        return tuple(name for name in self.levels if name not in self.crossed)

    def ask(self, X: xr.Dataset | None) -> xr.Dataset:
        """Return the places to be solved next or, when there are enough, the error of the train.

        Parameters
        ----------
        X : Dataset or None
            All cases solved so far, as `fit` takes them; None before any.

        Returns
        -------
        Dataset
            The crossed inputs over `place`; in the end `error` over `output`, as `error_`.
        """
        crossed = run(self._steps(), {} if X is None else self.blocks(X))
        if X is not None and isinstance(crossed, Crossed):
            error = ("output", crossed.error, {"long_name": "largest error over range at fresh places"})
            return xr.Dataset({"error": error}, {"output": self._names(X)})
        columns = zip(self.crossed, np.asarray(crossed).T, strict=True)
        return xr.Dataset(
            {
                name: (PLACE, self._box[name].levels(self.levels[name])[index], self._box[name].attrs)
                for name, index in columns
            }
        )

    def fit(self, X: xr.Dataset) -> Self:
        """Fit to the cases at the requested places.

        Parameters
        ----------
        X : Dataset
            The outputs over `place` and the inputs that are not crossed; the crossed inputs over `place`.

        Raises
        ------
        ValueError
            Cases are missing or not finite, or a value is no level.
        """
        crossed = run(self._steps(), self.blocks(X))
        if not isinstance(crossed, Crossed):
            raise ValueError(f"{len(crossed)} places are still to be solved; `ask` names them")
        self.inputs_ = tuple(self._box.values())
        self.levels_ = tuple(input_.levels(self.levels[name]) for name, input_ in self._box.items())
        self.outputs_ = tuple(self._names(X))
        self.attrs_ = {name: text_attrs(X[name]) for name in self.outputs_}
        self.calibration_ = self.correction_ = None
        self.cases_ = int(crossed.entries * np.prod([self.levels[name] for name in self.whole]))
        self.order_ = tuple(list(self._box).index(name) for name in (*self.crossed, *self.whole))
        self.error_ = dict(zip(self.outputs_, crossed.error.tolist(), strict=True))
        self.places_ = crossed.entries
        self._standardise(self._train(crossed), crossed)
        return self

    def _steps(self) -> Steps:
        return approximation([self.levels[name] for name in self.crossed], self.tolerance, self.most)

    def _names(self, X: xr.Dataset) -> list[str]:
        return output_names(X, self.outputs, exclude=tuple(self.levels))

    def blocks(self, X: xr.Dataset) -> dict[tuple[int, ...], Array]:
        """Return the cases (b, p) of every place by its indices among the levels; ValueError as for `fit`."""
        names = self._names(X)
        indices = np.stack([self._index(name, X[name].values) for name in self.crossed], axis=1)
        for name in self.whole:
            self._index(name, X[name].values)
        like = xr.DataArray(
            np.zeros([len(indices), *(self.levels[name] for name in self.whole)]), dims=(PLACE, *self.whole)
        )
        columns = [(X[name].drop_vars(X[name].coords) + like).transpose(PLACE, *self.whole) for name in names]
        blocks = np.stack([column.values.reshape(len(indices), -1) for column in columns], axis=-1)
        bad = ~np.isfinite(blocks).all(axis=(0, 1))
        if bad.any():
            raise ValueError(f"output {names[int(bad.argmax())]!r} is not finite in some case")
        return dict(zip(map(tuple, indices.tolist()), blocks, strict=True))

    def _index(self, name: str, values: Array) -> Indices:
        """Return the level number of every value; ValueError for a value that is no level."""
        axis = self._box[name]
        levels, unit = axis.to_unit(axis.levels(self.levels[name])), axis.to_unit(values)
        nearest = np.abs(unit[:, None] - levels).argmin(axis=1)
        mismatched = np.abs(unit - levels[nearest]) > LEVEL_TOLERANCE
        if mismatched.any():
            raise ValueError(f"input {name!r}: {values[mismatched][0]:.10g} is none of its {self.levels[name]} levels")
        return np.asarray(nearest, dtype=np.intp)

    def _train(self, crossed: Crossed) -> TensorTrain:
        """Return the train of coefficients in the orthonormal bases, of values less offset, over scale."""
        bases = [cosine_basis(self.levels[name])[0] for name in (*self.crossed, *self.whole)]
        cores = [np.einsum("rns,nm->rms", core, basis) for core, basis in zip(crossed.cores[:-1], bases, strict=False)]
        last = crossed.cores[-1]
        block: Any = last.reshape(*last.shape[:2], *(self.levels[name] for name in self.whole), last.shape[-1])
        for k, basis in enumerate(bases[len(cores) :], start=1):
            block = np.moveaxis(np.tensordot(block, basis, (k, 0)), -1, k)
        # the rows before the last core interpolate, so that an error of its entries is about that of all entries
        small = SMALL * self.compression
        split = compress(block.reshape(-1, *block.shape[2:]), small * float(np.sqrt(last.size))).cores
        first = split[0].reshape(*last.shape[:2], -1)
        whole = TensorTrain((*cores, first, *split[1:]))
        return whole.only(range(last.shape[-1]), small * float(np.sqrt(self._places())))

    def _standardise(self, train: TensorTrain, crossed: Crossed) -> None:
        """Set the outputs' means, deviations and train from a train of scaled values, then kernels and variance."""
        sizes = [len(self.levels_[k]) for k in self.order_]
        constants, grams = [np.eye(size)[:, :1] for size in sizes], train.grams()
        for k, (gram, size) in enumerate(zip(grams, sizes, strict=True)):
            # remove the mean, which is zero for a grid's standardised outputs
            line = train.evaluate([*constants[:k], np.eye(size), *constants[k + 1 :]])
            mean = line[:, :1].copy()
            gram[:, 0] -= mean * line
            line[:, 0] = 0
            gram[:, :, 0] -= mean * line
        spread = np.sqrt(np.trace(grams[0], axis1=1, axis2=2) / self._places())
        spread[spread <= 0] = 1.0
        self.offset_, self.scale_ = crossed.offset, crossed.scale * spread
        for gram, size in zip(grams, sizes, strict=True):
            gram /= (spread**2 * (self._places() / size))[:, None, None]
        back = np.argsort(self.order_)
        self._choose([grams[k] for k in back])
        whole = TensorTrain((*train.cores[:-1], train.cores[-1] / spread))
        self.train_ = whole.scaled([self.factors_[k].weights for k in self.order_])
