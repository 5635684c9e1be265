"""Whatever the code shows of its use runs and says what is printed there."""

import doctest
import importlib
import re
import runpy
from pathlib import Path

import pytest

from workflow.run.provenance import ROOT

SHOWING = [
    ".".join(file.relative_to(ROOT).with_suffix("").parts)
    for room in ("meecontact", "storage", "solver", "surrogate", "workflow", "verification")
    for file in sorted((ROOT / room).rglob("*.py"))
    if ">>> " in file.read_text(encoding="utf-8")
]

#: What each script says of its figure, from docs/gallery.md; the largest pressures also stand in theory-films.md.
SAID = {
    "film_pressure.py": "largest pressure [MPa]: 316.8, 383.1, 647.3",
    "film_voltage.py": "rigid: most charge, 47.66 pC/N, at 0.22 mm",
    "film_interface.py": "0.2 mm: shear 105.8 MPa at X = -0.90, tension 6.42 MPa at X = 2.28",
}


@pytest.mark.parametrize("module", SHOWING)
def test_examples_of_docstrings_print_what_they_say(module: str) -> None:
    assert doctest.testmod(importlib.import_module(module)).failed == 0


@pytest.mark.parametrize("script", sorted((ROOT / "examples").glob("*.py")), ids=lambda script: script.name)
def test_a_script_draws_what_the_gallery_shows(
    script: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert len(script.read_text(encoding="utf-8").splitlines()) <= 40
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(script))
    assert SAID[script.name] in capsys.readouterr().out.splitlines()
    (drawn,) = tmp_path.glob("*.svg")
    gallery = (ROOT / "docs/gallery.md").read_text(encoding="utf-8")
    assert f"({drawn.name})" in gallery
    assert f"examples/{script.name}" in gallery
    # numbers of the page are those of the script
    for number in re.findall(r"\d+\.\d+", SAID[script.name]):
        assert number in gallery
