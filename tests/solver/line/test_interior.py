"""Interior fields of films: figures, the closed form, interfaces, equilibrium and the surface."""

import numpy as np
import pytest

from solver.stack.layers import Layer, Stack, StackError
from tests.solver.line.films import (
    BTO,
    CFO,
    ELASTIC,
    FIBROUS,
    ON_STEEL,
    cylinder,
    interior_fields,
    surface_fields,
)

LAYERED = Stack((Layer(ELASTIC, 0.1e-3, "grounded"), Layer(FIBROUS, 0.1e-3), Layer(BTO, 0.1e-3, "bonded")), ELASTIC)


def test_fields_meet_the_surface_and_both_sides_of_interfaces() -> None:
    film = cylinder(LAYERED, 0.4, 1e5, (2e-5, 1e-3))
    h = float(film.half_width[0])
    X = np.array([-1.5, -0.4, 0.2, 0.8, 1.3])
    at_points = interior_fields(film, X, np.array([-1e-9]), ("stress_yy", "stress_xx", "electric_displacement_y"))[0][
        :, 0
    ]
    surface = surface_fields(film, X)
    expected = (-surface["contact_pressure"][0], surface["stress_xx"][0], surface["electric_displacement_y"][0])
    for first, other in zip(at_points, expected, strict=True):
        np.testing.assert_allclose(first, other, atol=2e-7 * np.max(np.abs(other)))
    mechanical = ("stress_xy", "stress_yy", "strain_xx")
    fluxes = ("electric_displacement_y", "electric_field_x", "magnetic_induction_y", "magnetic_field_x")
    for depth in (1e-4, 2e-4, 3e-4):
        Y = -np.array([depth * (1 - 1e-13), depth * (1 + 1e-9)]) / h
        pair = interior_fields(film, X, Y, mechanical + fluxes)[0]
        for name, values in zip(mechanical + fluxes, pair, strict=True):
            size = np.max(np.abs(values))
            if depth == 1e-4 and name.startswith("electric"):
                continue  # an electrode
            np.testing.assert_allclose(values[0], values[1], atol=2e-7 * size, err_msg=f"{name} {depth}")
    Y = -np.array([1e-4 * (1 - 1e-13), 1e-4 * (1 + 1e-9)]) / h
    inside = interior_fields(film, X, np.array([-0.5e-4 / h]), ("electric_field_x",))[0]
    grounded = interior_fields(film, X, Y, ("electric_field_x",))[0]
    assert np.max(np.abs(grounded)) < 1e-6 * np.max(np.abs(inside))


def test_a_rigid_base_has_no_fields_and_an_interface_belongs_to_the_film() -> None:
    film = cylinder(Stack((Layer(BTO, 0.5e-3),)))
    edge = 0.5e-3 / film.half_width[0]
    computed = interior_fields(film, np.zeros(1), -edge * np.array([1.0, 1 + 1e-9, 3.0]), ("stress_xx", "von_mises"))[0]
    assert np.all(np.isfinite(computed[:, 0]))
    assert np.all(np.isnan(computed[:, 1:]))


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


def test_what_is_not_resolved_is_refused() -> None:
    film = cylinder(Stack((Layer(BTO, 0.5e-3, magnetic="insulated"),)))
    with pytest.raises(StackError, match=r"x: 1e\+06 is farther from the contact than the fields inside this film"):
        interior_fields(film, np.array([1e6]), np.zeros(1), ("stress_xx",))
    with pytest.raises(StackError, match="magnetic_potential: is not given inside a film on a base that insulates"):
        interior_fields(film, np.zeros(1), np.zeros(1), ("magnetic_potential",))
