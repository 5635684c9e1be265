"""Potentials inside the half-plane against the punch response, line integrals of the fields, and their far field."""

from typing import Any

import numpy as np
import pytest

import solver

BOTH = ("electric", "magnetic")
POTENTIALS = [f"{field}_potential" for field in BOTH]
CASES: dict[str, dict[str, Any]] = {
    "cylinder": {"volume_fraction": 0.5, "radius": 0.05, "friction": 0.3, "charge": 1e-6, "magnetic_charge": -1e-3},
    "no friction": {"volume_fraction": 0.5, "radius": 0.05},
    "flat": {"volume_fraction": 0.3, "profile": "flat", "width": 0.01, "friction": 0.5, "charge": 2e-6, "datum": 3.0},
    "wedge": {"material": "BaTiO3", "profile": "wedge", "slope": 0.01, "friction": 0.4, "magnetic": "insulating"},
    "moving": {"material": "PZT-4", "radius": 0.1, "friction": 0.6, "electric": "insulating", "speed": 900.0},
}


def factors(name: str) -> dict[str, Any]:
    return {"load": 1e5, **CASES[name]}


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    "path", [((0.2, -0.4), (1.7, -0.05)), ((-1.4, -0.3), (-30.0, -8.0)), ((0.1, -5.0), (4.0, 0.0))]
)
@pytest.mark.parametrize("name", CASES)
def test_differences_are_line_integrals_of_the_fields(name: str, path: tuple[tuple[float, float], ...]) -> None:
    case = factors(name)
    response = solver.solve(case)
    half_width = float(response["contact_trailing"] + response["contact_leading"]) / 2
    t, weights = np.polynomial.legendre.leggauss(200)
    (x0, y0), (x1, y1) = path
    x, y = (x0 + x1) / 2 + t * (x1 - x0) / 2, (y0 + y1) / 2 + t * (y1 - y0) / 2
    across = solver.solve_interior(case, x, [y0], fields=[f"{field}_field_x" for field in BOTH])
    down = solver.solve_interior(case, [x1], y, fields=[f"{field}_field_y" for field in BOTH])
    ends = [solver.solve_interior(case, [x], [y], fields=POTENTIALS).squeeze(drop=True) for x, y in path]
    for field in BOTH:
        integral = weights @ across[f"{field}_field_x"].values[0] * (x1 - x0) / 2
        integral += weights @ down[f"{field}_field_y"].values[:, 0] * (y1 - y0) / 2
        first, last = (float(end[f"{field}_potential"]) for end in ends)
        size = max(abs(first), abs(last), 1e-30)
        assert last - first == pytest.approx(-half_width * integral, rel=1e-9, abs=1e-11 * size)
