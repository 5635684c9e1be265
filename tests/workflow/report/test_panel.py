"""The what-if panel in a browser: its map, stack, fields, link and CSV are those of Python, and anyone can use it."""

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from solver.names import ALL_QUANTITIES
from storage.netcdf import read_whole
from surrogate import GaussianProcess
from surrogate import load as load_surrogate
from surrogate.use.export import ERROR
from tests.workflow.conftest import Project
from tests.workflow.report.browser import axe, needs_browser, opened
from workflow.design.question import scenarios
from workflow.design.question.pilot import ask
from workflow.design.question.sources import Exact, Predicted
from workflow.design.verdict import assessment, netcdf
from workflow.language.numbers import number, shown
from workflow.learning import surface
from workflow.report import device, whatif
from workflow.report.device import Device
from workflow.study.model import load
from workflow.study.target import Target

NODES = 29  # a side of the map
Seen = dict[str, Any]

PROBE = """
<script>
addEventListener("load", async () => {
  const root = document.getElementById("whatif"), map = root.querySelector("svg.map");
  const data = JSON.parse(document.getElementById("whatif-data").textContent), fields = loadSurrogate(data.fields);
  const wait = (time) => new Promise((done) => setTimeout(done, time));
  const shown = () => [...root.querySelectorAll("output[data-input]")].map(({ dataset }) => dataset);
  const inputs = () => Object.fromEntries(shown().map(({ input, value }) => [input, Number(value)]));
  const scaled = (values) => data.surrogate.inputs.map((input) => toUnit(input, values[input.name]));
  const out = { start: inputs(), stack: root.querySelector("[data-stack]").innerHTML };
  const X = [-0.99, -0.5, 0.1, 0.9];
  const exponent = means(loadSurrogate(data.surrogate), scaled(out.start))[2];
  out.fields = surfaceFields(fields, scaled(out.start), exponent, X);
  await wait(3000);
  out.map = { ...map.dataset, lines: map.querySelectorAll("path.limit").length, words: map.textContent };
  const [frame, star] = [".frame", "[data-star]"].map((one) => map.querySelector(one).getBoundingClientRect());
  const near = { clientX: star.left + star.width / 2, clientY: star.top + star.height / 2 };
  map.dispatchEvent(new PointerEvent("pointermove", near));
  out.star = document.querySelector(".tip").innerText;
  const tile = (one) => root.querySelector(`[data-${one}]`);
  const headline = () => ({ goal: tile("goal").innerText, verdict: tile("verdict").dataset.verdict });
  out.headline = headline();
  const at = { clientX: frame.left + 0.75 * frame.width, clientY: frame.top + 0.25 * frame.height };
  map.dispatchEvent(new MouseEvent("click", at));
  map.dispatchEvent(new PointerEvent("pointermove", at));
  out.tile = headline();
  out.tip = document.querySelector(".tip").innerText;
  out.clicked = inputs();
  out.verdicts = [...root.querySelectorAll("li[data-limit]")].map((one) => one.dataset.verdict);
  root.querySelector("[data-share=link]").click();
  out.link = location.hash;
  let file = null;
  URL.createObjectURL = (blob) => { file = blob; return "#"; };
  root.querySelector("[data-share=csv]").click();
  out.csv = await file.text();
  location.hash = "#whatif?target=actuator&volume_fraction=0.3&radius=0.01&load=nonsense&unknown=1";
  await wait(100);
  out.restored = { ...inputs(), pressed: root.querySelector("button[aria-pressed=true]").innerText };
  out.charts = [...root.querySelectorAll("svg[data-field]")].map((svg) => svg.querySelectorAll("polyline").length);
  const found = await axe.run(document, { resultTypes: ["violations"] });
  out.violations = found.violations.map(({ id, nodes }) => `${id}: ${nodes.map((one) => one.target).join(" ")}`);
  const sliders = [...root.querySelectorAll("input[type=range]")];
  root.querySelector("details").open = true;
  out.slid = PLACES.map((place) => {
    sliders.forEach((slider, k) => {
      slider.value = String(place[k]);
      slider.dispatchEvent(new Event("input"));
    });
    const rows = [...root.querySelectorAll("tr[data-output]")];
    const cells = (row) => [{ ...row.dataset }, ...[1, 3, 2].map((k) => row.cells[k].innerText)];
    return { inputs: inputs(), rows: Object.fromEntries(rows.map((row) => [row.dataset.output, cells(row)])) };
  });
  out.complaints = complaints;
  report(out);
});
</script>
"""
#: Places of the sliders in scaled coordinates: the ends of the box, and others within it.
PLACES = np.vstack([-np.ones(5), np.ones(5), np.random.default_rng(0).uniform(-1, 1, (4, 5)).round(4)])

#: What the panel says of the limits of each target at some points of it.
JUDGING = """
<script>
addEventListener("load", async () => {
  const root = document.getElementById("whatif"), out = {};
  for (const point of POINTS) {
    location.hash = point;
    await new Promise((done) => setTimeout(done, 50));
    out[point] = [...root.querySelectorAll("li[data-limit]")].map(({ dataset }) => ({ ...dataset }));
  }
  report({ judged: out, over: document.getElementById("judged").textContent, complaints });
});
</script>
"""


@pytest.fixture(scope="module")
def seen(quickstart_run: Project, tmp_path_factory: pytest.TempPathFactory) -> Seen:
    """State of the quickstart's panel while it is used."""
    page = (quickstart_run.folder / "results/quickstart/report.html").read_text(encoding="utf-8")
    probe = PROBE.replace("PLACES", json.dumps(PLACES.tolist()))
    return opened(page, tmp_path_factory.mktemp("panel"), 1280, axe() + probe)


@pytest.fixture(scope="module")
def model(quickstart_run: Project) -> GaussianProcess:
    return load_surrogate(quickstart_run.folder / "results/quickstart/surrogate.nc")


@pytest.fixture(scope="module")
def rounding(quickstart_run: Project) -> dict[str, float]:
    """Rounding of each quantity on the page, a little more than on the points that judge it."""
    values = read_whole(quickstart_run.folder / "results/quickstart/quantities.nc")
    return {str(name): 1.5 * ERROR * float(np.ptp(array.values)) for name, array in values.items()}


@needs_browser
def test_the_map_is_the_goal_over_the_scenarios_and_a_click_moves_the_sliders(
    seen: Seen, model: GaussianProcess, quickstart_run: Project, rounding: dict[str, float]
) -> None:
    assert seen["complaints"] == seen["violations"] == []
    target = load("config/quickstart.yaml").design["sensor"]
    friction = scenarios.corners(target, scenarios.SEARCHED).values["friction"]
    t = np.linspace(-1, 1, NODES)
    fraction, radius = (model.box[name].from_unit(t) for name in ("volume_fraction", "radius"))
    point = {"volume_fraction": fraction, "radius": radius[::-1], "friction": friction, "load": 5e3, "charge": 0.0}
    # rows from the top
    predicted = model.predict(point, return_std=False).transpose("radius", "volume_fraction", "friction")
    goal, tension = (predicted[name].values for name in ("voltage_per_load", "trailing_tension"))
    worst = np.abs(goal).min(axis=-1)
    drawn, answer = seen["map"], netcdf.read(quickstart_run.folder / "results/quickstart/design/sensor.nc")
    exact = answer.terms[0].exact
    ends = [min(worst.min(), exact), max(worst.max(), exact)]
    room = rounding["voltage_per_load"]
    assert [float(drawn[end]) for end in ("low", "high")] == pytest.approx(ends, rel=0, abs=room)
    broken = tension.max(axis=-1) > 35e6  # what BaTiO3 bears
    assert 0 < broken.sum() < broken.size
    assert int(drawn["broken"]) == broken.sum()
    named = ("tension behind the contact at most 35 MPa", "radius [mm]", "volume fraction", "voltage per load [mV·m/N]")
    assert all(words in drawn["words"] for words in named)
    # the star, the large number and the card say the same
    value = shown(exact, "V m N-1", 3)
    words = "voltage per load at worst over friction 0.1 to 0.4"
    assert seen["star"].startswith(f"the design, exact\n{words}: {value}\n")
    assert seen["headline"] == {"goal": f"{value}\n{words}", "verdict": "kept"}
    assert seen["tip"].split("\n")[0] == "{1}: {0}".format(*seen["tile"]["goal"].split("\n"))
    assert ("a limit is broken" in seen["tip"]) == (seen["tile"]["verdict"] == "broken")
    for name in ("volume_fraction", "radius"):
        # a click is at a whole pixel, which is 1.4 % of the radius
        assert seen["clicked"][name] == pytest.approx(float(model.box[name].from_unit(0.5)), rel=0.015)
    assert seen["start"] == pytest.approx(dict(answer.terms[0].worst), rel=1e-9)
    for name in ("friction", "load"):
        assert seen["clicked"][name] == seen["start"][name]
    assert len(seen["verdicts"]) == 1


@needs_browser
def test_sliders_move_the_numbers_of_python(seen: Seen, model: GaussianProcess, rounding: dict[str, float]) -> None:
    for position, place in zip(PLACES, seen["slid"], strict=True):
        point = place["inputs"]
        expected = [float(axis.from_unit(t)) for axis, t in zip(model.inputs_, position, strict=True)]
        assert [point[name] for name in model.box] == pytest.approx(expected, rel=1e-12)
        mean, ends = model.predict(point), model.interval(point)
        for name, (data, value, unit, interval) in place["rows"].items():
            room, units = rounding[name], ALL_QUANTITIES[name].units
            printed, lower, upper = (float(data[key]) for key in ("mean", "lower", "upper"))
            half = float(ends[f"{name}_upper"] - ends[f"{name}_lower"]) / 2
            assert printed == pytest.approx(float(mean[name]), abs=room)
            expected = [float(ends[f"{name}_{end}"]) for end in ("lower", "upper")]
            assert [lower, upper] == pytest.approx(expected, abs=2 * room + 1e-4 * half)
            assert f"{value} {unit}".strip() == shown(printed, units, 3)
            half, share = (upper - lower) / 2, (upper - lower) / 2 / abs(printed)
            wide = f"{number(100 * share, 2)} %" if share < 1 else shown(half, units, 2)
            assert interval == ("± < 0.001 %" if share < 1e-5 else f"± {wide}")


@needs_browser
def test_the_stack_is_drawn_as_python_draws_it(seen: Seen, model: GaussianProcess) -> None:
    study, point = load("config/quickstart.yaml"), seen["start"]
    contact = model.predict(point, return_std=False)
    body = whatif.drawn_body(study, study.combinations[0])
    assert (body["size"], body["thickness"], body["base"]) == ("radius", None, "")
    drawn_punch = Device(body["profile"], body["corner"], point["radius"], float(contact["contact_trailing"]),
                 float(contact["contact_leading"]), point["load"], body["conducts"],
                 slides=point["friction"] > 0)  # fmt: skip
    assert body["slides"] == "friction"

    papers = r'<rect width[^>]*>|<rect [^>]*height="250"[^>]*>|<svg[^>]*>|<g [^>]*>|<marker.*?</marker>'

    def drawn(text: str) -> tuple[list[str], list[float]]:
        """Words and numbers of a drawing without its papers, parts and arrow tips."""
        bare = re.sub(papers, "", text)
        places = " ".join(re.findall(r'(?:points|[xy][12]?|width|height)="([^"]*)"', bare))
        return re.findall(r"<text[^>]*>([^<]*)", bare), [float(place) for place in re.findall(r"-?\d+\.?\d*", places)]

    words, numbers = drawn(seen["stack"])
    expected_words, expected = drawn(device.draw(drawn_punch, ""))
    assert words == expected_words
    np.testing.assert_allclose(numbers, expected, atol=0.011)


@needs_browser
def test_fields_are_those_of_python(seen: Seen, model: GaussianProcess, quickstart_run: Project) -> None:
    X = np.array([-0.99, -0.5, 0.1, 0.9])
    fields = load_surrogate(quickstart_run.folder / "results/quickstart/surface.nc")
    expected = surface.predict(fields, model, seen["start"], X)
    for name in surface.NAMES:
        room = 10 * ERROR * np.abs(expected[name]).max()  # singular edges
        np.testing.assert_allclose(seen["fields"][name], expected[name], rtol=0, atol=room)
    assert seen["charts"] == [1, 1, 1, 1]


@needs_browser
def test_a_link_and_a_file_hold_the_point(seen: Seen, model: GaussianProcess, rounding: dict[str, float]) -> None:
    point = seen["clicked"]
    values = [f"{name}={json.dumps(value)}" for name, value in point.items()]
    assert seen["link"] == "#whatif?" + "&".join([*values, "target=sensor"])
    header, row = (line.split(",") for line in seen["csv"].splitlines())
    columns = dict(zip(header, map(float, row), strict=True))
    expected = model.predict(point).assign(model.interval(point).data_vars)
    assert list(columns)[:5] == list(point)
    for name in model.outputs_:
        room, std = rounding[name], float(expected[f"{name}_std"])
        assert columns[name] == pytest.approx(float(expected[name]), abs=room)
        assert columns[f"{name}_std"] == pytest.approx(std, rel=2e-5)  # calibrated in single precision
        assert columns[f"{name}_upper"] == pytest.approx(float(expected[f"{name}_upper"]), abs=2 * room + 1e-4 * std)
    restored = seen["restored"]
    assert restored["volume_fraction"] == pytest.approx(0.3, rel=1e-12)
    assert restored["radius"] == pytest.approx(0.01, rel=1e-12)
    assert restored["load"] == pytest.approx(5e3)  # no number: the design's own
    assert restored["pressed"] == "Largest stroke per volt"


@needs_browser
def test_limits_within_tolerances_are_judged(quickstart_run: Project, model: GaussianProcess, tmp_path: Path) -> None:
    folder, study = quickstart_run.folder / "results/quickstart", load("config/quickstart.yaml")
    target = study.design["sensor"].model_dump() | {"tolerance": {"radius": "5 %", "volume_fraction": 0.02}}
    target["subject_to"] = [*target["subject_to"], "abs(voltage) / contact_trailing <= 4 MV/m"]
    mine = study.model_copy(update={"design": {"sensor": Target.model_validate(target)}})
    design = netcdf.read(folder / "design/sensor.nc")
    field = replace(design.terms[1], statement=mine.design["sensor"].limits[1], limit=4e6)
    design = replace(design, terms=(*design.terms[:2], field))
    content = whatif.content(mine, model, read_whole(folder / "quantities.nc"), [design])
    page = re.sub(
        r'(<script type="application/json" id="whatif-data">).*?(</script>)',
        lambda match: match[1] + str(whatif.as_json(content)) + match[2],
        (folder / "report.html").read_text(encoding="utf-8"),
        count=1,
    )
    points = [{"volume_fraction": v, "radius": r} for v, r in [(0.5, 0.12), (0.6722, 0.1456), (0.8, 0.03)]]
    links = [f"#whatif?target=sensor&volume_fraction={p['volume_fraction']}&radius={p['radius']}" for p in points]
    seen = opened(page, tmp_path, 1280, JUDGING.replace("POINTS", json.dumps(links)))
    assert seen["complaints"] == []
    assert "over friction 0.1 to 0.4 and the tolerances of radius and volume fraction" in seen["over"]
    question = ask(mine, "sensor", mine.design["sensor"], Predicted(model), Exact(mine))
    verdicts: set[str] = set()
    for point, link in zip(points, links, strict=True):
        x = np.array([[float(axis.to_unit(point[key])) for key, axis in question.inputs.items()]])
        judged = question.at(x)
        guessed = assessment.predict(judged, question.searched)
        rooms = guessed.reaches + assessment.tolerances(judged)
        rows = zip(question.terms, guessed.values, rooms, strict=True)
        expected = {t.label: (v, r, t.bound) for t, v, r in rows if t.limited}
        judgements = seen["judged"][link]
        assert [entry["limit"] for entry in judgements] == list(expected)
        for entry, (value, room, bound) in zip(judgements, expected.values(), strict=True):
            excess, reach = float(entry["value"]) - bound, float(entry["room"])
            words = "broken" if excess > reach else "held" if excess < -reach else "on the limit"
            assert entry["verdict"].startswith(words)
            verdicts.add(words)
            rounded = 2 * 200 * ERROR * abs(value)  # of two ranges, one 200 times larger
            assert float(entry["value"]) == pytest.approx(value, abs=rounded)
            assert (1 - 2e-5) * room - 2e-12 * abs(bound) <= float(entry["room"]) <= (1 + 2e-5) * room + rounded
    assert verdicts >= {"held", "broken"}
