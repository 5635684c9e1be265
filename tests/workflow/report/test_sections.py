"""The page's sections have templates and captions, and a figure in fewer bytes shows the same."""

import io
import re
from importlib import import_module
from xml.etree import ElementTree

import matplotlib.pyplot as plt
import numpy as np

from tests.studies import shipped
from workflow.report import sections
from workflow.report.figures.style import compacted, styled
from workflow.report.page import CAPTIONS, TEMPLATES

#: Templates that are no section.
SHARED = {"report", "firstscreen"}


def test_every_section_has_its_template_and_every_template_its_section() -> None:
    names = {section.name for part in sections.PARTS for section in part.sections}
    assert names == {file.name.removesuffix(".html.j2") for file in TEMPLATES.glob("*.html.j2")} - SHARED


def test_a_study_has_the_figures_of_its_sections_and_each_a_caption() -> None:
    paper = sections.figures(shipped("paper"))
    assert paper[0].startswith("effect_")
    for drawn in sections.drawn():
        assert len({figure.reads for _, figure in drawn}) == 1
        for _, figure in drawn:
            assert (CAPTIONS / f"{figure.kind}.rst").is_file()
            module, _, function = figure.draw.partition(".")
            assert callable(getattr(import_module(f"workflow.report.figures.{module}"), function)), figure.draw


SVG = "{http://www.w3.org/2000/svg}"


def outlines(text: str) -> list[list[float]]:
    """Coordinates of the corners of every path."""
    paths = re.findall(r'\sd="([^"]*)"', text)
    return [[float(number) for number in re.findall(r"-?\d*\.?\d+", path)] for path in paths]


@styled
def drawn() -> str:
    figure, axes = plt.subplots(1, 2)
    x = np.linspace(0, 40, 900)
    axes[0].plot(x, np.sin(x) * np.exp(-x), label="many steps")
    axes[0].legend()
    axes[1].scatter(x[:50], np.cos(x[:50]))
    axes[1].set_title("of $\\sigma_{xx}$")
    written = io.StringIO()
    figure.savefig(written, format="svg")
    return written.getvalue()


def test_a_compact_figure_shows_the_same() -> None:
    before = drawn()
    after = compacted(before)
    assert len(after) < 0.5 * len(before)
    for old, new in zip(outlines(before), outlines(after), strict=True):
        np.testing.assert_allclose(new, old, atol=0.008)  # half a hundredth of a point each way
    texts = [[*ElementTree.fromstring(text).iter(f"{SVG}text")] for text in (before, after)]
    words = [["".join("".join(element.itertext()).split()) for element in group] for group in texts]
    assert words[0] == words[1]
    assert "manysteps" in words[1]
    clips = [re.findall(r"url\(#([^)]+)\)", text) for text in (before, after)]
    assert [clips[0].index(element) for element in clips[0]] == [clips[1].index(element) for element in clips[1]]
    assert {*clips[1], *re.findall(r'href="#([^"]+)"', after)} == set(re.findall(r'id="([^"]+)"', after))
