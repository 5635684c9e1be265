"""The page in a real browser: every figure drawn, nothing loaded from elsewhere, no script needed."""

import html
import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import surrogate
from surrogate.netcdf import read_whole
from tests.workflow.conftest import Project

BROWSER = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
needs_browser = pytest.mark.skipif(BROWSER is None, reason="no Chromium: the browser tests are left out")

PROBE = """
<script>
addEventListener("load", () => {
  const out = {
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
               paths: svg.querySelectorAll("path").length };
    }),
    complaints,
    bytes: document.documentElement.outerHTML.length,
    overflow: document.documentElement.scrollWidth - document.documentElement.clientWidth,
    loaded: performance.getEntriesByType("resource").map(e => e.name).filter(n => !n.startsWith("data:")),
    text: document.body.innerText,
  };
  const pre = document.createElement("pre");
  pre.id = "probe";
  pre.textContent = JSON.stringify(out);
  document.body.replaceChildren(pre);
});
</script>
"""


#: Collects whatever a script complains about.
ERRORS = """
<script>
window.complaints = [];
addEventListener("error", (event) => complaints.push(String(event.message)));
console.error = console.warn = (...words) => complaints.push(words.join(" "));
</script>
"""

#: Moves every slider to given places, then presses the buttons, and reads the panel each time.
SLIDE = """
<script>
addEventListener("load", () => {
  const root = document.getElementById("whatif"), sliders = [...root.querySelectorAll("input[type=range]")];
  const all = (where, key, value) =>
    Object.fromEntries([...root.querySelectorAll(where)].map((one) => [one.dataset[key], one.dataset[value]]));
  const read = () => ({
    inputs: all("output[data-input]", "input", "value"),
    mean: all("tr[data-output]", "output", "mean"),
    std: all("tr[data-output]", "output", "std"),
    kept: [...root.querySelectorAll("li[data-limit]")].map((l) => l.dataset.kept === "true"),
    shown: [...root.querySelectorAll("tr[data-output]")].map((r) => r.innerText),
    curve: root.querySelector("svg polyline") ? root.querySelector("svg polyline").getAttribute("points") : "",
  });
  const seen = [read()];
  for (const place of PLACES) {
    sliders.forEach((slider, k) => {
      slider.value = String(place[k]);
      slider.dispatchEvent(new Event("input"));
    });
    seen.push(read());
  }
  const presets = [...root.querySelectorAll("button[data-case]")].map((button) => { button.click(); return read(); });
  const pre = document.createElement("pre");
  pre.id = "probe";
  pre.textContent = JSON.stringify({ seen, presets, complaints });
  document.body.replaceChildren(pre);
});
</script>
"""


def page(project: Project) -> str:
    return (project.folder / "results/small/report.html").read_text(encoding="utf-8")


def opened(text: str, folder: Path, width: int, probe: str = PROBE) -> dict[str, Any]:
    """What a headless Chromium sees of a page at some width."""
    assert BROWSER is not None
    file = folder / "probe.html"
    file.write_text(
        text.replace("<head>", f"<head>{ERRORS}", 1).replace("</body>", f"{probe}</body>"), encoding="utf-8"
    )
    flags = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"]
    flags += ["--disable-quic", "--disable-component-update", "--disable-sync", f"--user-data-dir={folder / 'profile'}"]
    done = subprocess.run(
        [BROWSER, *flags, f"--window-size={width},900", "--virtual-time-budget=20000", "--dump-dom", file.as_uri()],
        capture_output=True, text=True, timeout=120, check=True,
    )  # fmt: skip
    found = re.search(r'<pre id="probe">(.*?)</pre>', done.stdout, re.DOTALL)
    assert found, done.stdout[:2000]
    seen = json.loads(html.unescape(found[1]))
    assert isinstance(seen, dict)
    return seen


@needs_browser
@pytest.mark.parametrize("width", [1280, 500])
def test_every_figure_is_drawn(ran: Project, tmp_path: Path, width: int) -> None:
    seen = opened(page(ran), tmp_path, width)
    kinds = [figure["name"] for figure in seen["figures"]]
    shown = ("map", "slices", "bars", "contact")
    design = [f"figure-{kind}_{name}" for name in ("sensor", "impossible") for kind in shown]
    effects = [f"figure-{kind}_{name}" for name in ("friction", "material") for kind in ("effect", "interior")]
    learning = ("fields", "decay", "errors", "parity", "intervals", "sensitivity", "main_effects")
    assert kinds == [*(f"figure-{name}" for name in learning), *design, *effects]
    assert seen["images"] == 0
    for figure in seen["figures"]:
        assert figure["shown"] > 100
        assert figure["high"] > 50
        assert figure["paths"] > 10
        assert len(figure["alt"]) > 20
    ids = [one for figure in seen["figures"] for one in figure["ids"]]
    assert len(ids) == len(set(ids))
    tips = {figure["name"]: figure["tips"] for figure in seen["figures"]}
    assert tips["figure-map_sensor"][0].startswith("worst-case abs(voltage_sensitivity): ")
    assert "mV m N⁻¹\nvolume fraction of phase one: " in tips["figure-map_sensor"][0]
    assert "MPa" in tips["figure-contact_sensor"][0]
    assert all(tips[name] for name in kinds if not name.startswith(("figure-parity", "figure-bars", "figure-interior")))
    assert seen["loaded"] == []
    assert seen["complaints"] == []
    assert seen["overflow"] == 0
    assert seen["bytes"] < 6e6


@needs_browser
def test_the_page_says_what_a_reader_needs(ran: Project, tmp_path: Path) -> None:
    text = str(opened(page(ran), tmp_path, 1280)["text"])
    for word in (
        "A small study",
        "640",
        "exact solver",
        "surrogate, mean and interval",
        "feasible; binding",
        "infeasible",
    ):
        assert word in text


def test_the_page_is_self_contained(ran: Project) -> None:
    text = page(ran)
    sources = re.findall(r'(?:src|href)="([^"]*)"', text)
    assert sources
    assert all(source.startswith(("data:", "#")) for source in sources)
    assert not re.search(r"<script[^>]*\bsrc=", text)
    assert "url(" not in text.split("</style>")[0]
    assert set(re.findall(r"url\((.)", text)) == {"#"}


def test_text_from_the_study_is_escaped(ran: Project) -> None:
    from workflow import report, study

    config = study.load(ran.folder / "config/small.yaml").model_copy(update={"title": "<script>alert(1)</script>"})
    results = ran.folder / "results/small"
    figures = sorted((results / "figures").rglob("*.svg"))
    text = report.page(config, "small", results, figures, results / "provenance.json")
    assert "<script>alert" not in text
    assert "&lt;script&gt;" in text


@needs_browser
def test_sliders_move_numbers_that_are_those_of_python(ran: Project, tmp_path: Path) -> None:
    model = surrogate.load(ran.folder / "results/small/surrogate.nc")
    places = np.round(np.random.default_rng(0).uniform(-1, 1, (12, len(model.box))), 4)
    places[:2] = [[-1] * len(model.box), [1] * len(model.box)]
    probe = SLIDE.replace("PLACES", json.dumps(places.tolist()))
    found = opened(page(ran), tmp_path, 1000, probe)
    assert found["complaints"] == []
    assert len(found["seen"]) == len(places) + 1
    assert len(found["presets"]) == 2
    spread = read_whole(ran.folder / "results/small/quantities.nc")
    for one in [*found["seen"], *found["presets"]]:
        point = {name: float(value) for name, value in one["inputs"].items()}
        mean = model.predict(point)
        for name in model.outputs_:
            room = 1e-9 * np.ptp(spread[name].values)
            assert float(one["mean"][name]) == pytest.approx(float(mean[name]), abs=room)
            assert float(one["std"][name]) == pytest.approx(float(mean[f"{name}_std"]), rel=1e-6)
        tension, peak = float(mean["trailing_tension"]), float(mean["peak_pressure"])
        assert one["kept"] == [tension <= 50e6, peak <= 500e6, tension <= 1e6]
        assert one["curve"] == ""  # the small study does not learn the contact's extents
    for place, one in zip(places, found["seen"][1:], strict=True):
        for (name, value), t in zip(one["inputs"].items(), place, strict=True):
            assert float(value) == pytest.approx(float(model.box[name].from_unit(t)), rel=1e-12)
    texts = {tuple(one["shown"]) for one in found["seen"]}
    assert len(texts) == len(found["seen"])
    design = read_whole(ran.folder / "results/small/design/sensor.nc")
    for name, value in found["presets"][0]["inputs"].items():
        assert float(value) == pytest.approx(float(design["worst"].sel(factor=name)[0]), rel=1e-9)
