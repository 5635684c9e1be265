"""docs/names.md and docs/solver.md: choices, formulas, constants and alternatives are those of the code."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.special import digamma

import solver
from docs import pages
from docs.formulas import on_page_content, on_page_markdown
from solver.halfplane.surface import HalfPlane
from solver.material.constants import TRIGONAL, UNITS
from solver.names import ALL_QUANTITIES, CHOICES, FACTORS, LIMITS, PROFILES, QUANTITIES
from workflow.cli.casetable import TEXT_FACTORS, read_cases
from workflow.report import symbols
from workflow.run.provenance import ROOT
from workflow.study.reading import read_material

PAGE = (ROOT / "docs/names.md").read_text(encoding="utf-8")


def rows(header: str) -> dict[str, list[str]]:
    """Rows of the table with this first heading, by their first cells."""
    table = PAGE.split(f"\n| {header} |")[1].split("\n\n")[0].splitlines()[2:]
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in table]
    return {row[0].strip("`"): row[1:] for row in cells}


def test_the_choices_are_the_code_s() -> None:
    factors = rows("factor")
    assert set(factors) == set(TEXT_FACTORS)
    for name, choices in CHOICES.items():
        usual = "air on films, else insulated" if name == "surroundings" else choices[0]
        assert factors[name][:2] == [usual, ", ".join(choices)], name
    profiles = rows("profile")
    assert list(profiles) == list(PROFILES)
    for name, outline in PROFILES.items():
        assert [re.findall(r"\w+", cell) for cell in profiles[name]] == [list(outline.needs), list(outline.may)]


def test_the_built_page_has_every_name() -> None:
    names = re.findall(r"^\| `(\w+)` \|", pages.quantities(), re.MULTILINE)
    assert set(names) >= {*FACTORS, *ALL_QUANTITIES, *LIMITS}


@pytest.mark.parametrize("name", ["BaTiO3-CoFe2O4 50:50", "BaTiO3-CoFe2O4 0.2"])
def test_the_formulas_of_quantities_are_the_solver_s(name: str) -> None:
    case = {"friction": 0.4, "radius": 0.05, "load": 1e5, "charge": 2e-6, "magnetic_charge": 1e-3, "datum": 2.0}
    exact = solver.solve({"material": name, **case})
    half = HalfPlane(solver.find(name))
    symbols: dict[str, Any] = dict(zip(("eta", "R", "P", "T", "J", "L"), case.values(), strict=True))
    symbols |= {f"N{i + 1}{j + 1}": half.compliance[i, j] for i in range(3) for j in range(i, 3)}
    symbols |= {f"k{i + 1}": half.friction_coupling[i] for i in range(3)}
    symbols |= {"pi": np.pi, "tau": half.in_plane_stiffness * half.tangential_compliance}
    symbols["F"] = digamma(1 + float(exact["pressure_exponent"])) + np.euler_gamma
    frame = xr.Dataset({name: ("case", [float(value)]) for name, value in symbols.items()}).to_dataframe()
    for symbol, (formula, _) in rows("symbol").items():
        frame[symbol] = frame.eval(formula.strip("`"), engine="python")
    formulas = rows("quantity")
    assert list(formulas) == list(QUANTITIES)
    for quantity, (_, formula) in formulas.items():
        value = float(frame.eval(formula.strip("`"), engine="python").iloc[0])
        assert value == pytest.approx(float(exact[quantity]), rel=1e-11), quantity


def test_the_table_of_constants_is_the_code_s() -> None:
    constants = rows("key")
    words = ["cut", "conductor", "name", "source`, `note", "limits", "thermal", "alternatives"]
    assert list(constants) == [*UNITS, *TRIGONAL, *words]
    bare = solver.Material.from_mapping(dict.fromkeys(("c11", "c33"), 3e9) | dict.fromkeys(("c13", "c44"), 1e9))
    for name, units in (UNITS | TRIGONAL).items():
        default = float(getattr(bare, name))
        needed = name in ("c11", "c13", "c33", "c44")
        expected = "needed" if needed else "unknown" if np.isnan(default) else f"{default:.12g}"
        assert constants[name][:2] == [units, expected]


def test_the_table_of_alternatives_is_the_solver_s() -> None:
    """Contact width, voltage and charge per force over those of the entry, to two digits."""
    page = (ROOT / "docs/solver.md").read_text(encoding="utf-8")
    table = page.split("| material | other values | width | voltage | charge |\n")[1].split("\n\n")[0].splitlines()[1:]
    for line in table:
        name, _, *cells = (cell.strip() for cell in line.strip("|").split("|"))
        material = solver.find(name)
        out = solver.solve({"material": [material, *material.variants()], "radius": 0.05, "load": 1e4, "friction": 0.3})
        width = out["contact_trailing"] + out["contact_leading"]
        for cell, values in zip(cells, (width, out["voltage"], out["charge_per_force"]), strict=True):
            assert cell == "; ".join(f"{float(value / values[0]):.2f}" for value in values[1:]), name


def test_the_example_of_a_material_is_the_file() -> None:
    text = (ROOT / "examples/material.yaml").read_text(encoding="utf-8")
    assert "".join(f"    {line}\n" for line in text.splitlines()) in PAGE
    name, material = read_material(ROOT / "examples/material.yaml")
    for key in UNITS:
        np.testing.assert_array_equal(getattr(material, key), getattr(solver.find("PZT-5H"), key))
    assert material.limits["depoling_stress"].value == 10e6
    assert material.spread["eps33"] == (12.7e-9, 13.02e-9)
    assert name in read_cases(ROOT / "examples/own_material.csv").columns["material"]


def test_symbols_of_the_paper_are_those_of_its_page() -> None:
    table = [line for line in PAGE.partition("## Symbols of the paper")[2].splitlines() if line.startswith("|")]
    for name, (symbol, equation) in (symbols.FACTORS | symbols.FIELDS).items():
        (row,) = (row for row in table if f"`{name}`" in row)
        assert row.endswith(f"| ({equation}) |")
        plain = symbol.removeprefix("−").replace("η", "eta").replace("σ", "sigma")
        assert plain in row.replace(",", " ").split()


PAGES = {
    name: (ROOT / f"docs/{name}.md").read_text(encoding="utf-8") for name in ("theory", "theory-films", "theory-points")
}
SECTIONS = {name: set(re.findall(r"^## (\d+)\. ", text, re.MULTILINE)) for name, text in PAGES.items()}
EQUATIONS = {number for text in PAGES.values() for number in re.findall(r"\\tag\{([\w.]+)\}", text)}
_THEORY = re.compile(r"[Tt]heory(?:,? sections?|,)? (\d+)(?:(?:, | and |, and )(\d+))?(?: and (\d+))?(?![\w.])")
_FILMS = re.compile(r"\b[Ff]ilms, sections? (\d+(?:(?:, | and )\d+)*)")
_POINTS = re.compile(r"\(points, (\d)\)")
_EQUATION = re.compile(r"(?:[Tt]heory,? (?:eq\. |\()?|equations? \(|\bby \(|\bfrom \(|\bof \()(\d\.\d|1[abc])\)?")


def cited(text: str) -> dict[str, set[str]]:
    """Sections by page, and equations, that a text cites."""
    text = re.sub(r"\s+#?\s*", " ", text)
    return {
        "theory": {number for match in _THEORY.findall(text) for number in match if number},
        "theory-films": {number for match in _FILMS.findall(text) for number in re.findall(r"\d+", match)},
        "theory-points": set(_POINTS.findall(text)),
        "equations": set(_EQUATION.findall(text)) | set(re.findall(r"\(([FP]\d+\.\d+)\)", text)),
    }


def missing(text: str) -> set[str]:
    """Citations of a text that no page holds."""
    places = cited(text)
    sections = {f"{page} {number}" for page, held in SECTIONS.items() for number in places[page] - held}
    return sections | (places["equations"] - EQUATIONS)


def test_every_cited_section_and_equation_is_on_its_page() -> None:
    for page, sections in SECTIONS.items():
        assert sorted(map(int, sections)) == list(range(1, len(sections) + 1)), page
    rooms = ("solver", "surrogate", "workflow", "verification", "tests", "benchmarks")
    sources = [path for room in rooms for path in (ROOT / room).rglob("*.py") if path != Path(__file__)]
    texts = {str(path.relative_to(ROOT)): path.read_text(encoding="utf-8") for path in sources}
    lost = {name: missing(text) for name, text in {**texts, **PAGES}.items()}
    assert not {name: places for name, places in lost.items() if places}
    assert cited("(theory sections 3 and 9)")["theory"] == {"3", "9"}
    assert missing("Theory of films, section 99; films, section 99: by (F4.99), from theory (2.7)") == {
        "theory-films 99", "F4.99", "2.7"}  # fmt: skip


def test_formulas_become_mathml_and_code_stays() -> None:
    html = on_page_content(on_page_markdown(r"so $a = \frac{b}{2}$ and `$HOME` $$c = d \tag{9.1}$$"))
    assert html.count("<math") == 2
    assert "`$HOME`" in html
    assert 'id="eq-9.1">(9.1)<' in html
    for page in PAGES.values():
        assert "$$" not in re.sub(r"`[^`]*`", "", on_page_markdown(page))
