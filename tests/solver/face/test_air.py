"""Air beside the contact by the face: half-planes against their closed form, similarity, tables of both, refusals."""

from typing import Any

import numpy as np
import pytest
import xarray as xr

import solver
from solver.names import FILM_PEAKS, GAP_QUANTITIES, PEAKS
from solver.similarity import FACTOR_WEIGHTS, QUANTITY_WEIGHTS
from workflow.run.provenance import ROOT

AIR: dict[str, Any] = {"surroundings": "air"}
LINE: dict[str, Any] = {"material": "PZT-4", "radius": 0.05, "load": 2e4, "magnetic": "insulating"}
FILM = LINE | {"thickness": 2e-4, "base": "steel"}
#: Cases of the table in docs/names.md, in its order.
TABLE: list[dict[str, Any]] = [
    FILM,
    LINE | {"material": "AlN", "radius": 0.01, "load": 1e3, "thickness": 2e-6, "base": "silicon"},
]


@pytest.mark.parametrize("own", [{}, {"speed": 100.0, "punch": "steel", "radius": [0.02, 0.05], "datum": 0.3}])
def test_a_half_plane_in_no_air_is_the_closed_form(own: dict[str, Any]) -> None:
    """A gap of next to no permittivity; at the edge, where D_y is infinite without it, it is only next to none."""
    exact, found = solver.solve(LINE | own), solver.solve(LINE | AIR | own | {"gap_permittivity": 1e-16})
    gone = {f"{field}_edge_intensity_{edge}" for field in ("electric", "magnetic") for edge in ("trailing", "leading")}
    assert set(found.data_vars) - gone == set(exact.data_vars) - gone | GAP_QUANTITIES.keys() | {"capacitance"}
    for name in set(exact.data_vars) - gone - {"trailing_tension", "leading_compression"}:
        np.testing.assert_allclose(found[name], exact[name], rtol=1e-11, err_msg=str(name))


def test_air_changes_neither_pressure_nor_charge_per_load_of_a_half_plane() -> None:
    """The theorem of docs/theory.md, 10: both by the closed form; capacitances at fixed contact and load are one."""
    exact, found = solver.solve(LINE), solver.solve(LINE | AIR)
    for name in ("contact_trailing", "peak_pressure", "charge_sensitivity", "stroke_per_volt"):
        assert float(found[name]) == pytest.approx(float(exact[name]), rel=1e-9), name
    assert abs(float(found["voltage"] / exact["voltage"])) < 0.95
    assert float(found["capacitance_at_load"]) == pytest.approx(float(found["capacitance"]), rel=1e-9)


def test_films_scale_with_size_and_with_strength_and_permittivity() -> None:
    base = FILM | AIR | {"datum": 1.0, "gap_permittivity": 1.0}
    size, strength = 1.7, 0.8
    changed = {
        name: value * size ** FACTOR_WEIGHTS[name].size * strength ** FACTOR_WEIGHTS[name].strength
        for name, value in base.items()
        if name in FACTOR_WEIGHTS
    }
    one = solver.solve(base)
    two = solver.solve(base | changed | {"gap_permittivity": strength})
    assert GAP_QUANTITIES.keys() <= set(one.data_vars)
    for name in one.data_vars:
        weight = QUANTITY_WEIGHTS[str(name)]
        by = size**weight.size * strength**weight.strength
        # the contact's centre is 0 but for the rounding of both
        np.testing.assert_allclose(two[name], one[name] * by, rtol=1e-6, atol=1e-12, err_msg=str(name))


def test_a_table_holds_both_and_each_case_is_the_case_alone() -> None:
    both = solver.solve(FILM | {"surroundings": ["air", "insulated"], "load": [1e4, 2e4], "gap_permittivity": 1.0})
    assert "capacitance_at_load" not in both
    assert "electric_edge_intensity_trailing" not in both
    for around in ("air", "insulated"):
        alone = solver.solve(FILM | {"surroundings": around, "load": 1e4})
        for name in ("contact_trailing", "voltage", "capacitance", "charge_sensitivity"):
            at = both[name].sel(surroundings=around).isel(load=0)
            assert float(at) == pytest.approx(float(alone[name]), rel=1e-9), name


BALL: dict[str, Any] = {
    "material": "PZT-4",
    "profile": "sphere",
    "radius": 5e-3,
    "force": 0.1,
    "magnetic": "insulating",
}


@pytest.mark.parametrize(
    ("case", "around"),
    [
        (LINE, "insulated"),
        (FILM, "air"),
        (BALL, "insulated"),
        (BALL | {"thickness": 1e-4, "base": "steel"}, "air"),
        (FILM | {"electric": "insulating"}, "insulated"),
        (
            {name: value for name, value in FILM.items() if name != "radius"}
            | {"profile": solver.Profile.cylinder(np.array(0.05))},
            "air",
        ),
    ],
)
def test_films_are_in_air_by_default_bit_for_bit_and_half_planes_are_not(case: dict[str, Any], around: str) -> None:
    said, unsaid = solver.solve(case | {"surroundings": around}), solver.solve(case)
    assert set(said.data_vars) == set(unsaid.data_vars)
    for name in unsaid.data_vars:
        np.testing.assert_array_equal(said[name], unsaid[name])
    assert str(unsaid.coords.get("surroundings", "insulated").values if "thickness" in case else "insulated") == around
    assert ("gap_permittivity = 1" in unsaid.attrs["defaults"]) == (around == "air")


def test_what_cases_have_beside_them_may_differ_along_two_dimensions() -> None:
    conducts = {"electric": ["conducting", "insulating"], "magnetic": ["insulating", "conducting"]}
    found = solver.solve(FILM | conducts)
    assert found["surroundings"].transpose("electric", "magnetic").values.tolist() == [
        ["air", "air"],
        ["insulated", "air"],
    ]
    alone = solver.solve(FILM | {"electric": "insulating"})
    assert float(found["depth"].sel(electric="insulating", magnetic="insulating")) == float(alone["depth"])
    named = solver.solve(FILM | {"surroundings": xr.DataArray(["", "insulated"], dims="case")})
    assert named["surroundings"].values.tolist() == ["air", "insulated"]


def test_the_table_of_films_with_air_is_the_solver_s() -> None:
    page = (ROOT / "docs/names.md").read_text(encoding="utf-8")
    lines = page.split("| voltage at the load | charge per load, pC/N |\n")[1].split("\n\n")[0].splitlines()[1:]
    for line, case in zip(lines, TABLE, strict=True):
        bare, air = solver.solve(case | {"surroundings": "insulated"}), solver.solve(case)
        stored, volts, charge = (cell.strip() for cell in line.strip("|").split("|")[1:])
        assert stored == f"{float(bare['capacitance']) * 1e9:.3g}, air {float(air['capacitance']) * 1e9:.3g}"
        assert volts == f"x {float(air['voltage'] / bare['voltage']):.2g}"
        pico = [float(one["charge_sensitivity"]) * 1e12 for one in (bare, air)]
        assert charge == f"{pico[0]:.3g}, air {pico[1]:.3g}"


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"surroundings": "water"}, "surroundings: 'water' is not one of insulated, air"),
        (AIR | {"electric": "insulating"}, "surroundings: 'air' is not allowed: the punch conducts no field"),
        (AIR | {"profile": "flat", "width": 1e-3}, "surroundings: 'air' is not allowed: the punch has a corner"),
        (AIR | {"gap_permittivity": 0.0}, "gap_permittivity: 0 is not a finite number > 0 [1]"),
        ({"gap_permittivity": 2.2}, "gap_permittivity: 2.2 without surroundings: air; only its gap has one"),
        (
            {
                "material": "PMN-PT 67:33",
                "thickness": 5.8e-5,
                "base": "steel",
                "load": 1e3,
                "friction": 0.3,
                "charge": 1.8e-4,
            },
            "surroundings: the punch touches the surface beside the contact, at (x - c)/h = ",
        ),
        (AIR | {"speed": 1e4}, "speed: 10000 m/s is not below the limiting speed"),
        (
            AIR | {"profile": "sphere", "force": 1.0, "electric": "insulating", "magnetic": "insulating"},
            "surroundings: 'air' is not allowed: the punch conducts no field",
        ),
        (
            AIR | {"profile": "disc", "width": 1e-3, "force": 1.0},
            "surroundings: 'air' is not allowed: a disc's face touches all over",
        ),
        (
            AIR | {"profile": "cone", "slope": 0.1, "force": 1.0},
            "gap_radius: missing; must be a finite number > 0 [m]: a cone or a power beside air says nowhere",
        ),
        (AIR | {"gap_radius": 0.1}, "gap_radius: 0.1 beside a contact along a line; only a point's gap has one"),
        (
            {"profile": "sphere", "force": 1.0, "gap_radius": 0.1},
            "gap_radius: 0.1 without surroundings: air; only its gap has one",
        ),
    ],
)
def test_refused_in_one_line(changed: dict[str, Any], message: str) -> None:
    case = LINE | changed
    for name in {"flat": ["radius"], "sphere": ["load"], "disc": ["radius", "load"], "cone": ["radius", "load"]}.get(
        changed.get("profile", ""), []
    ):
        del case[name]
    with pytest.raises((solver.FactorError, solver.MaterialError)) as refusal:
        solver.solve(case)
    assert str(refusal.value).startswith(message)
    assert "\n" not in str(refusal.value)


def test_fields_and_peaks_in_no_air_are_those_without() -> None:
    """Of half-planes by the closed form, of films by their tables, whose nets are others: peaks to 1e-6."""
    positions, x, y = [-20.0, -2.0, -0.5, 0.3, 1.4], [-1.5, 0.2, 3.0], [-0.1, -0.7]
    bare, none = {"surroundings": "insulated"}, AIR | {"gap_permittivity": 1e-16}
    for case in (LINE, FILM | {"friction": 0.2, "load": 1e4}):
        exact, found = (solver.solve(case | own, positions, regular=True) for own in (bare, none))
        inside = [solver.solve_interior(case | own, x, y) for own in (bare, none)]
        for one, other in zip((found, inside[1]), (exact, inside[0]), strict=True):
            for name in (name for name in other.data_vars if other[name].ndim):
                size = float(np.max(np.abs(other[name])))
                np.testing.assert_allclose(one[name], other[name], rtol=0, atol=1e-8 * size, err_msg=str(name))
    slides = FILM | {"friction": 0.2, "load": 1e4}
    for case, names, region in ((slides, FILM_PEAKS, "interface"), (LINE | {"material": "BaTiO3"}, PEAKS, "body")):
        exact, found = (solver.solve(case | own, peaks=True) for own in (bare, none))
        for name in names:
            np.testing.assert_allclose(found[name], exact[name], rtol=1e-6, err_msg=name)
        curves = [solver.solve_curves(case | own, [region]) for own in (bare, none)]
        for name in curves[0].data_vars:
            size = float(np.max(np.abs(curves[0][name])))
            np.testing.assert_allclose(curves[1][name], curves[0][name], rtol=0, atol=1e-6 * size, err_msg=str(name))


def test_peaks_in_air_are_the_largest_of_the_fields() -> None:
    case = FILM | AIR | {"friction": 0.2}
    found = solver.solve(case, peaks=["film_peak_von_mises", "interface_shear"])
    half = float(found["contact_trailing"] + found["contact_leading"]) / 2
    x, bottom = np.linspace(-2, 2, 81) * 1.001, 2e-4 / half
    inside = solver.solve_interior(case, x, -np.linspace(0.1, bottom, 15), fields=["von_mises", "stress_xy"])
    largest = float(inside["von_mises"].max())
    assert largest <= float(found["film_peak_von_mises"]) * (1 + 1e-9) < largest * 1.01
    shear = float(np.abs(inside["stress_xy"].isel(y=-1)).max())
    assert shear <= float(found["interface_shear"]) * (1 + 1e-9) < shear * 1.001


def test_peaks_of_half_planes_in_air_are_the_largest_of_the_fields() -> None:
    """Charges beside a contact that slides lower its von Mises stress and move it; tension is at the least depth."""
    case = LINE | AIR | {"material": "BaTiO3", "friction": 0.05}
    found = solver.solve(case, peaks=True)
    fields = ["von_mises", "principal_tension"]
    inside = solver.solve_interior(case, np.linspace(-3.0, 3.0, 121) * 1.001, -np.linspace(0.1, 1.2, 23), fields=fields)
    for name in fields:
        largest = float(inside[name].max())
        assert largest <= float(found[f"peak_{name}"]) * (1 + 1e-9) < largest * 1.01, name
    bare = solver.solve(case | {"surroundings": "insulated"}, peaks=["peak_von_mises"])
    assert float(found["peak_von_mises"]) < 0.999 * float(bare["peak_von_mises"])


def test_what_is_not_given_of_points_in_air_is_refused() -> None:
    case = {"material": "PZT-4", "profile": "sphere", "radius": 0.05, "force": 1.0} | AIR
    with pytest.raises(solver.FactorError, match="curves: of a body under a point contact are not given; ask for peak"):
        solver.solve_curves(case, ["body"])


@pytest.mark.parametrize(
    "own",
    [
        {"radius": 0.02, "thickness": 3e-4, "base": "steel", "punch": "steel", "load": [1.9e4, 2e4, 2.1e4]},
        {"radius": 0.02, "friction": 0.2, "load": [7.9e3, 8e3, 8.1e3]},
        {"radius": 0.02, "friction": 0.2, "load": [2.99e4, 3e4, 3.01e4], "material": "PIC255"},
        {"friction": 0.3, "load": [0.99e5, 1e5, 1.01e5]},
        {
            "radius": 0.28,
            "friction": 0.4,
            "load": [4.4e6, 4.5e6, 4.6e6],
            "material": "PZT-5H",
            "thickness": 6.4e-4,
            "base": "polyimide",
            "punch": "steel",
        },
    ],
)
def test_a_held_potential_is_not_that_of_a_closed_gap(own: dict[str, Any]) -> None:
    """Newton's iteration once ended at a gap below zero next to an edge, at some loads or at all of them."""
    found = solver.solve(LINE | AIR | own)["charge_sensitivity"].values
    assert found[1] == pytest.approx((found[0] + found[2]) / 2, rel=1e-4)
