"""The page of factors, quantities and material files: its tables are those of the code, its formulas the solver's."""

import re
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.special import digamma

import solver
from solver.fields import POINT_FIELDS
from solver.halfplane.surface import HalfPlane
from solver.material.constants import UNITS
from solver.names import (
    CHOICES,
    ELECTRODE_QUANTITIES,
    EVERY_FILM_QUANTITY,
    EVERY_QUANTITY,
    FACTORS,
    GAP_QUANTITIES,
    LIMITED,
    LIMITS,
    PEAKS,
    POINT_GAP_QUANTITIES,
    POINT_QUANTITIES,
    POINT_SLIDING,
    PROFILES,
    QUANTITIES,
)
from workflow.cli.casetable import TEXT_FACTORS, read_cases
from workflow.run.provenance import ROOT
from workflow.study.reading import read_material

PAGE = (ROOT / "docs/names.md").read_text(encoding="utf-8")


def rows(header: str) -> dict[str, list[str]]:
    """Rows of the table with this first heading, by their first cells."""
    table = PAGE.split(f"\n| {header} |")[1].split("\n\n")[0].splitlines()[2:]
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in table]
    return {row[0].strip("`"): row[1:] for row in cells}


def test_the_table_of_factors_is_the_code_s() -> None:
    found = rows("factor")
    assert list(found) == [*TEXT_FACTORS, *FACTORS]
    for name, choices in CHOICES.items():
        usual = "air on films, else insulated" if name == "surroundings" else choices[0]
        assert found[name][2:4] == [usual, ", ".join(choices)]
    for name, factor in FACTORS.items():
        symbol, units, default, allowed, meaning = found[name]
        assert (units, meaning) == (factor.units, factor.long_name)
        assert default == ("" if factor.default is None else f"{factor.default:g}")
        assert f"a finite number {allowed} [{units}]" == factor.allowed or (allowed, factor.low) == ("any", -np.inf)
        assert symbol
    profiles = rows("profile")
    assert list(profiles) == list(PROFILES)
    for name, outline in PROFILES.items():
        assert [re.findall(r"\w+", cell) for cell in profiles[name]] == [list(outline.needs), list(outline.may)]


def test_the_table_of_quantities_is_the_code_s() -> None:
    found = rows("quantity")
    assert list(found) == list(EVERY_QUANTITY)
    for name, one in EVERY_QUANTITY.items():
        symbol, units, formula, meaning = found[name]
        assert (units, meaning) == (one.units, one.long_name)
        assert symbol
        assert (formula == "searched for") == (name in PEAKS)


def test_the_table_of_a_film_s_quantities_is_the_code_s() -> None:
    assert rows("of a film") == {name: [one.units, one.long_name] for name, one in EVERY_FILM_QUANTITY.items()}


def test_the_table_of_quantities_with_air_is_the_code_s() -> None:
    own = {name: [one.units, one.long_name] for name, one in GAP_QUANTITIES.items()}
    of_points = {
        name: [one.units, f"{one.long_name}, of a point"]
        for name, one in POINT_GAP_QUANTITIES.items()
        if name not in GAP_QUANTITIES
    }
    assert rows("of a contact with air") == own | of_points


def test_the_table_of_an_electrode_s_quantities_is_the_code_s() -> None:
    every = ELECTRODE_QUANTITIES
    assert rows("of an electrode") == {name: [its.units, its.long_name] for name, its in every.items()}


def test_the_table_of_a_point_s_quantities_is_the_code_s() -> None:
    own = {name: one for name, one in POINT_QUANTITIES.items() if name not in EVERY_QUANTITY}
    assert rows("of a point") == {name: [one.units, one.long_name] for name, one in own.items()}


def test_the_table_of_a_point_s_fields_is_the_code_s() -> None:
    sliding = {name: [one.units, one.long_name] for name, one in POINT_SLIDING.items()}
    assert rows("of a sliding point") == sliding
    assert rows("field of a point") == {name: [one.units, one.long_name] for name, one in POINT_FIELDS.items()}


@pytest.mark.parametrize("name", ["BaTiO3-CoFe2O4 50:50", "BaTiO3-CoFe2O4 0.2"])
def test_the_formulas_of_quantities_are_the_solver_s(name: str) -> None:
    case = {"friction": 0.4, "radius": 0.05, "load": 1e5, "charge": 2e-6, "magnetic_charge": 1e-3, "datum": 2.0}
    exact = solver.solve({"material": name, **case})
    half = HalfPlane(solver.find(name))
    known: dict[str, Any] = dict(zip(("eta", "R", "P", "T", "J", "L"), case.values(), strict=True))
    known |= {f"N{i + 1}{j + 1}": half.compliance[i, j] for i in range(3) for j in range(i, 3)}
    known |= {f"k{i + 1}": half.friction_coupling[i] for i in range(3)}
    known |= {"pi": np.pi, "tau": half.in_plane_stiffness * half.tangential_compliance}
    known["F"] = digamma(1 + float(exact["pressure_exponent"])) + np.euler_gamma
    frame = xr.Dataset({name: ("case", [float(value)]) for name, value in known.items()}).to_dataframe()
    for symbol, (formula, _) in rows("symbol").items():
        frame[symbol] = frame.eval(formula.strip("`"), engine="python")
    for quantity in QUANTITIES:
        value = float(frame.eval(rows("quantity")[quantity][2].strip("`"), engine="python").iloc[0])
        assert value == pytest.approx(float(exact[quantity]), rel=1e-11), quantity


def test_the_table_of_constants_is_the_code_s() -> None:
    found = rows("key")
    assert list(found) == [*UNITS, "conductor", "name", "source`, `note", "limits", "alternatives"]
    bare = solver.Material.from_mapping(dict.fromkeys(("c11", "c33"), 3e9) | dict.fromkeys(("c13", "c44"), 1e9))
    for name, units in UNITS.items():
        default = float(getattr(bare, name))
        needed = name in ("c11", "c13", "c33", "c44")
        expected = "needed" if needed else "unknown" if np.isnan(default) else f"{default:.12g}"
        assert found[name][:2] == [units, expected]


def test_the_table_of_limits_is_the_code_s() -> None:
    found = {name: [*cells[:2], tuple(re.findall(r"`(\w+)`", cells[2]))] for name, cells in rows("limit").items()}
    assert found == {name: [one.units, one.long_name, LIMITED[name]] for name, one in LIMITS.items()}


def test_the_table_of_alternatives_is_what_they_give() -> None:
    """In docs/solver.md: contact width, voltage and charge per force over those of the entry, to two digits."""
    page = (ROOT / "docs/solver.md").read_text(encoding="utf-8")
    table = page.split("| material | other values | width | voltage | charge |\n")[1].split("\n\n")[0].splitlines()[1:]
    for line in table:
        name, _, *cells = (cell.strip() for cell in line.strip("|").split("|"))
        material = solver.find(name)
        out = solver.solve({"material": [material, *material.variants()], "radius": 0.05, "load": 1e4, "friction": 0.3})
        width = out["contact_trailing"] + out["contact_leading"]
        for cell, values in zip(cells, (width, out["voltage"], out["charge_per_force"]), strict=True):
            assert cell == "; ".join(f"{float(one / values[0]):.2f}" for one in values[1:]), name


def test_the_examples_are_as_shown() -> None:
    text = (ROOT / "examples/material.yaml").read_text(encoding="utf-8")
    assert "".join(f"    {line}\n" for line in text.splitlines()) in PAGE
    name, material = read_material(ROOT / "examples/material.yaml")
    for key in UNITS:
        np.testing.assert_array_equal(getattr(material, key), getattr(solver.find("PZT-5H"), key))
    assert material.limits["depoling_stress"].value == 10e6
    assert material.spread["eps33"] == (12.7e-9, 13.02e-9)
    assert name in read_cases(ROOT / "examples/own_material.csv").columns["material"]
