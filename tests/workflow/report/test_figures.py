"""The page's sections have templates and captions; figures are compact, and no text of theirs is cut."""

import io
import re
from dataclasses import replace
from importlib import import_module
from xml.etree import ElementTree

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.text import Text

from storage.netcdf import read_whole
from tests.studies import shipped
from tests.workflow.conftest import Project
from workflow.design.verdict import netcdf
from workflow.language import grammar, statements, titles
from workflow.report import page, sections, svg
from workflow.report.figures import design_plots, sobol, surrogate_errors
from workflow.report.figures.style import compacted, styled
from workflow.report.page import CAPTIONS, TEMPLATES
from workflow.study import coupling
from workflow.study.model import load

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


def test_the_drawing_of_the_problem_follows_light_and_dark() -> None:
    drawn = str(svg.element((page.TEMPLATES / "halfplane.svg").read_text(encoding="utf-8"), "problem", page.TITLE))
    assert not re.findall(r"#[0-9a-f]{3,6}\b", drawn)
    assert {"var(--ink)", "var(--card)", "var(--accent)", "var(--soft)"} <= set(re.findall(r"var\(--\w+\)", drawn))
    assert set(re.findall(r'id="([^"]+)"|url\(#([^)]+)\)', drawn)) == {("problem-tip", ""), ("", "problem-tip")}


def test_no_text_is_cut_and_no_power_of_ten_stands_apart_from_its_ticks(ran: Project) -> None:
    study, folder = load(ran.folder / "config/small.yaml"), ran.folder / "results/small"
    answer, long = (netcdf.read(folder / "design/sensor.nc"), "abs(voltage_per_load) * (contact_trailing + radius) / 2")
    goal = replace(answer.terms[0], statement=statements.objective(long))
    answer = replace(answer, terms=(goal, *answer.terms[1:]))
    drawn = [*design_plots.figures_of(answer, study.design["sensor"]).values()]
    drawn += [surrogate_errors.residuals(read_whole(folder / "validation.nc"), study.outputs)]
    drawn += [sobol.main_effects(read_whole(folder / "sensitivity.nc"), study.outputs, coupling.of_interest(study))]
    seen = ""
    for figure in drawn:
        figure.canvas.draw()
        legends = [text for legend in (*figure.legends, *(ax.get_legend() for ax in figure.axes)) if legend
                   for text in legend.get_texts()]  # fmt: skip
        labels = [text for ax in figure.axes for text in (ax.title, ax.xaxis.label, ax.yaxis.label)]
        texts: list[Text] = [text for text in (*legends, *labels) if text.get_text()]
        for text in texts:
            box = text.get_window_extent()
            assert min(box.x0, box.y0) > -1, text
            assert box.x1 < figure.bbox.x1 + 1, text
            assert box.y1 < figure.bbox.y1 + 1, text
        for ax in figure.axes:
            assert ax.xaxis.get_offset_text().get_text() == ax.yaxis.get_offset_text().get_text() == ""
        seen += " ".join(text.get_text() for text in texts)
    assert "…" not in seen
    said = titles.spoken(grammar.parse(long), long)
    assert seen.replace("\n", " ").count(said) == 2  # map and slices, both in words
    assert "tension behind the contact [MPa]" in seen.replace("\n", " ")
