"""The registry of the page's sections: each has its template, and figures of what a study has."""

import inspect
from importlib import import_module

from tests.studies import shipped
from workflow.report import sections
from workflow.report.page import CAPTIONS, TEMPLATES

#: Templates that are no section.
SHARED = {"report", "firstscreen"}


def test_every_section_has_its_template_and_every_template_its_section() -> None:
    names = {section.name for part in sections.PARTS for section in part.sections}
    assert names == {file.name.removesuffix(".html.j2") for file in TEMPLATES.glob("*.html.j2")} - SHARED


def test_a_study_has_the_figures_of_its_sections_and_each_a_caption() -> None:
    quickstart = sections.figures(shipped("quickstart"))
    assert quickstart == [
        "signal",
        "sensitivity",
        "main_effects",
        "fields",
        "errors",
        "decay",
        "residuals",
        "intervals",
    ]
    paper = sections.figures(shipped("paper"))
    assert paper[0].startswith("effect_")
    for drawn in sections.drawn():
        assert len({figure.reads for _, figure in drawn}) == 1
        for _, figure in drawn:
            assert (CAPTIONS / f"{figure.kind}.rst").is_file()
            module, _, function = figure.draw.partition(".")
            drawing = getattr(import_module(f"workflow.report.figures.{module}"), function)
            assert tuple(inspect.signature(drawing).parameters)[1:] == figure.asks, figure.draw
