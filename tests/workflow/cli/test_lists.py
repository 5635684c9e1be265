"""Help, lists, materials, new studies and progress: printed on any terminal, and read as printed."""

import contextlib
import io
import logging
import os
import re
import shlex
import subprocess
import sys
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import solver
from solver.halfplane.surface import HalfPlane
from solver.material.constants import UNITS
from solver.material.punches import punches
from solver.names import ALL_QUANTITIES
from solver.units import in_si
from tests.programs import Command
from workflow.cli import main, studies
from workflow.cli.main import COMMANDS
from workflow.cli.progress import Progress, busy, step
from workflow.cli.words import printable_streams
from workflow.language.numbers import shown
from workflow.run.provenance import ROOT
from workflow.study.model import load
from workflow.study.reading import read_material, read_yaml


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_an_example_that_it_takes(name: str, here: Path, command: Command) -> None:
    program, *words = shlex.split(command(name, "--help")[0].split("example:\n")[1].replace("\\\n", " "))
    assert (program, words[0]) == ("meecontact", name)
    module, _, function = main._parser().parse_args(words).function.partition(".")
    assert callable(getattr(import_module(f"workflow.cli.{module}"), function))
    assert any(line.split()[:1] == [name] and len(line.split()) > 2 for line in command()[0].splitlines())
    if name in ("list", "material", "solve"):
        (here / "examples").symlink_to(ROOT / "examples")
        assert command(*words)[0]


@pytest.mark.slow
def test_no_command_loads_what_it_does_not_need(tmp_path: Path) -> None:
    program = f"""
import contextlib, sys
from workflow.cli.main import main
def loaded(*names): print(*[name for name in names if name in sys.modules], file=sys.stderr)
with contextlib.suppress(SystemExit):
    main(["--help"])
loaded("numpy", "pydantic")
main(["solve", "examples/cases.csv", "-o", {str(tmp_path / "out.nc")!r}])
loaded("pydantic", "surrogate", "scipy.linalg", "scipy.optimize")
import workflow.cli.query, surrogate.gp.gridgp
loaded("pydantic", "sklearn", "scipy.linalg", "scipy.optimize", "workflow.study.model")
import workflow.dataset.slabs, workflow.dataset.datacard, workflow.cli.launch
loaded("sklearn", "matplotlib", "jinja2", "scipy.stats")
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=ROOT)
    assert [line for line in done.stderr.split("\n") if not line.startswith(("wrote", "left out", "empty"))] == [""] * 5


@pytest.mark.parametrize("encoding", ["ascii", "cp1252", "utf-8"])
@pytest.mark.parametrize("command", [["material"], ["material", "PZT-4"], ["list"], ["--help"], ["list", "µ⁻¹ Ω – π"]])
def test_any_terminal_can_print_any_command(encoding: str, command: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    streams = [io.TextIOWrapper(io.BytesIO(), encoding=encoding) for _ in range(2)]
    for name, stream in zip(("stdout", "stderr"), streams, strict=True):
        monkeypatch.setattr(sys, name, stream)
    with contextlib.suppress(SystemExit):
        main.main(command)
    for stream in streams:
        stream.flush()
        assert b"?" not in stream.buffer.getvalue().replace(b"?\n", b"").replace(b"? ", b"")


def test_messages_that_nobody_reads_stop_no_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cases, answer = tmp_path / "cases.csv", tmp_path / "answer.csv"
    cases.write_text("material,profile,radius,force\nPZT-4,sphere,5 mm,1 N\n", encoding="utf-8")
    reader, writer = os.pipe()
    os.close(reader)
    with os.fdopen(writer, "w", encoding="utf-8") as stream:
        monkeypatch.setattr(sys, "stderr", stream)
        assert main.main(["solve", str(cases), "-o", str(answer)]) == 0
        monkeypatch.undo()
    assert answer.read_text(encoding="utf-8").count("\n") == 2


@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "utf-8"])
def test_numbers_are_read_as_they_are_printed(encoding: str, monkeypatch: pytest.MonkeyPatch) -> None:
    for unit in {*UNITS.values(), "V m N-1", "N m-1", "Ohm m", "F"}:
        for value in (-1.234e-12, 5.6e-5, 0.789, 4.2e3, 1.39e11):
            stream = io.TextIOWrapper(io.BytesIO(), encoding=encoding)
            monkeypatch.setattr(sys, "stdout", stream)
            printable_streams()
            print(shown(value, unit))
            stream.flush()
            printed = stream.buffer.getvalue().decode(encoding).strip()
            read = in_si(printed, unit) if not printed[-1].isdigit() or unit != "1" else float(printed)
            np.testing.assert_allclose(read, value, rtol=1e-4, err_msg=printed)


def test_temperatures_in_celsius_are_absolute() -> None:
    assert in_si("33 degC", "K") == in_si("33°C", "K") == 306.15
    assert in_si("-12.5 ℃", "K") == 260.65
    with pytest.raises(ValueError, match="'degC' is not a unit"):
        in_si("33 degC", "W m-1 K-1")


def test_material_lists_what_is_built_in(command: Command) -> None:
    out, _ = command("material")
    assert max(map(len, out.splitlines())) <= 100
    entries = [" ".join(text.split()) for text in re.split(r"\n(?! )", out)]
    for (name, material), entry in zip(solver.materials().items(), entries, strict=False):
        assert entry.startswith(name)
        assert entry.endswith(" ".join(material.source.split()))
        assert (entry[len(name) :].split()[0] == "*") == bool(material.note or material.alternatives)
    assert entries[len(solver.materials())].startswith("* repaired, doubtful or disputed")


EVIDENCE = """\
name: mine
c11: 126 GPa
c13: 84.1 GPa
c33: 117 GPa
c44: 23 GPa
limits:
  tensile_strength: {value: 27 MPa, source: a data sheet}
  coercive_field: {value: 0.8 kV/mm, source: another}
alternatives:
  - {c44: 25 GPa, eps33: 12.7 nF/m, source: another lot}
"""


def test_limits_and_alternatives_with_units(command: Command) -> None:
    path = command.file("m.yaml", EVIDENCE)
    assert read_material(path)[0] == "mine"
    printed = [" ".join(line.split()) for line in command("material", path)[0].splitlines()]
    assert "c44 23 GPa 23 GPa to 25 GPa by source" in printed
    assert "c11 126 GPa" in printed
    assert "mine (alternative 1): c44 = 25 GPa, eps33 = 12.7 nF/m: another lot" in printed
    assert "coercive_field 800 kV/m another" in printed


def test_the_compliance_of_a_material_has_the_solver_s_numbers(command: Command) -> None:
    name = "BaTiO3-CoFe2O4 50:50"
    out, _ = command("material", name)
    half = HalfPlane(solver.find(name))
    speed = float(solver.limiting_speed(solver.find(name)))
    assert f"limiting speed of a conducting punch: {speed / 1e3:.6g} km/s" in out
    for word in ("admissible", "1.901723i", "1.324019i", "0.935605i", "0.797192i", "Sih"):
        assert word in out
    lines = out[out.index("compliance N") :].splitlines()
    rows = [re.split(r" {2,}", line.strip()) for line in lines if line[0] == " "]
    values = np.array([[in_si(cell.replace("1/Pa", "Pa-1"), units) for cell, units in zip(row, row_units, strict=True)]
                      for row, row_units in zip(rows, UNITS_OF_N, strict=True)])  # fmt: skip
    np.testing.assert_allclose(values, [*half.compliance, half.friction_coupling], rtol=5e-6)


#: Slopes over tractions: [1/Pa], [V/m / Pa], [A/m / Pa], ...
UNITS_OF_N = [["Pa-1", "V/Pa/m", "A/Pa/m"], ["m2 C-1", "V m C-1", "A m C-1"], ["A m N-1", "A m C-1", "A m-1 T-1"],
              ["Pa-1", "V m N-1", "A m N-1"]]  # fmt: skip


@pytest.mark.parametrize("name", ["skin", "steel"])
def test_a_punch_has_its_constants_for_heat(name: str, command: Command) -> None:
    punch = command("material", name)[0].split(f"{name} as a punch: ")[1]
    for constant, unit in (("conductivity", "W m-1 K-1"), ("heat_capacity", "J m-3 K-1")):
        value = shown(punches()[name].thermal[constant].value, unit, 6)
        assert re.search(rf"  {constant} +{re.escape(value)} +\S", punch), constant


def test_what_init_writes_is_a_study_with_a_comment_on_every_part(here: Path, command: Command) -> None:
    assert command("init", "mine") == ("", "wrote config/mine.yaml: meecontact run mine\n")
    study = load(here / "config/mine.yaml")
    assert study.design["sensor"].limits
    assert study.cases == 12 * 4 * 6 * 6
    text = (here / "config/mine.yaml").read_text(encoding="utf-8")
    assert "meecontact run mine" in text
    assert text.count("#") > 12
    refusal = "meecontact: init: config/mine.yaml is there already; remove it, or choose another name\n"
    assert command.refused("init", "mine") == refusal
    assert command.refused("init", "../mine").startswith("meecontact: init: '../mine': a study's file must be named")
    assert [file.name for file in here.rglob("*.yaml")] == ["mine.yaml"]
    command("init", "balls", "--like", "point_sensor")
    assert read_yaml(here / "config/balls.yaml") == read_yaml(ROOT / "config/point_sensor.yaml")
    said = command.refused("init", "other", "--like", "point_senor")
    assert "--like: 'point_senor' is unknown; did you mean 'point_sensor'?" in said


def test_list_tells_every_name_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    printed = studies.listed(None)
    assert re.findall(r"^\w+:$", printed, re.MULTILINE) == ["studies:", "factors:", "quantities:", "materials:"]
    quantities = studies.listed("quantities").splitlines()
    assert [line.split()[0] for line in quantities] == list(ALL_QUANTITIES)
    assert any(line.split()[:2] == ["voltage_per_load", "V·m/N"] for line in quantities)
    assert re.search(r"^quickstart +Which composite", studies.listed("studies"), re.MULTILINE)
    local = studies.listed("studies")
    monkeypatch.chdir(tmp_path)
    assert studies.listed("studies") == local  # those that come with the program
    (tmp_path / "config").mkdir()
    (tmp_path / "config/mine.yaml").write_text("title: My own\n", encoding="utf-8")
    first, *others = studies.listed("studies").splitlines()
    assert first.split() == ["mine", "My", "own"]
    assert [line.split() for line in others] == [line.split() for line in local.splitlines()]


class Terminal(io.StringIO):
    """A stream that people look at."""

    def isatty(self) -> bool:
        return True


def record(event: str = "", level: int = logging.INFO, message: str = "", **known: Any) -> logging.LogRecord:
    """Record of Snakemake's log."""
    entry = logging.LogRecord("snakemake.logging", level, "", 0, message, None, None)
    entry.__dict__.update(known, event=type("Event", (), {"value": event})())
    return entry


def test_a_log_has_a_line_a_step_and_a_terminal_one_line_in_all() -> None:
    """Two jobs that begin, one that ends, and lines of Snakemake's own."""
    study = load("config/quickstart.yaml")
    records = [
        record("run_info", message="Job stats"),
        record("job_info", jobid=3, rule_name="surrogate", wildcards={"study": "quickstart"}),
        record("job_info", jobid=4, rule_name="target", wildcards={"study": "quickstart", "name": "sensor"}),
        record("job_finished", job_id=3, message="Finished jobid: 3"),
        record("progress", done=5, total=19),
        record(message="Nothing to be done (all requested files are present and up to date)."),
        record("job_error", logging.ERROR, "Error in rule surrogate"),
    ]
    fitting = "fitting the surrogate (21 quantities, 41,600 cases)"
    log, terminal = io.StringIO(), Terminal()
    for stream in (log, terminal):
        shown = Progress(study, stream)
        assert [shown.filter(entry) for entry in records] == [False] * 5 + [True] * 2
    assert log.getvalue() == f"{fitting}\ntarget sensor\n"
    shown.clear()
    text = terminal.getvalue()
    assert text.endswith("\r\x1b[K")
    assert "\n" not in text
    lines = text.split("\r\x1b[K")
    assert lines[1:3] == [fitting, f"{fitting}, target sensor"]
    assert "5 of 19 steps done; target sensor" in lines


def test_a_step_is_said_by_what_it_does() -> None:
    study, names = load("config/quickstart.yaml"), {"slab": "1", "name": "sensor", "group": "films", "round": "1"}
    for rule, name, words in (("slab", "slab", "solving the data set, part 2 of 2"),
                              ("figure_errors", "", "drawing errors"),
                              ("figure_design", "name", "drawing design sensor"),
                              ("check", "group", "verification films"),
                              ("report", "", "writing the page")):  # fmt: skip
        wildcards = {key: value for key, value in names.items() if key == name}
        assert step(study, rule, {"study": "quickstart", **wildcards}) == words
    rules = [line.split()[1].rstrip(":") for file in (ROOT / "workflow/rules").glob("*.smk")
             for line in file.read_text(encoding="utf-8").splitlines() if line.startswith("rule ")]  # fmt: skip
    assert len(rules) > 20
    assert all(rule.startswith("figure_") or "drawing" not in step(study, rule, names) for rule in rules)


def test_only_a_terminal_sees_the_step(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    with busy("searching"):
        pass
    assert capsys.readouterr() == ("", "")
    terminal = Terminal()
    monkeypatch.setattr("sys.stderr", terminal)
    with busy("searching"):
        pass
    clear = "\r\x1b[K"
    assert terminal.getvalue() == f"{clear}searching ...{clear}"
