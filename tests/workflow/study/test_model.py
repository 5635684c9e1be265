"""The study model: what it accepts, the one line with which it refuses, and studies without some keys."""

import json
from copy import deepcopy
from pathlib import Path
from random import Random
from typing import Any

import pytest
import xarray as xr
import yaml

from solver.names import ALL_QUANTITIES, PEAKS
from tests.studies import edited, made
from workflow.report import sections as page
from workflow.run.provenance import ROOT
from workflow.study import coupling, datum, model, partition, schema, solvable
from workflow.study.contents import Contents, Origin
from workflow.study.model import Study, load, remade, thawed
from workflow.study.reading import InputError, read_material, read_yaml

QUICKSTART = Path("config/quickstart.yaml")


def test_numbers_follow_yaml_1_2(tmp_path: Path) -> None:
    path = tmp_path / "numbers.yaml"
    path.write_text("a: 1e4\nb: -2.5E-3\nc: .5\nd: 7\ne: '1e4'\nf: '010'\ng: +0\nh: 007.5\ni: 1٢\n", encoding="utf-8")
    expected = {"a": 1e4, "b": -2.5e-3, "c": 0.5, "d": 7, "e": "1e4", "f": "010", "g": 0, "h": 7.5, "i": "1٢"}
    assert read_yaml(path) == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("!!python/object/apply:os.system ['true']", "not valid YAML"),
        ("a: &x [1]\nb: *x", "aliases are not allowed"),
        ("", "not a mapping"),
        ("1: 2", "not a mapping of names"),
        ("a: " + "[" * 3000 + "]" * 3000, "nested too deeply"),
        ("title: a: b", "line 1: not valid YAML: a colon and a blank within a text; write the text in quotes"),
        ("a: " + "9" * 4000, "line 1: not valid YAML: a number of 4000 digits; at most 40, or write it as 1e3999"),
        ("a: 010", "line 1: not valid YAML: '010' is not a decimal number; in quotes it is a text"),
        ("a: 1:30", "'1:30' is not a decimal number"),
        (r'a: "\ud800"', r"a text must not hold the character '\\ud800'"),
        (r'"\e[2J": 1', r"a text must not hold the character '\\x1b'"),
    ],
)
def test_yaml_is_data_only(tmp_path: Path, text: str, expected: str) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=expected):
        read_yaml(path)


def test_a_material_of_a_file_is_read(tmp_path: Path) -> None:
    text = QUICKSTART.read_text(encoding="utf-8").replace("tensile_strength", "50 MPa")  # nothing is known of its own
    text = text.replace("[BaTiO3, CoFe2O4]", "[mine, CoFe2O4]\nmaterials: [mine.yaml]")
    study = tmp_path / "own.yaml"
    study.write_text(text, encoding="utf-8")
    constants = "c11: 166e9\nc12: 77e9\nc13: 78e9\nc33: 162e9\nc44: 43e9\neps11: 11.2e-9\neps33: 12.6e-9\n"
    (tmp_path / "mine.yaml").write_text(constants, encoding="utf-8")
    assert float(load(study).own_materials["mine"].c33) == 162e9


@pytest.mark.parametrize("name", ["$x^$", "a\tb", "x" * 61])
def test_a_material_has_a_name_that_figures_and_files_bear(tmp_path: Path, name: str) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(f"name: {json.dumps(name)}\nc11: 166e9\nc13: 78e9\nc33: 162e9\nc44: 43e9\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"mine\.yaml: name: .* must be up to 60 letters, digits, blanks and any of"):
        read_material(path)


def test_documented_default_holds_every_default() -> None:
    documented = yaml.safe_load(schema.default_text().replace("1e-06", "1.0e-06"))
    documented["title"] = "t"
    fields = {name: field for name, field in Study.model_fields.items() if not field.is_required()}
    plain = {name: field.get_default(call_default_factory=True) for name, field in fields.items()}
    expected = {name: v.model_dump() if hasattr(v, "model_dump") else v for name, v in plain.items()}
    expected["dataset"]["positions"] = plain["dataset"].positions.model_dump()  # dumped only where they are given
    assert documented == {"title": "t", **expected}


def test_a_study_has_the_quantities_that_its_cases_have() -> None:
    text = """\
title: An insulating half cylinder
fixed: {profile: half_cylinder, electric: insulating, radius: 0.05, load: 1.0e+5}
factors: {volume_fraction: {low: 0.2, high: 0.8, levels: 4}, friction: {low: 0.0, high: 0.5, levels: 4}}
"""
    outputs = made(text).outputs
    assert {"magnetic_potential", "trailing_tension", "depth"} <= set(outputs)
    assert not {"voltage", "peak_pressure", "leading_compression", "peak_von_mises"} & set(outputs)
    assert made(text + "dataset: {peaks: true}\n").outputs == [*outputs, *PEAKS]


ALLOY = """\
title: Scandium
fixed: {composite: AlScN}
factors:
  scandium_fraction: {low: 0.0, high: 0.4, levels: 4}
  radius: {low: 0.01, high: 0.1, levels: 3}
  load: {low: 1e3, high: 1e4, levels: 3}
effects:
  baseline: {composite: fibrous, volume_fraction: 0.5, scandium_fraction: 0.2, radius: 0.05, load: 1e4}
  vary: {composite: [fibrous, AlScN], volume_fraction: [0.2, 0.8], load: [1e3, 1e4], material: [PZT-4, PVDF]}
"""


def test_a_study_over_the_composition_of_an_alloy() -> None:
    study = made(ALLOY)
    assert study.cases == 36
    assert "voltage_per_load" in study.quantities
    assert study.effects is not None
    fractions = {"volume_fraction", "scandium_fraction"}
    taken = {factor: fractions & set(study.effects.case(factor)) for factor in study.effects.vary}
    of_fibres = {"volume_fraction"}
    assert taken == {"composite": fractions, "volume_fraction": of_fibres, "load": of_fibres, "material": set()}


def test_a_long_check_says_what_it_does(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(model, "SILENCE", 0.0)
    monkeypatch.setattr(model, "_checked", {})
    model.named("quickstart")
    assert capfd.readouterr().err == "checking quickstart: solving the corners of its box and its effects\n"


def test_a_file_is_checked_again_when_it_has_changed(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    text = QUICKSTART.read_text(encoding="utf-8")
    path.write_text(text, encoding="utf-8")
    first = load(path)
    assert load(path) is first
    path.write_text(text.replace(first.title, "Another"), encoding="utf-8")
    assert load(path).title == "Another"


STUDY = """
title: a sensor
phases: [BaTiO3, CoFe2O4]
fixed: {{composite: fibrous, volume_fraction: {share}, friction: 0.2, charge: 0}}
factors:
  radius: {{low: {low}, high: {high}, levels: 3}}
  load: {{low: {load}, high: 2e4, levels: 3}}
effects: {{baseline: {{composite: fibrous, volume_fraction: 0.5, radius: {low}, load: 1e4, friction: 0.1, charge: 0}},
  vary: {{radius: [{low}, {high}]}}}}
design:
  mine: {{maximise: voltage, over: {{radius: {{low: {low}}}}}, worst_case: {{load: [{load}, 2e4]}},
    tolerance: {{radius: {off}}}}}
"""
BARE = {"share": "0.5", "low": "0.02", "high": "0.2", "load": "1e4", "off": "1e-4"}
WITH_UNITS = {"share": "50 %", "low": "20 mm", "high": "20 cm", "load": "10 N/mm", "off": "0.1 mm"}


def test_a_unit_says_what_a_bare_number_of_si_says() -> None:
    bare, other = made(STUDY.format(**BARE)), made(STUDY.format(**WITH_UNITS))
    assert other.physics == bare.physics
    assert other.design["mine"].tolerances == bare.design["mine"].tolerances == {"radius": (1e-4, 0.0)}
    sections = {"fixed", "factors", "effects"}
    assert other.model_dump(include=sections) == bare.model_dump(include=sections)
    assert other.design["mine"].worst_case == {"load": [1e4, 2e4]}
    assert other.design["mine"].variables["radius"].low == 0.02


POINT = """\
title: a ball
fixed: {material: PZT-4, profile: sphere, radius: 0.01, surroundings: insulated}
factors: {force: {low: 1.0, high: 2.0, levels: 3}}
validation: {cases: 20, calibration: 40}
"""


def test_a_box_that_no_material_bears_is_told_before_it_runs() -> None:
    assert not made(POINT).defaults
    heavy = made(edited(edited(POINT, "0.01", "0.001"), "low: 1.0, high: 2.0", "low: 500, high: 900")).defaults
    assert [line.partition(":")[0] for line in heavy] == ["pressure"]
    assert heavy[0].endswith("check force and radius: bare numbers are in SI")


def test_a_number_with_its_unit_passes_again_when_a_job_thaws_the_study() -> None:
    study = made(edited(edited(POINT, "0.01", "20 m"), "low: 1.0, high: 2.0", "low: 1 GN, high: 5 GN"))
    assert thawed(study.frozen()).fixed["radius"] == remade(study, title="again").fixed["radius"] == 20.0


STUDIES = sorted(ROOT.glob("config/*.yaml"))


@pytest.fixture
def _unsolved(monkeypatch: pytest.MonkeyPatch) -> None:
    """The solver is not asked: every case has all quantities of its kind of body."""

    def answered(study: Contents, *_: Any, **options: Any) -> xr.Dataset:
        return xr.Dataset(dict.fromkeys(study.kind.quantities, 0.0))

    monkeypatch.setattr(Contents, "solved", answered)
    monkeypatch.setattr(solvable, "solve_effects", lambda study: None)
    monkeypatch.setattr(model, "solve_effects", lambda study: None)
    hanging = datum.hanging
    by_base = frozenset({"depth"})  # as on every base that gives
    monkeypatch.setattr(datum, "hanging", lambda study: by_base if study.kind.datum == "by_base" else hanging(study))


def plan(content: dict[str, Any], origin: Origin) -> bool:
    """Read all that the rules ask of a study; return False for a refusal of several lines."""
    try:
        study = partition.with_slabs(model._validated(content, origin))
    except InputError as refusal:
        return "\n" not in str(refusal)
    page.figures(study), page.effects(study)
    coupling.outputs(study), coupling.aims(study), coupling.of_interest(study)
    study.final_files, study.output_names, study.regions, study.titles, study.crossed, study.frozen()
    study.digest(*type(study).model_fields)
    return study.absent <= ALL_QUANTITIES.keys()


def without(content: dict[str, Any], random: Random) -> dict[str, Any]:
    """A copy without one or two keys, at any depth."""
    copy = deepcopy(content)
    for _ in range(random.choice((1, 2))):
        part, name = copy, random.choice([*copy])
        while isinstance(part[name], dict) and part[name] and random.random() < 2 / 3:
            part = part[name]
            name = random.choice([*part])
        del part[name]
    return copy


@pytest.mark.usefixtures("_unsolved")
@pytest.mark.parametrize("file", STUDIES, ids=lambda file: file.stem)
def test_a_shipped_study_loads_and_is_a_plan_or_one_line_without_some_keys(file: Path) -> None:
    content = read_yaml(file)
    origin = Origin(file, dict(read_material(file.parent / name) for name in content.get("materials", [])))
    assert plan(content, origin)
    assert model._validated(content, origin).title == content["title"]  # no refusal; its corners: above
    random = Random(file.stem)
    for _ in range(8):
        shorter = without(content, random)
        assert plan(shorter, origin), shorter
