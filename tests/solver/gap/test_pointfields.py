"""Fields of points with air beside them: no air, one gap for both fields, both ways to the surface, a search."""

from typing import Any

import numpy as np
import pytest

import solver
from solver.material.constants import VACUUM_PERMEABILITY, VACUUM_PERMITTIVITY
from tests.solver.gap.test_points import FILM, HALF

MET = {
    "contact_pressure": "stress_yy", "electric_displacement": "electric_displacement_y",
    "magnetic_induction": "magnetic_induction_y",
}  # fmt: skip
POTENTIALS = {"electric_potential": "electric_displacement", "magnetic_potential": "magnetic_induction"}
FIBROUS: dict[str, Any] = {name: value for name, value in HALF.items() if name != "material"} | {
    "composite": "fibrous", "volume_fraction": 0.6, "total_charge": 2e-10,
}  # fmt: skip


@pytest.mark.parametrize(
    "case", [FILM | {"total_charge": 2e-10}, FIBROUS | {"magnetic": "conducting", "total_flux": 1e-9}]
)
def test_sums_over_b_meet_the_surface_and_both_fields_see_one_gap(case: dict[str, Any]) -> None:
    """Tractions follow from S in closed form, fields inside from sums over b and waves, V from tables."""
    positions = np.array([0.1, 0.6, 0.9, 1.2, 2.0, 5.0])
    surface = solver.solve(case, positions)
    below = solver.solve_interior(case, positions, [0.0], fields=[*MET.values(), *POTENTIALS]).isel(y=0)
    for name, other in MET.items():
        values = np.asarray(surface[name])
        np.testing.assert_allclose(values, below[other] * (-1 if name == "contact_pressure" else 1), rtol=0,
                                   atol=2e-7 * np.max(np.abs(values)), err_msg=name)  # fmt: skip
    gaps = []
    for (potential, density), vacuum in zip(
        POTENTIALS.items(), (VACUUM_PERMITTIVITY, VACUUM_PERMEABILITY), strict=True
    ):
        held = {"electric_potential": "voltage"}.get(potential, potential)
        if held in surface:
            phi, V = np.asarray(below[potential]), float(surface[held])
            np.testing.assert_allclose(phi[:3], V, rtol=1e-8)
            gaps.append(vacuum * (phi - V)[3:] / np.asarray(surface[density])[3:])
    assert np.all(gaps[0] > 0)
    np.testing.assert_allclose(gaps[-1], gaps[0], rtol=1e-6)
