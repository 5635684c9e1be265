"""The page of point contacts: what the code cites stands there, and its numbers are the solver's."""

import re
from typing import Any

import numpy as np
import pytest

import solver
from docs import points
from docs.formulas import on_page_markdown
from tests.solver.point.points import BTO, film, on_film
from workflow.run.provenance import ROOT

PAGE = (ROOT / "docs/theory-points.md").read_text(encoding="utf-8")
LIMITS = (ROOT / "docs/limits.md").read_text(encoding="utf-8")
SECTIONS = re.findall(r"^## (\d+)\. ", PAGE, re.MULTILINE)
EQUATIONS = re.findall(r"\\tag\{(P\d\.\d)\}", PAGE)
BALL: dict[str, Any] = {"profile": "sphere", "radius": 5e-3, "force": 10.0}


def rows(page: str) -> list[list[str]]:
    return [[cell.strip() for cell in row.split("|")[1:-1]] for row in re.findall(r"^\|.*\|$", page, re.MULTILINE)]


def row(page: str, name: str) -> list[float]:
    return [float(cell) for cell in next(row for row in rows(page) if row[0] == name)[1:]]


def last_digit(said: float, digits: int) -> float:
    """One of the last of so many digits."""
    return float(10.0 ** (np.floor(np.log10(abs(said))) - digits + 1))


def test_every_place_that_is_cited_stands_on_the_page() -> None:
    assert list(map(int, SECTIONS)) == list(range(1, len(SECTIONS) + 1))
    assert len(set(EQUATIONS)) == len(EQUATIONS) >= 9
    cited = set()
    for path in sorted((ROOT / "solver").rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        cited |= set(re.findall(r"\(points, (\d)\)", text))
        assert set(re.findall(r"\((P\d\.\d)\)", text)) <= set(EQUATIONS), path
    assert {"3", "4"} <= cited <= set(SECTIONS)
    films = (ROOT / "docs/theory-films.md").read_text(encoding="utf-8")
    assert set(re.findall(r"\((F\d\.\d)\)", PAGE)) <= set(re.findall(r"\\tag\{([\w.]+)\}", films))
    assert "$$" not in on_page_markdown(PAGE)


def test_the_tests_that_the_page_names_exist() -> None:
    named = re.findall(r"`(test_\w+\.py)::(test_\w+)`", PAGE)
    assert len(named) >= 6
    for file, name in named:
        places = [
            ROOT / f"tests/{room}{file}"
            for room in ("", "solver/point/", "solver/face/", "solver/gap/", "verification/")
        ]
        assert any(f"def {name}(" in one.read_text(encoding="utf-8") for one in places if one.is_file()), name


@pytest.mark.parametrize("material", ["PZT-4", "BaTiO3"])
def test_figures_of_the_page_are_the_solver_s(material: str) -> None:
    found = solver.solve(BALL | {"material": material})
    # the charge that a short circuit takes away leaves no voltage
    grounded = solver.solve(BALL | {"material": material, "total_charge": 10.0 * float(found["charge_per_force"])})
    assert abs(float(grounded["voltage"])) < 1e-10 * abs(float(found["voltage"]))
    ours = [
        abs(float(found["charge_per_force"])) * 1e12,
        float(found["contact_radius"]) * 1e6,
        float(grounded["depth"]) * 1e6,
        float(found["peak_pressure"]) / 1e6,
        abs(float(found["voltage"])),
    ]
    for value, said, digits in zip(ours, row(PAGE, material), (7, 5, 5, 4, 5), strict=True):
        assert value == pytest.approx(said, abs=0.6 * last_digit(said, digits))


def test_figures_of_films_are_the_solver_s() -> None:
    radii = np.array([0.2, 1.0, 5.0])
    forces = np.array(row(PAGE, "$PR/a^3$ [Pa]")) * radii**3
    grounded = on_film(film(BTO), 1.0, 2.0, 0.5, forces).grounded
    np.testing.assert_allclose(grounded.radius, radii, rtol=3e-7)
    charge = np.abs(grounded.loads[:, 1]) / forces * 1e12
    np.testing.assert_allclose(charge, row(PAGE, "size of $T/P$ [pC/N]"), rtol=4e-7)
    np.testing.assert_allclose(-grounded.displacement[:, 0] / radii**2, row(PAGE, "depth $R/a^2$"), rtol=1e-6)


def test_a_roller_in_place_of_a_ball_is_as_wrong_as_the_table_says() -> None:
    table = {(cells[0], cells[1]): cells[2:] for cells in rows(LIMITS) if cells[0] in points.MATERIALS}
    quantities = ("charge per force", "stroke per volt", "depth", "largest pressure")
    ours = points.numbers()
    assert len(table) == len(points.MATERIALS) * len(points.RATIOS)
    for material, ratio in {key[:2] for key in ours}:
        for name, cell in zip(quantities, table[material, f"{ratio:g}"], strict=True):
            ball, roller = map(float, cell.split(","))
            values = ours[material, ratio, name]
            assert (values["ball"], values["roller"]) == pytest.approx((ball, roller), rel=6e-4), (material, name)


@pytest.mark.parametrize(
    ("name", "own"),
    [
        ("half-space of BaTiO3", {}),
        (
            "BaTiO3 of 0.1 mm on steel, grounded",
            {"thickness": 1e-4, "surroundings": "insulated", "base": "steel", "interface_electric": "grounded"},
        ),
    ],
)
def test_figures_of_a_ball_in_air_are_the_solver_s(name: str, own: dict[str, Any]) -> None:
    case = BALL | own | {"material": "BaTiO3", "magnetic": "insulating"}
    bare, air = (solver.solve(case | {"surroundings": one}) for one in ("insulated", "air"))
    charge, capacitance, voltage = next(row for row in rows(PAGE) if row[0] == name)[1:]
    pico = [abs(float(one["charge_per_force"])) * 1e12 for one in (bare, air)]
    assert charge == f"{pico[0]:.2f}, air {pico[1]:.2f}"
    stored = [float(one["capacitance"]) * 1e12 for one in (bare, air)]
    assert capacitance == f"{stored[0]:.3f}, air {stored[1]:.3f}"
    assert voltage == f"x {float(air['voltage'] / bare['voltage']):.3f}"


def test_what_limits_md_says_of_what_is_left_out_is_computed() -> None:
    found = points.left_out()
    said = {"pull-off of a ball [mN]": "pulled off by {} mN", "adhesion, radius at 1 N": "wider by {} % at 1 N",
            "adhesion, radius at 0.01 N": "by {} % at 10 mN", "adhesion, radius of a probe": "at 10 uN by {} %",
            "ellipse of 1 to 2, pressure": "pressure {} % more", "ellipse of 1 to 2, radius": "mean radius {} % less",
            "ellipse of 1 to 10, pressure": "as 1 to 10 {} %", "ellipse of 1 to 10, radius": "and {} % (Hertz)",
            "fringe of a disc on BaTiO3": "adds {} %", "fringe of a disc on PVDF": "BaTiO3, {} % on PVDF",
            "finite body, charge per force": "force {} % less", "finite body, depth": "depth {} % less"}  # fmt: skip
    assert said.keys() == found.keys()
    for name, words in said.items():
        value = abs(found[name]) * (1 if "mN" in words and "pull" in words else 100)
        assert words.format(f"{value:.3g}") in LIMITS, name
