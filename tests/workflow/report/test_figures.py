"""Figures: no text is cut, no power of ten stands apart, and drawings follow light and dark."""

import re
from dataclasses import replace

from matplotlib.text import Text

from storage.netcdf import read_whole
from tests.workflow.conftest import Project
from workflow.design.verdict import netcdf
from workflow.language import grammar, statements, titles
from workflow.report import page, svg
from workflow.report.figures import design_plots, sobol, surrogate_errors
from workflow.study import coupling
from workflow.study.model import load


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
