"""Fields inside films through the face: figures found by other methods, the closed form, mixed tables, refusals."""

from typing import Any

import numpy as np
import pytest
import xarray as xr

import solver
from solver.fields import INTERIOR
from tests.solver.face.test_films import FIGURES, FILM

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


def test_a_mixed_table_and_rigid_bases_and_similarity() -> None:
    cases = xr.Dataset(
        {
            "thickness": ("case", [np.nan, 0.5e-3, 1e-3]),
            "surroundings": "insulated",
            "base": ("case", np.array(["", "rigid", "rigid"], dtype=object)),
            "load": ("case", [1e5, 1e5, 2e5]),
            "radius": ("case", [0.05, 0.05, 0.1]),
        }
    ).assign(material="BaTiO3")
    X, Y, fields = [-0.4, 1.5], [-4.0, -1.5, 0.0], [*INTERIOR, "electric_potential"]
    out = solver.solve_interior(cases, X, Y, fields=fields)
    half = solver.solve_interior({"material": "BaTiO3", "radius": 0.05, "load": 1e5}, X, Y, fields=fields)
    alone = solver.solve_interior(FILM, X, Y, fields=fields)
    for key in fields:
        np.testing.assert_array_equal(out[key][0], half[key])  # bit for bit
        size = float(np.nanmax(np.abs(alone[key].values)))
        np.testing.assert_allclose(out[key][1], alone[key], atol=1e-12 * size, err_msg=key)
        assert np.all(np.isnan(out[key][1:, 0]))
        assert np.all(np.isfinite(out[key][1:, 1:]))
        factor = 2 if key == "electric_potential" else 1  # the potential is that of a film twice as thick
        np.testing.assert_allclose(out[key][2], factor * out[key][1], atol=1e-11 * size, err_msg=key)
    punch = solver.solve(FILM)["voltage"]
    np.testing.assert_allclose(out["electric_potential"][1, 2, 0], punch, rtol=1e-8)


@pytest.mark.parametrize(
    ("factors", "fields", "words"),
    [
        ({}, ["stress"], "fields: 'stress' is not one of"),
        ({"material": "lead"}, None, "material: 'lead' is unknown"),
        ({"interface_magnetic": "insulated"}, ["magnetic_potential"], "magnetic_potential: is not given inside a film"),
    ],
)
def test_what_cannot_be_given_is_refused_in_one_line(
    factors: dict[str, Any], fields: list[str] | None, words: str
) -> None:
    with pytest.raises((solver.FactorError, solver.MaterialError)) as caught:
        solver.solve_interior(FILM | factors, [0.0], [-0.5], fields=fields)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_film_without_c12_has_the_other_fields() -> None:
    film = solver.Material(**{**vars(solver.find("BaTiO3")), "c12": np.array(np.nan), "name": "film"})
    out = solver.solve_interior(FILM | {"material": film}, [0.0], [-0.5])
    assert set(INTERIOR) - set(out.data_vars) == {"stress_zz", "von_mises"}
    with pytest.raises(solver.MaterialError, match="film: c12: missing; von_mises needs it"):
        solver.solve_interior(FILM | {"material": film}, [0.0], [-0.5], fields=["von_mises"])
