"""Fields with air beside the contact: finite elements, no air, the gap's law, balances, both ways to the surface."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from solver.arrays import Array
from solver.gap.airline import AirContacts
from solver.gap.charges import FAR
from solver.gap.fields import Solved, surface_fields
from solver.line.interior import fields_of
from solver.material.constants import VACUUM_PERMITTIVITY
from solver.stack.layers import Layer, Stack
from tests.solver.gap.airy import CFO, FIBROUS, PZT, airy, on_rigid, on_steel

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
def made(name: str) -> AirContacts:
    stack, options = CASES[name]
    return airy(stack, **options)  # type: ignore[arg-type]


def inside(contact: AirContacts, x: Array, y: Array, names: tuple[str, ...]) -> Array:
    tractions = Solved(contact.solutions()[0], EDGES, FAR).tractions
    fields: Array = fields_of(tractions, x, y, names, contact.contact.datum)[0]
    return fields


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", CASES)
def test_kernels_and_waves_meet_at_the_surface_and_the_gap_has_its_law(name: str) -> None:
    """Inside fields come from spectra of all charges, those on the surface from tables of kernels; V by the table."""
    contact = made(name)
    states, solution, scale = contact.solved.states, contact.solutions()[0], contact.contact.scale
    surface = surface_fields(solution, X)
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
    V, within = states.response.values[0, 1] * scale[2], np.abs(X) < 1
    np.testing.assert_allclose(interior[-1, within], V, rtol=3e-9)
    operators = solution.operators
    nodes = [30, 60]
    exterior = operators.grid.distance[nodes]
    phi = inside(contact, exterior, np.zeros(1), ("electric_potential",))[0, 0]
    gap = states.gap[0, nodes] * solution.half * scale[1]
    D = surface_fields(solution, exterior)["electric_displacement_y"][0]
    close = 1e-8 * np.abs(V / (V - phi))  # next to the edge the difference of potentials has fewer digits
    assert np.all(np.abs(D * gap / (-VACUUM_PERMITTIVITY * (V - phi)) - 1) < 1e-6 + close)


def test_edge_stresses_are_limits_of_the_fields_and_even_without_friction() -> None:
    """Guards a fixed error: charges on one side stretched the other edge with the wrong sign, 14 % here."""
    contact = made("steel")
    states = contact.solved.states
    others = contact.table.others.at(states.unknowns[:, 0]).times(states.columns[..., None])
    edge = others[0, 0, :2, 0] / contact.contact.scale[1]
    near = surface_fields(contact.solutions()[0], np.array([1 + 1e-7, -1 - 1e-7]))["stress_xx"][0]
    np.testing.assert_allclose(edge[0], edge[1], rtol=1e-9)
    np.testing.assert_allclose(edge, near, rtol=1e-4)


def test_fields_do_not_see_where_the_intervals_end() -> None:
    """Charges beyond the intervals count as a charge at infinity."""
    state = made("rigid").solutions()[0]
    few, many = (Solved(state, EDGES, count).tractions for count in (10, FAR))
    x, y = np.array([-2.0, 0.4]), np.array([-0.2, -0.9])
    coarse, fine = (fields_of(tractions, x, y, INSIDE[:5], np.ones(1)) for tractions in (few, many))
    np.testing.assert_allclose(coarse, fine, rtol=1e-9)
    far, part = replace(few, widest=3.0), slice(0, 1)
    assert far.part(part) is far
    np.testing.assert_allclose(fields_of(far, x, y, INSIDE[:5], np.ones(1)), coarse, rtol=1e-9)
