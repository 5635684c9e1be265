"""The study model: what it accepts, and the one line with which it refuses."""

import json
from pathlib import Path

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from solver.names import PEAKS
from tests.studies import NAMES, edited, made, refusal
from workflow.study import model, schema
from workflow.study.model import Study, load
from workflow.study.reading import InputError, read_material, read_yaml

QUICKSTART = Path("config/quickstart.yaml")
#: Studies of which the solver takes seconds for the corners.
SECONDS = {
    "air_sensor", "cut", "film", "film_actuator", "film_peaks", "film_sensor", "paper", "point", "point_sensor",
    "probe", "roller", "rough", "two_layers",
}  # fmt: skip


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.soak) if name in SECONDS else name for name in NAMES]
)
def test_every_study_of_the_project_loads(name: str) -> None:
    assert load(f"config/{name}.yaml").title


def test_quickstart_is_the_factorial_of_the_documentation() -> None:
    study = load(QUICKSTART)
    assert study.cases == 41_600
    assert {name: axis.levels for name, axis in study.factors.items()} == {
        "volume_fraction": 26, "friction": 5, "radius": 8, "load": 10, "charge": 4,
    }  # fmt: skip


EFFECTS = "title: t\neffects: {{baseline: {{material: PZT-4, radius: 0.05, load: 1e5}}, vary: {}}}\n"
FACTORIAL = """\
title: t
fixed: {{material: PZT-4, radius: 0.05}}
factors: {{friction: {{low: 0.0, high: 0.5, levels: {}}}, load: {{low: 5e3, high: 5e4, levels: {}}}}}
{}
"""


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (EFFECTS.format(f"{{friction: [{'0.1, ' * 201}]}}"), "effects: vary: friction: 201 values; must be 1"),
        (EFFECTS.format(f"{{friction: [{'0.1, ' * 12}]}}, positions: {{inside: 10000, outside: 10000}}"),
         "effects: vary: friction: 12 values x 20000 positions are more than 200000"),
        (EFFECTS.format("{friction: [0, 0.1]}, interior: {across: 2000, down: 2000}"),
         "effects.interior: across x down: 2000 x 2000 points are more than 250000"),
        (FACTORIAL.format(1000, 1000, "dataset: {positions: {inside: 2000, outside: 2}}"),
         "dataset: 1000000 cases x 2002 positions are more than 2000000000 values of each field"),
        (FACTORIAL.format(1000, 1000, "surrogate: {fields: 21}"),
         "surrogate: fields: 1000000 cases x 21 angles are more than 20000000"),
    ],
)  # fmt: skip
def test_refuses_what_no_later_step_could_bear(text: str, expected: str) -> None:
    assert refusal(text).startswith(expected)


def test_refuses_a_box_of_more_corners_than_are_solved_at_once() -> None:
    axes = ["volume_fraction", "friction", "radius", "load", "charge", "magnetic_charge", "speed", "width", "slope"]
    names = "[a, b, c, d, e, f, g, h]"
    kinds = ", ".join(f"{name}: {names}" for name in ("profile", "electric", "magnetic", "corner"))
    ranges = ", ".join(f"{name}: {{low: 0.001, high: 0.002}}" for name in axes)
    message = refusal(f"title: t\nfactors: {{{ranges}}}\ncategories: {{{kinds}}}\n")
    assert message.startswith("factors: a box of 2097152 corners, over all categories, has more than 262144")


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
        ("a: !!bool maybe", "line 1: not valid YAML: tags, as !!int, are not allowed"),
        (
            "title: a ball: on a film",
            "line 1: not valid YAML: a colon and a blank within a text; write the text in quotes",
        ),
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


@given(st.text(max_size=200))
def test_any_text_is_a_mapping_or_a_named_refusal(tmp_path_factory: pytest.TempPathFactory, text: str) -> None:
    path = tmp_path_factory.mktemp("fuzz") / "text.yaml"
    path.write_bytes(text.encode("utf-8", "replace"))
    try:
        content = read_yaml(path)
    except InputError as error:
        content = {}
        named = str(error).startswith(f"{path}:")
    else:
        named = True
    assert named
    assert isinstance(content, dict)


def test_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"absent\.yaml: No such file"):
        load(tmp_path / "absent.yaml")


def test_own_material_is_read_and_checked(tmp_path: Path) -> None:
    text = QUICKSTART.read_text(encoding="utf-8").replace("tensile_strength", "50 MPa")  # nothing is known of its own
    text = text.replace("[BaTiO3, CoFe2O4]", "[mine, CoFe2O4]\nmaterials: [mine.yaml]")
    study = tmp_path / "own.yaml"
    study.write_text(text, encoding="utf-8")
    constants = "c11: 166e9\nc12: 77e9\nc13: 78e9\nc33: 162e9\nc44: 43e9\neps11: 11.2e-9\neps33: 12.6e-9\n"
    (tmp_path / "mine.yaml").write_text(constants, encoding="utf-8")
    assert float(load(study).own_materials["mine"].c33) == 162e9
    (tmp_path / "mine.yaml").write_text(constants + "mu11: -590e-6\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"mine\.yaml: mine: mu11 = -0\.00059 N s2 C-2: must be positive; .*\+590e-6"):
        load(study)


@pytest.mark.parametrize("name", ["$x^$", "a\tb", "x" * 61, "a|b"])
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
    for extra, expected in (
        ("surrogate: {outputs: [voltage]}", "surrogate: outputs: some of these cases have no 'voltage'"),
        ("surrogate: {outputs: [peak_von_mises]}", "surrogate: outputs: 'peak_von_mises' needs dataset: peaks: true"),
        ("design: {least: {minimise: depth, over: [volume_fraction, friction], subject_to: [peak_von_mises <= 1 MPa]}}",
         "design: least: 'peak_von_mises' needs dataset: peaks: true"),
    ):  # fmt: skip
        assert refusal(f"{text}{extra}\n").startswith(expected)


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
    message = refusal(edited(ALLOY, "high: 0.4", "high: 0.6"))
    assert "scandium_fraction: 0.6 is not a finite number >= 0 and <= 0.5 [1]" in message


def test_a_level_that_the_calibration_does_not_tell_is_refused() -> None:
    study = load(QUICKSTART)
    content = study.model_dump(exclude_unset=True)
    content["validation"]["calibration"] = 99
    assert Study.model_validate({**content, "surrogate": {"level": 0.97}}).surrogate.level == 0.97
    with pytest.raises(
        ValueError, match=r"surrogate: level: 0\.99 is more than 0\.98, all that 99 cases of validation"
    ):
        Study.model_validate({**content, "surrogate": {"level": 0.99}})


def test_a_long_check_says_what_it_does(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(model, "SILENCE", 0.0)
    monkeypatch.setattr(model, "_last", {})
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
