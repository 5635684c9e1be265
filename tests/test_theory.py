"""The pages of theory hold every section and equation that the code cites."""

import re
from pathlib import Path

from docs.formulas import on_page_content, on_page_markdown
from workflow.run.provenance import ROOT

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
