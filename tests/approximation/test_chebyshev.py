"""Functions on Chebyshev points and on pieces, and their largest values."""

import numpy as np
import pytest
from numpy.polynomial import chebyshev as theirs
from numpy.polynomial.chebyshev import chebder, chebval
from scipy.optimize import minimize

from approximation import products
from approximation.arrays import Array
from approximation.chebyshev import coefficients, gauss_points, interpolation, mapped_points, polynomials, slopes
from approximation.measure import ITSELF, Measure
from approximation.panels import line
from approximation.piecewise import Piecewise
from approximation.summit import highest


@pytest.mark.parametrize("count", [1, 2, 3, 8, 41])
def test_points_are_the_zeros_of_the_polynomial_and_antisymmetric(count: int) -> None:
    points = gauss_points(count)
    np.testing.assert_allclose(points, np.sort(theirs.chebgauss(count)[0]), rtol=0, atol=2e-15)
    np.testing.assert_array_equal(points, -points[::-1])
    np.testing.assert_allclose(mapped_points(count, 2.0, 6.0), 4 + 2 * points, rtol=1e-15)


@pytest.mark.parametrize("axis", [0, 1, -1])
def test_coefficients_are_those_of_a_fit_through_all_values(axis: int) -> None:
    values = np.random.default_rng(3).normal(size=(7, 4, 5))
    along = np.moveaxis(values, axis, 0)
    size = len(along)
    fitted = theirs.chebfit(gauss_points(size), along.reshape(size, -1), size - 1).reshape(along.shape)
    np.testing.assert_allclose(np.moveaxis(coefficients(values, axis), axis, 0), fitted, rtol=0, atol=1e-13)


def test_interpolation_gives_polynomials_back_and_a_smooth_function_to_rounding() -> None:
    places = np.linspace(-1, 1, 37)
    np.testing.assert_allclose(interpolation(6, places) @ gauss_points(6) ** 5, places**5, rtol=0, atol=1e-14)
    # e^x/(x - 2): coefficients fall as (2 + sqrt 3)^-n, below 1e-16 of the largest at n = 30
    smooth = np.exp(gauss_points(30)) / (gauss_points(30) - 2)
    np.testing.assert_allclose(interpolation(30, places) @ smooth, np.exp(places) / (places - 2), rtol=1e-13)


@pytest.mark.parametrize("size", [5, 300])  # both ways of the recurrence
def test_polynomials_and_slopes_are_cosines_of_multiples(size: int) -> None:
    angle = np.linspace(0.05, np.pi - 0.05, size)
    orders = np.arange(12)[:, None]
    T = polynomials(np.cos(angle), 12)
    np.testing.assert_allclose(T, np.cos(orders * angle), rtol=0, atol=1e-13)
    exact = orders * np.sin(orders * angle) / np.sin(angle)
    np.testing.assert_allclose(slopes(np.cos(angle), T), exact, rtol=0, atol=1e-10)
    np.testing.assert_allclose(polynomials(np.array([2.0]), 4)[:, 0], [1, 2, 7, 26], rtol=1e-15)


DEGREES = np.array([[0, 0, 0], [3, 0, 1], [0, 5, 0], [2, 1, 4]])


def series(degree: int) -> list[float]:
    return [0.0] * degree + [1.0]


@pytest.mark.parametrize("count", [1, 7, 50])
def test_values_and_slopes_are_those_of_the_series(count: int) -> None:
    t = np.random.default_rng(0).uniform(-1, 1, (3, count))
    table = np.array([[chebval(x, series(degree)) for degree, x in zip(row, t, strict=True)] for row in DEGREES])
    np.testing.assert_allclose(products.values(DEGREES, t), table.prod(axis=1), atol=1e-13)
    T = products.polynomials(t, 6)
    S = products.derivatives(t, T)
    for k in range(len(t)):
        steep = table.copy()
        steep[:, k] = [chebval(t[k], chebder(series(degree))) for degree in DEGREES[:, k]]
        np.testing.assert_allclose(products.product(DEGREES, T, S, k), steep.prod(axis=1), atol=1e-12)


PLACES = np.array([[0.0, 0.3, 1.0], [1.7, 2.5, 4.0]])  # an end of two panels among them


def waves(x: Array) -> Array:
    """An odd and an even function; (place, 2)."""
    return np.stack([np.sin(x), np.cos(2 * x)], -1)


@pytest.mark.parametrize("groups", [None, np.array([0.0, 1.0, 1.0])])
def test_panels_hold_a_function_sums_of_its_outputs_and_its_mirror_image(groups: Array | None) -> None:
    panels = Piecewise.of(waves, np.array([0.0, 1.0, 2.0, 4.0]), 16, groups)
    np.testing.assert_allclose(panels.at(PLACES), waves(PLACES), atol=1e-12)
    mixing = np.array([[1.0, 0.0, 2.0], [1.0, -1.0, 0.5]])
    np.testing.assert_allclose(panels.at(PLACES, mixing), waves(PLACES) @ mixing, atol=1e-12)
    mirrored = panels.mirrored(np.array([True, False]))
    np.testing.assert_allclose(mirrored.at(-PLACES), waves(-PLACES), atol=1e-10)


def test_halves_resolve_what_a_whole_panel_does_not() -> None:
    coarse = Piecewise.of(waves, np.array([0.0, 0.5, 4.0]), 12)
    fine = coarse.halved(waves, np.array([False, True]))
    np.testing.assert_array_equal(fine.ends, [0, 0.5, 2.25, 4])
    missed, left = (np.abs(panels.at(PLACES) - waves(PLACES)).max() for panels in (coarse, fine))
    assert left < 1e-3 * missed  # of a series that falls like x^12 / 12!


NORM = Measure(np.zeros((1, 2)), np.eye(2)[None])


@pytest.mark.parametrize("top", [-0.37, 0.0, 0.81, 1.6])
def test_the_top_of_one_field_on_a_line_is_found_to_rounding_inside_and_at_an_end(top: float) -> None:
    values = np.exp(-((gauss_points(40) - top) ** 2))[None, None, None]
    summit = highest(values, (40,), ITSELF)
    place = min(top, 1.0)
    np.testing.assert_allclose(summit.across, place, rtol=0, atol=1e-12)
    np.testing.assert_allclose(summit.value, np.exp(-((place - top) ** 2)), rtol=1e-13)
    assert summit.down == 0


def test_the_top_of_a_norm_over_a_square_is_that_of_an_optimiser() -> None:
    def fields(x: Array, y: Array) -> Array:
        return np.array([np.exp(-3 * (x - 0.3) ** 2 - y**2), 0.4 * np.sin(2 * x + y)])

    x, y = np.meshgrid(gauss_points(30), gauss_points(24))
    top = highest(fields(x, y)[None], (30,), NORM)

    def below(place: Array) -> float:
        return -float(np.linalg.norm(fields(place[0], place[1])))

    best = minimize(below, np.array([0.3, 0.1]), tol=1e-14, method="Nelder-Mead")
    np.testing.assert_allclose(top.value, -best.fun, rtol=1e-12)
    np.testing.assert_allclose([top.across[0], top.down[0]], best.x, rtol=0, atol=1e-6)  # flat: the root of rounding


@pytest.mark.parametrize("lean", [-1e-4, 1e-4])
def test_of_hills_that_are_nearly_as_high_the_higher_is_found_though_its_points_lie_lower(lean: float) -> None:
    def field(x: Array) -> Array:  # of tops between two points of a panel and at one
        return np.asarray((1 + lean) * np.exp(-20 * (x - middle) ** 2) + np.exp(-20 * (x - other_middle) ** 2))

    x = line((60, 60), (-2.0, 0.0, 2.0))
    other_middle, middle = x[30], (x[89] + x[90]) / 2
    top = highest(field(x)[None, None, None], (60, 60), ITSELF)
    assert top.panel == (1 if lean > 0 else 0)
    np.testing.assert_allclose(top.value, 1 + max(lean, 0.0), rtol=1e-9)
