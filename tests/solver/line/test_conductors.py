"""Metals in a stack: one potential inside, elastic, with a permeability of their own."""

from typing import Any

import numpy as np
import pytest

import solver
from solver.stack.layers import Layer, Stack
from tests.solver.line.films import FIBROUS, SILICON, STEEL

PZT = solver.find("PZT-4")
BALL: dict[str, Any] = {"profile": "sphere", "radius": 0.01, "force": 0.1}
LINE: dict[str, Any] = {"radius": 0.05, "load": 1e4}


@pytest.mark.parametrize("punch", [BALL, LINE], ids=["ball", "roller"])
def test_a_nanometre_of_steel_is_a_grounded_interface(punch: dict[str, Any]) -> None:
    """The share of its stiffness falls with its thickness."""
    grounded = solver.solve(
        punch | {"surroundings": "insulated", "body": Stack([Layer(PZT, 2e-4, "grounded")], SILICON)}
    )
    for thickness, off in ((1e-7, 5e-6), (1e-9, 5e-8)):
        coated = solver.solve(
            punch | {"surroundings": "insulated", "body": Stack([Layer(PZT, 2e-4), Layer(STEEL, thickness)], SILICON)}
        )
        for name in ("charge_per_force", "voltage", "peak_pressure", "stroke_per_volt"):
            assert float(coated[name]) == pytest.approx(float(grounded[name]), rel=20 * off), (name, thickness)


def test_what_is_said_of_an_interface_to_a_metal_has_no_part() -> None:
    def on(electric: str | None) -> solver.Stack:
        return Stack([Layer(PZT, 2e-4, electric), Layer(solver.find("copper"), 2e-5, electric)], SILICON)

    computed = [
        solver.solve(BALL | {"surroundings": "insulated", "body": on(electric)})
        for electric in (None, "bonded", "grounded")
    ]
    for first in computed[1:]:
        np.testing.assert_array_equal(first["charge_per_force"], computed[0]["charge_per_force"])
    by_factors = BALL | {"material": "PZT-4", "thickness": 2e-4, "surroundings": "insulated", "base": "steel"}
    kinds = solver.solve(by_factors | {"interface_electric": ["grounded", "bonded"]})
    assert np.ptp(kinds["charge_per_force"].values) == 0


def test_no_field_is_inside_a_metal() -> None:
    stack = Stack([Layer(PZT, 1e-4), Layer(solver.find("copper"), 1e-4)], STEEL)
    inside = solver.solve_interior(LINE | {"surroundings": "insulated", "body": stack}, [0.3], [-0.1, -2.0, -4.0])
    half = float(solver.solve(LINE | {"surroundings": "insulated", "body": stack})["contact_trailing"])
    assert 0.1 * half < 1e-4 < 2.0 * half < 2e-4 < 4.0 * half
    field = np.abs(inside["electric_field_y"].values).ravel()
    assert field[0] > 1e3
    np.testing.assert_allclose(field[1:], 0, atol=1e-9 * field[0])


def test_flux_passes_through_a_metal_by_its_permeability() -> None:
    """Steel of a hundred times vacuum's lets pass what air would not; of one, it is what it was."""
    as_air = solver.Material(**{**vars(STEEL), "mu11": np.array(4e-7 * np.pi), "mu33": np.array(4e-7 * np.pi)})
    case = LINE | {"magnetic": "conducting", "datum": 0.1}
    steel, air, dielectric = (
        abs(
            float(
                solver.solve(case | {"surroundings": "insulated", "body": Stack([Layer(FIBROUS, 2e-4)], base)})[
                    "flux_per_force"
                ]
            )
        )
        for base in (STEEL, as_air, solver.Material.isotropic(200e9, 0.3))
    )
    assert air == pytest.approx(dielectric, rel=0.05)
    assert steel / air > 10


def test_a_metal_on_top_has_the_potential_itself() -> None:
    """A conducting punch on the metal acts as an insulating one: it presses, and nothing more."""
    stack = Stack([Layer(solver.find("aluminium"), 1e-6), Layer(PZT, 2e-5)], SILICON)
    pair = [
        solver.solve(BALL | {"surroundings": "insulated", "body": stack, "electric": kind})
        for kind in ("conducting", "insulating")
    ]
    assert "voltage" not in pair[0]
    np.testing.assert_array_equal(pair[0]["contact_radius"], pair[1]["contact_radius"])
    for case in (BALL | {"total_charge": 1e-12}, LINE | {"charge": 1e-9}):
        with pytest.raises(solver.FactorError, match="charge: 1e-"):
            solver.solve(case | {"surroundings": "insulated", "body": stack})
