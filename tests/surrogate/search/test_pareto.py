"""Pareto fronts against fronts known in closed form."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from surrogate.search.optimise import Problem
from surrogate.search.pareto import front, non_dominated
from tests.surrogate.hypervolume import hypervolume

Array = NDArray[np.float64]


def spheres(bulge: float) -> Problem:
    """Maximise -(|x - a|^2)^bulge and -(|x + a|^2)^bulge, a = (1/2, 0), in two scenarios; x1 >= 0.1.

    The front is the segment between (-1/2, 0.1) and (1/2, 0.1); it is convex for bulge 1, not for bulge 1/4.
    """
    shifts = np.array([0.0, 0.02])

    def value(X: Array) -> tuple[Array, Array]:
        rows = []
        for sign in (1, -1):
            square = (X[:, :1] - sign / 2) ** 2 + X[:, 1:] ** 2
            rows.append(-(square**bulge) + 0 * shifts - shifts)
        return np.concatenate(rows, 1), 0.1 - X[:, 1:]

    def slope(x: Array) -> tuple[Array, Array]:
        rows = []
        for sign in (1, -1):
            d = x - np.array([sign / 2, 0])
            rows += [-bulge * (d @ d) ** (bulge - 1) * 2 * d] * 2
        return np.array(rows), np.array([[0.0, -1.0]])

    return Problem(2, value, slope)


@pytest.mark.parametrize("bulge", [1.0, 0.25])
def test_front_of_two_spheres(bulge: float) -> None:
    optimum = front(spheres(bulge), 2)
    assert optimum is not None
    np.testing.assert_allclose(optimum.x[:, 1], 0.1, atol=1e-6)
    share = np.linspace(-0.5, 0.5, 200_001)
    exact = np.stack([-(((share - s) ** 2 + 0.01) ** bulge) - 0.02 for s in (0.5, -0.5)], -1)
    reference = exact.min(0)
    assert hypervolume(optimum.values, reference) == pytest.approx(hypervolume(exact, reference), rel=5e-3)
    assert hypervolume(optimum.values, reference) <= hypervolume(exact, reference) * (1 + 1e-9)
    np.testing.assert_allclose(optimum.reference, reference, atol=1e-6)
    assert np.abs(np.diff(optimum.x[:, 0])).max() < 0.02


@settings(max_examples=25, deadline=None, derandomize=True)
@given(st.integers(2, 3), st.integers(1, 40), st.integers(0, 1000))
def test_non_dominated_is_what_the_definition_says(k: int, count: int, seed: int) -> None:
    values = np.random.default_rng(seed).integers(0, 6, (count, k)).astype(float)
    front_rows = non_dominated(values)
    for i, row in enumerate(values):
        others = np.delete(values, i, 0)
        beaten = np.any(np.all(others >= row, 1) & np.any(others > row, 1))
        if front_rows[i]:
            assert not beaten
        else:  # beaten, or equal to one that was kept
            assert beaten or np.any(np.all(values[front_rows] == row, 1))
