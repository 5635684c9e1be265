"""Tensor trains from few entries of a tensor: cross approximation, where an entry is a whole block of values.

A sweep goes from the first mode to the last. At a mode, the tensor is sampled at the rows that are kept of the modes
before it, every index of its own, and a few indices of the modes behind it. What blocks hold makes a few enough: they
have many values, all of which the kept rows must interpolate. Rows are chosen by QR with pivoting, so that ranks follow
from the tolerance. Fresh entries judge the train; where it errs most is where the next sweep looks too.

Sources: I. V. Oseledets and E. Tyrtyshnikov, Linear Algebra Appl. 432 (2010) 70 (TT-cross); H. Cheng et al., SIAM J.
Sci. Comput. 26 (2005) 1389 (interpolation from rows chosen by QR).
"""

from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import qr, solve_triangular

from approximation.arrays import Array, Indices

#: The steps of an approximation: it yields indices (n, d), is sent their blocks (n, b, p), and returns what it found.
Steps = Generator[Indices, Array, "Crossed"]

# FRESH entries judge every sweep. A sweep asks for BEHIND indices of the modes behind, for BEHIND_FEW where a block has
# fewer values than MANY. The rows that it keeps give all others to LEFT of the tolerance in the first sweep; each
# further sweep multiplies that share by FINER.
FRESH, BEHIND, BEHIND_FEW, MANY = 24, 2, 4, 100
LEFT, FINER = 0.1, 0.5


@dataclass(frozen=True)
class Crossed:
    """Result of a cross approximation."""

    # Core k has shape (r_k, n_k, r_{k+1}), the last one (r_d, n_d, b, p). Values are less `offset`, over `scale`.
    cores: tuple[Array, ...]
    # shape (p,); Mean and range of the first fresh entries
    offset: Array
    scale: Array
    error: Array  # shape (p,); Largest error on the last fresh entries over `scale`
    entries: int  # Entries that were asked for, fresh ones included

    def at(self, indices: Indices) -> Array:
        """Return values less offset over scale, (n, b, p), at indices (n, d)."""
        return _at(self.cores, indices)


@dataclass(frozen=True)
class Cross:
    """A cross approximation of a tensor with blocks as entries."""

    sizes: tuple[int, ...]  # Indices n_k of every mode
    tolerance: float  # Largest error of any value over its output's range that fresh entries may show
    most: int = 10_000  # No sweep begins once so many entries have been asked for
    seed: int = 0  # Of fresh entries and first indices

    def steps(self) -> Steps:
        """Return the steps, each a batch of indices without repetition; same seed and blocks, same steps."""
        random = np.random.default_rng(self.seed)
        fresh = self._fresh(random, {})
        requested = dict.fromkeys(map(tuple, fresh.tolist()))
        blocks = yield fresh
        offset, scale = blocks.mean(axis=(0, 1)), np.ptp(blocks, axis=(0, 1))
        scale[scale == 0] = 1.0
        count = BEHIND if blocks[0].size >= MANY else BEHIND_FEW
        behind = [self._spread(random, k, count) for k in range(1, len(self.sizes))] + [np.zeros((1, 0), dtype=np.intp)]
        rows: list[Indices | None] = [None] * len(self.sizes)
        left = LEFT * self.tolerance
        while True:
            cores: list[Array] = []
            before = np.zeros((1, 0), dtype=np.intp)
            for k, size in enumerate(self.sizes):
                candidates = _pairs(before, np.arange(size)[:, None])
                wanted = _pairs(candidates, behind[k])
                requested |= dict.fromkeys(map(tuple, wanted.tolist()))
                values = ((yield wanted) - offset) / scale
                if k == len(self.sizes) - 1:
                    cores.append(values.reshape(len(before), size, *values.shape[1:]))
                    break
                matrix = values.reshape(len(candidates), -1)
                chosen, weights = interpolation(matrix, left, _places(candidates, rows[k]))
                cores.append(weights.reshape(len(before), size, -1))
                rows[k] = before = candidates[chosen]
            errors = np.abs(_at(cores, fresh) - (blocks - offset) / scale).max(axis=1)
            if errors.max() <= self.tolerance or len(requested) >= self.most:
                return Crossed(tuple(cores), offset, scale, errors.max(axis=0), len(requested))
            worst = fresh[errors.max(axis=1).argmax()]
            behind = [np.unique(np.vstack([old, worst[None, k + 1 :]]), axis=0) for k, old in enumerate(behind)]
            left *= FINER
            fresh = self._fresh(random, requested)
            requested |= dict.fromkeys(map(tuple, fresh.tolist()))
            blocks = yield fresh

    def _spread(self, random: np.random.Generator, k: int, count: int) -> Indices:
        """A few random indices of the modes from k on, different in each as far as it goes."""
        columns = [np.resize(random.permutation(size), count) for size in self.sizes[k:]]
        return np.unique(np.stack(columns, axis=1), axis=0)

    def _fresh(self, random: np.random.Generator, requested: Mapping[tuple[int, ...], None]) -> Indices:
        """Random indices that nobody has asked for, while there are some."""
        drawn = np.unique(random.integers(self.sizes, size=(2 * FRESH, len(self.sizes))), axis=0)
        drawn = random.permutation(drawn)
        unasked = [index for index in drawn.tolist() if tuple(index) not in requested]
        return np.array((unasked or drawn.tolist())[:FRESH], dtype=np.intp)


def run(steps: Steps, known: Mapping[tuple[int, ...], Array]) -> Indices | Crossed:
    """Go through steps as far as blocks are known.

    An approximation has no state but the blocks that it was given: it is gone through again from its first step, which
    costs little beside the blocks, and so an interrupted one goes on as if nothing had happened.

    result: (n, d), or Crossed.
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
    """Choose rows of a matrix from which all others follow.

    matrix: (m, n); result: (r,).
    """
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
    """Values of a train of cores, (n, b, p), at indices (n, d)."""
    state = np.ones((len(indices), 1))
    for core, index in zip(cores, indices.T, strict=True):
        state = np.einsum("nr,rn...->n...", state, core[:, index])
    return state


def _pairs(before: Indices, behind: Indices) -> Indices:
    """Every row of the first followed by every row of the second."""
    return np.hstack([np.repeat(before, len(behind), axis=0), np.tile(behind, (len(before), 1))])


def _places(candidates: Indices, rows: Indices | None) -> list[int]:
    """Return the positions of an earlier sweep's rows among the candidates, in their order."""
    number = {row: place for place, row in enumerate(map(tuple, candidates.tolist()))}
    return [] if rows is None else [number[row] for row in map(tuple, rows.tolist())]
