"""Fields with air beside the contact, and charges far away: finite elements, no air, the gap's law, farther panels."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import solver
from solver.arrays import Array
from solver.gap.airline import AirContacts
from solver.gap.charges import FAR
from solver.gap.fields import Solved, surface_fields
from solver.gap.operators import AirTable
from solver.line.interior import fields_of
from solver.material.constants import VACUUM_PERMITTIVITY
from solver.stack.layers import Layer, Stack
from tests.solver.gap.airy import CFO, FIBROUS, PZT, airy, half_plane, on_rigid, on_steel

X = np.array([-30.0, -3.0, -1.2, -1.01, -0.99, -0.5, 0.0, 0.3, 0.9, 1.001, 1.05, 2.0, 5.0])
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


@cache
def made(name: str) -> AirContacts:
    stack, options = CASES[name]
    return airy(stack, **options)  # type: ignore[arg-type]


def inside(contact: AirContacts, x: Array, y: Array, names: tuple[str, ...]) -> Array:
    tractions = Solved(contact.solutions()[0], np.array([1.0, -1.0]), FAR).tractions
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
        off = 1e-9 * np.max(np.abs(values)) + 1e-6 * (field == "shear_traction")
        np.testing.assert_allclose(values, sign * other, rtol=0, atol=off, err_msg=field)
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
    others = contact.table.outputs.others.at(states.unknowns[:, 0]).times(states.columns[..., None])
    edge = others[0, 0, :2, 0] / contact.contact.scale[1]
    near = surface_fields(contact.solutions()[0], np.array([1 + 1e-7, -1 - 1e-7]))["stress_xx"][0]
    np.testing.assert_allclose(edge[0], edge[1], rtol=1e-9)
    np.testing.assert_allclose(edge, near, rtol=1e-4)


ALN, PVDF, SILICON = (solver.find(name) for name in ("AlN", "PVDF", "silicon"))
ON_SILICON = Stack((Layer(ALN, 1.0, "grounded"),), SILICON)
ON_POLYIMIDE = Stack((Layer(PVDF, 1.0, "bonded"),), solver.find("polyimide"))


def figures(contact: AirContacts) -> Array:
    """Voltage, stroke per volt, capacitances: what took harm."""
    t = contact.solved.tangents[0]
    voltage, fixed = contact.solved.states.response.values[0, 1], contact.solved.at_fixed_contact[0, 1, 0]
    return np.array([voltage, t[0, 1] / t[1, 1], t[1, 1], fixed])


@pytest.mark.parametrize(
    ("stack", "load", "off"),
    [(half_plane(PVDF), 2e3, 1e-7), (ON_SILICON, 1e4, 1e-6), (ON_POLYIMIDE, 1e4, 3e-5)],
    ids=["half-plane", "thin", "bonded"],
)
def test_panels_sixteen_times_as_far_change_nothing(stack: Stack, load: float, off: float) -> None:
    """The error of half-planes was 3e-3: potentials grow like log x, which powers of 1/x on the last panel are not.

    Of AlN on silicon it was 3e-5, and 1e-4 more by rounding: charges far away move the contact by a thousand times
    their density, which left the others no digits. A film bonded to its base moves by 1e-4 of its strain constant.
    """
    contact = airy(stack, load, conducts=(True, False))
    far = replace(contact, table=AirTable(contact.table.table, 16 * np.cosh(contact.table.operators.grid.ends[-1])))
    assert far.table.operators.density_nodes > contact.table.operators.density_nodes
    np.testing.assert_allclose(figures(contact), figures(far), rtol=off)


def test_a_roller_that_hardly_touches_a_half_plane_has_its_charge_per_load() -> None:
    """Theorem: at zero volts no charge lies beside the contact, and Q/P is the half-plane's coupling at any load."""
    case = {"material": PVDF, "radius": 20e-3, "load": 1e-6, "surroundings": "air"}
    tiny, plain = (solver.solve(case | loads) for loads in ({}, {"load": 1e4, "surroundings": "insulated"}))
    assert float(tiny["charge_per_force"]) == pytest.approx(float(plain["charge_per_force"]), rel=1e-9)
