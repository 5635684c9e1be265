"""The punch as a factor: rigid, by name or by numbers, on every kind of body; what is refused."""

from typing import Any

import numpy as np
import pytest
import xarray as xr

import solver

STEEL = {"punch_modulus": 210e9, "punch_poisson": 0.3}
LINE: dict[str, Any] = {"volume_fraction": 0.5, "radius": 0.05, "load": 1e5, "friction": 0.3, "datum": 0.2}
FILM = LINE | {"thickness": 2e-4, "surroundings": "insulated", "base": "steel", "interface_magnetic": "grounded"}
BALL: dict[str, Any] = {"material": "BaTiO3", "profile": "sphere", "radius": 5e-3, "force": 10.0}


def width(out: xr.Dataset) -> xr.DataArray:
    return out["contact_trailing"] + out["contact_leading"]


def test_steel_makes_contacts_wider_by_the_published_shares() -> None:
    """The plane by two programs that share no code; balls by Hertz's formula with N11 of Willis."""
    body = [solver.fibrous(solver.find("BaTiO3"), solver.find("CoFe2O4"), 0.5), solver.find("BaTiO3")]
    plane = {"material": xr.DataArray(np.array(body, dtype=object), dims="kind"), "radius": 0.05, "load": 1e5}
    computed = width(solver.solve(plane | {"friction": 0.3, "punch": ["rigid", "steel"]}))
    np.testing.assert_allclose(computed.sel(punch="steel") / computed.sel(punch="rigid") - 1, [0.289, 0.248], atol=5e-4)
    ball = BALL | {"material": plane["material"], "punch": ["rigid", "steel"]}
    radius = solver.solve(ball)["contact_radius"]
    np.testing.assert_allclose(radius.sel(punch="steel") / radius.sel(punch="rigid") - 1, [0.185, 0.160], atol=5e-4)


@pytest.mark.parametrize(
    "case", [LINE, FILM, BALL, BALL | {"thickness": 1e-4, "surroundings": "insulated", "base": "glass"}]
)
def test_rigid_is_the_default_and_the_limit(case: dict[str, Any]) -> None:
    default, rigid = solver.solve(case), solver.solve(case | {"punch": "rigid"})
    hard = solver.solve(case | {"punch_modulus": 1e25, "punch_poisson": 0.3})
    named, stated = solver.solve(case | {"punch": "steel"}), solver.solve(case | STEEL)
    for name in default:
        np.testing.assert_array_equal(rigid[name], default[name], err_msg=str(name))
        np.testing.assert_allclose(hard[name], default[name], rtol=1e-9, err_msg=str(name))
        np.testing.assert_array_equal(named[name], stated[name], err_msg=str(name))
    assert float(abs(named["peak_pressure"] / default["peak_pressure"])) < 0.99


def test_a_material_of_the_library_and_one_s_own_may_be_punches() -> None:
    material = solver.Material.isotropic(70e9, 0.22, name="mine")
    cases = LINE | {"punch": np.array(["silicon", material, "mine", ""], dtype=object)}
    for case in (cases, FILM | {"punch": cases["punch"]}):
        if "silicon" not in solver.materials():
            pytest.fail("the library has no silicon")
        with pytest.raises(solver.MaterialError, match=r"^punch: 'silicon' is not isotropic"):
            solver.solve(case, materials={"mine": material})
    punches = np.array(["glass", material, "mine", "", "copper"], dtype=object)
    depth = width(solver.solve(LINE | {"punch": punches}, materials={"mine": material})).values
    assert depth[0] == pytest.approx(depth[1], rel=1e-12)
    assert depth[1] == depth[2]
    assert depth[3] == float(width(solver.solve(LINE)))
    assert depth[3] < depth[4] < depth[0]
