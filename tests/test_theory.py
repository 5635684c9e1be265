"""The pages of theory: what the code cites stands there, formulas are formulas, drawings and numbers the code's."""

import re
from pathlib import Path

import pytest

from docs import films, formulas, limits
from tests.solver.face import test_film_interior, test_films
from workflow.report import problem
from workflow.run.provenance import ROOT

PAGE = (ROOT / "docs/theory.md").read_text(encoding="utf-8")
FILMS = (ROOT / "docs/theory-films.md").read_text(encoding="utf-8")
SECTIONS = set(re.findall(r"^## (\d+)\. ", PAGE, re.MULTILINE))
EQUATIONS = set(re.findall(r"\\tag\{([\w.]+)\}", PAGE))
FILM_SECTIONS = set(re.findall(r"^## (\d+)\. ", FILMS, re.MULTILINE))
FILM_EQUATIONS = set(re.findall(r"\\tag\{([\w.]+)\}", FILMS))
_SECTION = re.compile(r"[Tt]heory(?:,? sections?|,)? (\d)(?:(?:, | and |, and )(\d))?(?: and (\d))?(?![\w.])")
_EQUATION = re.compile(r"(?:[Tt]heory,? (?:eq\. |\()?|equations? \(|\bby \(|\bfrom \(|\bof \()(\d\.\d|1[abc])\)?")
_FILM_SECTIONS = re.compile(r"\b[Ff]ilms, sections? (\d+(?:(?:, | and )\d+)*)")


def cited(text: str) -> tuple[set[str], set[str]]:
    """Sections and equations of the theory that a text names."""
    text = re.sub(r"\s+#?\s*", " ", text)
    sections = {number for found in _SECTION.findall(text) for number in found if number}
    return sections, set(_EQUATION.findall(text))


def cited_of_films(text: str) -> tuple[set[str], set[str]]:
    """Sections and equations of the theory of films that a text names."""
    text = re.sub(r"\s+#?\s*", " ", text)
    sections = {number for found in _FILM_SECTIONS.findall(text) for number in re.findall(r"\d+", found)}
    return sections, set(re.findall(r"\((F\d+\.\d+)\)", text))


def sources() -> list[Path]:
    rooms = ("solver", "surrogate", "workflow", "verification", "tests", "benchmarks")
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
    assert cited_of_films("(films, sections 3, 5)") == ({"3", "5"}, set())
    assert cited_of_films("Theory of films, section 19: by (F4.12)") == ({"19"}, {"F4.12"})


def test_every_place_of_the_theory_of_films_that_is_cited_stands_on_its_page() -> None:
    assert sorted(map(int, FILM_SECTIONS)) == list(range(1, len(FILM_SECTIONS) + 1))
    cited_sections = set()
    for path in [*sources(), *sorted((ROOT / "docs").glob("*.py"))]:
        sections, equations = cited_of_films(path.read_text(encoding="utf-8"))
        assert sections <= FILM_SECTIONS, path
        assert equations <= FILM_EQUATIONS, path
        cited_sections |= sections
    assert cited_sections >= {str(number) for number in range(1, 10)}
    # what the page says of itself, and of the half-plane's page
    assert cited_of_films(FILMS)[1] <= FILM_EQUATIONS
    assert set(re.findall(r"\bsection (\d+)", FILMS)) <= FILM_SECTIONS
    assert set(re.findall(r"\[Theory, (\d)\]\(theory\.md\)", FILMS)) <= SECTIONS
    assert set(re.findall(r"\((\d\.\d)\)", FILMS)) <= EQUATIONS


def test_the_tests_that_the_page_of_films_names_exist() -> None:
    named = re.findall(r"`(test_\w+\.py)::(test_\w+)`", FILMS)
    assert len(named) >= 10
    for file, name in named:
        files = [ROOT / f"tests/solver/{room}/{file}" for room in ("film", "face")]
        assert any(f"def {name}(" in one.read_text(encoding="utf-8") for one in files if one.is_file()), name


def test_figures_of_the_page_of_films_are_those_of_the_tests() -> None:
    rows = [[cell.strip() for cell in row.split("|")[1:-1]] for row in re.findall(r"^\|.*\|$", FILMS, re.MULTILINE)]
    start = rows.index(["", "case 1", "case 2", "case 3"]) + 2
    for case, (name, (_, scalars, on_surface)) in enumerate(test_films.FIGURES.items(), start=1):
        half_way, shear, normal = test_film_interior.INSIDE[name]
        tested = [*scalars, *on_surface, *half_way, shear[0], normal[0], shear[1], normal[1]]
        assert [float(row[case]) for row in rows[start : start + len(tested)]] == tested, name
    for ratio, (pzt, titanate, depth) in test_films.SHORT_CIRCUIT.items():
        row = next(row for row in rows if row[0] == f"{ratio:g}")
        assert [float(cell) for cell in row[1:]] == [*pzt, depth, *titanate], ratio


def test_formulas_become_mathml_and_code_stays() -> None:
    html = formulas.on_page_content(formulas.on_page_markdown(r"so $a = \frac{b}{2}$ and `$HOME` $$c = d \tag{9.1}$$"))
    assert html.count("<math") == 2
    assert "`$HOME`" in html
    assert 'id="eq-9.1">(9.1)<' in html
    for page in (PAGE, FILMS):
        assert "$$" not in re.sub(r"`[^`]*`", "", formulas.on_page_markdown(page))


def test_the_drawings_are_the_code_s() -> None:
    assert (ROOT / "docs/problem.svg").read_text(encoding="utf-8") == problem.draw()
    assert (ROOT / "docs/film.svg").read_text(encoding="utf-8") == problem.film()


SAID = {
    "volts per load, datum 0.01 m": "0.021",
    "volts per load, datum 10 m": "0.057",
    "width between conductor and insulator": "1.4 %",
    "pressure between conductor and insulator": "pressure 1.4 %",
    "width under an elastic punch of steel": "29 %",
    "(a/R)^2": "2e-05",
    "charge per load of PZT-4 on copper": "163 pC/N",
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
    unit = next((scale for unit, scale in {"%": 0.01, "MPa": 1e6, "pC/N": 1e-12}.items() if unit in text), 1.0)
    said = float(re.findall(r"[\d.]+(?:e-\d+)?", text)[0]) * unit
    assert value == pytest.approx(said, rel=0.1)
    assert text.replace("2e-05", "2e-5") in (ROOT / "docs/limits.md").read_text(encoding="utf-8")
    assert numbers["free of the datum within"] < 1e-5


@pytest.mark.parametrize("name", limits.DESIGNS)
def test_what_air_and_steel_make_of_a_sensor_is_measured(name: str) -> None:
    assert limits.surroundings(name, limits.DESIGNS[name]) in (ROOT / "docs/limits.md").read_text(encoding="utf-8")


SAID_OF_FILMS = {
    "thick film, rigid": "-3.6e-3 on a rigid base",
    "thick film, bonded": "-8.4e-4 on silicon to which the film is electrically bonded",
    "thick film, grounded": "-4.0e-4 on silicon with a grounded electrode",
    "thick film, bonded, BaTiO3": "-6.6e-4 bonded",
    "thick film, grounded, BaTiO3": "-7.0e-4 grounded",
    "V_J over Psi_T": "misses by 41 %",
    "d depth/dT": "3.72e-3 m per C/m",
    "-dV/dP": "2.50e-3",
    "-V/P": "3.92e-3",
    "half-length by charge": "+3.4 %",
    "half-length over H": "a contact 1.4 times as long",
    "permeance, datum 2H/pi": "-7.1e-3 Wb/(A m)",
    "permeance, datum H": "has 1.3e-3",
    "permeance, datum 10 H": "4.3e-5",
}


@pytest.fixture(scope="module")
def numbers_of_films() -> dict[str, float]:
    return films.numbers()


@pytest.mark.parametrize("name", SAID_OF_FILMS)
def test_what_the_theory_of_films_says_is_measured(name: str, numbers_of_films: dict[str, float]) -> None:
    text = SAID_OF_FILMS[name]
    assert text in FILMS.replace("\n", " ")
    said = float(re.findall(r"-?\d+\.?\d*(?:e-\d)?", text)[0]) * (0.01 if "%" in text else 1.0)
    assert numbers_of_films[name] == pytest.approx(said, rel=0.03)
    assert abs(numbers_of_films["P_T u_J + V_J over P_J u_T + Psi_T"]) < 1e-9
