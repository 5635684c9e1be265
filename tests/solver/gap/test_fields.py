"""Fields with air beside the contact: finite elements, no air, the gap's law, balances, both ways to the surface."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from solver.arrays import Array
from solver.gap.airline import AirContact
from solver.gap.charges import FAR
from solver.gap.fields import surface_fields
from solver.gap.operators import EDGE
from solver.gap.tractions import Solved
from solver.line.interior import fields_of
from solver.material.constants import VACUUM_PERMITTIVITY
from solver.stack.layers import Layer, Stack
from tests.solver.gap.airy import CFO, FIBROUS, PZT, airy, on_rigid, on_steel
from tests.solver.quadrature import rule

X = np.array([-30.0, -3.0, -1.2, -1.01, -0.99, -0.5, 0.0, 0.3, 0.9, 1.001, 1.05, 2.0, 5.0])
EDGES = np.array([1.0, -1.0])
BONDED = Stack((Layer(FIBROUS, 1.0, "bonded", "bonded"),), CFO)
#: Stack and what :func:`airy` takes: friction on a rigid base, one field without it on steel, potentials that grow.
CASES = {
    "rigid": (on_rigid(FIBROUS), {"friction": 0.3, "charges": (1e-7, -1e-4)}),
    "steel": (on_steel(PZT), {"load": 2e4, "conducts": (True, False)}),
    "bonded": (BONDED, {"charges": (1e-7, 0.0)}),
}
#: Fields along the surface, what they are inside, and the sign of that.
BOTH = (
    ("contact_pressure", "stress_yy", -1.0), ("shear_traction", "stress_xy", 1.0),
    ("electric_displacement_y", "electric_displacement_y", 1.0), ("magnetic_induction_y", "magnetic_induction_y", 1.0),
    ("stress_xx", "stress_xx", 1.0), ("electric_displacement_x", "electric_displacement_x", 1.0),
    ("magnetic_induction_x", "magnetic_induction_x", 1.0),
)  # fmt: skip
INSIDE = ("stress_xx", "stress_yy", "stress_xy", "electric_displacement_y", "electric_field_x", "electric_potential")


@cache
def made(name: str) -> AirContact:
    stack, options = CASES[name]
    return airy(stack, **options)  # type: ignore[arg-type]


def inside(contact: AirContact, x: Array, y: Array, names: tuple[str, ...]) -> Array:
    fields: Array = fields_of(Solved(contact.state, EDGES, FAR).tractions, x, y, names, contact.contact.datum)[0]
    return fields


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", CASES)
def test_kernels_and_waves_meet_at_the_surface_and_the_gap_has_its_law(name: str) -> None:
    """Inside fields come from spectra of all charges, those on the surface from tables of kernels; V by the table."""
    contact = made(name)
    state, scale = contact.state, contact.contact.scale
    surface = surface_fields(state, X)
    interior = inside(contact, X, np.zeros(1), (*(other for _, other, _ in BOTH), "electric_potential"))[:, 0]
    for (field, _, sign), other in zip(BOTH, interior[:-1], strict=True):
        values = surface[field][0]
        np.testing.assert_allclose(
            values,
            sign * other,
            rtol=0,
            atol=1e-9 * np.max(np.abs(values)) + 1e-6 * (field == "shear_traction"),
            err_msg=field,
        )
    V, within = state.response[1] * scale[2], np.abs(X) < 1
    np.testing.assert_allclose(interior[-1, within], V, rtol=3e-9)
    operators = state.problem.table.operators
    nodes = [30, 60]
    exterior = operators.grid.distance[nodes]
    phi = inside(contact, exterior, np.zeros(1), ("electric_potential",))[0, 0]
    gap = state.gap[nodes] * state.half * scale[1]
    D = surface_fields(state, exterior)["electric_displacement_y"][0]
    close = 1e-8 * np.abs(V / (V - phi))  # next to the edge the difference of potentials has fewer digits
    assert np.all(np.abs(D * gap / (-VACUUM_PERMITTIVITY * (V - phi)) - 1) < 1e-6 + close)


@pytest.mark.parametrize("name", CASES)
def test_tractions_balance_load_and_charges(name: str) -> None:
    """The contact by a double exponential rule, what is beside it by panels in arccosh X; an edge is good to 1e-6."""
    contact = made(name)
    state, nodes = contact.state, rule()
    on = surface_fields(state, nodes.X)
    local, weights = np.polynomial.legendre.leggauss(20)
    ends = np.concatenate([[0.0], np.geomspace(1e-6, 24.0, 60)])
    theta = ((ends[1:] + ends[:-1]) / 2)[:, None] + np.diff(ends)[:, None] / 2 * local
    share = (np.diff(ends)[:, None] / 2 * weights * np.sinh(theta)).ravel()
    distances = np.cosh(theta.ravel())
    densities = (
        Solved(state, EDGES, FAR).exterior_charges.density(np.concatenate([distances, -distances]))
        / contact.contact.scale[2:, None]
    )
    surface = surface_fields(state, distances[-900:-500])
    for density, other in zip(
        (surface["electric_displacement_y"], surface["magnetic_induction_y"]), densities, strict=True
    ):
        np.testing.assert_allclose(density[0], other[: distances.size][-900:-500], rtol=1e-12)
    totals = np.array([contact.contact.load[0], *contact.contact.charges[0]])
    for number, (field, _, _) in enumerate((BOTH[0], BOTH[2], BOTH[3])):
        sign = 1.0 if number == 0 else -1.0
        inner = sign * nodes.weight @ (on[field][0] * nodes.root)
        outer = sign * np.tile(share, 2) @ densities[number - 1] if number else 0.0
        size = abs(outer) + nodes.weight @ np.abs(on[field][0] * nodes.root) + 1e-300
        assert abs(state.half * (inner + outer) - totals[number]) <= 1e-6 * state.half * size, field


def test_edge_stresses_are_limits_of_the_fields_and_even_without_friction() -> None:
    """Of the charges on one side the stretch at the other edge had the wrong sign: 14 % here, and two edges unlike."""
    state = made("steel").state
    edge = state.outputs[EDGE] / state.problem.contact.scale[1]
    near = surface_fields(state, np.array([1 + 1e-7, -1 - 1e-7]))["stress_xx"][0]
    np.testing.assert_allclose(edge[0], edge[1], rtol=1e-9)
    np.testing.assert_allclose(edge, near, rtol=1e-4)


def test_fields_do_not_see_where_the_intervals_end() -> None:
    """What lies beyond them is a charge at infinity."""
    state = made("rigid").state
    few, many = (Solved(state, EDGES, count).tractions for count in (10, FAR))
    x, y = np.array([-2.0, 0.4]), np.array([-0.2, -0.9])
    coarse, fine = (fields_of(tractions, x, y, INSIDE[:5], np.ones(1)) for tractions in (few, many))
    np.testing.assert_allclose(coarse, fine, rtol=1e-9)
    far, part = replace(few, widest=3.0), slice(0, 1)
    assert far.part(part) is far
    np.testing.assert_allclose(fields_of(far, x, y, INSIDE[:5], np.ones(1)), coarse, rtol=1e-9)


def test_fields_inside_are_in_equilibrium_and_meet_at_interfaces() -> None:
    """Differences of sixth order: with the surface's values they leave no other field than that below it."""
    contact = made("bonded")
    half, step = contact.state.half, 1e-3
    tractions = replace(Solved(contact.state, EDGES).tractions, widest=3.0)
    names = ("stress_xx", "stress_xy", "stress_yy", "electric_displacement_x", "electric_displacement_y",
             "magnetic_induction_x", "magnetic_induction_y")  # fmt: skip
    offsets: Array = np.asarray(np.arange(-3, 4) * step, dtype=np.float64)
    stencil = np.array([-1, 9, -45, 0, 45, -9, 1]) / (60 * step)
    for x, depth in ((1.6, 0.4), (-2.5, 1.5 / half)):
        v = fields_of(tractions, x + offsets, -depth + offsets, names, np.ones(1))[0]
        along, down = v[:, 3] @ stencil, stencil @ v[:, :, 3].T
        for normal, other in ((0, 1), (1, 2), (3, 4), (5, 6)):
            size = abs(along[normal]) + abs(down[other])
            assert abs(along[normal] + down[other]) < 1e-6 * size + 1e-9 * np.max(np.abs(v[[normal, other]]))
    met = ("stress_xy", "stress_yy", "strain_xx", "electric_displacement_y", "electric_field_x")
    values = fields_of(tractions, X, -np.array([1 - 1e-13, 1 + 1e-9]) / half, met, np.ones(1))[0]
    for name, (over, under) in zip(met, values, strict=True):
        np.testing.assert_allclose(over, under, rtol=0, atol=2e-7 * np.max(np.abs(over)), err_msg=name)
