"""The page in a real browser, and its scripts in Node: what is drawn, said and judged, as Python does it."""

import base64
import json
import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jinja2 import Environment, FileSystemLoader

import surrogate
from storage.netcdf import read_whole
from surrogate import CurveGP, GaussianProcess, GroupedGP, Input
from surrogate.use.export import ERROR, exported
from tests.studies import fitted, made
from tests.surrogate import curved, functions, grouped
from tests.workflow.conftest import Project
from tests.workflow.report.browser import in_node, needs_browser, needs_node, opened
from workflow.dataset import factorial
from workflow.design.search import targets
from workflow.design.verdict import netcdf
from workflow.language import grammar
from workflow.language.constants import FIGURES
from workflow.language.titles import title
from workflow.report import page as reporting
from workflow.report import whatif
from workflow.report.page import TEMPLATES
from workflow.run.provenance import ROOT
from workflow.study.contents import Contents
from workflow.study.model import load
from workflow.study.target import Target

PROBE = """
<script>
addEventListener("load", () => {
  const first = Object.fromEntries([...document.querySelectorAll("[data-answer], .first")].map((one) => [
    `${one.closest("article")?.dataset.target ?? "page"} ${one.dataset.answer ?? "first"}`,
    { words: one.innerText, low: one.getBoundingClientRect().bottom + scrollY },
  ]));
  const evidence = [...document.querySelectorAll("#part-evidence section > details")];
  const [lines, shut] = [evidence.map((one) => one.firstElementChild.innerText), evidence.map((one) => one.open)];
  document.querySelectorAll("details").forEach((one) => { one.open = true; });
  const out = {
    first, lines, shut,
    images: document.images.length,
    figures: [...document.querySelectorAll("svg.figure")].map((svg) => {
      const frame = svg.getBoundingClientRect();
      const stored = svg.querySelector("metadata.hover"), tips = [];
      for (const { box } of stored ? JSON.parse(stored.textContent) : []) {
        for (let k = 1; k < 20 && !tips.length; k++) {
          for (let l = 1; l < 20 && !tips.length; l++) {
            const [x, y] = [box[0] + (k * (box[2] - box[0])) / 20, box[1] + (l * (box[3] - box[1])) / 20];
            const at = { clientX: frame.left + x * frame.width, clientY: frame.top + y * frame.height };
            svg.dispatchEvent(new PointerEvent("pointermove", at));
            const tip = document.querySelector(".tip");
            if (!tip.hidden) tips.push(tip.innerText);
          }
        }
      }
      const ids = [...svg.querySelectorAll("[id]")].map((one) => one.id);
      return { name: svg.closest("figure").id, shown: frame.width, high: frame.height, alt: svg.ariaLabel, tips, ids,
               paths: svg.querySelectorAll("path, line, text").length };
    }),
    complaints,
    bytes: document.documentElement.outerHTML.length,
    overflow: document.documentElement.scrollWidth - document.documentElement.clientWidth,
    loaded: performance.getEntriesByType("resource").map(e => e.name).filter(n => !n.startsWith("data:")),
    text: document.body.innerText,
  };
  report(out);
});
</script>
"""


def page(project: Project) -> str:
    return (project.folder / "results/small/report.html").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def looked(ran: Project, tmp_path_factory: pytest.TempPathFactory) -> Callable[[int], dict[str, Any]]:
    """Return the page as the browser sees it at a width; each is opened once."""
    return cache(lambda width: opened(page(ran), tmp_path_factory.mktemp("browser"), width, PROBE))


@needs_browser
@pytest.mark.parametrize("width", [1280, 500])
def test_every_figure_is_drawn(looked: Callable[[int], dict[str, Any]], width: int) -> None:
    seen = looked(width)
    kinds = [*dict.fromkeys(figure["name"] for figure in seen["figures"])]  # some have several parts
    targets = ("sensor", "impossible")
    devices = [f"device-{name}" for name in targets]
    design = [f"{kind}_{name}" for name in targets for kind in ("slices", "bars", "contact")]
    effects = ["spans"] + [f"{kind}_{name}" for name in ("friction", "material") for kind in ("effect", "interior")]
    evidence = ["decay", "errors", "residuals", "intervals"]
    names = [*devices, *design, "problem", "sensitivity", "main_effects", "fields", *effects, *evidence]
    assert kinds == [f"figure-{name}" for name in names]
    bars = [f"figure-{name}" for name in (*devices, "spans", "sensitivity", "bars_sensor", "bars_impossible")]
    assert seen["images"] == 0
    for figure in seen["figures"]:
        assert figure["shown"] > 100
        assert figure["high"] > 50
        assert figure["paths"] > (2 if figure["name"] in bars else 10)
        assert len(figure["alt"]) > 20
    ids = [identifier for figure in seen["figures"] for identifier in figure["ids"]]
    assert len(ids) == len(set(ids))
    tips = {figure["name"]: figure["tips"] for figure in seen["figures"]}
    assert "worst-case voltage per load: " in tips["figure-slices_sensor"][0]
    assert "MPa" in tips["figure-contact_sensor"][0]
    silent = ("figure-problem", "figure-residuals", "figure-interior", *bars)
    assert all(tips[name] for name in kinds if not name.startswith(silent))
    assert seen["loaded"] == seen["complaints"] == []
    assert seen["overflow"] == 0
    assert seen["bytes"] < 1.2e6


@needs_browser
@pytest.mark.parametrize("width", [1280, 500])
def test_who_decides_reads_the_first_screen_only(looked: Callable[[int], dict[str, Any]], width: int) -> None:
    seen = looked(width)
    first = {name: part["words"].replace("\N{NO-BREAK SPACE}", " ") for name, part in seen["first"].items()}
    assert first["page first"] == "Largest stroke per volt is not reachable (1 of 2 targets)."
    beyond = "beyond linear theory; otherwise recommended within the model; a tilt of "
    assert first["sensor verdict"].startswith(beyond)
    assert "50 MPa" in first["sensor stops"]
    assert first["sensor beyond"].startswith("Tension behind the contact of 50 MPa exceeds the tensile strength of ")
    assert first["impossible verdict"] == "not reachable"
    names = ("verdict", "build", "does", "stops", "breaks")
    targets = ("sensor", "impossible") if width == 1280 else ("sensor",)
    assert all(seen["first"][f"{target} {name}"]["low"] < 800 for target in targets for name in names)
    text = str(seen["text"]).replace("\N{NO-BREAK SPACE}", " ")
    assert "Left out of the model: a tilt of 100 µrad raises the largest pressure " in text
    assert "1 MPa: 9070 % beyond the limit" in text
    assert seen["shut"] == [False] * 3  # evidence is a line of verdict until it is opened
    assert seen["lines"][0].startswith("Surrogate ")
    assert "0.001 is met" in seen["lines"][0]


def test_the_page_is_whole_escaped_and_its_own(ran: Project, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    written = page(ran)
    assert f"Polish: {netcdf.read(ran.folder / 'results/small/design/sensor.nc').polish}." in written
    sources = re.findall(r'(?:src|href)="([^"]*)"', written)
    assert sources
    assert all(source.startswith(("data:", "#")) for source in sources)
    assert not re.search(r"<script[^>]*\bsrc=", written)
    assert "url(" not in written.split("</style>")[0]
    assert set(re.findall(r"url\((.)", written)) == {"#"}
    results = tmp_path / "results/small"
    shutil.copytree(ran.folder / "results/small", results)
    for orphan in ("fields/slab_2.nc", "fields/slab_3.nc", "levels.nc"):
        (results / orphan).write_bytes(b"old")
    config = load(ran.folder / "config/small.yaml").model_copy(update={"title": "<script>alert(1)</script>"})
    figures = sorted((results / "figures").rglob("*.svg"))
    monkeypatch.delattr(factorial, "exact")  # nothing is solved
    monkeypatch.delattr(Contents, "solved")
    text = reporting.page(config, "small", results, figures, results / "provenance.json")
    assert "<script>alert" not in text
    assert "&lt;script&gt;" in text
    assert re.search(r"positions each, in 2\s+slabs of", text)
    assert "Why these levels" not in text


@needs_node
def test_map_tile_and_verdict_agree_at_every_design(ran: Project, tmp_path: Path) -> None:
    (data,) = re.findall(r'id="whatif-data">(.*?)</script>', page(ran), re.DOTALL)
    script = """
const model = loadSurrogate(data.surrogate), panel = { data, model, chosen: 0, kind: null }, judge = judging(panel);
const told = data.cases.map((target, k) => {
  [panel.chosen, panel.kind] = [k, data.kinds[target.kind]];
  const t = model.inputs.map((input) => toUnit(input, target.values[input.name]));
  return { tile: judge.cell(t), map: judge.cell(t, true), exact: judge.goal().exact };
});"""
    seen = in_node(f"{SCRIPTS}const data = {data};{script}", "told", tmp_path)
    for card, name in zip(seen, ("sensor", "impossible"), strict=True):
        answer = netcdf.read(ran.folder / "results/small/design" / f"{name}.nc")
        goal, *limits = answer.terms
        assert card["exact"] == pytest.approx(goal.exact, rel=1e-12)
        for cell in (card["tile"], card["map"]):
            assert abs(cell["goal"] - goal.exact) <= goal.half
            assert cell["broken"] == (not answer.feasible)
            assert [beyond > 0 for beyond in cell["limits"]] == [limit.broken for limit in limits]


def test_the_page_knows_which_limits_a_point_decides(ran: Project) -> None:
    config, folder = load(ran.folder / "config/small.yaml"), ran.folder / "results/small"
    texts = ["trailing_tension <= 50 MPa", "trailing_tension <= 50 MPa with probability 0.9"]
    texts += ["deviation(voltage_per_load) <= 5 %"]
    changed = {"worst_case": {}, "uncertain": {"friction": {"normal": [0.2, 0.03]}}, "subject_to": texts}
    target = Target.model_validate(config.design["sensor"].model_dump() | changed | {"tolerance": {"radius": "5 %"}})
    answer = netcdf.read(folder / "design/sensor.nc")
    limits = [replace(answer.terms[1], statement=limit) for limit in target.limits]
    answer = replace(answer, terms=(answer.terms[0], *limits))
    study = config.model_copy(update={"design": {"one": target}})
    model, quantities = surrogate.load(folder / "surrogate.nc"), read_whole(folder / "quantities.nc")
    content = whatif.content(study, model, quantities, [answer])
    assert content is not None
    (case,) = content["cases"]
    assert [limit["judged"] for limit in case["limits"]] == [True, False, False]


#: A study whose punch and composite are chosen from lists.
CHOSEN = """\
title: A choice
fixed: {friction: 0.2, load: 1e4}
categories: {composite: [fibrous, laminate], profile: [cylinder, half_cylinder]}
factors:
  volume_fraction: {low: 0.5, high: 0.7, levels: 4}
  radius: {low: 0.02, high: 0.2, levels: 4, scale: log}
dataset: {slabs: 2, positions: {inside: 12, outside: 8}}
surrogate: {outputs: [voltage_per_load, trailing_tension]}
validation: {cases: 50, calibration: 100, tolerance: 1e-2}
design:
  best:
    maximise: abs(voltage_per_load)
    over: [volume_fraction, radius, composite, profile]
    subject_to: [trailing_tension <= 30 MPa]
  held:
    maximise: abs(voltage_per_load)
    over: [radius]
    at: {volume_fraction: 0.6, composite: laminate, profile: half_cylinder}
"""

#: Chooses every combination of the panel's lists, then presses the buttons, and reads the panel each time.
CHOOSE = """
<script>
addEventListener("load", () => {
  const root = document.getElementById("whatif"), choosers = [...root.querySelectorAll("select[data-category]")];
  const all = (where, key, value) =>
    Object.fromEntries([...root.querySelectorAll(where)].map((one) => [one.dataset[key], one.dataset[value]]));
  const read = () => ({
    names: choosers.map((one) => one.value),
    inputs: all("output[data-input]", "input", "value"),
    mean: all("tr[data-output]", "output", "mean"),
    limits: [...root.querySelectorAll("li[data-limit]")].map((one) => one.dataset.verdict),
  });
  const seen = [];
  const [one, other] = choosers;
  for (const first of one.options) for (const second of other.options) {
    one.value = first.value;
    other.value = second.value;
    other.dispatchEvent(new Event("change"));
    seen.push(read());
  }
  root.querySelectorAll("button[data-case]").forEach((button) => { button.click(); seen.push(read()); });
  report({ seen, complaints });
});
</script>
"""


@needs_browser
def test_lists_choose_what_the_panel_shows(ran: Project, tmp_path: Path) -> None:
    """The panel of a study with categories, in the place of the panel of the small study."""
    study = made(CHOSEN)
    model, quantities = fitted(study, calibrated=True), factorial.exact(study, factorial.axes(study))
    answers = [targets.solve_target(study, name, model) for name in study.design]
    content = whatif.content(study, model, quantities, answers)
    environment = Environment(loader=FileSystemLoader(TEMPLATES), autoescape=True)
    environment.filters["title"] = title
    assert content is not None
    known = {"hanging": frozenset(), "on_datum": lambda hangs: "", "whatif_json": whatif.as_json(content)}
    panel = environment.get_template("whatif.html.j2").render(whatif=content, **known)
    text = re.sub(r'<section id="whatif">.*?</section>', lambda _: panel, page(ran), count=1, flags=re.DOTALL)
    seen = opened(text, tmp_path, 1000, CHOOSE)
    assert seen["complaints"] == []
    assert len(seen["seen"]) == 6
    assert len({tuple(shown["names"]) for shown in seen["seen"][:4]}) == 4
    for shown in seen["seen"]:
        answer = model.predict({name: float(value) for name, value in shown["inputs"].items()})
        for name, value in shown["mean"].items():
            full = f"{name}[{', '.join(shown['names'])}]"
            low, high = content["ranges"][model.outputs_.index(full)]
            assert float(value) == pytest.approx(float(answer[full]), abs=1.5 * ERROR * (high - low))
    assert seen["seen"][-1]["names"] == ["laminate", "half_cylinder"]
    assert seen["seen"][-2]["limits"] == ["held"]
    assert seen["seen"][-1]["limits"] == []


SCRIPT = (ROOT / "workflow/report/templates/explore.js").read_text(encoding="utf-8")
WIDE, HIGH = 174.0, 34.0  # of "voltage over thickness / at most 500 kV/m"
STEPS = np.linspace(0.0, 1.0, 41)


def polyline(x: np.ndarray[Any, Any], y: np.ndarray[Any, Any]) -> list[list[list[float]]]:
    """Segments between points of the picture, whose frame is 64 to 470 by 12 to 318."""
    points = np.stack([np.broadcast_to(x, STEPS.shape), np.broadcast_to(y, STEPS.shape)], 1).tolist()
    return [list(pair) for pair in pairwise(points)]


LINES = {
    "steep": polyline(260 + 20 * STEPS, 12 + 306 * STEPS),
    "flat": polyline(64 + 406 * STEPS, 160 + 10 * STEPS),
    "diagonal": polyline(64 + 406 * STEPS, 318 - 306 * STEPS),
    "bent": polyline(100 + 300 * STEPS, 40 + 250 * (1 - STEPS) ** 3),
}


@needs_node
@pytest.mark.parametrize("others", [(), ("flat",)], ids=str)
def test_a_name_crosses_no_line_and_covers_no_other(others: tuple[str, ...], tmp_path: Path) -> None:
    segments = [segment for name in others for segment in LINES[name]]
    star = {"left": 250.0, "right": 286.0, "top": 147.0, "bottom": 181.0}
    lines = [(line, line + segments) for name, line in LINES.items() if name not in others]
    asks = ",".join(f"namePlace({line}, {WIDE}, {HIGH}, {all_lines}, [{star}])" for line, all_lines in lines)
    for (line, all_lines), place in zip(lines, in_node(SCRIPT, f"[{asks}]", tmp_path), strict=True):
        dense = np.concatenate([np.linspace(ends[0], ends[1], 9) for ends in all_lines])
        left, right, top, bottom = (place[key] for key in ("left", "right", "top", "bottom"))
        assert (right - left, bottom - top) == pytest.approx((WIDE, HIGH))
        assert not np.any((dense[:, 0] > left) & (dense[:, 0] < right) & (dense[:, 1] > top) & (dense[:, 1] < bottom))
        assert left >= star["right"] or right <= star["left"] or top >= star["bottom"] or bottom <= star["top"]
        assert 64 <= left < right <= 470
        assert 12 <= top < bottom <= 318
        starts = np.array([ends[0] for ends in line])
        aside = np.maximum(np.maximum(left - starts[:, 0], starts[:, 0] - right), 0)
        below = np.maximum(np.maximum(top - starts[:, 1], starts[:, 1] - bottom), 0)
        assert np.hypot(aside, below).min() < HIGH  # it is its line's


@needs_node
def test_the_panel_s_csv_quotes_commas_and_formulas(tmp_path: Path) -> None:
    script = (ROOT / "workflow/report/templates/share.js").read_text(encoding="utf-8")
    texts = ["PZT, soft", "=A1", "-x", 'say "so"', "plain", -1]
    cells = in_node(script, f"{json.dumps(texts)}.map(csvCell)", tmp_path)
    assert cells == ['"PZT, soft"', "'=A1", "'-x", '"say ""so"""', "plain", -1]


FILES = ("numbers.js", "surrogate.js", "largest.js", "judging.js")
SCRIPTS = "".join((TEMPLATES / name).read_text(encoding="utf-8") for name in FILES)

STUDY = """
title: A sensor
fixed: {surroundings: insulated, composite: fibrous, friction: 0.2, base: steel, thickness: 5e-4, radius: 0.05}
factors:
  volume_fraction: {low: 0.4, high: 0.6, levels: 3}
  load: {low: 1e3, high: 1e4, levels: 3}
surrogate: {outputs: [charge_per_force, capacitance]}
device:
  electrode_length: 10 mm
  amplifier: {input_capacitance: 10 pF, cable_capacitance: 100 pF, charge_noise: 1 fC, voltage_noise: 20 uV}
"""


@needs_node
def test_figures_at_the_sliders_are_those_of_python(tmp_path: Path) -> None:
    study = made(STUDY)
    values = {"charge_per_force": -4e-11, "capacitance_per_length": 2e-8, "load": 5e3}
    trees = {figure["name"]: figure["tree"] for figure in whatif.figures(study)}
    script = f"{SCRIPTS}const trees = {json.dumps(trees)}, values = {json.dumps(values)};"
    values_of = "Object.fromEntries(Object.entries(trees).map(([name, tree]) => [name, evaluate(tree, values)]))"
    constants = {name: np.array(value) for name, value in study.device.constants.items()} if study.device else {}
    known = {name: np.array(value) for name, value in values.items()} | constants
    expected = {name: float(grammar.parse(FIGURES[name].formula).evaluate(known)) for name in trees}
    assert in_node(script, values_of, tmp_path) == pytest.approx(expected, rel=1e-12)
    moved = in_node(script, "carried(trees.signal_charge, values, { charge_per_force: 1e-13 })", tmp_path)
    assert moved == pytest.approx(1e-13 * 5e3 * 0.01, rel=1e-9)  # linear in it: load times length times the change


ANSWERS = """({
  ...Object.fromEntries(["mean", "std", "lower", "upper"].map(
    (part) => [part, points.map((t) => [...predict(model, t)[part]])])),
  means: points.map((t) => [...means(model, t)]),
  shares: points.map((t) => fromUnit(share, t[0])),
})"""
SHARE = Input("share", 0.02, 0.9, "logit")


def of_groups() -> GaussianProcess:
    model = GroupedGP(grouped.GROUPING).fit(grouped.factorial(0.2))
    return model.calibrate(grouped.cases(300, 1, 0.2, to_ends=300))


def of_curves_over_groups() -> GaussianProcess:
    """Calibrated on cases that are off by some 1e-3: what they are is no matter here."""
    model = curved.fitted_over_groups()
    points = functions.drawn(curved.INPUTS, 60, 3)
    off = model.predict(points, return_std=False) * (1 + 1e-3 * np.sin(40 * points["a"]))
    return model.calibrate(off.assign(points.data_vars))


@needs_node
@pytest.mark.parametrize("fitted_model", [of_groups, of_curves_over_groups])
def test_the_script_says_the_same(fitted_model: Callable[[], GaussianProcess], tmp_path: Path) -> None:
    model = fitted_model()
    t = np.random.default_rng(2).uniform(-1, 1, (40, len(model.inputs_)))
    t[0], t[1] = 1.0, -1.0
    X = np.stack([axis.from_unit(row) for axis, row in zip(model.inputs_, t.T, strict=True)], axis=1)
    mean, std = model.predict_array(X, return_std=True)
    data = {"model": exported(model), "points": t.tolist()}
    data["share"] = {"name": "share", "low": 0.02, "high": 0.9, "scale": "logit"}
    script = f"{SCRIPTS}const data = {json.dumps(data)}, {{ points, share }} = data, model = loadSurrogate(data.model);"
    seen = in_node(script, ANSWERS, tmp_path)
    lower, upper = model.interval_array(X)
    interval = data["model"]["interval"]
    rooms = np.frombuffer(base64.b64decode(interval["rooms"]["data"]))
    size = np.ptp(mean, axis=0)
    assert (rooms <= (3 if isinstance(model, CurveGP) else 1) * ERROR * size).all()  # errors of scores add up
    np.testing.assert_array_equal(seen["mean"], seen["means"])
    off = np.abs(seen["mean"] - mean)
    assert (off <= 2 * rooms).all()  # they are the largest errors on 2,000 points
    np.testing.assert_allclose(seen["std"], std, rtol=2e-5)  # calibrated in single precision
    np.testing.assert_allclose(np.array(seen["lower"]) + rooms, lower, rtol=0, atol=3 * rooms.max() + 2e-5 * std.max())
    np.testing.assert_allclose(np.array(seen["upper"]) - rooms, upper, rtol=0, atol=3 * rooms.max() + 2e-5 * std.max())
    np.testing.assert_allclose(seen["shares"], SHARE.from_unit(t[:, 0]), rtol=1e-13)
