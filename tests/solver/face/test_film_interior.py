"""Fields inside films through the face: figures found by other methods, the closed form, mixed tables, refusals."""

import numpy as np
import pytest

import solver
from tests.solver.face.test_films import FIGURES

#: Theory of films, section 9, half way down at X = 0: sigma_xx, sigma_yy, D_y, von Mises; on the base at X = 0 and 1:
#: sigma_xy, sigma_yy.
INSIDE = {
    "BaTiO3 on rigid": (
        (-6.545137408e05, -2.051132126e08, -1.330565069e-02, 1.829406836e08),
        (0.0, 3.299573303e07), (-1.446113727e08, -1.059483710e08),
    ),
    "fibrous on rigid": (
        (-9.114078814e07, -3.431055653e08, -5.824930730e-02, 2.364533602e08),
        (-2.839180515e07, 6.210199417e07), (-2.792505284e08, -9.112992695e07),
    ),
    "fibrous on steel": (
        (-1.053084797e08, -2.981709574e08, -4.356648744e-03, 1.904045604e08),
        (-1.539243427e07, 5.320606955e07), (-2.376930566e08, -9.673632142e07),
    ),
}  # fmt: skip
_HALF_WAY = ("stress_xx", "stress_yy", "electric_displacement_y", "von_mises")


@pytest.mark.parametrize("name", INSIDE)
def test_published_figures_are_hit(name: str) -> None:
    factors, (half_way, shear, normal) = FIGURES[name][0], INSIDE[name]
    out = solver.solve(factors)
    depth = factors["thickness"] / float(out["contact_trailing"] + out["contact_leading"]) * 2
    computed = solver.solve_interior(factors, [0.0, 1.0], [-depth / 2, -depth], fields=[*_HALF_WAY, "stress_xy"])
    np.testing.assert_allclose([float(computed[key][0, 0]) for key in _HALF_WAY], half_way, rtol=1e-9)
    np.testing.assert_allclose(computed["stress_xy"][1], shear, rtol=1e-9, atol=1e-3)
    np.testing.assert_allclose(computed["stress_yy"][1], normal, rtol=1e-9)
