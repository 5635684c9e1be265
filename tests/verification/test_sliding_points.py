"""Balls that slide on a grid: what the first order leaves out is of the second, and the grid tells a wrong answer."""

import pytest

from verification.integral_equations import BALL, FILM, difference, raised


def test_what_is_neglected_grows_with_the_square_of_friction() -> None:
    """The numbers of docs/limits.md."""
    little, much = (difference(BALL, eta, 64) for eta in (0.3, 0.6))
    assert little.force == pytest.approx(-7.5e-4, rel=0.05)
    assert little.charge == pytest.approx(-1.5e-3, rel=0.05)
    assert much.force / little.force == pytest.approx(4, rel=0.1)
    assert much.charge / little.charge == pytest.approx(4, rel=0.1)
    assert max(abs(little.force_moment), abs(little.charge_moment)) < 8e-3


def test_a_film_s_first_order_is_no_half_space_s(monkeypatch: pytest.MonkeyPatch) -> None:
    """That it is the grid's, integral_equations says."""
    monkeypatch.setattr("verification.oracles.sliding_point.SlidingSphere._layers", lambda _, r: (0.0 * r, 0.0 * r))
    assert abs(difference(FILM, 0.05, 64).force_moment) > 0.1


@pytest.mark.soak
def test_the_largest_pressure_beside_the_centre_rises_with_friction_as_on_the_grid() -> None:
    """A stiff film on a soft base, largest at 0.7 a: 1.2 % more at eta = 0.05, all of it of the first order."""
    grid, first = raised(
        BALL | {"force": 30.0, "thickness": 1e-4, "surroundings": "insulated", "base": "polyimide"}, 0.05, 128
    )
    assert first == pytest.approx(grid, rel=2e-3)  # the grid's 4e-4, and the second order
    assert grid > 0.01
