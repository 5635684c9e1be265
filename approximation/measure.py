"""Measures of several fields at a point, such as norms and largest eigenvalues, with derivatives."""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from approximation.arrays import Array

Floats = NDArray[np.floating[Any]]  # of any precision
_TINY = np.finfo(float).tiny


class Bent(NamedTuple):
    """Values (n,) of a measure, with first and second derivatives by the fields, (n, m) and (n, m, m)."""

    value: Array
    slope: Array
    bend: Array


@dataclass(frozen=True, eq=False)
class Measure:
    """Largest over branches of ``linear . s + |root s|``, a function of the first m fields s."""

    linear: Array  # shape (branches, m)
    root: Array  # shape (branches, rows, m)

    def __post_init__(self) -> None:
        branches, fields = np.shape(self.linear) if np.ndim(self.linear) == 2 else (0, 0)
        if not fields or np.ndim(self.root) != 3 or (len(self.root), self.root.shape[2]) != (branches, fields):
            raise ValueError(f"a measure of shapes {np.shape(self.linear)} and {np.shape(self.root)} is none")
        if not (np.isfinite(self.linear).all() and np.isfinite(self.root).all()):
            raise ValueError("a measure has numbers that are not finite")

    @property
    def fields(self) -> int:
        """Number m of fields that the measure depends on."""
        return int(self.linear.shape[1])

    def of(self, fields: Array) -> Array:
        """Return the measure of fields, (..., m): (...)."""
        branches = [
            fields @ linear + np.linalg.norm(fields @ root.T, axis=-1)
            for linear, root in zip(self.linear, self.root, strict=True)
        ]
        return np.asarray(np.max(branches, axis=0))

    def values(self, s: Floats) -> Floats:
        """Return the measure of fields s, (B, >= m, n): (B, n)."""
        highest: Floats | None = None
        for linear, root in zip(self.linear, self.root, strict=True):
            squares = sum(_product(row, s) ** 2 for row in root if row.any())
            branch = _product(linear, s) + np.sqrt(squares)
            highest = np.asarray(branch) if highest is None else np.maximum(highest, branch, out=highest)
        return np.broadcast_to(np.asarray(highest), (len(s), s.shape[2]))

    def bent(self, s: Array) -> Bent:
        """Return the measure of fields s, (n, m), with the derivatives of the largest branch."""
        branches, count, fields = self.root.shape
        inner = (s @ self.root.reshape(-1, fields).T).reshape(len(s), branches, count)
        norms = np.sqrt((inner * inner).sum(axis=2))
        values = s @ self.linear.T + norms
        which, rows = values.argmax(axis=1), np.arange(len(s))
        root, norm = self.root[which], np.maximum(norms[rows, which], _TINY)[:, None]
        along = (inner[rows, which][:, None] @ root)[:, 0] / norm
        bend = (np.swapaxes(root, 1, 2) @ root - along[:, :, None] * along[:, None]) / norm[..., None]
        return Bent(values[rows, which], self.linear[which] + along, np.where(norm[..., None] > _TINY, bend, 0.0))


def _product(row: Array, s: Floats) -> Floats:
    """Return the sum of fields s (B, >= m, n) with weights (m,), skipping zero weights: (B, n)."""
    return np.asarray(sum(weight * s[:, k] for k, weight in enumerate(row.tolist()) if weight))


#: The measure that equals a single field.
ITSELF = Measure(np.ones((1, 1)), np.zeros((1, 1, 1)))
