"""The page's figures, sections and first screen: captions, drawings and sentences follow their numbers."""

import io
import re
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree

import matplotlib.pyplot as plt
import numpy as np
import pytest
import xarray as xr
from matplotlib.text import Text
from matplotlib.textpath import TextPath

from solver.body import KINDS
from storage.netcdf import read_whole
from tests.studies import made, shipped
from tests.workflow.conftest import Project
from workflow.dataset.effects import maps, spread
from workflow.design.verdict import netcdf
from workflow.design.wording.words import first_to_break
from workflow.language import grammar, statements, titles
from workflow.language.numbers import shown
from workflow.language.titles import title
from workflow.report import device, exact, firstscreen, page, ranked, sections, sentences, svg
from workflow.report.device import Device
from workflow.report.figures import contact_maps, design_plots, sobol, style, surrogate_errors
from workflow.report.figures.style import compacted, styled
from workflow.report.firstscreen import Case
from workflow.report.page import CAPTIONS, TEMPLATES
from workflow.report.svg import ACCENT, BAD, element
from workflow.study import coupling
from workflow.study.layered import BodyLayer
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


FILM = Device("cylinder", "leading", 0.05, 6e-4, 5e-4, 1e4, thickness=3e-4, base="steel", grounded=True, slides=True)


def horizontals(drawing: str, colour: str) -> list[float]:
    """Lengths of the horizontal lines of a colour, in pixels."""
    lines = re.findall(rf'<line x1="([\d.]+)" y1="([\d.]+)" x2="([\d.]+)" y2="([\d.]+)" stroke="{colour}"', drawing)
    return [float(x1) - float(x0) for x0, y0, x1, y1 in lines if y0 == y1 and float(x1) > float(x0)]


def test_both_parts_of_a_drawing_are_to_scale() -> None:
    drawing = device.draw(FILM, "a film")
    contact_whole, contact_near = horizontals(drawing, BAD)
    interface = [float(y) for y in re.findall(rf'y1="([\d.]+)" x2="[\d.]+" y2="[\d.]+" stroke="{ACCENT}"', drawing)]
    assert (interface[-1] - 128) / contact_near == pytest.approx(3e-4 / 1.1e-3, rel=1e-3)
    # the whole punch is two radii wide
    outline = re.findall(r'<polyline points="([^"]+)"', drawing)[0].split()
    places = [float(point.partition(",")[0]) for point in outline]
    assert (max(places) - min(places)) / 0.1 * 1.1e-3 == pytest.approx(contact_whole, abs=0.02)
    assert f"at {FILM.magnified:.0f} times that scale" in drawing
    assert contact_near / contact_whole == pytest.approx(FILM.magnified, rel=0.01)
    for words in ("R = 50 mm", "1.1 mm", "film 300 µm", "steel, grounded electrode between", "10 kN/m", "slides"):
        assert words in drawing


@pytest.mark.parametrize(
    ("punch", "words"),
    [
        (Device("flat", "leading", 4e-3, 2e-3, 2e-3, 1e4), "w = 4 mm"),
        (Device("wedge", "leading", 0.02, 3e-3, 0.0, 1e4), "slope 0.02"),
        (Device("half_cylinder", "trailing", 0.03, 0.0, 2e-3, 1e4, conducts=False), "R = 30 mm"),
        (Device("sphere", "leading", 0.01, 2e-4, 2e-4, 0.1), "100 mN"),
        (Device("sphere", "leading", 0.01, 2e-4, 2e-4, 0.1, thickness=1e-4, base="steel"), "a = 200 µm"),
        (Device("cone", "leading", 0.1, 2e-4, 2e-4, 0.1), "slope 0.1"),
        (Device("disc", "leading", 4e-4, 2e-4, 2e-4, 0.1), "w = 400 µm"),
        (Device("power", "leading", 1e9, 2e-4, 2e-4, 0.1, exponent=4.0), "half-space"),
    ],
)
def test_every_punch_touches_its_contact(punch: Device, words: str) -> None:
    x = np.linspace(-punch.leading, punch.trailing, 9)[1:-1]
    assert np.all(punch.heights(x) <= punch.sunk * (1 + 1e-6))
    drawing = device.draw(punch, "a punch")
    assert words in drawing
    below = "half-space" if punch.point else "half-plane"
    assert (f"film {shown(punch.thickness, 'm', 3)}" if punch.thickness else below) in drawing
    assert "slides" not in drawing
    assert ("polyline" in drawing) == punch.conducts


def test_a_sentence_changes_when_its_numbers_do(ran: Project) -> None:
    study = load(ran.folder / "config/small.yaml")
    folder, target = ran.folder / "results/small/design", study.design["sensor"]
    answer = netcdf.read(folder / "sensor.nc")
    moved = exact.of_design(study, target, answer)
    solved = {"contact": exact.contact(study, answer), "around": {}, "on_datum": moved}
    screen = firstscreen.answered(study, "sensor", target, answer, solved)
    assert said(screen.stops) == "Limited by tension behind the contact of 50 MPa."
    breaks = r"With .* 1 % off, tension behind the contact is [\d.]+ % beyond its limit\."
    assert re.fullmatch(breaks, said(screen.breaks))
    does = r"Voltage per load \(ground 1 m away\) ([\d.]+) mV·m/N ± ([\d.]+) %, at worst over friction 0\.1 to 0\.4"
    band = re.fullmatch(does, said(screen.does))
    assert band
    assert float(band[1]) == pytest.approx(1e3 * answer.terms[0].exact, rel=5e-3)
    assert float(band[2]) == pytest.approx(100 * answer.terms[0].spread, rel=0.05)
    goal = replace(answer.terms[0], exact=2 * answer.terms[0].exact)
    variables = tuple(replace(entry, value=0.05) if entry.name == "radius" else entry for entry in answer.variables)
    other = replace(answer, terms=(goal, *answer.terms[1:]), variables=variables)
    changed = firstscreen.answered(study, "sensor", target, other, {**solved, "contact": exact.contact(study, other)})
    assert said(changed.build).endswith("; R = 50 mm")
    number = [float(re.findall(r"[\d.]+", text.does)[1]) for text in (screen, changed)]
    assert number[1] == pytest.approx(2 * number[0], rel=0.01)
    assert changed.drawing != screen.drawing
    tight = replace(answer.terms[2], margin=0.02)
    within = [replace(variable, tolerance="5 %") if variable.chosen else variable for variable in answer.variables]
    terms = (goal, replace(answer.terms[1], margin=0.3), tight)
    assert "2 %" in first_to_break(replace(answer, variables=tuple(within), terms=terms))
    assert sentences.reached({"sensor": screen.verdict}) == "The target is reachable."


def said(text: str) -> str:
    return text.replace("\N{NO-BREAK SPACE}", " ")


def test_a_target_has_a_title_in_words_and_its_name_where_two_ask_the_same() -> None:
    study = load("config/quickstart.yaml")
    sensor, actuator = study.design.values()
    assert study.titles == {"sensor": "Largest voltage per load", "actuator": "Largest stroke per volt"}
    titled = actuator.model_copy(update={"title": "Which composite moves most?"})
    extended = study.model_copy(update={"design": {"sensor": sensor, "own_one": titled, "other_one": sensor}})
    first, second, third = extended.titles.values()
    assert (first, third) == ("Largest voltage per load (sensor)", "Largest voltage per load (other one)")
    assert second == "Which composite moves most?"


FILM_CASE: dict[str, float | str] = {
    "composite": "fibrous", "volume_fraction": 0.67, "thickness": 2.3e-4, "surroundings": "insulated", "base": "steel",
    "radius": 0.05,
}  # fmt: skip


@pytest.mark.parametrize(
    ("study", "case", "words"),
    [
        ("film", FILM_CASE, "Fibrous, 67 % BaTiO3, 230 µm on steel"),
        ("film", FILM_CASE | {"base": "rigid"}, "Fibrous, 67 % BaTiO3, 230 µm on a rigid base"),
        ("quickstart", {"material": "PZT-4"}, "PZT-4, a half-plane"),
        ("quickstart", {"composite": "AlScN", "scandium_fraction": 0.3}, "Al(0.7)Sc(0.3)N, a half-plane"),
    ],
)
def test_the_body_is_said_by_what_it_is(study: str, case: Case, words: str) -> None:
    assert firstscreen.body_in_words(shipped(study), case) == words


def test_layers_punches_and_doubts_are_said() -> None:
    body = [BodyLayer.model_validate({"composite": "fibrous", "volume_fraction": share, "thickness": 1e-4})
            for share in (0.2, 0.4)]  # fmt: skip
    layers = shipped("film").model_copy(update={"surroundings": "insulated", "body": body})
    expected = "Fibrous, 20 % BaTiO3, 100 µm on fibrous, 40 % BaTiO3, 100 µm on steel"
    assert firstscreen.body_in_words(layers, FILM_CASE) == expected
    contact = {"contact_trailing": 2e-4, "contact_leading": 2e-4}
    case = {**FILM_CASE, "radius": 0.05, "load": 1e4}
    assert "top layer 100 µm" in device.draw(firstscreen.of_case(layers, case, contact), "two layers")
    assert firstscreen.punch_in_words({"profile": "flat", "width": 2e-3}) == "flat punch 2 mm wide"
    finger: Case = {"profile": "sphere", "punch": "skin", "radius": 0.01}
    assert firstscreen.punch_in_words(finger) == "fingertip, R = 10 mm"
    assert firstscreen.punch_in_words({"profile": "wedge", "slope": 0.02}) == "wedge of slope 0.02"
    doubtful = shipped("quickstart").model_copy(update={"fixed": {"material": "P(VDF-TrFE) 75:25"}})
    assert firstscreen.doubted(doubtful) == "uncertain constants: c44 of P(VDF-TrFE) 75:25"
    assert firstscreen.doubted(shipped("quickstart")) == ""


def test_the_sentence_about_a_goal_is_that_of_the_chart_under_it(ran: Project) -> None:
    folder = ran.folder / "results/small"
    aims = coupling.aims(load(ran.folder / "config/small.yaml"))
    indices = read_whole(folder / "sensitivity.nc")
    drawn = (folder / "figures/sensitivity.svg").read_text(encoding="utf-8")
    bars = re.findall(r'data-factor="(\w+)".*? width="([\d.]+)"', drawn)
    count = indices.sizes["input"]
    assert len(bars) == count * len(aims)
    said = sentences.sensitivity(ranked.sensitivities(indices, aims))
    assert f'class="says">{said}'.replace("'", "&#39;") in (folder / "report.html").read_text(encoding="utf-8")
    for k, aim in enumerate(aims):
        bars_of_aim = bars[k * count : (k + 1) * count]
        totals = indices["total"].sel(output=aim)
        assert np.all(np.diff([float(totals.sel(input=name)) for name, _ in bars_of_aim]) <= 0)
        widths = [float(wide) for _, wide in bars_of_aim]
        assert widths == sorted(widths, reverse=True)
        assert re.search(rf"{title(aim)} \(\d+ %\)[^;]* most on {title(bars_of_aim[0][0])}", said, re.IGNORECASE)


def test_every_section_says_what_its_numbers_say() -> None:
    worst = {"name": "voltage", "error": 4.7e-7}
    assert [sentences.surrogate(worst, bound).endswith("is met.") for bound in (1e-6, 1e-7)] == [True, False]
    assert "4.7×10⁻⁷ of the range (voltage)" in sentences.surrogate(worst, 1e-6)
    for exact_time, faster in ((1e-5, "the exact solver is 3 times faster"), (6e-5, "the surrogate is 2 times faster")):
        times = {"exact_per_scattered_case": exact_time, "surrogate_mean_std_per_query": 3e-5}
        assert faster in sentences.time(times)
    rows = [{"name": "a", "error": 2e-4, "tolerance": 1e-3, "passed": True}]
    assert sentences.checks({"checks": rows}).startswith("1 of 1 checks passed; the largest error is 20 %")
    tried = {"cases": 50, "rows": [{"name": "load", "coverage": 0.96, "width": 0.01, "left": 0.1}]}
    assert all(number in sentences.readout([tried]) for number in ("1 %", "95 %", "96 % of 50 cases"))


def test_the_strongest_factor_is_that_of_the_widest_span_of_the_table() -> None:
    rows = [
        {"name": "base", "spans": {"trailing_tension": (1e3, 1e6)}},  # by a factor of 1,000, and yet the lesser
        {"name": "friction", "spans": {"trailing_tension": (20e6, 150e6), "voltage": (-1.0, 2.0)}},
    ]
    charts = ranked.spans(rows)
    assert [[bar.name for bar in width.bars] for width in charts] == [["friction", "base"], ["friction"]]
    drawn = ranked.draw(charts)
    assert re.findall(r'data-factor="(\w+)"', drawn) == ["friction", "base", "friction"]
    widths = [float(width) for width in re.findall(r'class="bar".*? width="([\d.]+)"', drawn)]
    assert widths[1] / widths[0] == pytest.approx(0.999 / 130, abs=0.01)
    (right,) = {*re.findall(r'viewBox="0 0 (\d+) ', drawn)}
    words = re.findall(r'<text x="([\d.]+)" y="\d+" fill="[^"]+" font-size="11">([^<]+)<', drawn)
    assert max(float(x) + TextPath((0, 0), text, size=11).get_extents().x1 for x, text in words) < float(right)
    sentence = sentences.strongest(charts)
    assert sentence.startswith("Tension behind the contact depends most on friction (20 MPa to 150 MPa)")


ROUGH = """\
title: Rough
effects:
  baseline:
    {material: PZT-4, profile: rough_sphere, radius: 20 mm, roughness: 10 nm, force: 200 mN,
     longest_wavelength: 100 um, shortest_wavelength: 30 um, grid_error: 0.1}
  realisations: 2
  positions: {inside: 10, outside: 10}
  vary: {force: [0.1, 0.4]}
"""


def test_random_surfaces_are_solved_each_and_drawn_with_their_band() -> None:
    data = spread(made(ROUGH), "force")
    each = data["peak_pressure"].transpose("force", "realisation")
    assert each.shape == (2, 2)
    # 1.8 and 8.3 % on grids of 0.005 as well
    np.testing.assert_allclose(np.ptp(each.values, axis=1) / each.values.mean(1), [0.018, 0.083], rtol=0.1)
    labels = [ax.get_ylabel() for ax in contact_maps.spread(data).axes if ax.get_visible()]
    assert labels == ["contact pressure [MPa]", "charge per force [pC/N]", "depth [nm]"]


def test_maps_share_a_window_that_holds_every_contact(tmp_path: Path) -> None:
    data = maps(made(ROUGH), "force")
    pressure = data["contact_pressure"].transpose("force", "x", "y")
    cell = float(np.diff(data["x"])[0] * np.diff(data["y"])[0])
    # a map of 121 points reads a grid of 64 cells: the sum of the pressure is the force to some percent
    np.testing.assert_allclose(pressure.sum(("x", "y")) * cell, [0.1, 0.4], rtol=0.05)
    assert float(abs(pressure[:, [0, -1]]).max()) < 1e-6 * float(pressure.max())
    style.save(contact_maps.maps(data), tmp_path / "map.svg")
    assert (tmp_path / "map.svg").stat().st_size > 10_000


def test_polar_plot_shows_both_signs_over_a_whole_turn() -> None:
    angle = np.linspace(0.01, np.pi - 0.01, 40)
    charge = xr.DataArray(1e-11 * np.sin(2 * angle), {"cut_angle": angle}, attrs={"units": "C N-1"})
    (ax,) = contact_maps.polar(xr.Dataset({"charge_per_force": charge})).axes
    shown = [np.isfinite(line.get_ydata()).sum() for line in ax.get_lines()]
    assert shown == pytest.approx([180, 180, 180, 180], abs=2)  # of 361 angles, half have each sign
    assert max(np.nanmax(line.get_ydata()) for line in ax.get_lines()) == pytest.approx(10, rel=1e-3)


ROLLER = {"profile": "roller", "radius": 0.02, "length": 5e-3, "crown_radius": 3.0, "punch": "steel"}
CUT = {"profile": "sphere", "radius": 5e-3, "cut": "tilt", "cut_angle": np.pi / 6}


@pytest.mark.parametrize(
    ("case", "words"),
    [
        (ROLLER, "PZT-4, 100 µm on steel; steel roller, R = 20 mm, 5 mm long, crown of 3 m, in air"),
        (CUT, "PZT-4, tilt cut of 30 deg, 100 µm on steel; ball, R = 5 mm, in air"),
    ],
)
def test_cards_name_and_draw_punches_in_space(case: dict[str, float | str], words: str) -> None:
    study = made(ROUGH)
    whole = {"material": "PZT-4", "thickness": 1e-4, "base": "steel", "surroundings": "air", "force": 1.0, **case}
    film = SimpleNamespace(**{name: getattr(study, name) for name in ("device", "phases", "own_materials")})
    film.body, film.kind, film.surroundings = [], KINDS["space", True, True], ["air"]
    assert firstscreen.in_words(film, whole) == words  # type: ignore[arg-type]
    drawn = firstscreen.of_case(film, whole, {"contact_length_x": 2e-4})  # type: ignore[arg-type]
    assert (drawn.contact, drawn.size) == (2e-4, case.get("radius", 5e-3))
    assert "<svg" in str(element(device.draw(drawn, "a punch"), "punch", "a punch"))
