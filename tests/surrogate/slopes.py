"""Derivatives of a model against differences of its own means."""

import numpy as np

from approximation.arrays import Array
from surrogate import GaussianProcess


def assert_slopes(model: GaussianProcess, X: Array, step: float = 1e-4, rtol: float = 1e-6) -> None:
    """Compare all derivatives at X (n, d) with fourth-order differences, to ``rtol`` of the largest slope.

    ``step`` is over an input's value, or over a hundredth of its range where that is more.
    """
    slopes = model.gradient_array(X)  # (n, p, d)
    for k, input_ in enumerate(model.inputs_):
        moves = step * np.maximum(np.abs(X[:, k]), 0.01 * (input_.high - input_.low))
        ends = [model.predict_array(X + move * moves[:, None] * np.eye(X.shape[1])[k]) for move in (-2, -1, 1, 2)]
        difference = (ends[0] - 8 * ends[1] + 8 * ends[2] - ends[3]) / (12 * moves[:, None])
        room = rtol * np.max(np.abs(difference), axis=0)
        assert np.all(np.abs(slopes[..., k] - difference) <= room + 1e-300), (input_.name, slopes[..., k], difference)
