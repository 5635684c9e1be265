"""Robust constrained optimisation against brute force and closed forms."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from surrogate.search.optimise import Problem, improve, maximise, retreat
from surrogate.search.pareto import front, non_dominated

Array = NDArray[np.float64]

SCENARIOS = np.linspace(-1.0, 1.0, 9)


def linear_on_a_disc(radius: float) -> Problem:
    """Maximise min_s (x0 (1 - s/10) + x1/2) on discs x0^2 + x1^2 <= radius - s/5: the worst s is 1 for both."""

    def value(X: Array) -> tuple[Array, Array]:
        objective = X[:, :1] * (1 - SCENARIOS / 10) + X[:, 1:] / 2
        excess = X[:, :1] ** 2 + X[:, 1:] ** 2 - radius + SCENARIOS / 5
        return objective, excess

    def slope(x: Array) -> tuple[Array, Array]:
        ones = np.ones_like(SCENARIOS)
        objective = np.stack([1 - SCENARIOS / 10, ones / 2], -1)
        return objective, np.stack([2 * x[0] * ones, 2 * x[1] * ones], -1)

    return Problem(2, value, slope)


def wavy(shift: float, limit: float) -> Problem:
    """Several local maxima under a wavy limit, in three scenarios."""
    s = np.array([-0.3, 0.0, 0.3])

    def value(X: Array) -> tuple[Array, Array]:
        x, y = X[:, :1], X[:, 1:]
        objective = np.sin(3 * x + s) * np.cos(2 * y - shift) + 0.3 * x
        excess = x**2 + 0.5 * np.sin(4 * y + s) + y * s - limit
        return objective, excess

    def slope(p: Array) -> tuple[Array, Array]:
        x, y = p
        objective = np.stack(
            [3 * np.cos(3 * x + s) * np.cos(2 * y - shift) + 0.3, -2 * np.sin(3 * x + s) * np.sin(2 * y - shift)], -1
        )
        excess = np.stack([np.full(3, 2 * x), 2 * np.cos(4 * y + s) + s], -1)
        return objective, excess

    return Problem(2, value, slope)


def brute_force(problem: Problem, side: int = 401) -> float:
    """Best feasible worst case on a dense grid."""
    axis = np.linspace(-1, 1, side)
    X = np.stack([g.ravel() for g in np.meshgrid(axis, axis)], -1)
    objective, excess = problem.value(X)
    return float(objective[excess.max(1) <= 0].min(1).max())


def test_closed_form_on_a_disc() -> None:
    optimum = maximise(linear_on_a_disc(1.0))
    assert optimum.feasible
    assert optimum.objective == pytest.approx(np.sqrt(0.8) * np.hypot(0.9, 0.5), rel=1e-10)
    np.testing.assert_allclose(optimum.x, np.sqrt(0.8) * np.array([0.9, 0.5]) / np.hypot(0.9, 0.5), atol=1e-5)
    assert optimum.excess.max() == pytest.approx(0.0, abs=1e-9)


def test_the_least_violation_is_found_where_nothing_is_feasible() -> None:
    optimum = maximise(linear_on_a_disc(-1.0))
    assert not optimum.feasible
    assert optimum.excess.max() == pytest.approx(1.2, rel=1e-9)
    np.testing.assert_allclose(optimum.x, 0.0, atol=1e-4)


@settings(max_examples=6, deadline=None, derandomize=True)
@given(st.floats(-1.5, 1.5), st.floats(-0.2, 1.2))
def test_never_worse_than_brute_force(shift: float, limit: float) -> None:
    problem = wavy(shift, limit)
    optimum = maximise(problem, scan=1024)
    assert optimum.feasible
    assert optimum.objective >= brute_force(problem) - 1e-9


def test_a_free_choice_goes_to_the_largest_margin() -> None:
    def value(X: Array) -> tuple[Array, Array]:
        return X[:, :1], (X[:, 1:] - 0.25) ** 2 - 0.5

    def slope(x: Array) -> tuple[Array, Array]:
        return np.array([[1.0, 0.0]]), np.array([[0.0, 2 * (x[1] - 0.25)]])

    optimum = maximise(Problem(2, value, slope))
    np.testing.assert_allclose(optimum.x, [1.0, 0.25], atol=1e-5)


@given(st.floats(0.1, 0.9), st.floats(0, 2 * np.pi), st.floats(1e-14, 1e-6))
@example(square=0.5, angle=5e-324, beyond=1e-6)
def test_a_point_beyond_a_limit_steps_back_onto_it_the_shortest_way(square: float, angle: float, beyond: float) -> None:
    """On the disc of the worst scenario that way is along the radius."""
    problem, size = linear_on_a_disc(square + 0.2), np.sqrt(square)
    towards = np.array([np.cos(angle), np.sin(angle)])
    back = retreat(problem, towards * size * (1 + beyond))
    np.testing.assert_allclose(back, towards * size, rtol=0, atol=1e-15 + beyond**2)


def test_a_retreat_ends_at_the_box() -> None:
    """The way back from beyond a line leads out of the box for the first variable, then along its side."""
    normal = np.array([1.0, -0.1])

    def value(X: Array) -> tuple[Array, Array]:
        return X[:, :1], (X @ normal)[:, None] + 1.01

    problem = Problem(2, value, lambda x: (np.array([[1.0, 0.0]]), normal[None]))
    np.testing.assert_allclose(retreat(problem, np.array([-0.999, 0.0])), [-1.0, 0.1], atol=1e-14)


def test_what_a_climb_ends_with_keeps_its_limits_to_rounding() -> None:
    """A start that exceeds a limit by what the search counts as none, and is better by as little, is not kept."""
    problem = linear_on_a_disc(0.5)
    best = improve(problem, maximise(problem, scan=256).x * (1 + 2e-10), 1.0)
    assert best.feasible
    assert best.excess.max() <= 1e-15


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


def hypervolume(values: Array, reference: Array) -> float:
    """Area that a front of two objectives (m, 2) dominates beyond a reference (2,)."""
    inside = values[np.all(values > reference, axis=1)]
    inside = inside[non_dominated(inside)]
    inside = inside[np.argsort(-inside[:, 0])]
    seconds = np.concatenate([[reference[1]], inside[:, 1]])
    return float(np.sum((inside[:, 0] - reference[0]) * np.diff(seconds)))


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
