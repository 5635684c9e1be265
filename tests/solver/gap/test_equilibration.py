"""Charges far away and next to the edge: finer and farther panels change nothing."""

from dataclasses import replace

import numpy as np
import pytest

import solver
from solver.arrays import Array
from solver.gap.airline import AirContacts
from solver.gap.newton import solved
from solver.gap.operators import AirTable
from solver.stack.layers import Layer, Stack
from tests.solver.gap.airy import airy, half_plane

ALN, PVDF, SILICON = (solver.find(name) for name in ("AlN", "PVDF", "silicon"))
ON_SILICON = Stack((Layer(ALN, 1.0, "grounded"),), SILICON)
BONDED = Stack((Layer(PVDF, 1.0, "bonded"),), solver.find("polyimide"))


def test_columns_and_rows_of_any_size() -> None:
    """A well-conditioned system, each row and each column times a power of ten between -12 and 12."""
    draw = np.random.default_rng(3)
    inner: Array = np.eye(30) + 0.1 * draw.standard_normal((30, 30))
    rows, columns, x = 10 ** draw.uniform(-12, 12, (2, 30)), 10 ** draw.uniform(-12, 12, 30), draw.standard_normal(30)
    matrix = rows[0][:, None] * inner * columns
    np.testing.assert_allclose(solved(matrix, rows[0] * (inner @ x)), x / columns, rtol=1e-12)
    many = solved(matrix, (rows[0] * (inner @ x))[:, None] * [1.0, 2.0])
    np.testing.assert_allclose(many, (x / columns)[:, None] * [1.0, 2.0], rtol=1e-12)


def figures(contact: AirContacts) -> Array:
    """Voltage, stroke per volt, capacitances: what took harm."""
    t = contact.solved.tangents[0]
    voltage, fixed = contact.solved.states.response.values[0, 1], contact.solved.at_fixed_contact[0, 1, 0]
    return np.array([voltage, t[0, 1] / t[1, 1], t[1, 1], fixed])


@pytest.mark.parametrize(
    ("stack", "load", "off"),
    [(half_plane(PVDF), 2e3, 1e-7), (ON_SILICON, 1e4, 1e-6), (BONDED, 1e4, 3e-5)],
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
