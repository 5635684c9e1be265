"""Fields with air beside a contact along a line, and charges far away: limits at the edges, farther panels, theorem."""

from typing import Any

import numpy as np
import pytest

import solver
from solver.gap import operators
from solver.stack.layers import Layer, Stack

ROLLER: dict[str, Any] = {"radius": 0.1, "magnetic": "insulating", "surroundings": "air"}


def test_edge_stresses_are_limits_of_the_fields_and_even_without_friction() -> None:
    """Guards a fixed error: charges on one side stretched the other edge with the wrong sign, 14 % here."""
    case = ROLLER | {"material": "PZT-4", "thickness": 3e-4, "base": "steel", "load": 2e4}
    solution = solver.solve(case, [1 + 1e-7, -1 - 1e-7])
    trailing, leading = float(solution["trailing_tension"]), float(solution["leading_compression"])
    assert trailing == pytest.approx(leading, rel=1e-9)
    np.testing.assert_allclose(solution["stress_xx"].squeeze(), trailing, rtol=1e-4)


ON_POLYIMIDE = Stack((Layer("PVDF", 3e-4, "bonded"),), solver.find("polyimide"))


@pytest.mark.parametrize(
    ("body", "off"),
    [
        ({"material": "PVDF", "load": 2e3}, 1e-7),
        ({"material": "AlN", "thickness": 3e-4, "base": "silicon", "load": 1e4}, 1e-6),
        ({"body": ON_POLYIMIDE, "load": 1e4}, 3e-5),
    ],
    ids=["half-plane", "thin", "bonded"],
)
def test_panels_sixteen_times_as_far_change_nothing(
    body: dict[str, Any], off: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The error of half-planes was 3e-3: potentials grow like log x, which powers of 1/x on the last panel are not.

    Of AlN on silicon it was 3e-5, and 1e-4 more by rounding: charges far away move the contact by a thousand times
    their density, which left the others no digits. A film bonded to its base moves by 1e-4 of its strain constant.
    """
    names = ["voltage", "stroke_per_volt", "capacitance_at_load", "capacitance_per_length"]
    usual = solver.solve(ROLLER | body)[names]
    for margin in ("_MARGIN", "_MARGIN_OF_BASE"):
        monkeypatch.setattr(operators, margin, 16 * getattr(operators, margin))
    far = solver.solve(ROLLER | body)[names]
    assert not far.equals(usual)  # other panels
    for name in names:
        assert float(far[name]) == pytest.approx(float(usual[name]), rel=off), name


def test_a_roller_that_hardly_touches_a_half_plane_has_its_charge_per_load() -> None:
    """Theorem: at zero volts no charge lies beside the contact, and Q/P is the half-plane's coupling at any load."""
    case = {"material": "PVDF", "radius": 20e-3, "load": 1e-6, "surroundings": "air"}
    tiny, plain = (solver.solve(case | loads) for loads in ({}, {"load": 1e4, "surroundings": "insulated"}))
    assert float(tiny["charge_per_force"]) == pytest.approx(float(plain["charge_per_force"]), rel=1e-9)
