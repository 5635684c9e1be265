"""Air beside a contact: half-planes, films and points against closed forms, finite elements, limits and twins."""

import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.integrate import quad

import solver
from solver.gap import operators
from solver.material.constants import VACUUM_PERMEABILITY, VACUUM_PERMITTIVITY, Material
from solver.names import GAP_QUANTITIES, POINT_GAP_QUANTITIES
from solver.point.sliding import FirstOrderWarning
from solver.stack.layers import Layer, Stack
from tests.solver.cases import BTO, assert_alike, without
from verification.cases import constants
from verification.oracles.fem_film import Layer as ElementLayer
from verification.oracles.fem_point import PointContact
from verification.oracles.spectral import ELECTRIC
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


SPHERE = {"profile": "sphere", "radius": 5e-3, "magnetic": "insulating", "surroundings": "air"}
COATED = SPHERE | {
    "material": BTO,
    "thickness": 1e-4,
    "base": "steel",
    "interface_electric": "grounded",
    "force": 37.0,
}
HALF = SPHERE | {"material": BTO, "force": 10.0}
SLID = {"friction": 0.3}
COMPOSITE = SPHERE | {"composite": "fibrous", "volume_fraction": 0.6, "force": 10.0}


def answer(case: Mapping[str, Any]) -> dict[str, float]:
    return {str(name): float(value) for name, value in solver.solve(case).data_vars.items()}


def test_elements_of_body_and_gap_agree() -> None:
    """On a rigid base, order 8, single nodes good to 4e-5; on steel and half-spaces, in half a minute, as well."""
    radius, charge = 1e-4, 1e-9
    other = PointContact([ElementLayer(constants(BTO) | {"c12": float(BTO.c12)}, 1e-4)], None, 5e-3, radius, charge)
    case = SPHERE | {"material": BTO, "thickness": 1e-4, "base": "rigid", "total_charge": charge, "force": other.force}
    solution = answer(case)
    expected = [radius, other.depth, other.voltage]
    np.testing.assert_allclose([solution[name] for name in ("contact_radius", "depth", "voltage")], expected, rtol=1e-6)
    r, phi = other.exterior(ELECTRIC)
    compared = np.flatnonzero((r > 1.02) & (r < 6))[::7]
    inside = solver.solve_interior(case, r[compared], [0.0], fields=["electric_potential"])
    np.testing.assert_allclose(inside["electric_potential"][0], phi[compared], rtol=0, atol=1e-4 * abs(other.voltage))
    assert np.max(np.abs(phi[compared] - other.voltage)) > 0.3 * abs(other.voltage)


def test_a_gap_s_end_is_a_sphere_s_radius_unless_it_is_said() -> None:
    """A power of 2 is a sphere; four times the end adds 4 pi eps0 R log 4 to the capacitance."""
    sphere = answer(HALF)
    power = answer(
        without(HALF, "radius") | {"profile": "power", "exponent": 2.0, "coefficient": 100.0, "gap_radius": 5e-3}
    )
    for name, value in sphere.items():
        assert power[name] == pytest.approx(value, rel=1e-12), name
    wide = answer(HALF | {"gap_radius": 2e-2})
    difference = wide["capacitance"] - sphere["capacitance"]
    assert difference == pytest.approx(4 * np.pi * VACUUM_PERMITTIVITY * 5e-3 * np.log(4), rel=0.02)


def test_a_ball_that_hardly_touches_has_the_capacitance_of_one_that_touches_at_a_point() -> None:
    """A dielectric so thin that field lines cross it straight: the sum over r of two capacitors in series.

    Field lines spread over (h/L)^2 = 1e-5 of it, L = sqrt(2 R h/eps_r) being the distance as far as charges lie.
    """
    h, R, eps = 1e-5, 1.0, 3.0
    film: dict[str, Any] = {"c11": 3e9, "c12": 1e9, "c13": 1e9, "c33": 3e9, "c44": 1e9}
    film |= {f"eps{place}": eps * VACUUM_PERMITTIVITY for place in ("11", "33")}
    case = {"material": Material(**film), "thickness": h, "base": "rigid", "profile": "sphere", "radius": R}

    def per_log_r(log_r: float) -> float:
        r = np.exp(log_r)
        return float(2 * np.pi * r**2 * VACUUM_PERMITTIVITY / (r**2 / (2 * R) * (1 + (r / R) ** 2) + h / eps))

    touching = quad(per_log_r, np.log(1e-8), np.log(1e5), limit=200)[0]
    for force in (1e-13, 5e-18):  # contact radii of 3e-3 and 1.1e-4 thicknesses, 3e-8 and 1e-9 of the gap's end
        assert answer(case | {"force": force})["capacitance"] == pytest.approx(touching, rel=1e-5)


def test_a_gap_that_opens_slowly_leaves_its_equations_their_digits() -> None:
    """A power of 4 opens by 1e-20 m where it touches: the capacitance is that of the wide gap, whatever touches."""
    case = {"material": "PZT-4", "surroundings": "air", "profile": "power", "exponent": 4.0, "coefficient": 1e5}
    small, tiny = (answer(case | {"gap_radius": 1e-2, "force": force}) for force in (1e-8, 1e-17))
    for name in ("capacitance", "capacitance_at_force", "voltage_per_force"):
        assert tiny[name] == pytest.approx(small[name], rel=1e-6), name
    assert tiny["contact_stiffness"] == pytest.approx(small["contact_stiffness"] * 1e-9**0.2, rel=1e-6)


def test_a_gap_that_ends_too_far_away_or_within_the_contact_is_refused() -> None:
    with pytest.raises(solver.FactorError, match=r"^contact: narrower than 1e-12 of the distance at which"):
        answer(HALF | {"gap_radius": 1e10})
    radius = answer(HALF)["contact_radius"]
    assert answer(HALF | {"gap_radius": 1.1 * radius})["contact_radius"] == pytest.approx(radius, rel=1e-3)
    with pytest.raises(solver.FactorError, match=r"^gap_radius: .* is less than the contact's radius [0-9.e-]+ m: "):
        answer(HALF | {"gap_radius": 0.9 * radius})


@pytest.mark.parametrize("case", [HALF, HALF | {"punch": "steel"}, COMPOSITE | {"magnetic": "conducting"}])
def test_grounded_on_a_half_space_it_does_not_see_the_air(case: dict[str, Any]) -> None:
    """Theorem: the whole surface is at zero, and the charge per force is -r_1 whatever is beside the contact."""
    bare, air = answer(case | {"surroundings": "insulated"}), answer(case)
    for name in ("contact_radius", "charge_per_force", "stroke_per_volt", "peak_pressure", "contact_stiffness"):
        assert air[name] == pytest.approx(bare[name], rel=1e-11, abs=0)
    assert air["capacitance"] > 1.2 * bare["capacitance"]


def test_magnetic_gap_is_the_electric_one_s_twin() -> None:
    """Magnetic constants in the ratio of the vacuum's to the electric ones: the same contact in other units."""
    ratio = VACUUM_PERMEABILITY / VACUUM_PERMITTIVITY
    root = float(np.sqrt(ratio))
    electric_constants = constants(BTO)
    changed: dict[str, Any] = {name: electric_constants[name] for name in ("c11", "c13", "c33", "c44")}
    changed |= {f"f{place}": root * electric_constants[f"e{place}"] for place in ("31", "33", "15")}
    changed |= {f"mu{place}": ratio * electric_constants[f"eps{place}"] for place in ("11", "33")}
    twin = Material(**changed, eps11=np.array(1e-9), eps33=np.array(1e-9), name="twin")
    case = COATED | {"thickness": 2e-4, "base": "rigid", "interface_magnetic": "grounded"}
    electric = answer(case | {"friction": 0.2})
    magnetic = answer(case | {"friction": 0.2, "material": twin, "electric": "insulating", "magnetic": "conducting"})
    for name in ("contact_radius", "contact_offset"):
        assert magnetic[name] == pytest.approx(electric[name], rel=1e-11, abs=0)
    assert magnetic["flux_per_force"] == pytest.approx(root * electric["charge_per_force"], rel=1e-9)
    assert magnetic["magnetic_potential"] == pytest.approx(electric["voltage"] / root, rel=1e-9)
    assert magnetic["permeance"] == pytest.approx(ratio * electric["capacitance"], rel=1e-9)


def test_a_dielectric_under_its_own_elasticity_feels_nothing_of_it() -> None:
    """Equal bodies do not shift, and no stress makes a charge: Hamilton's tension, and charges as at rest."""
    poisson = 0.3
    body = Material.isotropic(200e9, poisson, name="dielectric")
    case = HALF | {"material": body, "punch": body, "total_charge": 1e-10}
    still, slid = answer(case | {"friction": 0.0}), answer(case | SLID)
    for name in ("contact_radius", "peak_displacement", "gap_field"):
        assert slid[name] == pytest.approx(still[name], rel=1e-12)
    hamilton = slid["peak_pressure"] * ((1 - 2 * poisson) / 3 + 0.3 * np.pi * (4 + poisson) / 8)
    assert slid["trailing_tension"] == pytest.approx(hamilton, rel=1e-12)
    shifted = answer(case | SLID | {"punch": "rigid"})
    assert abs(shifted["contact_offset"]) > 1e-3 * shifted["contact_radius"]
    assert shifted["peak_displacement"] > still["peak_displacement"]


def test_electric_and_magnetic_charges_see_one_gap_that_friction_tilts() -> None:
    """D g = eps0 (phi - V) to the first order: what it says of g_1 from D and phi is what B and psi say."""
    case = COMPOSITE | SLID | {"total_charge": 2e-10, "magnetic": "conducting", "total_flux": 1e-9}
    r = np.array([1.1, 1.6, 2.5, 5.0])
    punch, names = solver.solve(case), ["electric_potential", "magnetic_potential"]
    inside = solver.solve_interior(case, np.concatenate([r, -r]), [0.0], fields=names)
    surface, gaps = solver.solve(case, np.concatenate([r, -r])), []
    for potential, density, level, vacuum in (
        ("electric_potential", "electric_displacement", "voltage", VACUUM_PERMITTIVITY),
        ("magnetic_potential", "magnetic_induction", "magnetic_potential", VACUUM_PERMEABILITY),
    ):
        pairs = inside[potential].values.reshape(2, -1) - float(punch[level]), surface[density].values.reshape(2, -1)
        (phi, phi_1), (D, D_1) = (((pair[0] + pair[1]) / 2, (pair[0] - pair[1]) / 2) for pair in pairs)
        gap = vacuum * phi / D
        gaps.append((gap, (vacuum * phi_1 - D_1 * gap) / D))
    for electric, other in zip(*gaps, strict=True):
        np.testing.assert_allclose(electric, other, rtol=1e-5)
    assert np.all(np.abs(gaps[0][1]) > 1e-3 * gaps[0][0])


def test_largest_values_are_those_of_the_fields() -> None:
    """Beside the edge of a contact whose charge is below what the surface gives way to; inside the edge D is steep."""
    case = HALF | {"friction": 0.02, "total_charge": 1.6e-9}
    solution = answer(case)
    beside = 1 + np.geomspace(1e-3, 3, 9)
    fields = solver.solve(case, np.concatenate([np.linspace(-0.99, 0.99, 23), beside, -beside]))
    D = np.abs(fields["electric_displacement"].values.ravel())
    assert np.max(D) <= solution["peak_displacement"] * (1 + 1e-9)
    np.testing.assert_allclose(np.max(D), solution["peak_displacement"], rtol=0.1)


def test_a_field_beyond_what_the_surface_carries_is_told() -> None:
    grounded = HALF | {"total_charge": 1.68e-9}
    with pytest.warns(FirstOrderWarning, match=r"^friction: to its first order the field in the gap .* 4\.5 times"):
        answer(grounded | SLID)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        answer(grounded | {"friction": 0.05})
        answer(HALF | SLID)
