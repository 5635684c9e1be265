"""Plans of measurements beside all choices there are, by information matrices."""

from itertools import combinations

import numpy as np
import pytest

from approximation.arrays import Array
from surrogate.use.planning import chosen, spread, widths

SLOPES = np.random.default_rng(3).normal(size=(12, 3))
NOISE = np.linspace(0.5, 2.0, 12)


def covariance(plan: tuple[int, ...]) -> Array:
    """Of three constants whose priors are 1, after readings."""
    some = SLOPES[list(plan)]
    return np.asarray(np.linalg.inv(np.eye(3) + some.T @ (some / NOISE[list(plan), None])))


def joint(answers: Array) -> Array:
    rows = np.concatenate([np.eye(3), SLOPES, answers])
    return np.asarray(rows @ rows.T)


@pytest.mark.parametrize("wanted", [[1], [0, 2]])
def test_a_plan_is_the_best_of_all_that_there_are(wanted: list[int]) -> None:
    both, rows = [joint(np.empty((0, 3)))], np.array(wanted)
    plan = chosen(both, NOISE, rows, 3)
    volumes: dict[tuple[int, ...], float] = {}
    volumes |= {some: np.linalg.det(covariance(some)[np.ix_(wanted, wanted)]) for some in combinations(range(12), 3)}
    assert volumes[tuple(sorted(plan))] == pytest.approx(min(volumes.values()), rel=1e-12)
    np.testing.assert_allclose(widths(both, NOISE, plan, rows) ** 2, np.diag(covariance(tuple(plan)))[wanted])


def test_an_answer_is_told_and_never_chosen() -> None:
    answer = np.array([[0.3, -1.0, 0.5]])
    both, noise = [joint(answer)], np.append(NOISE, np.inf)
    plan = chosen(both, noise, np.array([15]), 2)
    told: dict[tuple[int, ...], float] = {}
    told |= {some: float((answer @ covariance(some) @ answer.T)[0, 0]) for some in combinations(range(12), 2)}
    assert told[tuple(sorted(plan))] == pytest.approx(min(told.values()), rel=1e-12)
    assert len(chosen(both, noise, np.array([15]), 12)) == 12


def test_places_reach_the_ends_and_are_even_in_their_second_half() -> None:
    t = spread(2, 200)
    assert np.abs(t).max() == 1
    assert (np.abs(t[:100]) == 1).mean() == pytest.approx(1 / 3, abs=0.05)
    np.testing.assert_allclose((t[100:] ** 2).mean(axis=0), 1 / 3, rtol=0.1)
