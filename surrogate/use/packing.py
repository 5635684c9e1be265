"""Tensor-train cores in a few bytes an entry: no finer than what an entry changes of the outputs."""

import base64
from collections.abc import Sequence
from typing import Any

import numpy as np

from surrogate.data.arrays import Array
from surrogate.gp.factors import ChebyshevFactor

#: Rounding of one entry, as it reaches an output of unit variance: a hundred thousand of them add up to some 1e-10.
STEP = 1e-12
_DRAWS = 256  # points of the box at which states are measured
_LOW = 7  # bits of a byte that hold digits; the highest says that another byte follows


def packed(cores: Sequence[Array], factors: Sequence[ChebyshevFactor], order: Sequence[int]) -> list[dict[str, Any]]:
    """Every core as whole numbers of a few bytes each, times a number for its row and one for its column.

    An entry from row i to column j reaches the outputs times what comes in at i and what goes out at j. Their
    root-mean-squares over the box give the entry a step that changes every output alike: most entries have few digits.

    Parameters
    ----------
    cores : sequence of ndarray, shape (r, modes, s)
        In their order along the train.
    factors : sequence of ChebyshevFactor
        By input.
    order : sequence of int
        Input of each core.

    Returns
    -------
    list of dict
        ``shape``; ``rows``, (r,), and ``columns``, (s,), float64 as :func:`array` has them; ``data``, base64 of the
        entries in C order, each the bytes of 2 |n| - (n < 0), lowest seven bits first, 128 added where more follow.
    """
    t = np.random.default_rng(0).uniform(-1, 1, (_DRAWS, len(order)))
    features = [factors[k].features(t[:, k], core.shape[1]).mean for k, core in zip(order, cores, strict=True)]
    coming, going = _coming(cores, features), _going(cores, features)
    out = []
    for core, rows, columns in zip(cores, coming[:-1], going[1:], strict=True):
        out.append(rounded(core, 1 / rows, STEP / columns))
    return out


def rounded(core: Array, rows: Array, columns: Array) -> dict[str, Any]:
    """An array, (r, modes, s), as whole numbers times one for its row, (r,), and one for its column, (s,).

    Its parts are those that :func:`packed` describes.
    """
    whole = np.rint(core / (rows[:, None, None] * columns)).astype(np.int64)
    data = base64.b64encode(_bytes(whole.ravel())).decode("ascii")
    return {"shape": list(core.shape), "rows": array(rows), "columns": array(columns), "data": data}


def array(values: Array) -> dict[str, Any]:
    """An array as its shape and base64 of little-endian float64, so that no digit is lost."""
    little = np.ascontiguousarray(values, dtype="<f8")
    return {"shape": list(little.shape), "data": base64.b64encode(little.tobytes()).decode("ascii")}


def _coming(cores: Sequence[Array], features: Sequence[Array]) -> list[Array]:
    """Root-mean-square of every state from the left, before each core and after the last."""
    state = np.ones((_DRAWS, 1))
    out = [_rms(state)]
    for core, feature in zip(cores, features, strict=True):
        state = np.einsum("ni,imj,mn->nj", state, core, feature, optimize=True)
        out.append(_rms(state))
    return out


def _going(cores: Sequence[Array], features: Sequence[Array]) -> list[Array]:
    """The same of what every state does to the outputs; of the outputs the one that it changes most."""
    outputs = cores[-1].shape[2]
    state = np.broadcast_to(np.eye(outputs), (_DRAWS, outputs, outputs))
    out = [_rms(state).max(axis=-1)]
    for core, feature in zip(cores[::-1], features[::-1], strict=True):
        state = np.einsum("imj,mn,njp->nip", core, feature, state, optimize=True)
        out.append(_rms(state).max(axis=-1))
    return out[::-1]


def _rms(states: Array) -> Array:
    """Over the points; never zero, as it divides."""
    return np.asarray(np.maximum(np.sqrt(np.square(states).mean(axis=0)), np.finfo(np.float64).tiny ** 0.25))


def _bytes(whole: np.ndarray[tuple[int], np.dtype[np.int64]]) -> bytes:
    """Whole numbers by groups of seven bits."""
    rest = (2 * np.abs(whole) - (whole < 0)).astype(np.uint64)
    groups, more = [], [np.ones(rest.shape, dtype=bool)]
    while more[-1].any():
        groups.append((rest & np.uint64(2**_LOW - 1)).astype(np.uint8))
        rest = rest >> np.uint64(_LOW)
        more.append(rest > 0)
    follow = np.stack(more[1:], axis=-1)
    table = np.stack(groups, axis=-1) | (follow << _LOW).astype(np.uint8)
    return bytes(table[np.stack(more[:-1], axis=-1)])
