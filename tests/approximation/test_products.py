"""Products of Chebyshev polynomials and their derivatives, against numpy's series."""

import numpy as np
import pytest
from numpy.polynomial.chebyshev import chebder, chebval

from approximation import products
from approximation.arrays import blocks

DEGREES = np.array([[0, 0, 0], [3, 0, 1], [0, 5, 0], [2, 1, 4]])


def series(degree: int) -> list[float]:
    return [0.0] * degree + [1.0]


@pytest.mark.parametrize("count", [1, 7, 50])
def test_values_and_slopes_are_those_of_the_series(count: int) -> None:
    t = np.random.default_rng(0).uniform(-1, 1, (3, count))
    table = np.array([[chebval(x, series(degree)) for degree, x in zip(row, t, strict=True)] for row in DEGREES])
    np.testing.assert_allclose(products.values(DEGREES, t), table.prod(axis=1), atol=1e-13)
    for k, slope in enumerate(products.slopes(DEGREES, t)):
        steep = table.copy()
        steep[:, k] = [chebval(t[k], chebder(series(degree))) for degree in DEGREES[:, k]]
        np.testing.assert_allclose(slope, steep.prod(axis=1), atol=1e-12)


def test_blocks_cover_every_place_once() -> None:
    places = np.arange(11)
    assert np.concatenate([places[block] for block in blocks(11, 4)]).tolist() == places.tolist()
