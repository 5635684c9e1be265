"""docs/names.md and docs/solver.md: choices, formulas, constants and alternatives are those of the code."""

import re
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.special import digamma

import solver
from solver.halfplane.surface import HalfPlane
from solver.material.constants import TRIGONAL, UNITS
from solver.names import CHOICES, PROFILES, QUANTITIES
from workflow.cli.casetable import TEXT_FACTORS
from workflow.run.provenance import ROOT

PAGE = (ROOT / "docs/names.md").read_text(encoding="utf-8")


def rows(header: str, page: str = PAGE) -> dict[str, list[str]]:
    """Rows of the table with this first heading, by their first cells."""
    table = page.split(f"\n| {header} |")[1].split("\n\n")[0].splitlines()[2:]
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in table]
    return {row[0].strip("`"): row[1:] for row in cells}


def test_the_choices_are_the_code_s() -> None:
    factors = rows("factor")
    assert set(factors) == set(TEXT_FACTORS)
    for name, choices in CHOICES.items():
        usual = "air on films, else insulated" if name == "surroundings" else choices[0]
        assert factors[name][:2] == [usual, ", ".join(choices)], name
    profiles = rows("profile")
    assert list(profiles) == list(PROFILES)
    for name, outline in PROFILES.items():
        assert [re.findall(r"\w+", cell) for cell in profiles[name]] == [list(outline.needs), list(outline.may)]


@pytest.mark.parametrize("name", ["BaTiO3-CoFe2O4 50:50", "BaTiO3-CoFe2O4 0.2"])
def test_the_formulas_of_quantities_are_the_solver_s(name: str) -> None:
    case = {"friction": 0.4, "radius": 0.05, "load": 1e5, "charge": 2e-6, "magnetic_charge": 1e-3, "datum": 2.0}
    exact = solver.solve({"material": name, **case})
    half = HalfPlane(solver.find(name))
    symbols: dict[str, Any] = dict(zip(("eta", "R", "P", "T", "J", "L"), case.values(), strict=True))
    symbols |= {f"N{i + 1}{j + 1}": half.compliance[i, j] for i in range(3) for j in range(i, 3)}
    symbols |= {f"k{i + 1}": half.friction_coupling[i] for i in range(3)}
    symbols |= {"pi": np.pi, "tau": half.in_plane_stiffness * half.tangential_compliance}
    symbols["F"] = digamma(1 + float(exact["pressure_exponent"])) + np.euler_gamma
    frame = xr.Dataset({name: ("case", [float(value)]) for name, value in symbols.items()}).to_dataframe()
    for symbol, (formula, _) in rows("symbol").items():
        frame[symbol] = frame.eval(formula.strip("`"), engine="python")
    formulas = rows("quantity")
    assert list(formulas) == list(QUANTITIES)
    for quantity, (_, formula) in formulas.items():
        value = float(frame.eval(formula.strip("`"), engine="python").iloc[0])
        assert value == pytest.approx(float(exact[quantity]), rel=1e-11), quantity


def test_the_table_of_constants_is_the_code_s() -> None:
    constants = rows("key")
    words = ["cut", "conductor", "name", "source`, `note", "limits", "thermal", "alternatives"]
    assert list(constants) == [*UNITS, *TRIGONAL, *words]
    bare = solver.Material.from_mapping(dict.fromkeys(("c11", "c33"), 3e9) | dict.fromkeys(("c13", "c44"), 1e9))
    for name, units in (UNITS | TRIGONAL).items():
        default = float(getattr(bare, name))
        needed = name in ("c11", "c13", "c33", "c44")
        expected = "needed" if needed else "unknown" if np.isnan(default) else f"{default:.12g}"
        assert constants[name][:2] == [units, expected]


def test_the_table_of_alternatives_is_the_solver_s() -> None:
    """Contact width, voltage and charge per force over those of the entry, to two digits."""
    page = (ROOT / "docs/solver.md").read_text(encoding="utf-8")
    for name, (_, *cells) in rows("material", page).items():
        material = solver.find(name)
        out = solver.solve({"material": [material, *material.variants()], "radius": 0.05, "load": 1e4, "friction": 0.3})
        width = out["contact_trailing"] + out["contact_leading"]
        for cell, values in zip(cells, (width, out["voltage"], out["charge_per_force"]), strict=True):
            assert cell == "; ".join(f"{float(value / values[0]):.2f}" for value in values[1:]), name


def test_the_example_of_a_material_is_the_file() -> None:
    text = (ROOT / "examples/material.yaml").read_text(encoding="utf-8")
    assert "".join(f"    {line}\n" for line in text.splitlines()) in PAGE
