"""The calculator's scripts agree with the solver: every material, profile and film."""

import json
import subprocess
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
import xarray as xr

import solver
from solver import Material
from solver.material.library import materials
from solver.material.punches import find_punch
from tests import programs
from workflow.calculator import films
from workflow.calculator.page import library, script

pytestmark = pytest.mark.needs("node")

LIBRARY = library()
AXIAL = [material for material in materials().values() if material.axial]
EVERY = [variant for material in AXIAL for variant in (material, *material.variants())]
LINES: list[dict[str, Any]] = [
    {"profile": profile, **size, "load": 1e4, "datum": 0.7, "friction": friction, "charge": 3e-9}
    for profile, size in (("cylinder", {"radius": 0.05}), ("flat", {"width": 1e-3}), ("wedge", {"slope": 0.01}))
    for friction in (0.0, 0.3)
]
POINTS: list[dict[str, Any]] = [
    {"profile": "sphere", "radius": 5e-3, "force": 10.0, "total_charge": 4e-12},
    {"profile": "cone", "slope": 0.05, "force": 10.0, "total_charge": 4e-12},
    {"profile": "disc", "width": 1e-3, "force": 10.0, "total_charge": 4e-12},
]
CASES: list[dict[str, Any]] = [
    case | punch | ({"electric": "insulating", **dict.fromkeys(CHARGES & case.keys(), 0.0)} if insulates else {})
    for CHARGES in [{"charge", "total_charge"}]
    for case in LINES + POINTS
    for punch, insulates in (({}, False), ({"punch": "steel"}, False), ({"punch": "steel"}, True))
]
#: Of a film, whose tables know no magnetic field.
MAGNETIC = (
    "magnetic_edge_intensity", "magnetic_potential", "magnetic_potential_per_force", "flux_per_force",
    "stroke_per_ampere", "blocked_force_per_ampere", "permeance",
)  # fmt: skip
DRIVER = """
const told = JSON.parse(require("fs").readFileSync(0, "utf8"));
const { library } = told;
const answered = (found, at) => ({ ...found, at: at && at.map(found.pressure) });
const answers = told.asked.map(({ kind, given, at }) => {
  try {
    if (kind === "line") return answered(solveLine(given, library.digamma), at);
    if (kind === "point") return answered(solvePoint(given), at);
    if (kind === "own") return ownMaterial(given, library);
    if (kind === "alloy") return alloyed(library.alloy, given);
    return quantity(given[0], given[1], library).value;
  } catch (error) { return { refused: error.message }; }
});
console.log(JSON.stringify(answers));
"""


def calculated(questions: list[dict[str, Any]]) -> list[Any]:
    content = json.dumps({"library": LIBRARY, "asked": questions})
    command = [programs.path("node"), "-e", script() + DRIVER]
    done = subprocess.run(command, input=content, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return list(json.loads(done.stdout))


def given(case: dict[str, Any], material: Material) -> dict[str, Any]:
    """A case of the solver as the scripts take it."""
    punch: dict[str, Any] = {name: case[name] for name in ("profile", "radius", "width", "slope") if name in case}
    if case.get("punch", "rigid") != "rigid":
        known = find_punch(case["punch"])
        punch |= {"modulus": known.modulus, "poisson": known.poisson}
    plain = {name: value for name, value in material.plain().items() if isinstance(value, float)}
    return {
        "material": plain,
        "punch": punch,
        "conducts": [case.get("electric") != "insulating", True],
        "charges": [case.get("charge", case.get("total_charge", 0.0)), 0.0],
        **{name: case[name] for name in ("load", "force", "friction", "datum") if name in case},
    }


def compared(answer: dict[str, Any], solved: xr.Dataset) -> Iterator[tuple[str, float]]:
    """Every quantity of a case, and how far the script is off; absolutely where it is nothing."""
    for name in solved.data_vars:
        value = float(solved[name])
        yield str(name), abs(answer[str(name)] / value - 1) if value else abs(answer[str(name)])


@pytest.mark.parametrize("kind", ["line", "point"])
def test_every_material_and_profile_is_the_solver_s(kind: str) -> None:
    cases = [case for case in CASES if ("load" in case) == (kind == "line")]
    questions = [{"kind": kind, "given": given(case, material)} for case in cases for material in EVERY]
    answers = iter(calculated(questions))
    worst: dict[str, float] = {}
    for case in cases:
        names = xr.DataArray(np.array(EVERY, dtype=object), dims="case")
        solved = solver.solve({**case, "material": names})
        if case["profile"] == "disc":  # all its flux is that of its edge: none
            solved = solved.drop_vars("magnetic_edge_intensity")
        for number in range(len(EVERY)):
            for name, off in compared(next(answers), solved.isel(case=number, missing_dims="ignore")):
                worst[name] = max(worst.get(name, 0.0), off)
    assert len(worst) > 15
    assert {name: off for name, off in worst.items() if not off < 1e-12} == {}


def test_stress_beside_a_ball_and_pressures_are_the_solver_s() -> None:
    outside, inside = 1.5, [-0.9, -0.2, 0.7]
    for case in (POINTS[0] | {"punch": "steel"}, LINES[1]):
        kind = "point" if "force" in case else "line"
        (answer,) = calculated([{"kind": kind, "given": given(case, materials()["BaTiO3"]), "at": inside}])
        solved = solver.solve({**case, "material": "BaTiO3"}, [*inside, outside])
        assert answer["at"] == pytest.approx(solved["contact_pressure"].values[:3], rel=1e-12, abs=0)
        if kind == "point":
            stress = float(solved["radial_stress"][3]) * outside**2
            assert answer["edge_tension"] == pytest.approx(stress, rel=1e-12, abs=0)


def test_a_held_voltage_is_that_of_its_charge() -> None:
    for case in (LINES[0], LINES[1], POINTS[0], POINTS[2]):
        material = materials()["PZT-4"]
        kind = "point" if "force" in case else "line"
        held = given(case, material) | {"charges": [0.0, 0.0], "voltage": 25.0}
        (answer,) = calculated([{"kind": kind, "given": held}])
        charge = "total_charge" if kind == "point" else "charge"
        solved = solver.solve({**case, "material": "PZT-4", charge: answer["charge"]})
        assert float(solved["voltage"]) == pytest.approx(25.0, rel=1e-10)
        assert answer["depth"] == pytest.approx(float(solved["depth"]), rel=1e-10, abs=0)
        if kind == "line":  # what a charge adds to the voltage of a contact that keeps its width
            charged = solver.solve({**case, "material": "PZT-4", charge: answer["charge"] + 1e-8})
            risen = float(charged["voltage"] - solved["voltage"])
            assert answer["capacitance"] == pytest.approx(1e-8 / risen, rel=1e-8, abs=0)


SHAPES: list[dict[str, Any]] = [{"profile": "cone", "slope": 0.02}, {"profile": "disc", "width": 3e-6}]


@pytest.mark.sampled(1)
@pytest.mark.parametrize("shape", SHAPES, ids=str)
@pytest.mark.parametrize("name", films.FILMS)
def test_films_are_the_solver_s(name: str, shape: dict[str, Any]) -> None:
    top = films.top_of(films.FILMS[name])
    softness = float(top.c33) / 4e11
    forces = [1e-4 * softness, 1e-1 * softness]
    case: dict[str, Any] = {**shape, "total_charge": 1e-15 * softness}
    cases = [(table, force) for table in films.tables([name]) for force in forces]
    inputs = [given({**case, "force": force, "punch": table["punch"]}, top) for table, force in cases]
    answers = calculated([
        {"kind": "point", "given": known | {"film": table, "thickness": 2e-6}}
        for (table, _), known in zip(cases, inputs, strict=True)
    ])  # fmt: skip
    factors = {**case, **films.FILMS[name], "thickness": 2e-6}
    solved = solver.solve({**factors, "punch": list(films.PUNCHES), "force": forces})
    names = [name for name in solved.data_vars if name in answers[0]]
    assert set(solved.data_vars) - set(names) == {name for name in MAGNETIC if name in solved} | {"nominal_field"}
    for (table, force), answer in zip(cases, answers, strict=True):
        exact = solved[names].sel(punch=table["punch"], force=force)
        assert {name: off for name, off in compared(answer, exact) if not off < 2e-6} == {}


#: Radius over thickness, and force * radius / thickness^3 over c33: narrow, usual and wide contacts.
BALLS = ((3.0, 3e-5), (25.0, 1e-3), (400.0, 3e-2), (3000.0, 2.0), (30.0, 20.0))


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", films.FILMS)
def test_balls_on_films_are_the_solver_s_in_air(name: str) -> None:
    """Compare every figure of the page with the solver at its defaults; three digits are shown: 5e-4."""
    top, thickness = films.top_of(films.FILMS[name]), 2e-6
    table = films.tables([name])[len(name) % len(films.PUNCHES)]
    radius = [ratio * thickness for ratio, _ in BALLS]
    force = [float(top.c33) * load * thickness**3 / size for size, (_, load) in zip(radius, BALLS, strict=True)]
    case = {**films.FILMS[name], "profile": "sphere", "punch": table["punch"], "thickness": thickness}
    rows = {key: xr.DataArray(values, dims="case") for key, values in (("radius", radius), ("force", force))}
    solved = solver.solve(case | rows)
    assert solved["surroundings"] == "air"
    film = {"film": table, "thickness": thickness}
    pairs = zip(radius, force, strict=True)
    questions = [given({**case, "radius": size, "force": pressed}, top) | film for size, pressed in pairs]
    answers = calculated([{"kind": "point", "given": inputs, "at": [0.0]} for inputs in questions])
    for number, answer in enumerate(answers):
        exact = solved.isel(case=number)
        shown = [key for key in exact.data_vars if key in answer]
        assert len(shown) == 9
        assert {key: off for key, off in compared(answer, exact[shown]) if not off < 5e-4} == {}
        assert answer["at"][0] == pytest.approx(answer["peak_pressure"], rel=0.05)


def test_other_constants_of_a_film_are_the_solver_s() -> None:
    """Compare to four fifths of the least band that the page shows: 2e-3 of balls in air, 5e-4 of cones."""
    name = "PVDF on glass"
    (table,) = (candidate for candidate in films.tables([name]) if candidate["punch"] == "steel")
    case: dict[str, Any] = {"force": 1e-3, "punch": "steel", "thickness": 2e-6}
    pairs = list(films.variants(films.FILMS[name]))[1:]
    assert {f"{top.name} on {base.name}" for top, base in pairs} == {
        words for k in (1, 2) for words in (f"PVDF (alternative {k}) on glass", f"PVDF on glass (alternative {k})")
    }
    for shape, room in (({"profile": "sphere", "radius": 1e-3}, 1.6e-3), (SHAPES[0], 4e-4)):
        questions = [
            {"kind": "point", "given": given(case | shape, top) | {"film": table | candidate, "thickness": 2e-6}}
            for (top, _), candidate in zip(pairs, table["variants"], strict=True)
        ]
        for (top, base), answer in zip(pairs, calculated(questions), strict=True):
            solved = solver.solve(case | shape | {"material": top, "base": base})
            names = [key for key in solved.data_vars if key in answer]
            assert len(names) > 8
            assert {key: off for key, off in compared(answer, solved[names]) if not off < room} == {}


def test_the_alloy_is_the_solver_s() -> None:
    fractions = (0.0, 0.13, 0.5)
    for x, answer in zip(fractions, calculated([{"kind": "alloy", "given": x} for x in fractions]), strict=True):
        factors = {"composite": "AlScN", "scandium_fraction": x}
        for name, value in films.top_of(factors).plain().items():
            if isinstance(value, float):
                assert answer[name] == pytest.approx(value, rel=1e-14, abs=0)


TOML = """["mine"]
c11 = 126e9 # soft
c12 = 79.5e9
c13 = 84.1 GPa
c33 = "117 GPa"
c44 = 23_000_000_000
e33 = 23.3 C/m2
"""
MORE = "limits:\n  depoling_stress: {value: 10 MPa, source: x}\nalternatives:\n  - {c11: 1}\n"
JSON = '{"name": "soft", "c11": 126e9, "c12": 79.5e9, "c13": "84.1 GPa", "c33": 117e9, "c44": 23e9, "e33": 23.3}'


def test_own_constants_are_read_as_text() -> None:
    wanted = {"c11": 126e9, "c12": 79.5e9, "c13": 84.1e9, "c33": 117e9, "c44": 23e9, "e33": 23.3, "e15": 0.0}
    texts = {TOML: "mine", TOML.replace(" = ", ": ") + MORE: "mine", JSON: "soft"}
    answers = calculated([{"kind": "own", "given": text} for text in texts])
    for answer, name in zip(answers, texts.values(), strict=True):
        assert {key: answer[key] for key in wanted} == pytest.approx(wanted, rel=1e-14)
        assert answer["name"] == name
        assert answer["mu33"] == LIBRARY["defaults"]["mu"]


#: Texts of own constants that are refused, and why.
WRONG = {
    "c11 = 1e11": "c13: missing",
    TOML.replace("79.5e9", "179.5e9"): "c12 = 1.795×10¹¹ Pa: needs |c12| < c11",
    TOML + "c66 = 1e9": "c66: unknown entry",
    TOML + "eps33 = 3 GPa": "eps33: GPa does not measure it",
    TOML + "eps33 = alert(1)": "eps33: “alert(1)” is no number",
    TOML + "alert(1)": "line 8: “alert(1)” is not of the form",
    "{": "is no JSON",
    TOML + "depoling_stress = -1": "depoling_stress: must be positive",
}


def test_wrong_constants_are_refused_by_name() -> None:
    answers = calculated([{"kind": "own", "given": text} for text in WRONG])
    for answer, reason in zip(answers, WRONG.values(), strict=True):
        assert reason in answer["refused"]


def test_numbers_take_units() -> None:
    lengths, wrong = {"20 um": 2e-5, "2e-5": 2e-5, "1.2 µm": 1.2e-6}, ("20 kg", "x", "", "5 mm mm", "5 constructor")
    wanted = {(text, "m"): value for text, value in lengths.items()}
    wanted |= {("10kN/m", "N m-1"): 1e4, ("3 N/mm", "N m-1"): 3e3, ("50 %", "1"): 0.5, ("−5 V", "V"): -5.0}
    wanted |= {("580 N/(A m)", "N A-1 m-1"): 580.0, ("7.5 g/cm3", "kg m-3"): 7500.0}
    answers = calculated([{"kind": "number", "given": given} for given in (*wanted, *((text, "m") for text in wrong))])
    assert answers[: len(wanted)] == pytest.approx([*wanted.values()], rel=1e-14)
    assert all("refused" in answer for answer in answers[len(wanted) :])
