"""The theory page: each place that the code cites stands there, its formulas are formulas, its numbers are measured."""

import re
from pathlib import Path

import pytest

from docs import formulas, limits
from workflow.report import problem
from workflow.run.provenance import ROOT

PAGE = (ROOT / "docs/theory.md").read_text(encoding="utf-8")
SECTIONS = set(re.findall(r"^## (\d+)\. ", PAGE, re.MULTILINE))
EQUATIONS = set(re.findall(r"\\tag\{([\w.]+)\}", PAGE))
_SECTION = re.compile(r"[Tt]heory(?:,? sections?|,)? (\d)(?:(?:, | and |, and )(\d))?(?: and (\d))?(?![\w.])")
_EQUATION = re.compile(r"(?:[Tt]heory,? (?:eq\. |\()?|equations? \(|\bby \(|\bfrom \(|\bof \()(\d\.\d|1[abc])\)?")


def cited(text: str) -> tuple[set[str], set[str]]:
    """Sections and equations of the theory that a text names."""
    text = re.sub(r"\s+#?\s*", " ", text)
    sections = {number for found in _SECTION.findall(text) for number in found if number}
    return sections, set(_EQUATION.findall(text))


def sources() -> list[Path]:
    rooms = ("solver", "surrogate", "workflow", "tests", "benchmarks")
    return [path for room in rooms for path in sorted((ROOT / room).rglob("*.py")) if path != Path(__file__)]


def test_every_place_of_the_theory_that_the_code_cites_stands_on_the_page() -> None:
    found = {path: cited(path.read_text(encoding="utf-8")) for path in sources()}
    astray = {
        str(path.relative_to(ROOT)): (sections - SECTIONS) | (equations - EQUATIONS)
        for path, (sections, equations) in found.items()
        if not (sections <= SECTIONS and equations <= EQUATIONS)
    }
    assert not astray
    assert {one for sections, _ in found.values() for one in sections} >= {"2", "3", "4", "5", "6", "7"}
    assert {one for _, equations in found.values() for one in equations} >= {"2.1", "2.2"}


def test_a_place_that_is_not_there_would_be_found() -> None:
    assert cited("(theory sections 3 and 9)") == ({"3", "9"}, set())
    assert cited("theory, 4 and 5") == ({"4", "5"}, set())
    assert cited("from theory (2.7)") == (set(), {"2.7"})


def test_formulas_become_mathml_and_code_stays() -> None:
    html = formulas.on_page_content(formulas.on_page_markdown(r"so $a = \frac{b}{2}$ and `$HOME` $$c = d \tag{9.1}$$"))
    assert html.count("<math") == 2
    assert "`$HOME`" in html
    assert 'id="eq-9.1">(9.1)<' in html
    assert "$$" not in re.sub(r"`[^`]*`", "", formulas.on_page_markdown(PAGE))


def test_the_drawing_is_the_code_s() -> None:
    assert (ROOT / "docs/problem.svg").read_text(encoding="utf-8") == problem.draw()


SAID = {
    "volts per load, datum 0.01 m": "0.021",
    "volts per load, datum 10 m": "0.057",
    "width between conductor and insulator": "1.4 %",
    "pressure between conductor and insulator": "pressure 1.4 %",
    "width under an elastic punch of steel": "30 %",
    "(a/R)^2": "2e-05",
    "largest pressure": "312 MPa",
    "tension behind the trailing edge": "200 MPa",
}


@pytest.fixture(scope="module")
def numbers() -> dict[str, float]:
    return limits.numbers()


@pytest.mark.parametrize("name", SAID)
def test_what_the_model_leaves_out_is_measured(name: str, numbers: dict[str, float]) -> None:
    value = numbers[name]
    text = SAID[name]
    unit = next((scale for unit, scale in {"%": 0.01, "MPa": 1e6}.items() if unit in text), 1.0)
    said = float(re.findall(r"[\d.]+(?:e-\d+)?", text)[0]) * unit
    assert value == pytest.approx(said, rel=0.1)
    assert text.replace("2e-05", "2e-5") in (ROOT / "docs/limits.md").read_text(encoding="utf-8")
    assert numbers["free of the datum within"] < 1e-5
