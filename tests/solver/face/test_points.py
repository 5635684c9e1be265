"""Point contacts and punches through the face: half-spaces, films, mixed tables, elastic punches."""

from typing import Any

import numpy as np
import pytest

import solver
from solver.names import POINT_QUANTITIES, POINT_SLIDING
from tests.solver.cases import assert_alike, without

BALL: dict[str, Any] = {"material": "BaTiO3", "profile": "sphere", "radius": 5e-3, "force": 10.0}
COATED = BALL | {"thickness": 1e-4, "surroundings": "insulated", "base": "steel"}


def test_profiles_and_films_may_be_mixed_along_one_dimension() -> None:
    case = without(COATED, "radius") | {"force": [1.0, 10.0]}
    mixed = solver.solve(case | {"profile": ["sphere", "cone"], "radius": 5e-3, "slope": 0.1})
    for name, options in {"sphere": {"radius": 5e-3}, "cone": {"slope": 0.1}}.items():
        assert_alike(mixed.sel(profile=name), solver.solve(case | options | {"profile": name}), 0.0, ["depth"])


def test_what_friction_adds_is_given_where_it_is_a_factor() -> None:
    """Zero at rest, in proportion to friction; trailing and leading edge lie about their mean."""
    computed = solver.solve(COATED | {"friction": [0.0, 0.2, 0.4]})
    assert set(computed.data_vars) == {*POINT_QUANTITIES, *POINT_SLIDING, "nominal_field"}
    assert computed["contact_offset"][0] == 0
    mean, trailing, leading = (computed[f"electric_edge_intensity{end}"] for end in ("", "_trailing", "_leading"))
    np.testing.assert_allclose(trailing + leading, 2 * mean, rtol=1e-12)
    assert np.all(np.abs(trailing - leading)[1:] > 0.01 * np.abs(mean)[1:])
    for name in ("contact_offset", "trailing_tension"):
        steps = np.diff(computed[name].values)
        assert steps[1] == pytest.approx(steps[0], rel=1e-9)
    assert set(solver.solve(COATED).data_vars) == {*POINT_QUANTITIES, "nominal_field"}


def test_what_is_even_in_friction_is_given_of_discs_and_below_electrodes() -> None:
    """Reflection makes it equal to that at rest; a disc stays in place, but its pressure shifts."""
    others = without(COATED, "radius") | {"friction": [0.0, 0.3]}
    disc = others | {"profile": "disc", "width": 1e-4}
    covered = COATED | others | {"electrode": "top", "magnetic": "insulating"}
    for case, extra in ((disc, set[str]()), (covered, {"contact_offset"})):
        computed = solver.solve(case)
        for name in set(computed.data_vars) - {"contact_offset", "peak_pressure"}:
            np.testing.assert_array_equal(computed[name][0], computed[name][1])
        if "peak_pressure" in computed:  # of the first order where it is not largest at the centre
            np.testing.assert_allclose(computed["peak_pressure"][1], computed["peak_pressure"][0], rtol=2e-3)
        assert set(POINT_SLIDING) & set(computed.data_vars) == extra
    assert "charge_per_force" in solver.solve(disc)
    slid = solver.solve(disc, [-0.5, 0.5, 1.5])["contact_pressure"].values
    assert slid[0, 0] == slid[0, 1]
    assert slid[1, 0] != slid[1, 1]
    assert slid[1, 2] == 0


def test_rough_sliding_is_told_with_the_size_of_what_is_neglected() -> None:
    with pytest.warns(
        solver.PrecisionWarning, match=r"^friction: 0.8 with the angle 0.19 is solved to its first order"
    ):
        solver.solve(BALL | {"friction": 0.8})


def test_a_rigid_base_has_no_fields_and_others_their_own() -> None:
    film = COATED | {"base": ["rigid", "steel"]}
    computed = solver.solve_interior(film, [0.0], [-0.5, -3.0], fields=["stress_yy", "electric_displacement_y"])
    below = computed.isel(y=1).sel(base="rigid")
    assert np.isnan(below["stress_yy"]).all()
    assert computed["stress_yy"].sel(base="steel")[..., 0].max() < 0
    assert abs(computed["electric_displacement_y"].sel(base="steel")[..., 1, 0]) < 1e-12


STEEL = {"punch_modulus": 210e9, "punch_poisson": 0.3}
LINE: dict[str, Any] = {"volume_fraction": 0.5, "radius": 0.05, "load": 1e5, "friction": 0.3, "datum": 0.2}
FILM = LINE | {"thickness": 2e-4, "surroundings": "insulated", "base": "steel", "interface_magnetic": "grounded"}


@pytest.mark.parametrize(
    "case", [LINE, FILM, BALL, BALL | {"thickness": 1e-4, "surroundings": "insulated", "base": "glass"}]
)
def test_rigid_is_the_default_and_the_limit(case: dict[str, Any]) -> None:
    default, rigid = solver.solve(case), solver.solve(case | {"punch": "rigid"})
    hard = solver.solve(case | {"punch_modulus": 1e25, "punch_poisson": 0.3})
    named, stated = solver.solve(case | {"punch": "steel"}), solver.solve(case | STEEL)
    assert_alike(rigid, default, 0.0)
    assert_alike(hard, default, 1e-9)
    assert_alike(named, stated, 0.0)
    assert float(abs(named["peak_pressure"] / default["peak_pressure"])) < 0.99


def test_a_material_of_the_library_and_one_s_own_may_be_punches() -> None:
    material = solver.Material.isotropic(70e9, 0.22, name="mine")
    with pytest.raises(solver.MaterialError, match=r"^punch: 'silicon' is not isotropic"):
        solver.solve(LINE | {"punch": ["silicon", material]})
    punches = np.array(["glass", material, "mine", "", "copper"], dtype=object)
    ends = solver.solve(LINE | {"punch": punches}, materials={"mine": material})["contact_trailing"].values
    assert ends[0] == pytest.approx(ends[1], rel=1e-12)
    assert ends[1] == ends[2]
    assert ends[3] == float(solver.solve(LINE)["contact_trailing"])
    assert ends[3] < ends[4] < ends[0]
