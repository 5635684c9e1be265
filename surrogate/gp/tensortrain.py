"""Tensor trains: coefficient tensors compressed to an error (I. V. Oseledets, SIAM J. Sci. Comput. 33 (2011) 2295)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from approximation.arrays import Array


@dataclass(frozen=True)
class TensorTrain:
    """A tensor over d factors and p outputs as d cores, so that one pass evaluates every output."""

    cores: tuple[Array, ...]  # core k has shape (r_k, modes_k, r_{k+1}), with r_0 = 1 and r_d = p

    @property
    def modes(self) -> tuple[int, ...]:
        """Number of modes of every factor."""
        return tuple(core.shape[1] for core in self.cores)

    def check(self, sizes: Sequence[int], outputs: int) -> None:
        """Raise ValueError unless the cores' shapes fit each other, the factors' sizes and the number of outputs."""
        rank = 1
        for k, (core, size) in enumerate(zip(self.cores, sizes, strict=True)):
            if core.ndim != 3 or core.shape[0] != rank or not 1 <= core.shape[1] <= size:
                raise ValueError(f"core {k} has the shape {core.shape} after rank {rank}, with {size} levels")
            rank = core.shape[2]
        if rank != outputs:
            raise ValueError(f"the last core gives {rank} outputs, not {outputs}")

    def evaluate(self, features: Sequence[Array]) -> Array:
        """Contract with features, (modes_k, B) for every factor: (p, B)."""
        state = None
        for core, feature in zip(self.cores, features, strict=True):
            state = _absorb(state, core, feature)
        return np.asarray(state)

    def gradient(self, features: Sequence[Array], slopes: Sequence[Array]) -> Array:
        """Contract with the slopes (modes, B) of each factor in turn and the features of all others: (d, p, B)."""
        states: list[Array | None] = [None]
        for core, feature in zip(self.cores, features, strict=True):
            states.append(_absorb(states[-1], core, feature))
        parts = []
        for k, slope in enumerate(slopes):
            state = _absorb(states[k], self.cores[k], slope)
            for core, feature in zip(self.cores[k + 1 :], features[k + 1 :], strict=True):
                state = _absorb(state, core, feature)
            parts.append(state)
        return np.stack(parts)

    def grams(self) -> list[Array]:
        """Return for every factor the Gram matrix of the tensor's slices along it, (p, modes, modes)."""
        outputs = self.cores[-1].shape[2]
        behind = [np.einsum("ip,jp->pij", np.eye(outputs), np.eye(outputs))]
        for core in self.cores[:0:-1]:
            half = np.einsum("amb,pbc->pamc", core, behind[-1], optimize=True)
            behind.append(np.einsum("pamc,dmc->pad", half, core, optimize=True))
        before, grams = np.ones((1, 1)), []
        for core, gram in zip(self.cores, reversed(behind), strict=True):
            half = np.einsum("ad,dnc->anc", before, core, optimize=True)
            grams.append(np.einsum("amb,pbc,anc->pmn", core, gram, half, optimize=True))
            before = np.einsum("amb,amc->bc", core, half, optimize=True)
        return grams

    def scaled(self, weights: Sequence[Array]) -> "TensorTrain":
        """Return the train with the modes of factor k multiplied by weights[k], shape (modes_k,)."""
        return TensorTrain(tuple(core * w[:, None] for core, w in zip(self.cores, weights, strict=True)))

    def only(self, outputs: Sequence[int], error: float) -> "TensorTrain":
        """Return the train of these outputs with ranks cut to a Frobenius norm: Oseledets (2011), algorithm 2."""
        cores = [*self.cores[:-1], self.cores[-1][..., list(outputs)]]
        for k in range(len(cores) - 1, 0, -1):  # orthogonal from the last core to the first
            rank, *trailing = cores[k].shape
            q, r = np.linalg.qr(cores[k].reshape(rank, -1).T)
            cores[k] = q.T.reshape(-1, *trailing)
            cores[k - 1] = cores[k - 1] @ r.T
        allowed = error**2 / max(len(cores) - 1, 1)
        for k in range(len(cores) - 1):  # cut from the first to the last
            rank, size, _ = cores[k].shape
            left, values, right = np.linalg.svd(cores[k].reshape(rank * size, -1), full_matrices=False)
            rank_kept = _kept(values, allowed)
            cores[k] = np.ascontiguousarray(left[:, :rank_kept]).reshape(rank, size, rank_kept)
            cores[k + 1] = np.tensordot(values[:rank_kept, None] * right[:rank_kept], cores[k + 1], 1)
        return TensorTrain(tuple(cores))


def compress(tensor: Array, error: float) -> TensorTrain:
    """Compress a tensor (modes_1, ..., modes_d, p) to a Frobenius norm of the error: Oseledets (2011), algorithm 1."""
    *modes, outputs = tensor.shape
    allowed = error**2 / max(len(modes) - 1, 1)
    cores, remainder, rank = [], tensor, 1
    for size in modes[:-1]:
        remainder = remainder.reshape(rank * size, -1)
        # the left singular vectors need only the triangle of the short side
        short = (
            np.asarray(np.linalg.qr(remainder.T, mode="r")).T if remainder.shape[1] > remainder.shape[0] else remainder
        )
        left, values, _ = np.linalg.svd(short, full_matrices=False)
        new_rank = _kept(values, allowed)
        left = left[:, :new_rank]
        cores.append(np.ascontiguousarray(left).reshape(rank, size, new_rank))
        remainder, rank = left.T @ remainder, new_rank
    cores.append(np.ascontiguousarray(remainder).reshape(rank, modes[-1], outputs))
    return TensorTrain(tuple(cores))


def _kept(values: Array, allowed: float) -> int:
    """Return how many of the descending singular values to keep for dropped squares of at most `allowed` in total."""
    dropped = np.cumsum(values[::-1] ** 2)[::-1]
    return max(1, int(np.count_nonzero(dropped > allowed)))


def _absorb(state: Array | None, core: Array, feature: Array) -> Array:
    """Contract a state (r, B), None at first, and a feature (modes, B) with a core (r, modes, s): (s, B)."""
    r, modes, s = core.shape
    product = feature if state is None else (state[:, None, :] * feature).reshape(r * modes, -1)
    return np.asarray(core.reshape(r * modes, s).T @ product)
