"""Largest measures of fields on panels against closed forms, eigenvalues and a dense scan."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import minimize

from approximation.chebyshev import gauss_points
from approximation.measure import ITSELF, Measure
from approximation.panels import Panels, line
from approximation.summit import highest

Array = NDArray[np.float64]
NORM = Measure(np.zeros((1, 2)), np.eye(2)[None])
TOP = Measure(np.array([[0.5, 0.5, 0.0]]), np.array([[[0.5, -0.5, 0.0], [0.0, 0.0, 1.0]]]))


def test_a_measure_is_the_largest_eigenvalue_it_is_written_as() -> None:
    fields = np.random.default_rng(5).normal(size=(40, 3))
    matrices = np.array([[[xx, xy], [xy, yy]] for xx, yy, xy in fields])
    largest = np.linalg.eigvalsh(matrices)[:, -1]
    np.testing.assert_allclose(TOP.of(fields), largest, rtol=1e-13)
    np.testing.assert_allclose(TOP.values(fields.T[None])[0], largest, rtol=1e-13)
    np.testing.assert_allclose(TOP.bent(fields).value, largest, rtol=1e-13)


@pytest.mark.parametrize("top", [-0.37, 0.0, 0.81, 1.6])
def test_the_top_of_one_field_on_a_line_is_found_to_rounding_inside_and_at_an_end(top: float) -> None:
    values = np.exp(-((gauss_points(40) - top) ** 2))[None, None, None]
    summit = highest(values, (40,), ITSELF)
    across, down, value = summit.across, summit.down, summit.value
    place = min(top, 1.0)
    np.testing.assert_allclose(across, place, rtol=0, atol=1e-12)
    np.testing.assert_allclose(value, np.exp(-((place - top) ** 2)), rtol=1e-13)
    assert down == 0


def test_the_top_of_a_norm_over_a_square_is_that_of_an_optimiser() -> None:
    def fields(x: Array, y: Array) -> Array:
        return np.array([np.exp(-3 * (x - 0.3) ** 2 - y**2), 0.4 * np.sin(2 * x + y)])

    x, y = np.meshgrid(gauss_points(30), gauss_points(24))
    top = highest(fields(x, y)[None], (30,), NORM)
    across, down, value = top.across, top.down, top.value

    def below(place: Array) -> float:
        return -float(np.linalg.norm(fields(place[0], place[1])))

    best = minimize(below, np.array([0.3, 0.1]), tol=1e-14, method="Nelder-Mead")
    np.testing.assert_allclose(value, -best.fun, rtol=1e-12)
    np.testing.assert_allclose([across[0], down[0]], best.x, rtol=0, atol=1e-6)  # flat: the root of rounding


@pytest.mark.parametrize("lean", [-1e-4, 1e-4])
def test_of_hills_that_are_nearly_as_high_the_higher_is_found_though_its_points_lie_lower(lean: float) -> None:
    def field(x: Array) -> Array:  # of tops between two points of a panel and at one
        return np.asarray((1 + lean) * np.exp(-20 * (x - middle) ** 2) + np.exp(-20 * (x - other_middle) ** 2))

    x = line((60, 60), (-2.0, 0.0, 2.0))
    other_middle, middle = x[30], (x[89] + x[90]) / 2
    top = highest(field(x)[None, None, None], (60, 60), ITSELF)
    assert top.panel == (1 if lean > 0 else 0)
    np.testing.assert_allclose(top.value, 1 + max(lean, 0.0), rtol=1e-9)


def test_of_equal_tops_the_first_is_given() -> None:
    x = line((30, 30), (-1.0, 0.0, 1.0))
    top = highest(np.cos(2 * np.pi * (np.abs(x) - 0.5))[None, None, None], (30, 30), ITSELF)
    assert top.panel == 0
    np.testing.assert_allclose(top.across, 0.0, atol=1e-9)


def test_points_of_panels_come_panel_by_panel() -> None:
    panels = Panels((2, 3), (2, 1))
    net = np.arange(15.0).reshape(3, 5)
    ordered = panels.by_panel(net)
    for down, across, part in panels.parts:
        assert ordered[part].reshape(down, across).shape == (down, across)
    np.testing.assert_array_equal(ordered, [0, 1, 5, 6, 2, 3, 4, 7, 8, 9, 10, 11, 12, 13, 14])
    np.testing.assert_allclose(line((1, 1), (0.0, 2.0, 6.0)), [1.0, 4.0], rtol=1e-15)
