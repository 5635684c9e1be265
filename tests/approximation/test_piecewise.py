"""Tabled functions against the functions themselves, in closed form."""

import numpy as np
import pytest

from approximation.arrays import Array
from approximation.chebyshev import coefficients
from approximation.piecewise import Interval, Piecewise

PLACES = np.array([[0.0, 0.3, 1.0], [1.7, 2.5, 4.0]])  # an end of two panels among them


def waves(x: Array) -> Array:
    """An odd and an even function; (place, 2)."""
    return np.stack([np.sin(x), np.cos(2 * x)], -1)


def test_polynomials_and_rates_are_those_of_the_function() -> None:
    interval = Interval(-1.0, 3.0, 24)
    series, x = coefficients(np.exp(interval.points)), np.linspace(-1, 3, 50)
    np.testing.assert_allclose(interval.polynomials(x) @ series, np.exp(x), rtol=1e-12)
    np.testing.assert_allclose(
        interval.polynomials(x) @ interval.derived(series), np.exp(x), rtol=1e-11
    )  # differentiated
    np.testing.assert_array_equal(interval.polynomials(np.array([9.0])), interval.polynomials(np.array([3.0])))


@pytest.mark.parametrize("groups", [None, np.array([0.0, 1.0, 1.0])])
def test_panels_hold_the_function_and_sums_of_its_outputs(groups: Array | None) -> None:
    panels = Piecewise.of(waves, np.array([0.0, 1.0, 2.0, 4.0]), 16, groups)
    np.testing.assert_allclose(panels.at(PLACES), waves(PLACES), atol=1e-12)
    mixing = np.array([[1.0, 0.0, 2.0], [1.0, -1.0, 0.5]])
    np.testing.assert_allclose(panels.at(PLACES, mixing), waves(PLACES) @ mixing, atol=1e-12)


def test_halves_resolve_what_a_whole_panel_does_not() -> None:
    coarse = Piecewise.of(waves, np.array([0.0, 0.5, 4.0]), 12)
    fine = coarse.halved(waves, np.array([False, True]))
    np.testing.assert_array_equal(fine.ends, [0, 0.5, 2.25, 4])
    missed, left = (np.abs(panels.at(PLACES) - waves(PLACES)).max() for panels in (coarse, fine))
    assert left < 1e-3 * missed  # of a series that falls like x^12 / 12!


def test_a_mirrored_function_has_the_parities_of_its_outputs() -> None:
    mirrored = Piecewise.of(waves, np.array([0.0, 1.0, 4.0]), 20).mirrored(np.array([True, False]))
    np.testing.assert_allclose(mirrored.at(-PLACES), waves(-PLACES), atol=1e-10)
