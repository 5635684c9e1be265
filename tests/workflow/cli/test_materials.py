"""Material files with units, and the list of what is built in."""

import tomllib
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest

import solver
from solver.material.constants import UNITS
from workflow.cli import main
from workflow.run.provenance import ROOT
from workflow.study.reading import InputError, read_material


def test_material_lists_what_is_built_in(capsys: pytest.CaptureFixture[str]) -> None:
    assert main.main(["material"]) == 0
    lines = capsys.readouterr().out.splitlines()
    for (name, material), line in zip(solver.materials().items(), lines, strict=False):
        assert line.startswith(name)
        assert line.endswith(material.source)
        assert (line[len(name) :].split()[0] == "*") == bool(material.note)
    assert lines[len(solver.materials())].startswith("* repaired, doubtful or disputed")


def test_constants_with_units_are_those_of_the_library_to_the_last_bit(tmp_path: Path) -> None:
    table = tomllib.loads((ROOT / "solver/material/materials.toml").read_text(encoding="utf-8"))
    prefix = {"Pa": (9, "GPa"), "C m-2": (-6, "uC/mm2"), "N A-1 m-1": (0, "N/A/m"), "F m-1": (-9, "nF/m"),
              "N s V-1 C-1": (-9, "ns/m"), "N s2 C-2": (-6, "uH/m"), "kg m-3": (0, "kg/m3")}  # fmt: skip
    for name, entry in table.items():
        lines = [f"name: {name!r}"]
        for key, units in UNITS.items():
            if key in entry:
                power, unit = prefix[units]
                power = 0 if unit == "uC/mm2" else power  # uC/mm2 is C/m2
                lines.append(f"{key}: {Decimal(repr(entry[key])).scaleb(-power)} {unit}")
        path = tmp_path / "one.yaml"
        path.write_text("\n".join(lines), encoding="utf-8")
        found = read_material(path)[1]
        for key in UNITS:
            np.testing.assert_array_equal(getattr(found, key), getattr(solver.find(name), key), err_msg=f"{name} {key}")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("c11: 115 GPas\n", "m: c11: 'GPas' is not a unit"),
        ("c11: 115 GV\n", "m: c11: '115 GV': unit mismatch: 'GV' does not measure what 'Pa' measures"),
        ("c11: 1e999 GPa\n", "m: c11: '1e999 GPa' is not a finite number [Pa]"),
        ("c11: 1e308 GPa\n", "m: c11: '1e308 GPa' is not a finite number [Pa]"),
        ("c11: '115e9'\n", "m: c11: '115e9' is not a finite number [Pa], nor one with a unit behind a blank"),
        ("c11: 115GPa\n", "m: c11: '115GPa' is not a finite number [Pa], nor one with a unit behind a blank"),
        (f"c11: {'1' * 2000} GPa\n", "11' is not a finite number [Pa]"),
    ],
)
def test_constants_with_bad_units_are_refused(tmp_path: Path, text: str, expected: str) -> None:
    path = tmp_path / "m.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_material(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert expected in str(caught.value)
