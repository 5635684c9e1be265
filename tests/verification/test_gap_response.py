"""The surface of finite elements beside a contact: its nodes, and the polynomials between them."""

import numpy as np

from verification.oracles.fem_film import contact
from verification.oracles.film_mesh import layered_mesh
from verification.oracles.gap_response import along, sides
from verification.oracles.sample_materials import BARIUM_TITANATE
from verification.oracles.spectral import Body, lagrange

ORDER = 4


def test_polynomials_through_lobatto_s_points_are_exact_up_to_their_order() -> None:
    line = Body(layered_mesh([1.0], True), [BARIUM_TITANATE], ORDER).line
    x = np.linspace(-1, 1, 7)
    assert line[[0, -1]].tolist() == [-1.0, 1.0]
    np.testing.assert_allclose(lagrange(line, x)[0] @ line**ORDER, x**ORDER, atol=1e-14)
    np.testing.assert_allclose(lagrange(line, x)[0].sum(axis=1), 1.0, atol=1e-14)


def test_values_of_nodes_are_those_between_them() -> None:
    body = Body(layered_mesh([1.0], False), [BARIUM_TITANATE, BARIUM_TITANATE], ORDER)
    x, y = body.places.T
    assert np.all(np.abs(x[contact(body)]) <= 1)
    assert np.all(np.diff(x[contact(body)]) > 0)
    assert np.all(y[sides(body)] == 0)
    assert np.all(np.abs(x[sides(body)]) >= 1)
    places = np.array([-1.7, 1.0, 1.3])
    np.testing.assert_allclose(along(body, x**3 - x, places), places**3 - places, atol=1e-9)
    assert along(body, 1 + x, np.array([1e9])).tolist() == [0.0]
