"""Material files with units, and the list of what is built in."""

import re

import numpy as np
import pytest

import solver
from solver.halfplane.surface import HalfPlane
from solver.material.punches import punches
from solver.units import in_si
from tests.programs import Command
from workflow.language.numbers import shown
from workflow.study.reading import read_material


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
    rows = [
        re.split(r" {2,}", line.strip()) for line in out[out.index("compliance N") :].splitlines() if line[0] == " "
    ]
    values = np.array([[in_si(cell.replace("1/Pa", "Pa-1"), units) for cell, units in zip(row, row_units, strict=True)]
                      for row, row_units in zip(rows, UNITS_OF_N, strict=True)])  # fmt: skip
    np.testing.assert_allclose(values, [*half.compliance, half.friction_coupling], rtol=5e-6)


#: Slopes over tractions: [1/Pa], [V/m / Pa], [A/m / Pa], ...
UNITS_OF_N = [["Pa-1", "V/Pa/m", "A/Pa/m"], ["m2 C-1", "V m C-1", "A m C-1"], ["A m N-1", "A m C-1", "A m-1 T-1"],
              ["Pa-1", "V m N-1", "A m N-1"]]  # fmt: skip


@pytest.mark.parametrize("name", ["skin", "steel"])
def test_a_punch_has_its_constants_for_heat(name: str, command: Command) -> None:
    punch = command("material", name)[0].split(f"{name} as a punch: ")[1]
    for constant, units in (("conductivity", "W m-1 K-1"), ("heat_capacity", "J m-3 K-1")):
        value = shown(punches()[name].thermal[constant].value, units, 6)
        assert re.search(rf"  {constant} +{re.escape(value)} +\S", punch), constant
