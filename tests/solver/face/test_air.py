"""Air beside a contact: half-planes against their closed form, limits at edges, farther panels, defaults, tables."""

from typing import Any

import numpy as np
import pytest
import xarray as xr

import solver
from solver.gap import operators
from solver.names import GAP_QUANTITIES, POINT_GAP_QUANTITIES
from solver.stack.layers import Layer, Stack
from tests.solver.cases import assert_alike, without
from workflow.run.provenance import ROOT

AIR: dict[str, Any] = {"surroundings": "air"}
LINE: dict[str, Any] = {"material": "PZT-4", "radius": 0.05, "load": 2e4, "magnetic": "insulating"}
FILM = LINE | {"thickness": 2e-4, "base": "steel"}
#: Cases of the table in docs/names.md, in its order.
TABLE: list[dict[str, Any]] = [
    FILM,
    LINE | {"material": "AlN", "radius": 0.01, "load": 1e3, "thickness": 2e-6, "base": "silicon"},
]


@pytest.mark.parametrize("case", [LINE | {"punch": "steel", "datum": 0.3}, FILM | {"friction": 0.2, "load": 1e4}])
def test_lines_in_no_air_are_those_without(case: dict[str, Any]) -> None:
    """A gap of next to no permittivity; at the edge, where D_y is infinite without it, it is only next to none."""
    positions, x, y = [-20.0, -2.0, -0.5, 0.3, 1.4], [-1.5, 0.2, 3.0], [-0.1, -0.7]
    bare, none = {"surroundings": "insulated"}, AIR | {"gap_permittivity": 1e-16}
    exact, computed = (solver.solve(case | options, positions, regular=True) for options in (bare, none))
    gone = {f"{field}_edge_intensity_{edge}" for field in ("electric", "magnetic") for edge in ("trailing", "leading")}
    added = GAP_QUANTITIES.keys() | {"capacitance_per_length"}
    assert set(computed.data_vars) - gone == set(exact.data_vars) - gone | added
    quantities = {name for name in map(str, exact) if not exact[name].ndim} - gone
    assert_alike(computed, exact, 1e-8, [name for name in map(str, exact) if exact[name].ndim])
    of_edges = {"trailing_tension", "leading_compression"}
    assert_alike(computed, exact, 1e-9 if "thickness" in case else 1e-11, quantities - of_edges)
    inside = [solver.solve_interior(case | options, x, y) for options in (bare, none)]
    assert_alike(inside[1], inside[0], 1e-8)


def test_air_changes_neither_pressure_nor_charge_per_load_of_a_half_plane() -> None:
    """The theorem of docs/theory.md, 10: both by the closed form; capacitances at fixed contact and load are one."""
    exact, computed = solver.solve(LINE), solver.solve(LINE | AIR)
    assert_alike(computed, exact, 1e-9, ("contact_trailing", "peak_pressure", "charge_per_force", "stroke_per_volt"))
    assert abs(float(computed["voltage"] / exact["voltage"])) < 0.95
    assert float(computed["capacitance_at_load"]) == pytest.approx(float(computed["capacitance_per_length"]), rel=1e-9)
    case = {"material": "PVDF", "radius": 20e-3}  # of which the charge per load is that of any load
    tiny, plain = (solver.solve(case | loads) for loads in (AIR | {"load": 1e-6}, {"load": 1e4}))
    assert_alike(tiny, plain, 1e-9, ("charge_per_force",))


def test_a_load_alone_has_the_quantities_that_it_has_in_a_sweep() -> None:
    """Alone it reads a narrow table of other half-lengths, in a sweep one of half a decade, which errs by 3e-7."""
    loads = np.geomspace(1e4, 4e4, 2)
    sweep = solver.solve(FILM | {"friction": 0.3} | {"load": xr.DataArray(loads, dims="load")})
    for load in loads.tolist():
        alone = solver.solve(FILM | {"friction": 0.3} | {"load": load})
        for name in ("contact_leading", "peak_pressure", "voltage", "voltage_per_load", "gap_field"):
            assert float(alone[name]) == pytest.approx(float(sweep[name].sel(load=load)), rel=1e-6), name
            assert float(alone[name]) != float(sweep[name].sel(load=load)), "both read the same table"


BALL: dict[str, Any] = {
    "material": "PZT-4", "profile": "sphere", "radius": 5e-3, "force": 0.1, "magnetic": "insulating"
}  # fmt: skip
OWN: dict[str, Any] = FILM | {"radius": None, "profile": solver.Profile.cylinder(np.array(0.05))}


@pytest.mark.parametrize(
    ("case", "around"),
    [
        (LINE, "insulated"), (FILM, "air"), (BALL, "insulated"), (BALL | {"thickness": 1e-4, "base": "steel"}, "air"),
        (FILM | {"electric": "insulating"}, "insulated"), (OWN, "air"),
    ],
)  # fmt: skip
def test_films_are_in_air_by_default_bit_for_bit_and_half_planes_are_not(case: dict[str, Any], around: str) -> None:
    case = without(case)
    said, unsaid = solver.solve(case | {"surroundings": around}), solver.solve(case)
    assert set(said.data_vars) == set(unsaid.data_vars)
    assert_alike(said, unsaid, 0.0)
    assert str(unsaid.coords.get("surroundings", "insulated").values if "thickness" in case else "insulated") == around
    assert ("gap_permittivity = 1" in unsaid.attrs["defaults"]) == (around == "air")


def test_what_cases_have_beside_them_may_differ_along_two_dimensions() -> None:
    conducts = {"electric": ["conducting", "insulating"], "magnetic": ["insulating", "conducting"]}
    computed = solver.solve(FILM | conducts)
    assert computed["surroundings"].transpose("electric", "magnetic").values.tolist() == [
        ["air", "air"],
        ["insulated", "air"],
    ]
    alone = solver.solve(FILM | {"electric": "insulating"})
    assert float(computed["depth"].sel(electric="insulating", magnetic="insulating")) == float(alone["depth"])
    named = solver.solve(FILM | {"surroundings": xr.DataArray(["", "insulated", ""], dims="case")})
    assert named["surroundings"].values.tolist() == ["air", "insulated", "air"]


def test_the_table_of_films_with_air_is_the_solver_s() -> None:
    page = (ROOT / "docs/names.md").read_text(encoding="utf-8")
    lines = page.split("| voltage at the load | charge per load, pC/N |\n")[1].split("\n\n")[0].splitlines()[1:]
    for line, case in zip(lines, TABLE, strict=True):
        bare, air = solver.solve(case | {"surroundings": "insulated"}), solver.solve(case)
        stored, volts, charge = (cell.strip() for cell in line.strip("|").split("|")[1:])
        nano = [f"{float(answer['capacitance_per_length']) * 1e9:.3g}" for answer in (bare, air)]
        assert stored == ", air ".join(nano)
        assert volts == f"x {float(air['voltage'] / bare['voltage']):.2g}"
        pico = [float(first["charge_per_force"]) * 1e12 for first in (bare, air)]
        assert charge == f"{pico[0]:.3g}, air {pico[1]:.3g}"


def test_points_in_no_air_are_those_without() -> None:
    case = without(BALL, "material") | {"force": 10.0, "composite": "fibrous", "volume_fraction": 0.6}
    x, y = [-3.0, -1.05, -0.5, 0.3, 0.95, 2.0], [-0.02, -0.7, -2.5]
    for friction in ({}, {"friction": 0.3}):
        options = case | friction | {"total_charge": 2e-10}
        exact, computed = (
            (solver.solve(options | around, x), solver.solve_interior(options | around, x, y))
            for around in ({"surroundings": "insulated"}, AIR | {"gap_permittivity": 1e-15})
        )
        gone = {name for name in map(str, exact[0].data_vars) if "edge_intensity" in name}
        assert set(computed[0].data_vars) == set(exact[0].data_vars) - gone | POINT_GAP_QUANTITIES.keys()
        names_left = set(map(str, exact[0].data_vars)) - gone - {"magnetic_induction"}  # which is rounding alone
        assert_alike(computed[0], exact[0], 1e-10, {name for name in names_left if not exact[0][name].ndim})
        assert_alike(computed[0], exact[0], 1e-9, names_left)
        assert_alike(computed[1], exact[1], 1e-9)


@pytest.mark.parametrize(
    "options",
    [
        {"radius": 0.02, "thickness": 3e-4, "base": "steel", "punch": "steel", "load": [1.9e4, 2e4, 2.1e4]},
        {"radius": 0.02, "friction": 0.2, "load": [2.99e4, 3e4, 3.01e4], "material": "PIC255"},
        {"radius": 0.28, "friction": 0.4, "load": [4.4e6, 4.5e6, 4.6e6], "material": "PZT-5H", "thickness": 6.4e-4,
         "base": "polyimide", "punch": "steel"},
    ],
)  # fmt: skip
def test_a_held_potential_is_not_that_of_a_closed_gap(options: dict[str, Any]) -> None:
    """Newton's iteration once ended at a gap below zero next to an edge, at some loads or at all of them."""
    computed = solver.solve(LINE | AIR | options)["charge_per_force"].values
    assert computed[1] == pytest.approx((computed[0] + computed[2]) / 2, rel=1e-4)


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
    assert_alike(far, usual, off)
