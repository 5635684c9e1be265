"""Robust constrained optimisation against brute force and closed forms."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from surrogate.search.optimise import Optimum, Problem, improve, maximise, retreat

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


def test_no_limits() -> None:
    problem = linear_on_a_disc(1.0)
    none = np.empty((1, 0))
    free = Problem(
        2,
        lambda X: (problem.value(X)[0], np.broadcast_to(none, (len(X), 0))),
        lambda x: (problem.slope(x)[0], np.empty((0, 2))),
    )
    optimum: Optimum = maximise(free)
    assert optimum.feasible
    assert optimum.excess.size == 0
    np.testing.assert_allclose(optimum.x, [1.0, 1.0], atol=1e-9)


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
