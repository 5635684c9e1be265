"""Figures: the same however the data set is cut into slabs; no text is cut, no power of ten stands apart."""

import re
import warnings
from dataclasses import replace
from pathlib import Path

import pytest
from matplotlib.text import Text

from storage.netcdf import read_whole
from tests.workflow.conftest import Project
from workflow.dataset import slabs as dataset
from workflow.design.verdict import netcdf
from workflow.language import grammar, statements, titles
from workflow.report import page, svg
from workflow.report.figures import design_plots, field_panels, sobol, style, surrogate_errors
from workflow.study import coupling, partition
from workflow.study.model import load

ONE = "factors: {friction: {low: 0.0, high: 0.6, levels: 7}}"
TWO = "factors: {volume_fraction: {low: 0.2, high: 0.8, levels: 7}, friction: {low: 0.0, high: 0.6, levels: 4}}"
NAMED = f"categories: {{composite: [fibrous, laminate]}}\n{ONE}"


@pytest.mark.sampled(2)
@pytest.mark.parametrize("factors", [ONE, TWO, NAMED], ids=["one factor", "two factors", "a category and a factor"])
def test_the_number_of_slabs_does_not_change_the_figure_of_fields(factors: str, tmp_path: Path) -> None:
    drawn = set()
    for slabs in (1, 3):
        file = tmp_path / "some.yaml"
        fixed = {"radius": 0.05, "load": 1e5, "composite": "fibrous", "volume_fraction": 0.5}
        fixed = {name: value for name, value in fixed.items() if name not in factors}
        file.write_text(f"title: Some\n{factors}\nfixed: {fixed}\ndataset: {{slabs: {slabs}}}\n", encoding="utf-8")
        study = load(file)
        parts = []
        for index in range(partition.count(study)):
            dataset.write_slab(study, index, tmp_path / f"{index}.nc")
            parts.append(read_whole(tmp_path / f"{index}.nc"))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            style.save(field_panels.fields(parts, coupling.fields(study)), tmp_path / "fields.svg")
        drawn.add((tmp_path / "fields.svg").read_bytes())
    assert len(drawn) == 1


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
