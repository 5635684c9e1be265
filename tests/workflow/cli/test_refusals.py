"""Options and files are refused in one line with status 2, and nothing is written or replaced."""

import json
import os
import shlex
import subprocess
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from snakemake.cli import parse_config

from surrogate import GridGP, Input, save
from tests.programs import Command
from workflow.cli import casetable
from workflow.study import location

STUDY = """\
title: Mine
fixed: {material: PZT-4, radius: 0.05}
factors: {load: {low: 5e3, high: 5e4, levels: 4}}
"""
CONSTANTS = "c11: 1e11\nc13: 5e10\nc33: 1e11\nc44: 1e10\n"
FILES = {
    "cases.csv": "material,radius,load\nBaTiO3,0.1,1e4\n",
    "points.csv": "radius,friction\n0.1,0.1\n",
    "history.csv": "time,force\n0,0\n1,1\n",
    "config/mine.yaml": STUDY,
    "config/slip.yaml": STUDY.replace("load:", "laod:"),
    "results/one/report.html": "",
    "results/two/surrogate.nc": "",
}


def two_inputs(path: Path, output: str, units: str) -> Path:
    """The file of a surrogate of two inputs and one output."""
    inputs = [Input("radius", 0.01, 0.2, "log", "m"), Input("friction", 0.0, 0.5, units="1")]
    axes = {axis.name: axis.levels(5) for axis in inputs}
    values = np.exp(axes["friction"]) * np.log(axes["radius"])[:, None]
    data = xr.Dataset({output: (("radius", "friction"), values, {"units": units})}, coords=axes)
    save(GridGP(inputs=inputs, outputs=[output]).fit(data), path)
    return path


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    return two_inputs(tmp_path_factory.mktemp("model") / "surrogate.nc", "depth", "m").read_bytes()


@pytest.fixture
def place(model: bytes, here: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a file of every kind that commands read, a pipe, a folder and a link."""
    monkeypatch.setattr(os, "environ", {**os.environ})
    monkeypatch.setattr(casetable, "_MOST_CASES", 20)
    monkeypatch.setattr(casetable, "_MOST_LINES", 80)
    for name, text in FILES.items():
        Path(name).parent.mkdir(parents=True, exist_ok=True)
        Path(name).write_text(text, encoding="utf-8")
    for name in ("surrogate.nc", "results/one/surrogate.nc"):
        Path(name).write_bytes(model)
    os.mkfifo("pipe.nc")
    Path("folder.nc").mkdir()
    Path("link.nc").symlink_to("cases.csv")
    return here


SOLVED, INSIDE = "solve cases.csv -o out.nc", "interior cases.csv -o out.nc --x=0 --y=-1"
ASKED, SIGNAL = "query surrogate.nc --extrapolate --at", "signal history.csv -o out.csv --device input_resistance=1GOhm"
BALL = "--on profile=sphere,material=BaTiO3,radius=5mm"
AMPLIFIED = "signal history.csv -o out.csv --device input_capacitance=10pF,input_resistance=1GOhm"

COMMANDS = [
    ("slove", "'slove' is unknown; did you mean 'solve'?"),
    ("list material", "list: 'material' is unknown; did you mean 'materials'?"),
    *((f"run mine --cores={count}", "--cores: ") for count in ("0", "x", "１", "9" * 300)),
    ("run slip", "config/slip.yaml: factors.laod: 'laod' is not a factor; did you mean 'load'"),
    ("material AlScN", "is a composition, not one material: a case says composite=AlScN and scandium_fraction"),
    # files
    ("solve absent.csv -o out.nc", "absent.csv: No such file"),
    ("solve cases.csv -o absent/out.nc", "absent does not exist"),
    ("solve cases.csv -o x.xlsx", "must end in .nc"),
    ("interior cases.csv --x=0 --y=-1", "-o/--output"),
    ("solve cases.csv -o out.csv --positions 0", "out.csv: fields over position go to netCDF"),
    ("solve cases.csv -o link.nc", "link.nc: is an input of this command, so it is not replaced"),
    ("query surrogate.nc points.csv -o points.csv", "points.csv: is an input of this command, so it is not replaced"),
    ("query surrogate.nc points.csv -o surrogate.nc", "'surrogate.nc': must end in .csv"),
    ("query surrogate.nc points.csv -o /dev/null", "'/dev/null': must end in .csv"),
    ("solve cases.csv -o pipe.nc", "pipe.nc: not a regular file, so it is not replaced"),
    ("solve cases.csv -o folder.nc", "folder.nc: not a regular file, so it is not replaced"),
    ("solve pipe.nc -o out.nc", "pipe.nc: not a regular file"),
    ("solve /dev/zero -o out.nc", "/dev/zero: not a regular file"),
    ("query pipe.nc --at radius=0.1,friction=0.1", "not a regular file"),
    ("material pipe.nc", "not a regular file"),
    *((f"{words} {'x' * 300}", "xxx: File name too long") for words in ("query --at a=1", "export --as c", "solve")),
    # exports
    ("export surrogate.nc --as c --outputs volt", "--outputs: volt: not an output of the surrogate; allowed: depth"),
    ("export surrogate.nc --as c --error 2", "--error: 2: must be one number from 1e-12 to 0.1, a share of the range"),
    ("export surrogate.nc --as c -o x.c --precision single --error 1e-9", "error 1e-09 is not reached"),
    ("export surrogate.nc --as c -o 2.c", "export: '2' is no name in C"),
    ("export surrogate.nc --as c -o x.cpp", "-o: x.cpp: must end in .c"),
    ("export surrogate.nc --as fortran", "'fortran' is unknown; allowed: c, fmu"),
    # results
    ("query config --at load=1", "surrogate: config: holds no surrogate.nc"),
    ("query WRONG --at load=1", "WRONG: no such file or folder; must be results/STUDY"),
    ("query results/tow --at load=1", "did you mean 'two'? allowed: one, two; `meecontact run STUDY` makes one"),
    ("query results/one/report.html --at load=1", "is a page, no surrogate; results/one/surrogate.nc is"),
    # positions and grids
    (f"{SOLVED} --positions=0,x", "--positions: 'x' is not a number"),
    (f"{SOLVED} --positions=nan", "positions: nan"),
    (f"{INSIDE} --x=0,a", "--x: 'a' is not a number"),
    (f"{INSIDE} --y=0.5", "y: 0.5 is above the surface; y/h must be <= 0"),
    (f"{INSIDE} --fields=von_mise", "fields: 'von_mise' is not one of"),
    (f"{INSIDE} --x=1 --y=-1e-300", "line 2: von_mises: not finite for these factors"),
    # a case on the command line
    ("solve", "give either a table CASES.csv or --at"),
    ("solve --at material=PZT-4,radius", "'radius' is not of the form NAME=VALUE"),
    ("solve --at 'material=PZT-4,radius=5 kg,load=1 N/m'", "--at: radius: '5 kg': unit mismatch"),
    ("solve --at material=my.yaml,radius=5mm,load=1", "; an own one: --materials FILE.yaml"),
    ("solve --at 'material=PZT-4 radius=5 mm'", "two equal signs; commas stand between NAME=VALUE"),
    ("solve --at material=PZT-4,radius=5mm,lod=1", "did you mean 'load'?"),
    ("solve --at 'material=PZT-4,profile=sphere,radius=5 mm,force=1000'", "did you mean 1000 mN?"),
    ("solve --at 'material=PZT-4,radius=5mm,load=1 N/m' --positions 0", "fields need -o"),
    # points of a surrogate
    ("query surrogate.nc --at radius=0.3,friction=0.1", "radius = 0.3 is outside the trained box [0.01, 0.2] m"),
    (f"{ASKED} radius=-1,friction=0.1", "radius = -1 (trained within [0.01, 0.2] m): no finite answer so far outside"),
    (f"{ASKED} radius=0.1,friction=1e200", "friction = 1e+200 (trained within [0, 0.5]): no finite answer so far"),
    (f"{ASKED} radius=1_0,friction=0.1", "radius: '1_0' is not a finite number"),
    (f"{ASKED} radius=0.1", "friction: missing; the surrogate needs radius, friction"),
    (f"{ASKED} radius=0.1,raduis=0.2", "raduis: not an input of the surrogate; did you mean 'radius'?"),
    ("query surrogate.nc points.csv -o x.csv --level nan", "--level: level nan is not between 0 and 1"),
    # signals
    (f"{SIGNAL} {BALL}", "amplifier.input_capacitance: missing"),
    (f"{AMPLIFIED},resistivity=0 {BALL}", "resistivity: 0 is not a finite number > 0"),
    (f"{AMPLIFIED},resistivity=1,loss_tangent=1 {BALL}", "give one of them"),
    (f"{AMPLIFIED},electrode_length=1 {BALL}", "a point contact has none"),
    (f"{AMPLIFIED},cable=1 {BALL}", "cable: unknown key; did you mean 'cable_capacitance'?"),
    (f"{AMPLIFIED} {BALL},radius=1", "given twice"),
    (f"{AMPLIFIED} --on profile=sphere,material=BaTiO3,radius=20", "did you mean 20 mm?"),
    (f"{AMPLIFIED} --on material=BaTiO3,radius=1", "electrode_length: missing"),
]  # fmt: skip

MISSING = ("NA", "nan", "null", "-", "\u2013", "?", "-9999")

#: Tables of cases, of points and of forces over time, and material files: what stands in `bad`, and the reason.
CASES = [
    (b"", "bad: is empty: needs a header of factor names and at least one case"),
    (b"0.05,1e5\n", "has no header"),
    (b"My table\nradius,load\n0.05,1e5\n", "the header is line 2"),
    (b"radius [mm,load\n1,1\n", "column 'radius': '[mm' is not a unit"),
    (b"radius [Pa]\n1\n", "column 'radius': unit mismatch: 'Pa' does not measure what 'm' measures"),
    (b"radius [m],radius [mm]\n1,1\n", "column 'radius': given twice"),
    (b"material [1]\nsteel\n", "column 'material': holds names, which have no unit"),
    (b"radius [mm],lod [kN/m]\n1,1\n", "column 'lod [kN/m]': unknown factor; did you mean 'load [kN/m]'?"),
    (b"radius [mm],zzz [kg]\n1,1\n", "column 'zzz [kg]': unknown factor; all names: meecontact list factors"),
    (b"load [TN/fm]\n1e300\n", "line 2: load: inf is not a finite number > 0 [N m-1]"),
    (b"load\n1_00_000\n", "line 2: load: '1_00_000' is not a finite number > 0 [N m-1]"),
    ("load\n\n\u0663\n".encode(), "line 3: load: '\u0663' is not a finite number"),
    (b"load\n1e5\n1e999\n", "line 3: load: inf is not a finite number"),
    (b"electric\nconducting\n\nisolating\n", "line 4: electric: 'isolating' is not one of conducting, insulating"),
    (b"thickness\n20 kg\n", "line 2: thickness: '20 kg': unit mismatch: 'kg' does not measure what 'm'"),
    (b"material\nsteel\n" + b"x" * 201, "line 3: material: 'xxxxxxxxxxxxxxxxxxxx...' has more than 200 characters"),
    (b"load\n1" + b" " * 70_000, "line 2: longer than 65536 characters"),
    (b'load\n"1\n' + b"\n" * 70_000 + b'"\n', "longer than 65536 characters"),
    (b"load\n1" + b"," * 60_000 + b"1\n", "line 2: 60001 cells, the header has 1"),
    (b"load\n" + b"1\n" * 21, "line 22: more than 20 cases; split the table"),
    (b"load\n" + b"\n" * 90, "more than 80 lines"),
    (b"PK\x03\x04\x14\x00", "is a workbook (Excel .xlsx"),
    (b"<!DOCTYPE html><table>", "is a page of HTML"),
    *((f"load\n1e5\n{word}\n".encode(), f"line 3: load: {word!r} stands for a missing value") for word in MISSING),
    (b"material\nPZT-4\nn.a.\n", "line 3: material: 'n.a.' stands for a missing value"),
    (b"radius\n\x00\x01\x02", "is no text file"),
    (b"radius\n\x81\x8d\n", "encoding: is neither UTF-8 nor UTF-16"),
    (b"radius|load\n1|2\n", "separator: columns are separated by '|'"),
    (b"radius,load\n0,05,1e5\n", "3 cells, the header has 2; a decimal comma?"),
    (b'radius,load\n"0,05",1e5\n', "has a decimal comma in a table with commas"),
    (b"radius;load\n1.000,5;1e5\n", "groups its digits"),
    (b"radius;load\n1,5;1.000\n", "'1.000' may group its digits"),
    ("radius [mm]\n5 ± 0.1\n".encode(), "has an error behind it"),
    (b"radius\n50\n", "50 is 50 m; did you mean 50 mm?"),
    (b"base_modulus\n200\n", "200 is 200 Pa; did you mean 200 GPa?"),
    # a row at fault, by its line
    (b"material,radius,load\n\nsteel,1,1e4\nstel,1,1e4", "line 4: material: 'stel' is unknown; did you mean 'steel'?"),
    (b"material,radius,load\nsteel,-1,1e4\n", "line 2: radius: -1 is not a finite number > 0"),
    (b"material,radius,load\nsteel,1,\n", "line 2: load: missing"),
    (b"material,radius,load\nsteel,1e300,1e300 N/m\n", "line 2: contact_trailing: not finite for these factors"),
    (b"material,radius,load,surroundings,electric,magnetic\nPZT-4,1,1,air,insulating,insulating\n",
     "line 2: surroundings: 'air' is not allowed: "),
]  # fmt: skip
POINTS = [
    (b"radius,friction\n0.1,0.1\n0.3,0.2", "bad: line 3: radius = 0.3 is outside the trained box [0.01, 0.2] m"),
    (b"radius,friction\n0.1,0.1\n\n,0.2", "bad: line 4: radius: empty; must be a number"),
    (b"radius,friction\n0.1,0.1\n0.1,1e999", "bad: line 3: friction: inf is not a finite number"),
]
HISTORIES = [
    ("", "needs a header"),
    ("time [s],force [N]\n0,0\n", "1 row; a history has two or more"),
    ("time [s],force [N]\n0,0\n2,1\n1,0\n", "line 4: time: 1 is not after 2"),
    ("time [s],force [N],temperature [K]\n0,0,295\n1,1,295\n1,1,306\n",
     "line 4: time: 1 is not after 1, from 295 to 306 K: no temperature jumps without time"),
    ("time [s],force [N],temperature [degC]\n0,0,22\n1,1,-300\n", "line 3: temperature: -26.85 K is not a finite"),
    ("time,force,temperature [K],temperature [degC]\n0,0,295,22\n1,1,306,33\n", "column 'temperature': given twice"),
    ("time [s],force [N]\n0,1\n1,-1\n", "line 3: force: -1 is not a finite number >= 0; subtract"),
    ("time [s],force [N]\n0,0\n1,0\n", "is 0 all the time"),
    ("time [m],force [N]\n0,0\n1,1\n", "unit mismatch: 'm' does not measure"),
    ("time [s],load [N/m]\n0,0\n1,1\n", "load: a point contact has none"),
    ("time [s],force [N],load [N/m]\n0,0,0\n1,1,1\n", "load: is no column of a history"),
    ("time [s],CH1 [V]\n0,0\n1,1\n", "column 'CH1 [V]': unknown"),
    ("force [N]\n0\n1\n", "time: missing"),
    ("time,force\n12:00:00,0\n12:00:01,1\n", "line 2: time: '12:00:00' is not a finite number [s]"),
]  # fmt: skip
MATERIALS = [
    ("- 1\n", "not a mapping"),
    ("c11: [1\n", "not valid YAML"),
    ("c11: 115 GPas\n", "bad: c11: 'GPas' is not a unit"),
    ("c11: 115 GV\n", "bad: c11: '115 GV': unit mismatch: 'GV' does not measure what 'Pa' measures"),
    ("c11: 1e308 GPa\n", "bad: c11: '1e308 GPa' is not a finite number [Pa]"),
    ("c11: '115e9'\n", "bad: c11: '115e9' is not a finite number [Pa], nor one with its unit"),
    (f"c11: {'1' * 2000} GPa\n", "11' is not a finite number [Pa]"),
    ("s11:\n", "bad: s11: empty is not a finite number [Pa-1]"),
    ("d33: 3 pC/N\nK33T: 1700\n", "K33T: unknown entry; did you mean eps_r33?"),
    ("c33D: 1e11\n", "c33D: unknown entry; did you mean c33, which is at constant electric field?"),
    ("Y11: 61 GPa\n", "Y11: unknown entry; did you mean s11, which is 1/Y?"),
    ("density: 7700\n", "density: unknown entry; did you mean rho?"),
    (f"{CONSTANTS}limits: {{tensile_strength: {{value: 27 MV, source: x}}}}\n",
     "limits: tensile_strength: value: '27 MV': unit mismatch: 'MV' does not"),
    (f"{CONSTANTS}alternatives: [{{c44: 25 GV, source: x}}]\n", "alternatives: 1: c44: '25 GV': unit mismatch"),
    (CONSTANTS + 'name: "\\e]0;own\\a\\e[31m \\u202e\\n steel: admissible"\n', "must not hold the character"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("words", "content", "reason"),
    [(words, b"", reason) for words, reason in COMMANDS]
    + [("solve bad -o out.nc", *row) for row in CASES]
    + [("query surrogate.nc bad -o out.csv", *row) for row in POINTS]
    + [(f"{AMPLIFIED} {BALL}".replace("history.csv", "bad"), text.encode(), reason) for text, reason in HISTORIES]
    + [("material bad", text.encode(), reason) for text, reason in MATERIALS],
)
def test_it_is_refused_in_one_line(words: str, content: bytes, reason: str, place: Path, command: Command) -> None:
    Path("bad").write_bytes(content)
    before = {path: path.read_bytes() if path.is_file() else b"" for path in place.rglob("*")}
    line = command.refused(*shlex.split(words))
    assert reason in line
    assert len(line) < 500
    assert line.strip().isprintable()  # no text of a file commands the terminal
    assert {path: path.read_bytes() if path.is_file() else b"" for path in place.rglob("*")} == before


@pytest.mark.parametrize("name", ["results", "logs", "results/mine", "logs/mine"])
@pytest.mark.usefixtures("here")
def test_a_file_where_results_would_go_is_named(name: str, monkeypatch: pytest.MonkeyPatch, command: Command) -> None:
    monkeypatch.setattr(os, "environ", {**os.environ})
    Path(name).parent.mkdir(exist_ok=True)
    Path(name).write_text("", encoding="utf-8")
    assert f"{name}: is no folder" in command.refused("run", command.file("mine.yaml", STUDY), "-n")


def test_results_of_a_namesake_are_not_replaced(place: Path, command: Command) -> None:
    other = command.file("mine.yaml", STUDY)
    results = Path("results/mine")
    results.mkdir()
    (results / "provenance.json").write_text(json.dumps({"study": "../../config/mine.yaml"}), encoding="utf-8")
    assert "results/mine: holds the results of" in command.refused("run", other, "-n")
    location.given(str(other))
    (place / "config/mine.yaml").unlink()  # the study has moved
    location.check_owner("mine", results)


def test_a_folder_that_no_netcdf_file_can_have_is_refused(monkeypatch: pytest.MonkeyPatch, command: Command) -> None:
    (command.folder / "a\\b").mkdir()
    monkeypatch.chdir(command.folder / "a\\b")
    assert "backslash" in command.refused("run", "quickstart")


@pytest.mark.slow
@pytest.mark.parametrize("folder", ["müller", "a'b", 'a"b', "a b", "a: b #c", "100%25", "a\\b"])
def test_snakemake_hands_on_any_path_of_a_study(folder: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "environ", {**os.environ})
    path = tmp_path / folder / "mine.yaml"
    path.parent.mkdir()
    path.write_text("title: Mine\n", encoding="utf-8")
    assert location.given(str(path)) == "mine"
    handed = parse_config([f"study={location.address('mine')}"])["study"]
    quoted = subprocess.run(["bash", "-c", f"printf %s {handed}"], capture_output=True, text=True, check=True)
    assert quoted.stdout == handed
    os.environ.pop("MEECONTACT_STUDIES")
    assert location.given(handed) == "mine"
    assert location.location("mine") == path
