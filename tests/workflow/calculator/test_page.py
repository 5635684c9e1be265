"""The calculator in a browser: what is typed is told, drawn, kept in the link, and anyone can use it."""

import json
from pathlib import Path
from typing import Any

import pytest

import solver
from solver.names import ALL_QUANTITIES
from solver.units import in_si
from tests.programs import Command
from tests.workflow.report.browser import axe, needs_browser, opened
from workflow.calculator import page as calculator
from workflow.calculator.films import FILMS, PUNCHES, tables, variants
from workflow.calculator.page import page

PROBE = """
<script>
const text = (id) => document.getElementById(id).textContent;
const out = {}, seen = (name) => (document.querySelector(`[data-name=${name}] .value`) || {}).textContent;
const set = (values) => {
  for (const [name, one] of Object.entries(values)) form.elements[name].value = one;
  form.dispatchEvent(new Event("input"));
};
addEventListener("load", async () => {
  const bands = (...names) => names.map((name) => document.querySelector(`[data-name=${name}] .band`).textContent);
  const told = ["contact_radius", "charge_per_force", "peak_pressure"];
  const words = text("band-words");
  out.first = { verdict: text("verdict"), bands: bands(...told), words };
  const shown = [...document.querySelectorAll(".figure")].map((one) => one.dataset.name);
  out.first.figures = Object.fromEntries(shown.map((name) => [name, seen(name)]));
  out.first.commands = text("commands");
  set({ material: "AlN", profile: "cylinder", radius: "2 cm", load: "50 kN/m", friction: "0.3", punch: "steel" });
  const names = ["width", "trailing_tension", "voltage"];
  out.line = Object.fromEntries(names.map((name) => [name, seen(name)]));
  out.hash = location.hash;
  out.drawn = document.querySelectorAll("#drawing circle, #pressure .curve").length;
  out.commands = text("commands");
  set({ radius: "2 kg" });
  const invalid = form.elements.radius.getAttribute("aria-invalid");
  out.refused = [text("radius-note"), invalid, document.getElementById("answer").hidden];
  set({ radius: "50" });
  out.asked = text("radius-note");
  const ball = { profile: "sphere", radius: "0.1 mm", force: "1 mN" };
  form.elements.material.value = "AlScN (30 % Sc) on silicon";
  form.elements.material.dispatchEvent(new Event("input", { bubbles: true }));
  out.thickness = form.elements.thickness.value;
  set(ball);
  out.film = seen("contact_radius");
  set({ profile: "cylinder" });
  out.film_line = text("refused-words");
  set({ material: "own constants", ...ball, electric: "voltage", voltage: "25 V" });
  out.own = text("verdict-lines");
  location.hash = "#material=PZT-4&profile=disc&width=1+mm&force=10+N&punch=rigid&nonsense=1";
  await new Promise((done) => setTimeout(done, 100));
  const curves = document.querySelectorAll("#pressure .curve").length;
  out.restored = [seen("contact_radius"), seen("peak_pressure"), curves];
  const violations = (await axe.run(document, { resultTypes: ["violations"] })).violations;
  out.violations = violations.map(({ id, nodes }) => `${id}: ${nodes.map((one) => one.target).join(" ")}`);
  out.wide = document.documentElement.scrollWidth > innerWidth;
  out.complaints = complaints;
  report(out);
});
</script>
"""


@needs_browser
@pytest.mark.parametrize("width", [1280, 500])
def test_the_page_answers_draws_and_keeps_its_state(width: int, tmp_path: Path) -> None:
    seen: dict[str, Any] = opened(page(), tmp_path, width, axe() + PROBE)
    assert seen["complaints"] == seen["violations"] == []
    assert not seen["wide"]
    if width == 500:
        return
    default = FILMS["PVDF on glass"] | {"profile": "sphere", "radius": 2.5e-3, "punch": "steel", "thickness": 110e-6}
    assert "surroundings" not in seen["first"]["commands"]  # the page has the solver's default
    assert seen["first"]["verdict"] == "Within what is known of the material"
    assert seen["first"]["words"].startswith("The face between film and base is grounded. The band is how far 4 other")
    assert seen["first"]["words"].endswith("Air surrounds the contact.")
    default["force"] = 0.01
    pairs = variants(FILMS["PVDF on glass"])
    pressed, *moved = (solver.solve({**default, "material": top, "base": base}) for top, base in pairs)
    names = ("contact_radius", "charge_per_force", "peak_pressure")
    wide = [max(abs(float(other[name] / pressed[name] - 1)) for other in moved) for name in names]
    assert seen["first"]["bands"] == [f"± {100 * share:.{1 if share < 0.1 else 2}g} %" for share in wide]
    assert len(seen["first"]["figures"]) == 10
    for name in names:  # three digits, 5e-3 of 1.00, of tables that are good to 5e-4
        read = in_si(seen["first"]["figures"][name], pressed[name].units)
        assert read == pytest.approx(float(pressed[name]), rel=5.5e-3), name
    line = {"profile": "cylinder", "material": "AlN", "radius": 0.02, "load": 5e4, "friction": 0.3, "punch": "steel"}
    solved = solver.solve(line)
    assert seen["line"] == {
        "width": f"{1e6 * float(solved['contact_trailing'] + solved['contact_leading']):.3g} µm",
        "trailing_tension": f"{float(solved['trailing_tension']) / 1e6:.3g} MPa",
        "voltage": f"{float(solved['voltage']) / 1e3:.3g} kV".replace("-", "−"),
    }
    assert seen["hash"].startswith("#material=AlN&profile=cylinder&radius=2+cm")
    assert seen["drawn"] == 2
    assert "AlN,cylinder,0.02,50000,0.3,1,steel" in seen["commands"]
    note, invalid, hidden = seen["refused"]
    assert (invalid, hidden) == ("true", True)
    assert "kg does not measure it" in note
    assert seen["asked"] == "50 is 50 m; did you mean 50 µm?"
    film = FILMS["AlScN (30 % Sc) on silicon"] | {"profile": "sphere", "radius": 1e-4, "thickness": 1e-6}
    assert seen["thickness"] == "1 um"
    pressed = solver.solve(film | {"force": 1e-3, "punch": "steel"})
    assert seen["film"] == f"{1e9 * float(pressed['contact_radius']):.3g} nm"
    assert "a film under a roller" in seen["film_line"].lower()
    assert "depoling stress" in seen["own"]
    assert seen["restored"] == ["500 µm", "–", 1]


def test_a_command_writes_it(tmp_path: Path, command: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(calculator, "tables", lambda: tables(["AlN on silicon"]))
    path = tmp_path / "mine.html"
    assert "open it in a browser" in command("calculator", "-o", path)[1]
    written = path.read_text(encoding="utf-8")
    assert written == page()
    library, films = (written.partition(f'id="{name}">')[2].partition("</script>")[0] for name in ("library", "films"))
    assert set(json.loads(library)["units"]) >= set(ALL_QUANTITIES)
    assert [table["punch"] for table in json.loads(films)] == list(PUNCHES)
