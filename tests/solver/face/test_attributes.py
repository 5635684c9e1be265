"""Global attributes of a solution name the phases, the composite and every default that was used."""

import pytest

import solver
from solver.face.attributes import united

COMMON = "charge = 0 C m-1, magnetic_charge = 0 Wb m-1, speed = 0 m s-1, datum = 1 m"
CONDUCTING = "electric = conducting, magnetic = conducting, surroundings = insulated"


@pytest.mark.parametrize(
    ("factors", "said"),
    [
        (
            {"volume_fraction": [0.3, 0.5], "radius": 0.05},
            {
                "composite": "fibrous",
                "phases": "BaTiO3, CoFe2O4",
                "defaults": f"friction = 0, {COMMON}, composite = fibrous, profile = cylinder, {CONDUCTING}",
            },
        ),
        (
            {"volume_fraction": 0.3, "composite": ["laminate", "fibrous"], "radius": 0.05, "profile": "half_cylinder"},
            {
                "composite": "laminate, fibrous",
                "phases": "BaTiO3, CoFe2O4",
                "defaults": f"friction = 0, {COMMON}, corner = leading, {CONDUCTING}",
            },
        ),
        (
            {"material": "PZT-4", "width": 0.1, "profile": "flat", "friction": 0.2, "datum": 2.0, "speed": 0.0},
            {"defaults": f"charge = 0 C m-1, magnetic_charge = 0 Wb m-1, slope = 0, {CONDUCTING}"},
        ),
    ],
)
def test_a_solution_says_what_no_factor_says(factors: dict[str, object], said: dict[str, str]) -> None:
    for out in (solver.solve({**factors, "load": 1e4}), solver.solve_interior({**factors, "load": 1e4}, [0], [-1])):
        attrs = dict(out.attrs)
        assert attrs.pop("title").startswith("exact ")
        assert attrs.pop("source").startswith("meecontact: closed-form")
        assert attrs == said


def test_own_phases_go_by_their_names() -> None:
    mine = solver.find("PZT-4").renamed("mine")
    out = solver.solve({"volume_fraction": 0.3, "radius": 0.1, "load": 1e4}, phases=(mine, "BaTiO3"))
    assert out.attrs["phases"] == "mine, BaTiO3"


def test_solutions_put_together_keep_what_any_of_them_says() -> None:
    parts = [
        {"title": "t", "defaults": "friction = 0, slope = 0"},
        {"phases": "a, b", "defaults": "friction = 0, x = 1"},
    ]
    assert united(parts) == {"title": "t", "phases": "a, b", "defaults": "friction = 0, slope = 0, x = 1"}
