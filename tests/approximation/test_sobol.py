"""Sobol's points: all of them differ along each axis, and they stand for a cube's volume better than random ones."""

import numpy as np

from approximation.sobol import sobol_points


def test_each_of_equal_strips_of_a_cube_has_one_point() -> None:
    for seed in (None, 0, 3):
        points = sobol_points(64, 3, seed)
        assert points.shape == (64, 3)
        for along in points.T:
            assert sorted(np.floor(64 * along)) == list(range(64))


def test_a_seed_decides_the_points() -> None:
    assert np.array_equal(sobol_points(16, 2, 1), sobol_points(16, 2, 1))
    assert not np.array_equal(sobol_points(16, 2, 1), sobol_points(16, 2, 2))
