"""Tensor-train cores in a few bytes an entry: no finer than what an entry changes of the outputs."""

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from approximation.arrays import Array

#: Rounding of one entry, as it reaches an output of unit variance: a hundred thousand of them add up to some 1e-10.
STEP = 1e-12
_LOW = 7  # bits of a byte that hold digits; the highest says that another byte follows


@dataclass(frozen=True, eq=False)
class Rounded:
    """An array to be stored as whole numbers, each times one number for its row and one for its column."""

    values: Array  # shape (r, modes, s); The array
    # shape (r,) and (s,); What the whole numbers are multiplied by
    rows: Array
    columns: Array


def rounded(cores: Sequence[Array], features: Sequence[Array]) -> list[Rounded]:
    """Return how the cores of a train are rounded: most entries have few digits.

    An entry from row i to column j reaches the outputs times what comes in at i and what goes out at j. Their
    root-mean-squares over the box give the entry a step that changes every output alike.

    cores: sequence of ndarray, shape (r, modes, s); features: sequence of ndarray, shape (modes, n).
    """
    coming, going = _coming(cores, features), _going(cores, features)
    parts = zip(cores, coming[:-1], going[1:], strict=True)
    return [Rounded(core, 1 / rows, STEP / columns) for core, rows, columns in parts]


def encoded(plain: Any) -> Any:
    """Return plain values as what JSON can hold.

    An array becomes what :func:`array` says. One that is `Rounded` becomes ``shape``; ``rows`` and ``columns``, as
    :func:`array` has them; ``data``, base64 of the entries in C order, each the bytes of 2 |n| - (n < 0), lowest seven
    bits first, 128 added where more follow.
    """
    if isinstance(plain, np.ndarray):
        return array(plain)
    if isinstance(plain, Rounded):
        whole = np.rint(plain.values / (plain.rows[:, None, None] * plain.columns)).astype(np.int64)
        data = base64.b64encode(_bytes(whole.ravel())).decode("ascii")
        return {"shape": list(whole.shape), "rows": array(plain.rows), "columns": array(plain.columns), "data": data}
    if isinstance(plain, Mapping):
        return {name: encoded(value) for name, value in plain.items()}
    return [encoded(value) for value in plain] if isinstance(plain, list | tuple) else plain


def array(values: Array) -> dict[str, Any]:
    """An array as its shape and base64 of little-endian float64, so that no digit is lost."""
    little = np.ascontiguousarray(values, dtype="<f8")
    return {"shape": list(little.shape), "data": base64.b64encode(little.tobytes()).decode("ascii")}


def _coming(cores: Sequence[Array], features: Sequence[Array]) -> list[Array]:
    """Root-mean-square of every state from the left, before each core and after the last."""
    state = np.ones((features[0].shape[1], 1))
    sizes = [_rms(state)]
    for core, feature in zip(cores, features, strict=True):
        state = np.einsum("ni,imj,mn->nj", state, core, feature, optimize=True)
        sizes.append(_rms(state))
    return sizes


def _going(cores: Sequence[Array], features: Sequence[Array]) -> list[Array]:
    """The same of what every state does to the outputs; of the outputs the one that it changes most."""
    outputs = cores[-1].shape[2]
    state = np.broadcast_to(np.eye(outputs), (features[0].shape[1], outputs, outputs))
    sizes = [_rms(state).max(axis=-1)]
    for core, feature in zip(cores[::-1], features[::-1], strict=True):
        state = np.einsum("imj,mn,njp->nip", core, feature, state, optimize=True)
        sizes.append(_rms(state).max(axis=-1))
    return sizes[::-1]


def _rms(states: Array) -> Array:
    """Over the points; never zero, as it divides."""
    return np.asarray(np.maximum(np.sqrt(np.square(states).mean(axis=0)), np.finfo(np.float64).tiny ** 0.25))


def _bytes(whole: np.ndarray[tuple[int], np.dtype[np.int64]]) -> bytes:
    """Whole numbers by groups of seven bits."""
    remainder = (2 * np.abs(whole) - (whole < 0)).astype(np.uint64)
    groups, continued = [], [np.ones(remainder.shape, dtype=bool)]
    while continued[-1].any():
        groups.append((remainder & np.uint64(2**_LOW - 1)).astype(np.uint8))
        remainder = remainder >> np.uint64(_LOW)
        continued.append(remainder > 0)
    follow = np.stack(continued[1:], axis=-1)
    table = np.stack(groups, axis=-1) | (follow << _LOW).astype(np.uint8)
    return bytes(table[np.stack(continued[:-1], axis=-1)])
