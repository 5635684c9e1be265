"""Outputs over products of powers of the inputs: what is learnt of them, and how they follow from it.

    output(x) = scale(x) (f(x) + coefficient log added(x)),   or   sign scale(x) exp(sign f(x))

with scale and added products of powers of the inputs x, and f what is learnt.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from approximation.arrays import Array
from surrogate.data.inputs import Input
from surrogate.transforms.inputs import Powers, row_of


@dataclass(frozen=True)
class Scaling:
    """Map from the learnt function to one output.

    Parameters
    ----------
    powers : mapping of str to float
        The output is proportional to this product of powers of the inputs.
    coefficient : float
        What the logarithm of `Grouping.added` is multiplied by, before the product.
    logarithm : {-1, 0, 1}
        The sign of an output whose logarithm is learnt, 0 where it is learnt itself.
    """

    powers: Powers = field(default_factory=dict)
    coefficient: float = 0.0
    logarithm: int = 0


class Scales:
    """The scales of p outputs as functions of points in the inputs.

    references: (d,).
    """

    def __init__(
        self,
        inputs: Sequence[Input],
        names: Sequence[str],
        scalings: Mapping[str, Scaling],
        added: Powers,
        references: Array,
    ) -> None:
        self.names = tuple(names)
        self.powers = np.stack([row_of(scalings[name].powers, inputs) for name in names])
        self.coefficients = np.array([scalings[name].coefficient for name in names])
        self.signs = np.array([scalings[name].logarithm for name in names])
        self.added, self.references = row_of(added, inputs), references
        self._distinct, which = np.unique(self.powers, axis=0, return_inverse=True)
        self._which = which.reshape(-1)
        self._logarithms = [(int(k), int(self.signs[k])) for k in np.flatnonzero(self.signs)]

    def values(self, X: Array) -> Array:
        """Return what learnt outputs are multiplied by at points (n, d): (p, n)."""
        return np.asarray(np.exp(self._logarithm(X, self._distinct))[self._which])

    def steepness(self, X: Array) -> Array:
        """Return the derivatives of their logarithms by the inputs at points (n, d): (d, p, n)."""
        return np.stack([_steepness(X, row) for row in self.powers], axis=1)

    def additions(self, X: Array) -> Array:
        """Return what is added to learnt outputs at points (n, d): (p, n)."""
        return np.asarray(self.coefficients[:, None] * self._logarithm(X, self.added[None]))

    def added_slopes(self, X: Array) -> Array:
        """Return the derivatives of `additions` by the inputs at points (n, d): (d, p, n)."""
        return np.asarray(self.coefficients[:, None] * _steepness(X, self.added)[:, None])

    def transform(self, values: Array, X: Array) -> Array:
        """Return what is to be learnt of outputs, (p, n).

        values: (p, n), the outputs in their units; X: (n, d), points in physical units.
        """
        learnt = values / self.values(X)
        for k, sign in self._logarithms:
            if (learnt[k] * sign <= 0).any():
                low, high = values[k].min(), values[k].max()
                raise ValueError(
                    f"output {self.names[k]!r} is from {low:g} to {high:g}: no logarithm of what changes sign"
                )
            learnt[k] = sign * np.log(learnt[k] * sign)  # grows with the output
        return np.asarray(learnt - self.additions(X))

    def untransform(self, learnt: Array, X: Array) -> Array:
        """Return the outputs of what is learnt, (p, n): the inverse of `transform`.

        learnt: (p, n); X: (n, d), points in physical units.
        """
        outputs = learnt + self.additions(X)
        for k, sign in self._logarithms:
            outputs[k] = sign * np.exp(sign * outputs[k])
        return np.asarray(outputs * self.values(X))

    def sizes(self, X: Array, mean: Array) -> Array:
        """Return what errors of learnt outputs are multiplied by, (p, n): their scale, or the output of a logarithm.

        X: (n, d); mean: (p, n).
        """
        return np.asarray(np.where(self.signs[:, None] == 0, self.values(X), np.abs(mean)))

    def _logarithm(self, X: Array, rows: Array) -> Array:
        """Logarithms of products of powers relative to the reference, (rows, n); only positive inputs occur in them."""
        used = rows.any(axis=0)
        return np.asarray(rows[:, used] @ np.log(X[:, used] / self.references[used]).T)


def _steepness(X: Array, row: Array) -> Array:
    """Derivatives of the logarithm of a product by the inputs, (d, n)."""
    steep = np.zeros((len(row), len(X)))
    steep[row != 0] = row[row != 0, None] / X.T[row != 0]
    return steep
