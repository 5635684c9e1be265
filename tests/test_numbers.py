"""Numbers that docs/limits.md and the pages of theory state, computed by the solver."""

import itertools
import re
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.interpolate import CubicSpline

import solver
from solver.arrays import Array
from solver.face.filmbodies import stack_of
from solver.face.heat import charged_area, responses
from solver.halfplane.profile import Profile
from solver.heat.charge import film_coefficient, film_gap
from solver.heat.touch import Shape as SpotShape
from solver.heat.touch import Spot
from solver.line import outputs
from solver.line.contact import FilmContact
from solver.line.table import table
from solver.material.punches import punches
from solver.point.body import Film
from solver.point.contact import Pressed
from solver.point.profile import Shape
from solver.point.table import PointKind
from solver.stack.layers import Layer, Stack
from solver.stack.reflection import sideways
from tests.solver.cases import BTO, tables
from verification.cases import half_length
from workflow.language import grammar
from workflow.language.constants import Meeting
from workflow.run.provenance import ROOT
from workflow.study.reading import read_yaml
from workflow.study.sections import Device

LIMITS, FILMS, POINTS, HEAT = (
    " ".join((ROOT / f"docs/{name}.md").read_text(encoding="utf-8").split())
    for name in ("limits", "theory-films", "theory-points", "heat")
)


def described(study: str) -> str:
    return " ".join(read_yaml(Path(ROOT / f"config/{study}.yaml"))["description"].split())


# The half-plane of docs/limits.md

CASE = {"volume_fraction": 0.5, "radius": 0.05, "load": 1e5, "friction": 0.3}


def test_datum_conduction_and_punch_change_a_contact_as_stated() -> None:
    datum = solver.solve({**CASE, "datum": [0.01, 0.1, 1.0, 10.0]})
    volts = ", ".join(f"{abs(value):.3f}" for value in datum["voltage_per_load"].values)
    assert f"voltage per load {volts} V m/N" in LIMITS
    for name in ("charge_per_force", "stroke_per_volt", "contact_trailing", "peak_pressure", "trailing_tension"):
        assert np.ptp(datum[name].values) < 1e-5 * abs(datum[name].values).mean()
    conduction = ["conducting", "insulating"]
    conducted = solver.solve({**CASE, "electric": conduction, "magnetic": conduction})
    width, pressure = conducted["contact_trailing"] + conducted["contact_leading"], conducted["peak_pressure"]
    spreads = (float(values.max() / values.min() - 1) for values in (width, pressure))
    assert "width {:.1%}, largest pressure {:.1%}".format(*spreads).replace("%", " %") in LIMITS
    elastic = solver.solve({**CASE, "punch": ["rigid", "steel"]})
    rigid, steel = (elastic["contact_trailing"] + elastic["contact_leading"]).values
    assert f"widens the contact by {100 * (steel / rigid - 1):.0f} %" in LIMITS
    assert f"(a/R)^2 = {(float(rigid) / 2 / CASE['radius']) ** 2:.0e}".replace("e-0", "e-") in LIMITS
    assert f"largest pressure is {datum['peak_pressure'].values[0] / 1e6:.0f} MPa" in LIMITS
    assert f"the tension {datum['trailing_tension'].values[0] / 1e6:.0f} MPa" in LIMITS


def test_a_film_on_copper_has_the_stated_charge() -> None:
    layers = [solver.Layer(solver.find("PZT-4"), 2e-4), solver.Layer(solver.find("copper"), 2e-5)]
    body = solver.Stack(layers, solver.find("silicon"))
    charge = solver.solve({"body": body, "surroundings": "insulated", "radius": 0.05, "load": 2e4})
    assert f"20 kN/m: {abs(float(charge['charge_per_force'])) * 1e12:.0f} pC/N" in LIMITS


#: Designs of ``config/film_sensor.yaml``, rounded, in the case that decides; with a ball they are all `CASES`.
FILMS_SENSED = {
    "charge": {"volume_fraction": 0.8345, "thickness": 2.16e-4, "radius": 0.0514, "load": 5e3},
    "voltage": {"volume_fraction": 0.8325, "thickness": 1.486e-3, "radius": 0.0432, "load": 5e3},
    "quiet": {"volume_fraction": 0.8325, "thickness": 3.3e-3, "radius": 0.102, "load": 1e4},
}
GROUNDED: dict[str, Any] = {
    "interface_electric": "grounded", "interface_magnetic": "grounded", "base": "steel", "punch": "steel",
    "friction": 0.3,
}  # fmt: skip
BALL: dict[str, Any] = {
    "material": "PZT-4", "profile": "sphere", "radius": 0.02, "thickness": 80e-6, "base": "steel", "punch": "steel",
    "magnetic": "insulating",
}  # fmt: skip
CASES = {name: GROUNDED | design for name, design in FILMS_SENSED.items()} | {"ball": BALL | {"force": 0.2}}
FIGURES = {
    "charge_per_force": 1e12,
    "circuit_capacitance - input_capacitance - cable_capacitance": 1e12,
    "signal_voltage": 1.0,
    "smallest_force": 1e6,
    "contact_trailing + contact_leading": 1e6,
    "contact_trailing * contact_leading / (2 * radius)": 1e9,
}


@cache
def solved(name: str, surroundings: str) -> xr.Dataset:
    return solver.solve(CASES[name] | {"surroundings": surroundings})


def device_figures(
    case: dict[str, Any], answer: xr.Dataset, study: str, meeting: Meeting, formulas: Iterable[str]
) -> list[float]:
    """Figures of the device of a shipped study in a case."""
    device = Device.model_validate(read_yaml(Path(ROOT / f"config/{study}.yaml"))["device"])
    values = {str(quantity): np.abs(array.values) for quantity, array in answer.data_vars.items()}
    numbers = {**device.constants, **{factor: value for factor, value in case.items() if not isinstance(value, str)}}
    values |= {factor: np.asarray(value) for factor, value in numbers.items()}
    return [float(grammar.parse(text, meeting).evaluate(values)) for text in formulas]


@pytest.mark.parametrize("name", FILMS_SENSED)
def test_air_changes_a_film_sensor_as_stated(name: str) -> None:
    meetings: tuple[tuple[str, Meeting], ...] = (("insulated", "line"), ("air", "line in air"))
    columns = []
    for surroundings, meeting in meetings:
        figures = device_figures(CASES[name], solved(name, surroundings), "film_sensor", meeting, FIGURES)
        columns.append([f"{figure * scale:.3g}" for figure, scale in zip(figures, FIGURES.values(), strict=True)])
    pairs = (", ".join(pair) for pair in zip(*columns, strict=True))
    assert f"| {name} | {' | '.join(pairs)} |" in LIMITS


def in_kelvin(
    case: dict[str, Any], answer: xr.Dataset, study: str, meeting: Meeting, length: float
) -> tuple[float, float]:
    """Changes of temperature everywhere that equal the noise and the force [K]."""
    (smallest,) = device_figures(case, answer, study, meeting, ["smallest_force"])
    per_newton = abs(float(answer["charge_per_force"]))
    _, uniform = responses(case | {"surroundings": "air"}, answer, np.array([1.0]))
    force = case.get("force", case.get("load", 0.0) * length)
    noise, signal = (newton * per_newton / abs(uniform * length) for newton in (smallest, force))
    return noise, signal


def test_smallest_forces_equal_the_stated_changes_of_temperature() -> None:
    kelvin = [in_kelvin(CASES[name], solved(name, "air"), "film_sensor", "line in air", 0.01) for name in FILMS_SENSED]
    charge, voltage, quiet = (f"{1e6 * noise:.2g}" for noise, _ in kelvin)
    largest = [force for _, force in kelvin]
    assert f"a change of {charge}, {voltage} and {quiet} uK everywhere" in LIMITS
    assert f"its largest {min(largest):.3g} to {max(largest):.3g} K" in LIMITS
    text = described("film_sensor")
    assert f"of {quiet} to {charge} microkelvin everywhere makes as much charge as the smallest" in text
    assert f"one of {min(largest):.1g} to {max(largest):.1g} K as much as the rated one" in text


def test_the_heat_of_a_ball_equals_the_stated_shares() -> None:
    ball = BALL | {"thickness": 50e-6, "radius": 0.017, "surroundings": "air"}
    answers = {force: solver.solve(ball | {"force": force}) for force in (0.2, 0.02)}
    large, small = (
        in_kelvin(ball | {"force": force}, answer, "point_sensor", "point in air, charge amplifier", 1.0)[0]
        for force, answer in answers.items()
    )
    assert f"at 200 mN {1e6 * large:.3g} uK, at 20 mN {1e6 * small:.3g} uK" in LIMITS
    assert "by some tens of microkelvin" in described("point_sensor")
    assert 2e-5 < min(small, large) < max(small, large) < 1e-4
    # the mean rise of a disc of even flux on a half-space is 8 Q / (3 pi^2 kappa a)
    radius, per_newton = (float(answers[0.2][name]) for name in ("contact_radius", "charge_per_force"))
    film = film_coefficient(solver.find("PZT-4"), solver.find("steel"))
    equal = abs(0.2 * per_newton / (film * np.pi * radius**2))
    kappa = solver.find("PZT-4").thermal["conductivity"].value
    rise = 8 * (0.3 * 0.2 * 1e-3) / (3 * np.pi**2 * kappa * radius)
    share = f"{100 * rise / equal:.3g} % of the charge of the force from below"
    assert f"{rise:.3g} K if all of it enters the film's material, {share}" in LIMITS
    steel = punches()["steel"].thermal["conductivity"].value
    assert f"the ball itself conducts {100 * steel / (steel + kappa):.0f} % of the heat away" in LIMITS


# docs/heat.md


@pytest.mark.filterwarnings("ignore::solver.face.refusal.SmallStrainWarning")
def test_a_warm_finger_makes_the_stated_charge() -> None:
    layers = [Layer("PDMS", 1e-3, "grounded"), Layer("P(VDF-TrFE) 75:25 (alternative 1)", 50e-6)]
    case: dict[str, Any] = {"body": Stack(layers, "FR4"), "profile": "sphere", "radius": 0.01, "punch": "skin"}
    case |= {"electric": "insulating", "magnetic": "insulating", "collector": 2, "patch_size": 2e-3}
    case |= {"touch_temperature": 306.15, "body_temperature": 295.15, "hold": [0.3, 1.0]}
    out = solver.solve(case | {"force": [5e-3, 50e-3], "patch_position": [0.0, 1e-3, 2e-3]})
    shares = abs(out["heat_charge"] / (out["patch_charge_per_force"] * out["force"]))
    (soon, soon_most), (late, late_most) = (
        (float(part.min()), float(part.max())) for part in (shares.isel(hold=0), shares.isel(hold=1))
    )
    assert f"{soon:.2f} to {soon_most:.2f} times the charge of the touch in 0.3 s" in HEAT
    assert f"and {late:.0f} to {late_most:.0f} times in 1 s" in HEAT
    quick, slow = (
        solver.solve(case | {"force": 0.05, "patch_position": 0.0, "hold": 0.3} | leak)["temperature_equal"]
        for leak in ({"feedback_resistance": 1e10, "feedback_capacitance": 1e-11}, {})
    )
    assert f"share of the signal {float(slow / quick):.0f} times larger" in HEAT


def test_a_ball_s_heat_is_as_stated() -> None:
    shares = []
    for kind in ("insulated", "air"):
        step, uniform = responses(CASES["ball"] | {"surroundings": kind}, solved("ball", kind), np.array([1.0]))
        shares.append(100 * abs(step[0] / (0.2 * float(solved("ball", kind)["charge_per_force"]))))
    assert f"{shares[0]:.2g} % insulated, {shares[1]:.2g} % in air" in HEAT
    area = np.pi * float(solved("ball", "air")["contact_radius"]) ** 2
    contact = film_coefficient(solver.find("PZT-4"), solver.find("steel")) * area
    assert f"{abs(uniform / contact):.0f} times the charge below its contact" in HEAT


def test_the_field_beyond_a_contact_s_edge_is_as_large_as_stated() -> None:
    """All of a film polarised alike: what collects by its capacitance, over the contact and the parts below its gap."""
    shares: dict[str, list[float]] = {"insulated": [], "air": []}
    for kind, (name, case) in itertools.product(shares, CASES.items()):
        values = {str(quantity): float(array) for quantity, array in solved(name, kind).items()}
        stack = stack_of(case)
        half = values.get("contact_radius") or (values["contact_trailing"] + values["contact_leading"]) / 2
        shape: SpotShape = "disc" if "contact_radius" in values else "strip"
        r = half + np.geomspace(1e-9, case["radius"], 4001)
        gap = Spot(shape, half, radius=case["radius"] if kind == "air" else None).gap(r)
        below = np.trapezoid((2 * np.pi * r if shape == "disc" else 2.0) / (1 + gap / film_gap(stack)), r)
        area = charged_area(case | values, stack)
        shares[kind].append(area / (Spot(shape, half).area + float(below)))
    low, high = (100 * (share - 1) for share in (min(shares["air"]), max(shares["air"])))
    assert f"that is {low:.0f} to {high:.0f} % of the charge in air" in HEAT
    assert f"it is {min(shares['insulated']):.2g} to {max(shares['insulated']):.0f} times the charge below" in HEAT


# Points of docs/limits.md

RADIUS, THICKNESS = 5e-3, 1e-4
MATERIALS, RATIOS = ("PZT-4", "BaTiO3"), (0.2, 1.0, 5.0)


def pressed(profile: str, loading: str, ends: tuple[float, float], extent: str) -> dict[str, Array]:
    """Quantities (material, ratio) of a punch whose contact has the half-width a = ratio h, from a sweep of loads."""
    body = {"radius": RADIUS, "thickness": THICKNESS, "base": "rigid", "surroundings": "insulated", "profile": profile}
    answer = solver.solve(body | {"material": list(MATERIALS), loading: np.geomspace(*ends, 80)})
    a = answer[extent]
    columns = {
        "charge per force": answer["charge_per_force"] * 1e12,
        "stroke per volt": answer["stroke_per_volt"] * 1e12,
        "depth": answer["depth"] * RADIUS / a**2,
        "largest pressure": answer["peak_pressure"] * RADIUS / a / 1e9,
    }
    ratios = np.log(a.values / THICKNESS)
    return {
        name: np.array([CubicSpline(*row)(np.log(RATIOS)) for row in zip(ratios, values.values, strict=True)])
        for name, values in columns.items()
    }


@pytest.fixture(scope="module")
def ball() -> dict[str, Array]:
    return pressed("sphere", "force", (0.05, 3e4), "contact_radius")


def test_a_roller_in_place_of_a_ball_is_as_wrong_as_stated(ball: dict[str, Array]) -> None:
    roller = pressed("cylinder", "load", (2e3, 5e7), "contact_trailing")
    stated = {(cells[0], cells[1]): cells[2:] for cells in tables("limits") if cells[0] in MATERIALS}
    for (m, material), (r, ratio) in ((m, r) for m in enumerate(MATERIALS) for r in enumerate(RATIOS)):
        for name, cell in zip(ball, stated[material, f"{ratio:g}"], strict=True):
            pair = ball[name][m, r], roller[name][m, r]
            assert pair == pytest.approx(tuple(map(float, cell.split(","))), rel=6e-4), (material, ratio, name)


def test_what_points_leave_out_is_as_large_as_stated(ball: dict[str, Array]) -> None:
    pull = 3 * np.pi * 0.05 * RADIUS  # Johnson, Kendall and Roberts, at 50 mJ/m2
    wider = [(1 + (pull + np.sqrt(2 * pull * force + pull**2)) / force) ** (1 / 3) - 1 for force in (1.0, 0.01)]
    assert f"pulled off by {500 * pull:.3g} mN" in LIMITS
    assert f"wider by {100 * wider[0]:.3g} % at 1 N and by {100 * wider[1]:.3g} % at 10 mN" in LIMITS
    disc: dict[str, Any] = {"profile": "disc", "width": 1e-4, "force": 1.0, "magnetic": "insulating"}
    fringe = [
        4 * 8.8541878188e-12 * 5e-5 / float(solver.solve(disc | {"material": name})["capacitance"])
        for name in ("BaTiO3", "PVDF")
    ]
    assert f"adds {100 * fringe[0]:.3g} % to the capacitance of a disc on BaTiO3, {100 * fringe[1]:.3g} % on" in LIMITS
    alone = solver.solve({"material": "BaTiO3", "profile": "sphere", "radius": RADIUS, "force": 1.0})
    charge = 1 - ball["charge per force"][1, 0] / (abs(float(alone["charge_per_force"])) * 1e12)
    depth = 1 - ball["depth"][1, 0] / float(alone["depth"] * RADIUS / alone["contact_radius"] ** 2)
    assert f"charge per force {100 * charge:.3g} % less, depth {100 * depth:.3g} % less" in LIMITS


# docs/theory-points.md


def stated(name: str) -> list[float]:
    """Numbers of a row of docs/theory-points.md."""
    return [float(cell) for cell in next(row for row in tables("theory-points") if row[0] == name)[1:]]


@pytest.mark.parametrize("material", MATERIALS)
def test_a_ball_on_a_half_space_has_the_stated_figures(material: str) -> None:
    case: dict[str, Any] = {"profile": "sphere", "radius": 5e-3, "force": 10.0, "material": material}
    opened = solver.solve(case)
    grounded = solver.solve(case | {"total_charge": 10.0 * float(opened["charge_per_force"])})
    assert abs(float(grounded["voltage"])) < 1e-10 * abs(float(opened["voltage"]))
    figures = [
        abs(float(opened["charge_per_force"])) * 1e12,
        float(opened["contact_radius"]) * 1e6,
        float(grounded["depth"]) * 1e6,
        float(opened["peak_pressure"]) / 1e6,
        abs(float(opened["voltage"])),
    ]
    assert figures == pytest.approx(stated(material), rel=8e-5)


def test_balls_on_films_have_the_stated_figures() -> None:
    radii = np.array([0.2, 1.0, 5.0])
    forces = np.array(stated("$PR/a^3$ [Pa]")) * radii**3
    kind, conducts = PointKind(Stack([Layer(BTO, 1.0)]), (True, True), Shape(2.0)), np.array([True, True])
    body, coefficients = Film(kind, np.ones(3)), np.full(3, 0.5)
    grounded = Pressed(body, kind.scale, coefficients, forces, np.zeros((3, 2)), conducts).grounded
    np.testing.assert_allclose(grounded.radius, radii, rtol=3e-7)
    charge = np.abs(grounded.loads[:, 1]) / forces * 1e12
    np.testing.assert_allclose(charge, stated("size of $T/P$ [pC/N]"), rtol=4e-7)
    np.testing.assert_allclose(-grounded.displacement[:, 0] / radii**2, stated("depth $R/a^2$"), rtol=1e-6)


@pytest.mark.parametrize("layered", [False, True])
def test_a_ball_in_air_has_the_stated_figures(layered: bool) -> None:
    body = {"thickness": 1e-4, "base": "steel", "interface_electric": "grounded"} if layered else {}
    case: dict[str, Any] = {"profile": "sphere", "radius": 5e-3, "force": 10.0, "material": "BaTiO3"}
    case |= body | {"magnetic": "insulating"}
    bare, air = (solver.solve(case | {"surroundings": kind}) for kind in ("insulated", "air"))
    charge = [abs(float(answer["charge_per_force"])) * 1e12 for answer in (bare, air)]
    stored = [float(answer["capacitance"]) * 1e12 for answer in (bare, air)]
    voltage = float(air["voltage"] / bare["voltage"])
    name = "BaTiO3 of 0.1 mm on steel, grounded" if layered else "half-space of BaTiO3"
    row = f"| {name} | {charge[0]:.2f}, air {charge[1]:.2f} | {stored[0]:.3f}, air {stored[1]:.3f} | x {voltage:.3f} |"
    assert row in POINTS


# docs/theory-films.md

MIXED = solver.fibrous(solver.find("BaTiO3"), solver.find("CoFe2O4"), 0.5)
CYLINDER = Profile.cylinder(np.array(0.05))


def pressed_film(stack: Stack, friction: float = 0.0, load: float = 1e5, charge: float = 0.0) -> FilmContact:
    """Contact of a conducting cylinder of 50 mm on a stack."""
    contacts = table(stack, friction, least=0.3, most=4.0, nodes=20)
    return FilmContact(contacts, CYLINDER, np.array([load]), np.array([[charge, 0.0]]), np.array(1.0))


def thick(material: solver.Material) -> list[float]:
    """Half-length on a film ten half-lengths thick over the half-plane's, less 1: rigid, bonded, grounded base."""
    case = {"material": material, "radius": 0.05, "load": 1e5, "friction": 0.3}
    half = float(half_length(solver.solve(case)))
    film = {"thickness": 10 * half, "surroundings": "insulated"}
    bases = [{"base": "rigid"}, *({"base": "silicon", "interface_electric": kind} for kind in ("bonded", "grounded"))]
    return [float(half_length(solver.solve(case | film | base))) / half - 1 for base in bases]


def said(pattern: str) -> float:
    """The number at ``{}`` of a phrase of the page of films."""
    number = r"(-?\d+\.?\d*(?:e-\d)?)"
    match = re.search(re.escape(pattern).replace(r"\{\}", number), FILMS)
    assert match, pattern
    return float(match[1])


def test_a_thick_film_differs_from_its_half_plane_as_stated() -> None:
    rigid, bonded, grounded = thick(MIXED)
    assert rigid == pytest.approx(said("by {} on a rigid base"), rel=0.03)
    assert bonded == pytest.approx(said("by {} on silicon to which the film is electrically bonded"), rel=0.03)
    assert grounded == pytest.approx(said("by {} on silicon with a grounded electrode"), rel=0.03)
    _, bonded, grounded = thick(solver.find("BaTiO3"))
    assert bonded == pytest.approx(said("BaTiO3 has {} bonded"), rel=0.03)
    assert grounded == pytest.approx(said("bonded and {} grounded"), rel=0.03)


def test_reciprocity_holds_and_fails_as_stated() -> None:
    contact = pressed_film(Stack((Layer(MIXED, 3e-4),)), load=2e5)
    read = contact.table.interval.read(np.log(contact.half_width), contact.table.series)[0]
    T = len(contact.table.system.powers)
    (load_T, u_T, _, psi_T), (load_J, u_J, V_J, _) = read[[outputs.LOAD, 3, 4, 5]][:, [T, T + 1]].T
    assert load_T * u_J + V_J == pytest.approx(load_J * u_T + psi_T, rel=1e-9)
    assert abs(V_J / psi_T - 1) == pytest.approx(0.01 * said("alone misses by {} %"), rel=0.03)
    assert contact.tangents[0][0, 1] == pytest.approx(said("is {} m per C/m"), rel=0.03)
    assert -contact.tangents[0][1, 0] == pytest.approx(said(r"$-\partial V/\partial P$ is {}"), rel=0.03)
    assert -contact.response[0, 1] / 2e5 == pytest.approx(said("the half-plane's identity, {}"), rel=0.03)


def test_charge_and_datum_change_a_film_as_stated() -> None:
    stack = Stack((Layer(MIXED, 2e-4),))
    wide, plain = (pressed_film(stack, 0.3, charge=charge).half_width[0] for charge in (2e-5, 0.0))
    assert wide / plain - 1 == pytest.approx(0.01 * said("the half-length by +{} %"), rel=0.03)
    stack = Stack((Layer(MIXED, 1e-4, magnetic="insulated"),))
    contact, c_B = pressed_film(stack), sideways(stack) * stack.scale[3] ** 2
    assert contact.half_width[0] / stack.thickness == pytest.approx(said("contact {} times as long"), rel=0.03)
    potential = contact.at_fixed_contact[0, 2, 1]
    phrases = {2 / np.pi: "it is {} Wb/(A m)", 1.0: "the same film has {}", 10.0: "from $10 H$ {}"}
    for datum, phrase in phrases.items():
        permeance = 1 / (potential - c_B / 2 * (datum - 2 / np.pi) * stack.thickness)
        assert permeance == pytest.approx(said(phrase), rel=0.03)
