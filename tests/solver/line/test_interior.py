"""Interior fields of films: figures, the closed form, interfaces, equilibrium and the surface."""

import numpy as np
import pytest

from solver.stack.layers import Layer, Stack
from tests.solver.line.films import BTO, CFO, FIBROUS, ON_STEEL, cylinder, interior_fields

BONDED = Stack((Layer(FIBROUS, 0.2e-3, "bonded", "bonded"),), CFO)
BETWEEN = Stack((Layer(BTO, 1e-4, "grounded"), Layer(FIBROUS, 1e-4), Layer(CFO, 1e-4)), CFO)


@pytest.mark.parametrize("stack", [ON_STEEL, BONDED, BETWEEN], ids=["grounded", "bonded", "electrode between"])
def test_potentials_are_the_punch_s_on_it_meet_at_interfaces_and_have_the_fields_as_gradients(stack: Stack) -> None:
    film = cylinder(stack, 0.3, 1e5, (2e-5, 1e-2), 0.01)
    h, X, step = float(film.half_width[0]), np.array([-0.9, 0.0, 0.5]), 1e-3
    names = ("electric_potential", "magnetic_potential")
    at_points = interior_fields(film, X, np.array([0.0, -0.1 * stack.thickness / h]), names)[0]
    for field in (0, 1):
        np.testing.assert_allclose(at_points[field, 0], film.response[0, 1 + field], rtol=1e-9)
    size = np.max(np.abs(at_points), axis=(1, 2))
    ends = np.cumsum([layer.thickness for layer in stack.layers]) / h
    for end in ends:
        pair = interior_fields(film, X, -end * np.array([1.0, 1 + 1e-9]), names)[0]
        assert np.all(np.max(np.abs(pair[:, 0] - pair[:, 1]), 1) < 1e-8 * size)
    fields = ("electric_field_x", "electric_field_y", "magnetic_field_x", "magnetic_field_y")
    for y in (-0.4 * ends[0], -(ends[-1] + 0.4)):
        stencil, offsets = np.array([1, -8, 0, 8, -1]) / (12 * step), np.linspace(-2 * step, 2 * step, 5)
        around = interior_fields(film, 0.4 + offsets, y + offsets, names)[0] / h
        fields_there = interior_fields(film, np.array([0.4]), np.array([y]), fields)[0, :, 0, 0]
        for field in (0, 1):
            gradient = np.array([around[field, 2] @ stencil, around[field, :, 2] @ stencil])
            np.testing.assert_allclose(gradient, -fields_there[2 * field : 2 * field + 2], atol=1e-7 * size[field] / h)
