"""An answer: its file, tables and words, and the effects left out of the model, each against a figure by hand."""

import csv
import io
import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.integrate import quad
from scipy.optimize import brentq

from solver import find, solve
from solver.body import around, kind_of
from solver.surface import response as surface
from solver.surface.contact import solve_contact
from solver.surface.shape import Roller, RoughSphere, sphere
from storage.netcdf import read_whole, write_whole
from tests.workflow.conftest import Project
from workflow.design.verdict import answer as parts
from workflow.design.verdict import leftout, multipliers, netcdf
from workflow.design.verdict.leftout import LeftOut, SolvedCase
from workflow.design.wording import table, words
from workflow.language import statements
from workflow.language.numbers import shown
from workflow.study.allowable import Allowable

CASE = {"radius": 0.105, "load": 1e4}
GOAL = parts.Term(
    statements.objective("abs(voltage) / load", maximise=False), predicted=1.01, predicted_std=0.01, half=0.02,
    exact=1.0,
    inside=True, limit=np.nan, margin=np.nan, units="V m N-1", bound="", source="", worst=CASE, effect=(0.03, 0.04),
    spread=0.05,
)  # fmt: skip
LIMIT = replace(
    GOAL, statement=statements.limit("trailing_tension <= 0.5 tensile_strength"), limit=2e7, exact=1.9e7, margin=0.05,
    units="Pa", bound="tensile strength of PZT", source="a table", inside=False,
)  # fmt: skip
SLOPES = parts.Sensitivity((0.5, -1.0), 0.01, 0.02, False, 0.03)
RADIUS = parts.Variable("radius", 0.1, parts.Role.VARIABLE, SLOPES, "5 %", parts.End.UPPER_ASKED)
LOAD = parts.Variable("load", 1e4, parts.Role.WORST_CASE, parts.Sensitivity((1.0, 1.0), 0.1, 0.2, True, 0.3))
PZT, FLAT = parts.Category("material", "PZT", parts.Role.VARIABLE), parts.Category("profile", "flat", parts.Role.GIVEN)
ANSWER = parts.Answer(
    terms=(GOAL, LIMIT),
    variables=(RADIUS, LOAD),
    ranges=(parts.Range("voltage", -1.0, 2.0),),
    beyond="nominal field exceeds it (a book)",
    exceeded=("nominal field exceeds it",),
    flags="nominal field exceeds it",
    target="mine",
    statistic="worst-case",
    polish="on the exact solver",
    source="a test",
    figures=(parts.Figure("force", 1.0, 2.0),),
    overload=parts.Overload(1.5, "trailing_tension <= 0.5 tensile_strength"),
    constants=(parts.Constant("c11", "5 %"), parts.Constant("e31", "10 %")),
    tolerated=parts.Tolerated({"radius": 0.1}, {"radius": 0.05}, {"radius": 0.11}, 1.1, "PZT"),
    left_out=(LeftOut("heat", "signal", 1.0, 0.5, "K", 2.0, 40.0, "heat is 2 times the signal", "Heat is it."),),
    categories=(PZT, FLAT),
    choices=(parts.Choice("PZT", 1.0, True), parts.Choice("PVDF", 2.0, False)),
    pictures=xr.Dataset({"map_objective": (("map_x", "map_y"), np.eye(2))}),
)


def test_a_file_holds_all_of_an_answer(tmp_path: Path) -> None:
    write_whole(netcdf.entire(ANSWER), tmp_path / "mine.nc")
    stored = netcdf.read(tmp_path / "mine.nc")
    assert stored.terms[1] == LIMIT
    assert stored.terms[0].statement == GOAL.statement
    assert np.isnan(stored.terms[0].limit)
    assert replace(stored, terms=()) == replace(ANSWER, terms=())
    np.testing.assert_array_equal(stored.pictures["map_objective"], np.eye(2))
    data = read_whole(tmp_path / "mine.nc")
    assert data.attrs["goal"] == "minimise abs(voltage) / load"
    assert data["edge"].values.tolist() == ["upper end of the range asked for", ""]
    whole = netcdf.together([data, data.assign_coords(target="other")])
    assert whole["target"].values.tolist() == ["mine", "other"]
    assert whole["feasible"].values.all()


def test_tables_hold_the_numbers() -> None:
    content = json.loads(table.as_json(ANSWER))
    assert content["factors"]["radius"] == {"value": 0.1, "role": "variable", "units": "m", "tolerance": "5 %"}
    assert content["terms"][LIMIT.name]["margin"] == 0.05
    assert content["terms"][GOAL.name]["limit"] is None
    assert content["categories"] == {"material": {"value": "PZT", "role": "variable"},
                                  "profile": {"value": "flat", "role": "given"}}  # fmt: skip
    rows = {row[2]: row for row in csv.reader(io.StringIO(table.as_csv([ANSWER])))}
    assert rows["radius"] == ["mine", "variable", "radius", "m", "", "", "0.1", "", "", ""]
    assert rows[LIMIT.name][-1] == "0"
    lines = table.as_text(ANSWER).splitlines()
    assert lines[0] == "minimise abs(voltage) / load"
    assert any(line.split() == ["radius", "100", "mm", "variable,", "within", "5", "%"] for line in lines)
    assert any(line.split()[:2] == ["PVDF", "2"] and line.endswith("infeasible") for line in lines)
    plain = table.as_text(ANSWER, si=True).splitlines()
    assert any(line.split() == ["radius", "0.1", "m", "variable,", "within", "5", "%"] for line in plain)


def design(
    exact: list[float],
    limits: list[float],
    elasticity: list[list[float]],
    ends: tuple[parts.End | None, parts.End | None] = (None, None),
    *,
    maximise: bool = True,
    matters: tuple[bool, bool] = (True, True),
) -> parts.Answer:
    """A design of radius and load with stroke_per_volt for its goal, trailing_tension and peak_pressure limited."""
    goal = statements.objective("stroke_per_volt", maximise=maximise)
    terms = [replace(GOAL, statement=goal, exact=exact[0], units="m V-1", effect=(), spread=np.nan)]
    stated = ["trailing_tension <= 50 MPa", "peak_pressure <= 500 MPa"]
    for text, value, limit in zip(stated, exact[1:], limits, strict=False):
        room = (limit - value) / limit
        bounded = replace(LIMIT, statement=statements.limit(text), exact=value, limit=limit, margin=room, bound="")
        terms.append(replace(bounded, source="", effect=(), spread=np.nan))
    rows = zip(("radius", "load"), (0.2, 1e4), elasticity, matters, ends, strict=True)
    variables = [
        parts.Variable(name, value, parts.Role.VARIABLE, parts.Sensitivity(tuple(slopes), matters=matter), edge=end)
        for name, value, slopes, matter, end in rows
    ]
    return parts.Answer(tuple(terms), tuple(variables))


def test_a_limit_or_nothing_stops_a_recommended_design() -> None:
    held = words.verdict(design([1e-9, 50e6, 1e6], [50e6, 500e6], [[1.0, 1, 0], [2, 2, 0]]))
    assert str(held) == "Recommended: limited by tension behind the contact of 50 MPa."
    free = words.verdict(design([1e-9, 5e6, 1e6], [50e6, 500e6], [[0.0, 1, 0], [0, 2, 0]], matters=(False, True)))
    assert str(free).startswith("Recommended: ")
    assert "radius" in free.without_effect
    assert words.spread(design([1e-9, 5e6, 1e6], [50e6, 500e6], [[0.0, 1, 0], [0, 2, 0]])) == ""  # no constants


@pytest.mark.parametrize(("farther", "goal"), [(2.0, 1e-9), (3.0, 1e-9), (2.0, -1e-9)])
def test_an_end_is_worth_its_multiplier(farther: float, goal: float) -> None:
    """R^n P under R P <= constant, R at its upper end: P follows R, so that the goal grows as R^(n-1)."""
    answer = design([goal, 50e6], [50e6], [[farther, 1.0], [1.0, 1.0]], (parts.End.UPPER, None), maximise=goal > 0)
    judged = words.verdict(answer)
    assert judged.kind == words.AT_EDGE
    weights = multipliers.multipliers(answer, answer.limits, answer.at_ends)
    assert weights == pytest.approx({"radius": farther - 1})
    assert "200 mm" in judged.stops
    assert "tension behind the contact of 50 MPa" in judged.stops
    assert judged.advice == f"To first order, radius 220 mm would gain {10 * (farther - 1):g} %."


def test_an_end_beyond_which_nothing_is_gained_does_not_stop_a_design() -> None:
    upper = parts.End.UPPER
    judged = words.verdict(design([1e-9, 5e6], [50e6], [[1e-5, 1.0], [1.0, 1.0]], (upper, upper)))
    assert judged.kind == words.AT_EDGE
    assert "10 kN/m" in judged.stops
    assert judged.advice == "To first order, load 11 kN/m would gain 10 %."
    assert "radius (200 mm" in judged.without_effect
    alone = words.verdict(design([1e-9, 50e6], [50e6], [[1e-5, 0.0], [1.0, 1.0]], (upper, None)))
    assert alone.kind == words.RECOMMENDED
    unexplained = design([1e-9, 5e6], [50e6], [[1.0, 1.0], [1.0, 1.0]], (upper, None))
    assert multipliers.multipliers(unexplained, [], unexplained.at_ends) == {}
    assert words.verdict(unexplained).advice == "A wider range may allow a better design."  # promises no number


@pytest.mark.parametrize("matters", [True, False])  # to the goal, which is not what is missed
def test_a_miss_says_by_how_much_and_what_would_help(matters: bool) -> None:
    ends = (parts.End.UPPER, None)
    answer = design([1e-9, 91.751e6], [50e6], [[1.0, -0.5], [1.0, 1.0]], ends, matters=(matters, True))
    judged = words.verdict(answer)
    assert judged.kind == words.UNREACHABLE
    for number in ("91.8 MPa", "50 MPa", "83.5 %"):
        assert number in judged.stops
    for number in ("91.8 MPa", "radius 220 mm", "5 %"):
        assert number in judged.advice


def test_a_limit_of_the_material_is_named_with_its_source_and_linear_theory_comes_first() -> None:
    answer = design([1e-9, 25e6, 1e6], [25e6, 500e6], [[1.0, 1, 0], [2, 2, 0]])
    statement = statements.limit("trailing_tension <= 0.5 tensile_strength")
    limit = replace(answer.terms[1], statement=statement, bound="tensile strength of PZT", source="a table")
    answer = replace(answer, terms=(answer.terms[0], limit), beyond="nominal field of 2 kV/mm exceeds it (a book)")
    judged = words.verdict(answer)
    assert judged.kind == "beyond linear theory; otherwise recommended"
    assert judged.stops == "limited by tension behind the contact of 25 MPa (50 % of the tensile strength of PZT)."
    assert judged.beyond == "Nominal field of 2 kV/mm exceeds it (a book)."
    assert judged.sources == "Tensile strength of PZT: a table (unverified: no dated source)."
    assert str(judged).startswith("Beyond linear theory; otherwise recommended: limited by")


STEEL = {"profile": "sphere", "radius": 0.02, "force": 0.2, "punch": "steel"}
WEDGE = {"material": "PZT-4", "profile": "wedge", "slope": 0.01, "load": 1e3}
AMPLIFIER = {"input_capacitance": 1e-11, "feedback_capacitance": 1e-11, "feedback_resistance": 1e13}
BALL = STEEL | {"material": "PZT-4", "thickness": 80e-6, "base": "steel", "magnetic": "insulating"}


def of_pzt(name: str) -> Allowable:
    return Allowable({"depoling_stress": 83e6, "coercive_field": 1e6}[name], "PZT-4", "a table")


def effects(
    case: Mapping[str, Any],
    solved: Mapping[str, float] | Callable[[Mapping[str, Any]], xr.Dataset] | None = None,
    device: Mapping[str, float] = MappingProxyType({}),
    *,
    smallest_force: float = np.nan,
    band: float = np.nan,
) -> dict[str, LeftOut]:
    """The budget by name, of quantities that are given or solved."""

    def answer(factors: Mapping[str, Any]) -> xr.Dataset:
        if solved is None:
            return solve(factors)
        if callable(solved):
            return solved(factors)
        frictionless = {"trailing_tension": 0.0} if factors.get("friction") == 0.0 else {}
        return xr.Dataset({**solved, **frictionless})

    kind = kind_of([*case], case.get("profile", "cylinder"), case.get("surroundings") or around(case))
    whole = SolvedCase(kind, case, answer, of_pzt, device, smallest_force, band=band)
    return {effect.left_out: effect for effect in leftout.budget(whole)}


POINT = {"contact_radius": 4e-5, "peak_pressure": 60e6, "charge_per_force": -2e-10, "contact_stiffness": 5e6}
LINE = {"contact_trailing": 2e-4, "contact_leading": 2e-4, "trailing_tension": 3e7}
ROLLER = {"radius": 0.05, "load": 1e4, "punch": "rigid", "friction": 0.2}
ENDS = {"contact_length_x": 2e-4, "contact_length_y": 2e-3, "peak_pressure": 60e6, "charge_per_force": -2e-10}
SPACE = {"profile": "roller", "radius": 0.01, "length": 2e-3, "force": 1.0}
ROUGH = {"profile": "rough_sphere", "longest_wavelength": 1e-4, "roughness": 1e-8}


@pytest.mark.parametrize(
    ("name", "case", "solved", "size", "matters", "share"),
    [
        ("small strain", {}, POINT, 4e-5 / 0.02, 0.2, 4e-6),  # the circle's next term, (a/R)^2
        # Johnson (1985) 13.2: p* = 2 pi E* sigma/a with Hertz's E* = p0 pi R/2a = 47.124 GPa: 74.02 MPa of 60 MPa
        ("roughness", {}, POINT, 1e-8, 8.1057e-9, 1.23370),
        # no wave of 2 nm is 10 nm high: 20 pm, p*/p0 = 4.9348, crests apart: (24/pi 24.352)^(1/3) - 1
        ("roughness", {"radius": 1e-7}, POINT | {"contact_radius": 2e-9}, 2e-11, 4.0528e-12, 4.70866),
        # E* = 2 R p0/a = 5 p0/0.01, so p*/p0 = 4 pi 1e-8 0.05/4e-8
        ("roughness", ROLLER, LINE, 1e-8, 6.3662e-8, 0.157080),
        # rise 0.4 um, an end of 10 mm lifts at 80 urad: (2 (100/80)^(1/2))^(1/2) - 1
        ("tilt", ROLLER, LINE, 1e-4, 3.2e-4, 0.495349),
        # both ends press where the radius is 10 mm: 100 of 400 urad, (1 + 1/4)^(1/2) - 1
        ("tilt", ROLLER | {"radius": 0.01}, LINE, 1e-4, 1.6e-3, 0.118034),
        # the 4 mN beside 20: Tabor's number is 46, so (1 + 0.400553 + 2 (0.200277 + 0.040111)^(1/2))^(1/3) - 1
        ("adhesion", {"radius": 0.017, "force": 0.02}, POINT, 4.00553e-3, 0.02, 0.335376),
        # Tabor's number is 0.01: 2 pi w R, and (1 + 0.0314159)^(1/3) - 1
        ("adhesion", {"radius": 1e-8, "force": 1e-7}, {"contact_radius": 1e-9}, 3.14159e-9, 1e-7, 0.0103645),
        # docs/limits.md has three digits of these: 2.31 and 25.2 %
        ("adhesion", {"radius": 5e-3, "force": 1.0}, POINT, 1.17810e-3, 1.0, 2.31415e-2),
        ("adhesion", {"radius": 5e-3, "force": 10e-3}, POINT, 1.17810e-3, 0.01, 25.1763e-2),
        ("mass of the punch", {"radius": 0.017}, POINT, 1.5747, 0.2, 7.8735),  # the 1.57 N
        ("mass of the punch", ROLLER, LINE, 6.0097, 100.0, 0.060097),
        # the 1 pA through 10 TOhm, 10 V (1 - exp(-t/100 s)), beside 40 pC in 10 pF
        ("amplifier", {}, POINT, 0.0995017, 4.0, 0.0248754),
        ("amplifier", {"hold": 10.0}, POINT, 0.951626, 4.0, 0.237906),
        # 4 pi sigma R/a^2 with half of the width; 7.8 g/cm3 of pi 1 cm^2 0.2 cm, and of a ball of 1 cm
        ("roughness", SPACE, ENDS, 1e-8, 7.9577e-8, 0.125664),
        ("mass of the punch", SPACE, ENDS, 4.80767e-2, 1.0, 4.80767e-2),
        ("mass of the punch", SPACE | ROUGH, ENDS, 0.320521, 1.0, 0.320521),
        ("friction", ROLLER, LINE, 3e7, np.nan, np.nan),
        ("depoling stress", {}, POINT, 60e6, 83e6, np.nan),
        ("spark beside the contact", {}, POINT | {"gap_field": 1.3e8}, 1.3e8, 65e6, np.nan),
    ],
)
def test_each_formula_gives_a_figure_by_hand(
    name: str, case: dict[str, Any], solved: dict[str, float], size: float, matters: float, share: float
) -> None:
    whole = case if solved is LINE else STEEL | case
    budget = effects(whole, solved, device=AMPLIFIER, band=0.1)
    effect = budget[name]
    assert effect.left_out_size == pytest.approx(size, rel=1e-4)  # five digits by hand
    assert effect.left_out_matters == pytest.approx(matters, rel=1e-4, nan_ok=True)
    assert effect.left_out_share == pytest.approx(share, rel=1e-4, nan_ok=True)
    assert effect.left_out_ratio == pytest.approx(share / 0.1, rel=1e-4, nan_ok=True)
    ratios = [effect.left_out_ratio for effect in budget.values() if np.isfinite(effect.left_out_ratio)]
    assert ratios == sorted(ratios, reverse=True)


def test_words_say_how_long_and_how_much() -> None:
    budget = effects(STEEL | {"hold": 10.0}, POINT, AMPLIFIER, smallest_force=5e-6)
    assert budget["amplifier"].left_out_words == (
        "The bias current adds 24 % of the signal in 10 s; 1 pA adds 950 mV where the signal is 4 V, and 10 V in the "
        "end (time constant 100 s); its charge equals that of the smallest force after 1 ms."
    )


def test_adhesion_moves_a_films_charge_as_a_wider_contact_does() -> None:
    def answer(case: Mapping[str, Any]) -> xr.Dataset:  # falls with the radius, a^3 with the force
        return xr.Dataset(POINT | {"charge_per_force": -2e-10 * (0.02 / case["force"]) ** (1 / 3)})

    film = effects(BALL | {"radius": 0.017, "force": 0.02}, answer)["adhesion"]
    assert film.left_out_share == pytest.approx(0.335376 / 1.335376, rel=1e-4)  # the widening by hand, above
    assert film.left_out_words.startswith("Adhesion widens the contact by 34 % and changes the charge by 25 %; ")


def test_heat_says_when_it_is_the_share_that_the_case_names() -> None:
    case = BALL | {"surroundings": "insulated", "touch_temperature": 303.15, "hold": 1.0, "heat_share": 0.1}
    reached = shown(float(solve(case)["heat_time"]), "s", 2)
    assert f" for 10 K in 1 s, 10 % of it after {reached}" in effects(case)["heat"].left_out_words


def test_a_weight_above_a_tenth_of_the_force_presses_too() -> None:
    def answer(factors: Mapping[str, Any]) -> xr.Dataset:
        heavier = {"peak_pressure": 90e6, "contact_stiffness": 8e6}
        return xr.Dataset(POINT | (heavier if factors["force"] > 0.2 else {}))

    balls = (STEEL | {"radius": radius} for radius in (0.02, 0.003))
    heavy, light = (effects(ball, answer)["mass of the punch"].left_out_words for ball in balls)
    # 4 pi/3 (20 mm)^3 of 7.8 g/cm3: 261 g on 8 N/um
    assert heavy == (
        "The punch's weight is 13 times the force; solid steel weighs 2.56 N beside 200 mN and rings at 880 Hz; with "
        "its weight the contact pressure exceeds the depoling stress."
    )
    assert light.endswith("weighs 8.65 mN beside 200 mN and rings at 12 kHz.")


@pytest.mark.parametrize("contact", ["point", "line"])
def test_the_amplifier_holds_the_electrode_where_fields_are_read(contact: str) -> None:
    """A charge amplifier leaves no voltage, an input shares it with the contact, without one all of it is left."""
    film = {"material": "PZT-4", "punch": "steel", "thickness": 20e-6, "base": "steel", "magnetic": "insulating"}
    punch = {"radius": 0.02, "surroundings": "air"}
    punch |= {"profile": "sphere", "force": 0.2} if contact == "point" else {"load": 1e3}
    case, length = film | punch, 0.01
    kind = kind_of([*case], str(punch.get("profile", "cylinder")), "air")
    exact = {name: float(value) for name, value in solve(case).data_vars.items() if value.size == 1}
    capacitance = exact["capacitance_at_force" if contact == "point" else "capacitance_at_load"]
    capacitance *= 1 if contact == "point" else length
    for device, left in (
        ({}, 1.0),
        ({"input_capacitance": capacitance, "cable_capacitance": capacitance}, 1 / 3),
        ({"input_capacitance": 1e-11, "feedback_capacitance": 1e-11}, 0.0),
    ):
        device |= {"electrode_length": length}
        solved, circuit = SolvedCase(kind, case, solve, of_pzt, device).read_out
        # the capacitance of a held contact differs by a few percent from that of the contact which the voltage widens
        assert solved["voltage"] == pytest.approx(left * exact["voltage"], rel=0.02, abs=1e-6 * abs(exact["voltage"]))
        budget = effects(case, device=device)
        assert budget["spark beside the contact"].left_out_words.startswith(circuit.capitalize())
        assert budget["spark beside the contact"].left_out_size == pytest.approx(solved["gap_field"])
        assert ("coercive field" in budget) == (left > 0)
        if left:
            assert budget["coercive field"].left_out_size == pytest.approx(abs(solved["voltage"]) / 20e-6)


def in_space(body: surface.SurfaceBody, shape: Any, force: float) -> Any:
    """The contact of a punch's shape in space, at zero volts and without air."""
    return solve_contact(body, shape, force=force, voltage=0.0, air=None, cells=48)


def roughened(body: surface.SurfaceBody, radius: float, force: float, rms: float) -> tuple[Any, float, list[Any]]:
    """The contact of a smooth ball, its radius, and those of five random surfaces of the ball."""
    smooth = in_space(body, sphere(radius), force)
    half = float(np.sqrt(smooth.area / np.pi))
    waves = [RoughSphere(radius, rms, 2 * half, half / 2, number) for number in range(5)]
    return smooth, half, [in_space(body, shape, force) for shape in waves]


@pytest.mark.parametrize(("radius", "force"), [(5e-3, 1.0), (20e-3, 0.02)])  # crests flattened, and apart
def test_roughness_raises_the_pressure_as_five_random_surfaces_do_on_average(radius: float, force: float) -> None:
    body = surface.SurfaceBody((), find("PZT-4").stiffness_tensor())
    smooth, half, rough = roughened(body, radius, force, 1e-8)
    rule = effects({"profile": "sphere", "radius": radius, "force": force}, {"contact_radius": half})["roughness"]
    raised = np.mean([contact.peak_pressure for contact in rough]) / smooth.peak_pressure
    assert raised == pytest.approx(1 + rule.left_out_share, rel=0.1)


def test_roughness_moves_the_charge_of_a_film_by_less_than_is_said() -> None:
    film = surface.SurfaceLayer(find("PVDF").stiffness_tensor(), 6.3e-6, grounded=True)
    radius, rms = 20e-3, 2e-8
    smooth, half, rough = roughened(surface.SurfaceBody((film,)), radius, 10e-3, rms)
    assert half / film.thickness == pytest.approx(5, rel=0.05)
    moved = [contact.charge / smooth.charge - 1 for contact in rough]
    most = leftout._CHARGE_MOVES * 2 * radius * rms / half**2
    assert 0.8 * most < max(moved) < 1.05 * most  # the second surface is the one that set it, on a grid of 64
    assert min(moved) > 0


@pytest.mark.parametrize(
    ("thickness", "load", "tilt", "near"),
    # a half-space's slices lean on each other, a thin film's hardly do
    [(np.inf, 5e3, 1e-4, 1 / 6), (20e-6, 1e5, 5e-4, 0.03)],
)
def test_a_tilted_roller_is_that_in_space(
    thickness: float, load: float, tilt: float, near: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two half widths from the sharp end, where the pressure has no bound; there it has fallen by the rule as well."""
    monkeypatch.setattr(leftout, "TILT", tilt)
    radius, length, is_film = 20e-3, 5e-3, np.isfinite(thickness)
    stiffness = find("PZT-4").stiffness_tensor()
    film = surface.SurfaceBody((surface.SurfaceLayer(stiffness, thickness, grounded=True),)) if is_film else None
    body = film or surface.SurfaceBody((), stiffness)
    plane, tilted = (in_space(body, Roller(radius, length, tilt=slope), load * length) for slope in (0.0, tilt))
    middle = plane.y.size // 2
    half = float(plane.weight[:, middle].sum() * (plane.x[1] - plane.x[0]) / 2)
    away = np.abs(tilted.y) < length / 2 - 2 * half
    raised = float(tilted.pressure[:, away].max() / plane.pressure[:, middle].max())

    case = {"material": "PZT-4", "magnetic": "insulating", "radius": radius, "load": load}
    case |= {"thickness": thickness, "base": "rigid"} if is_film else {}
    contact = None if is_film else LINE | {"contact_trailing": half, "contact_leading": half}
    rule = effects(case, contact, {"electrode_length": length})["tilt"]
    power = 1.0 if is_film else 0.5
    deepest, falls = (1 + rule.left_out_share) ** (1 / power), 2 * tilt * length * radius / half**2
    assert raised == pytest.approx((deepest - falls * 2 * half / length) ** power, rel=near)
    least = float(rule.left_out_words.split("at least ")[1].split(" %")[0]) / 100  # 38 %, where 79 % are in contact
    assert tilted.lengths[1] / length > least - 0.02
    if is_film:
        assert tilted.lengths[1] / length == pytest.approx(least, abs=0.02)


@pytest.mark.parametrize(("material", "load", "air"), [("BaTiO3", 5e5, "insulated"), ("PZT-4", 1e5, "air")])
def test_the_ends_of_a_roller_in_space_add_at_most_what_is_said(material: str, load: float, air: str) -> None:
    length = 6e-3
    line = {"material": material, "thickness": 0.2e-3, "base": "steel", "radius": 0.3, "punch": "steel"}
    line |= {"magnetic": "insulating", "surroundings": air}
    roller = {"profile": "roller", "length": length, "force": load * length, "grid_error": 0.01}
    plane, space = (float(solve(line | press)["charge_per_force"].squeeze()) for press in ({"load": load}, roller))
    words = effects(line | {"load": load}, device={"electrode_length": length})["tilt"].left_out_words
    most = float(words.split("both ends add at most ")[1].split(" %")[0])
    assert most / 2.5 < 100 * (space / plane - 1) < most


def test_a_ball_on_a_film_has_the_figures_of_its_page() -> None:
    budget = effects(BALL, device=AMPLIFIER, smallest_force=5e-6)
    assert 1 + budget["roughness"].left_out_share == pytest.approx(2.7, rel=0.1)  # of another grid, its waves unknown
    heat = budget["heat"]
    exact = solve(BALL | {"touch_temperature": 294.15, "hold": 1.0})
    assert heat.left_out_matters == pytest.approx(float(exact["temperature_equal"]))
    assert heat.left_out_share == pytest.approx(1 / heat.left_out_matters)
    assert "85 µK the smallest force" in heat.left_out_words
    # 40.0 pC times 5 uN/0.2 N over 14.625 pF times 539 uC/m2/K 80 um/7.603 nF/m (docs/heat.md)
    assert heat.left_out_words.endswith("; of the whole body 12 µK equal the smallest force.")
    assert next(iter(budget)) == "mass of the punch"  # what the verdict names stands first, then exceeded limits
    assert [*budget].index("spark beside the contact") == sum(e.left_out_ratio > 3 for e in budget.values())


def test_the_quickstarts_ball_is_recommended_with_room(quickstart_run: Project) -> None:
    answer = netcdf.read(quickstart_run.folder / "results/ball/design/ball.nc")
    assert words.verdict(answer).kind == "recommended"
    ratios = [effect.left_out_ratio for effect in answer.left_out if np.isfinite(effect.left_out_ratio)]
    assert max(ratios) < leftout.MOST * 3 / 4
    assert {effect.left_out for effect in answer.left_out} > {"heat", "amplifier", "roughness", "mass of the punch"}
    # of what is sold, the one with the smallest force at the largest ball's pressure by the exact solver
    ball = {"material": "PVDF", "profile": "sphere", "punch": "steel", "base": "steel", "magnetic": "insulating"}
    films = [28e-6, 52e-6, 110e-6]

    def least_radius(thickness: float) -> float:
        def excess(radius: float) -> float:  # at the corner with the largest pressure, a thin film under a small ball
            case = ball | {"thickness": 0.95 * thickness, "radius": 0.95 * radius, "force": 1.0}
            return float(solve(case)["peak_pressure"]) / 45e6 - 1

        return float(brentq(excess, 1e-3, 0.02, rtol=1e-6))

    radii = [least_radius(thickness) for thickness in films]
    cases = [ball | {"thickness": t, "radius": r, "force": 0.2} for t, r in zip(films, radii, strict=True)]
    best = int(np.argmax([abs(float(solve(case)["charge_per_force"])) for case in cases]))
    chosen = {variable.name: variable.value for variable in answer.variables}
    assert chosen["thickness"] == films[best]
    assert chosen["radius"] == pytest.approx(radii[best], rel=1e-4)


def test_a_change_everywhere_charges_an_electrode_without_end_without_limit() -> None:
    read = BALL | {"electrode": "top", "collector": 2, "surroundings": "insulated"}
    assert "of the whole body" not in effects(read)["heat"].left_out_words
    # 539 uC/m2/K over a disc of 1 mm: the pad's own area
    pad = effects(read | {"patch_size": 1e-3})["heat"]
    kelvin = abs(float(solve(read | {"patch_size": 1e-3})["patch_charge_per_force"])) * 0.2 / (539e-6 * np.pi * 0.25e-6)
    assert f"; of the whole body {shown(kelvin, 'K', 2)} equal the signal." in pad.left_out_words


def test_a_base_that_bends_and_a_pad_that_ends() -> None:
    # e31 - e33 c13/c33 of PZT-4 is -14.956 C/m2, steel has 200 GPa and 0.3; the ball's 36.175 um and 40 pC
    half, radius, film = 36.175e-6, 0.02, 93.16e-9  # film: 80 um eps0/(7.603 nF/m)

    def moments(r: float) -> float:  # of 0.2 N over the distance, times the circumference
        return float(0.2 * r / 2 * (2.6 * np.log(0.01 / r) + 0.7))

    def collected(r: float) -> float:
        root = np.sqrt(r**2 / half**2 - 1)
        gap = half**2 / (np.pi * radius) * (root + (r**2 / half**2 - 2) * np.arccos(half / r))
        return float(film / (film + gap))

    rings = ((half, 1e-4), (1e-4, 1e-3), (1e-3, 0.01))
    whole = quad(moments, 0, half)[0] + sum(quad(lambda r: moments(r) * collected(r), *ring)[0] for ring in rings)
    thickness = np.sqrt(14.956 * 6 * 0.7 / 200e9 * whole / 4e-12)  # 1.1 mm
    assert effects(BALL)["bending of the base"].left_out_size == pytest.approx(thickness, rel=2e-3)
    pad = {"material": "AlN", "profile": "sphere", "radius": 1e-3, "thickness": 1e-6, "base": "silicon", "force": 0.01}
    ends = effects(pad | {"electrode": "top", "collector": 2, "surroundings": "insulated"})["end of the pad"]
    assert ends.left_out_share == pytest.approx(1 - 0.23 / 0.26, abs=0.03)  # docs/electrodes.md, two digits
    assert ends.left_out_size == pytest.approx(10e-3 * ends.left_out_share, rel=1e-12)


def test_signals_are_judged_at_the_smallest_force_and_stresses_at_the_largest() -> None:
    ball, radii = {"profile": "sphere", "radius": 0.02, "punch": "steel"}, {0.02: 2e-5, 0.2: 4e-5}
    kind = kind_of([*ball, "force"], "sphere", "insulated")

    def answer(case: Mapping[str, Any]) -> xr.Dataset:
        return xr.Dataset(POINT | {"contact_radius": radii.get(case["force"], np.nan)})

    least, most = (SolvedCase(kind, ball | {"force": force}, answer, of_pzt, {}) for force in radii)
    budget = {effect.left_out: effect for effect in leftout.budget(least, most)}
    assert budget["adhesion"].left_out_matters == 0.02
    assert budget["roughness"].left_out_matters == pytest.approx(8.1057e-9, rel=1e-4)


FILM = {"material": "PZT-4", "thickness": 1e-4, "base": "steel", "punch": "steel"}


@pytest.mark.parametrize(
    ("name", "case", "solved", "said"),
    [
        ("heat", BALL | {"base": "rigid"}, None, "Heat is not known for the base 'rigid': conductivity"),
        ("heat", STEEL | {"material": "PZT-4"}, None, "Heat is solved for films only."),
        ("heat", FILM | SPACE, ENDS, "Heat is not solved for contacts in space."),
        ("tilt", FILM | SPACE, ENDS, "Tilt and ends of the roller are solved."),
        ("tilt", WEDGE, None, "Tilt is not figured for the profile wedge."),
        ("adhesion", FILM | SPACE, ENDS, "Adhesion is not figured for the profile roller."),
        ("bending of the base", FILM | SPACE, ENDS, "Bending of the base is not figured for the profile roller."),
        ("roughness", FILM | SPACE | ROUGH, ENDS, "Roughness is solved."),
        ("mass of the punch", WEDGE, None, "Mass of the punch is not figured for the profile wedge."),
    ],
)
def test_the_unknown_is_named(name: str, case: dict[str, Any], solved: dict[str, float] | None, said: str) -> None:
    effect = effects(case, solved)[name]
    assert np.isnan(effect.left_out_share)
    assert effect.left_out_words.startswith(said)


def test_a_cover_without_charge_has_no_effect_on_a_signal() -> None:
    soft = {"material": "PDMS", "radius": 0.01, "punch": "skin", "thickness": 3e-3, "force": 0.02}
    assert not {"heat", "bending of the base", "spark beside the contact"} & {*effects(BALL | soft)}


@pytest.mark.parametrize(
    ("goal", "moves", "ratio", "kind"),
    [
        ("abs(charge_per_force)", "signal", 3.1, "recommended within the model; heat is 35 times the signal"),
        ("abs(charge_per_force)", "signal", 2.9, "recommended"),
        ("abs(charge_per_force)", "stress", 40.0, "recommended within the model; heat is 35 times the signal"),
        ("abs(stroke_per_volt)", "signal", 40.0, "recommended"),  # nobody reads a charge
        ("smallest_force", "signal, stress", 40.0, "recommended within the model; heat is 35 times the signal"),
        ("abs(charge_per_force)", "", np.nan, "recommended"),
    ],
)
def test_a_recommendation_needs_effects_within_their_band(goal: str, moves: str, ratio: float, kind: str) -> None:
    objective = replace(ANSWER.terms[0], statement=statements.objective(goal, maximise=True))
    effect = LeftOut("heat", moves, 1.0, 1.0, "K", ratio / 20, ratio, "heat is 35 times the signal", "It is.")
    limited = replace(ANSWER.terms[1], margin=0.5)
    inside = tuple(replace(variable, edge=None) for variable in ANSWER.variables)
    answer = replace(ANSWER, terms=(objective, limited), variables=inside, beyond="", left_out=(effect,))
    assert words.verdict(answer).kind == kind
    assert words.verdict(replace(answer, beyond="a stress")).kind == f"beyond linear theory; otherwise {kind}"
    effect_words = kind.removeprefix("recommended").removeprefix(" within the model")
    ended = replace(answer, variables=tuple(replace(variable, edge=parts.End.UPPER) for variable in inside))
    assert words.verdict(ended).kind == words.AT_EDGE + effect_words
    missed = replace(answer, terms=(objective, replace(limited, margin=-0.5)))
    assert words.verdict(missed).kind == words.UNREACHABLE  # claims nothing that an effect could take back
