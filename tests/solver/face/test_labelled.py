"""The labelled face: names, dimensions, units, coordinates, attributes, and tables of cases."""

import re
import tracemalloc
import warnings
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from numpy.testing import assert_allclose

import solver
from solver.face import cases
from solver.fields import FIELDS, INTERIOR, INTERIOR_ON_REQUEST
from solver.names import EVERY_QUANTITY
from tests.refusals import assert_refused
from tests.solver.cases import BTO, CFO, assert_alike

POSITIONS = (-2.0, -0.5, 0.9, 1.001)
#: Friction, both charges: nothing that depends on the datum does so by chance alone.
CASE_OF_DATUM: dict[str, Any] = {
    "volume_fraction": 0.67, "radius": 0.14, "load": 1e4, "friction": 0.4, "charge": 1e-7, "magnetic_charge": -1e-3
}  # fmt: skip
ONE = {"material": "BaTiO3", "radius": 0.05, "load": 1e5}


def test_materials_and_phases_may_be_named_or_objects() -> None:
    mine = solver.find("PZT-4").renamed("mine")
    factors = {"composite": "laminate", "volume_fraction": [0.2, 0.6], "radius": 0.05, "load": 1e5, "friction": 0.2}
    by_name = solver.solve(factors, POSITIONS, phases=("PZT-4", "steel"))
    by_material = solver.solve(factors, POSITIONS, phases=(mine, solver.find("steel")))
    assert_alike(by_name, by_material, 0.0)
    assert_alike(by_name, solver.solve(factors, POSITIONS, phases=("own", "steel"), materials={"own": mine}), 0.0)
    assert by_material.attrs["phases"] == "mine, steel"
    by_object = solver.solve({**ONE, "material": mine}, POSITIONS)
    named = solver.solve({**ONE, "material": "light"}, POSITIONS, materials={"light": mine})
    pair = solver.solve({**ONE, "material": ["steel", mine]}, POSITIONS)
    assert [by_object.coords["material"].item(), named.coords["material"].item()] == ["mine", "light"]
    assert list(pair.coords["material"].values) == ["steel", "mine"]
    assert_alike(by_object, named, 0.0)
    assert_alike(pair.isel(material=1), by_object, 1e-14)


def test_what_is_marked_as_hanging_on_the_datum_is_what_changes_with_it() -> None:
    case = {**CASE_OF_DATUM, "datum": [0.01, 1.0, 10.0]}
    of_surface = solver.solve(case, POSITIONS, peaks=True)
    of_body = solver.solve_interior(case, [0.0, 0.5], [-0.5], fields=[*INTERIOR, *INTERIOR_ON_REQUEST])
    for out, known in ((of_surface, EVERY_QUANTITY | FIELDS), (of_body, INTERIOR | INTERIOR_ON_REQUEST)):
        changed = set()
        for name, array in out.data_vars.items():
            values = array.transpose("datum", ...).values.reshape(3, -1)
            if np.any(np.ptp(values, axis=0) > 1e-9 * np.abs(values).max()):
                changed.add(name)
        assert changed == {name for name, quantity in known.items() if quantity.on_datum}
        assert set(out.data_vars) == set(known)


def test_what_hangs_on_the_datum_says_which_one_it_has() -> None:
    for datum, said in (({}, "1 m, the default"), ({"datum": [0.1, 1.0]}, "that of the coordinate datum")):
        voltage = solver.solve(CASE_OF_DATUM | datum)["voltage"]
        assert voltage.attrs["comment"].endswith(f"datum: {said}")
    inside = solver.solve_interior(CASE_OF_DATUM | datum, [0.0], [-1.0], fields=["electric_potential", "stress_xx"])
    assert inside["electric_potential"].attrs["comment"] == voltage.attrs["comment"]
    assert "comment" not in inside["stress_xx"].attrs


TABLE = pd.DataFrame(
    {"material": ["PZT-4", "BaTiO3", "PZT-4"], "radius": ["50 mm", 0.06, 0.07], "load": [1e4, 2e4, 3e4]},
    index=["a", "b", "c"],
)
CASE: dict[str, Any] = {"material": "PZT-4", "radius": 0.05, "load": 1e4}


@pytest.mark.parametrize(
    "varying",
    [
        {"volume_fraction": [0.2, 0.9, 0.2, 0.5], "composite": ["fibrous", "laminate"], "radius": [0.05]},
        {"material": ["PZT-4", "BaTiO3"], "electric": ["conducting", "insulating"], "speed": [0.0, 900.0, 900.0],
         "radius": [0.05]},
        {"material": ["PZT-4", "BaTiO3"], "profile": ["sphere"], "radius": [4e-3, 5e-3, 6e-3, 7e-3]},
    ],
)  # fmt: skip
def test_blocks_of_a_table_do_not_show(monkeypatch: pytest.MonkeyPatch, varying: dict[str, list[Any]]) -> None:
    """Rows of one material are solved together, in blocks; each is as alone, to rounding."""
    force, friction = ("force", {}) if "profile" in varying else ("load", {"friction": np.linspace(0.1, 0.4, 24)})
    columns = {name: np.resize(np.array(values, dtype=object), 24) for name, values in varying.items()}
    table = pd.DataFrame(columns | friction | {force: np.geomspace(1, 1e2, 24) * (1 if force == "force" else 1e2)})
    monkeypatch.setattr(cases, "_BLOCK", 7)
    rows = solver.solve(table, [-2.0, 0.3, 1.0])
    for place in (0, 10, 23):
        alone = solver.solve(dict(table.iloc[place]), [-2.0, 0.3, 1.0])
        for name in rows.data_vars:
            assert_allclose(rows[name][place], alone[name].squeeze(), rtol=1e-11, err_msg=str(name))


def test_several_cases_are_printed_with_one_prefix_a_column() -> None:
    answer = solver.solve({"material": "PZT-4", "radius": 0.05, "load": [1e4, 1e6]})
    printed = solver.table(answer)
    assert not [name for name in printed.columns if "magnetic" in name]  # PZT-4 couples no magnetic field
    assert printed["peak_pressure [MPa]"].to_numpy() == pytest.approx(answer["peak_pressure"].values / 1e6, rel=1e-12)
    assert printed.index.to_list() == [1e4, 1e6]


def test_memory_of_a_table() -> None:
    """Beyond input and output: the number of each row in the order of the materials, and the labels, 400 bytes."""
    count = 200_000
    rng = np.random.default_rng(0)
    named = np.array(["PZT-4", "BaTiO3"], dtype=object)[rng.integers(0, 2, count)]
    table = pd.DataFrame({"material": named, "radius": 0.05, "load": rng.uniform(1e3, 1e4, count)})
    tracemalloc.start()
    rows = solver.solve(table)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak - rows.nbytes < 400 * count


def test_series_with_one_index_are_columns_of_a_table() -> None:
    columns = {name: TABLE[name] for name in ("radius", "load")}
    rows = solver.solve({"material": "PZT-4", "friction": [0.0, 0.1]} | columns)
    assert dict(rows["voltage"].sizes) == {"friction": 2, "case": 3}
    assert list(rows["case"].values) == ["a", "b", "c"]
    levels = TABLE.set_index(pd.MultiIndex.from_tuples([(1, 2), (1, 3), (2, 4)]))
    kinds = levels.assign(thickness=[np.nan, 1e-3, np.nan], base=[None, "steel", None])
    for table in (levels, kinds):
        assert solver.solve(table)["case"].values.tolist() == [0, 1, 2]
    alone = solver.solve({"material": "PZT-4"} | {name: TABLE[name].iloc[1] for name in columns})
    assert float(rows["voltage"][0, 1]) == pytest.approx(float(alone["voltage"]), rel=1e-12)
    with pytest.raises(solver.FactorError, match=r"^load: its rows are not those of radius: Series are columns"):
        solver.solve(columns | {"material": "PZT-4", "load": TABLE["load"].iloc[::-1]})


BALL: dict[str, Any] = {"material": "AlN", "profile": "sphere", "radius": "1 mm", "force": "1 N"}
FILM: dict[str, Any] = CASE | {"thickness": "1 mm", "base": "steel", "surroundings": "insulated"}
KINDS = [CASE, BALL, {"volume_fraction": 0.5, "radius": 0.05, "load": 1e4, "friction": 0.1}, CASE | {"load": 2e4}, FILM]


@pytest.mark.parametrize("table", [KINDS, pd.DataFrame(KINDS[:2] + KINDS[3:4], index=["a", "b", "c"])])
def test_rows_of_several_kinds_are_solved_kind_by_kind(table: Any) -> None:
    rows = solver.solve(table, [0.0, 0.5])
    alone = [solver.solve(row, [0.0, 0.5]) for row in (KINDS if table is KINDS else [KINDS[0], KINDS[1], KINDS[3]])]
    assert rows.sizes == {"case": len(table), "position": 2}
    for name in {name for answer in alone for name in answer.data_vars}:
        for place, answer in enumerate(alone):
            expected = answer[name].squeeze() if name in answer else np.nan
            assert_allclose(rows[name][place], expected, rtol=1e-12, err_msg=str(name))
    np.testing.assert_array_equal(rows["force"][:2], [np.nan, 1.0])
    assert rows["profile"].values.tolist()[:2] == ["", "sphere"]
    inside = solver.solve_interior(table, [0.0], [-1.0])["stress_yy"]
    assert inside.sizes == {"case": len(table), "y": 1, "x": 1}
    if isinstance(table, pd.DataFrame):
        assert rows["case"].values.tolist() == ["a", "b", "c"]


def test_a_heading_may_have_a_unit() -> None:
    headed = pd.DataFrame({"material": "PZT-4", "radius [mm]": [50.0, "6 cm"], "load (kN/m)": [10, 20]})
    rows = solver.solve(headed)
    assert rows["radius"].values.tolist() == [0.05, 0.06]
    assert rows["load"].values.tolist() == [1e4, 2e4]


@pytest.mark.parametrize(
    ("table", "word"),
    [
        (TABLE.iloc[:0], "without rows"),
        ([], "no list of mappings"),
        ("PZT-4", "no list of mappings"),
        (pd.concat([TABLE, TABLE[["load"]]], axis=1), "load: two columns"),
        (TABLE.assign(load=pd.array([1e4, None, 2e4], dtype="Float64")), "load: missing"),
        (TABLE.assign(material=["PZT-4", None, "PZT-4"]), "material: missing"),
        (TABLE.assign(colour=1), "colour: unknown factor"),
        (TABLE.assign(load=[1e4, np.nan, 1e4]), r"^load: missing; must be .* \(row b\)$"),
        (TABLE.assign(load=[1e4, 1e4, -1.0]), r"^load: -1 is not .* \(row c\)$"),
        # no kind of body: a hole
        (pd.DataFrame([CASE, BALL, CASE], index=list("abc")).assign(friction=[0.1, 0.2, np.nan]),
         r"^friction: nan is not .* \(row c\)$"),
        (TABLE.drop(columns="radius").assign(**{"radius [kg]": 1}), r"^radius \[kg\]: unit mismatch: 'kg'"),
        (TABLE.drop(columns="radius").assign(**{"radius [smoot]": 1}), r"^radius \[smoot\]: .* is not a unit"),
        (TABLE.assign(**{"radius [mm]": 50}), "^radius: two columns"),
        (CASE | {"material": np.ma.array(["PZT-4", "BaTiO3"], mask=[False, True])}, "material: 'n"),
    ],
)  # fmt: skip
def test_what_is_no_table_of_cases_is_refused(table: Any, word: str) -> None:
    assert_refused(solver.FactorError, word, solver.solve, table)


def test_masked_positions_and_fractions_are_refused() -> None:
    hidden = np.ma.array([0.5, 2.0], mask=[False, True])
    assert_refused(solver.FactorError, "positions: nan", solver.solve, CASE, hidden)
    assert_refused(solver.MaterialError, "nan is not within", solver.fibrous, BTO, CFO, hidden)


def test_a_text_with_a_unit_is_its_number() -> None:
    film = BALL | {"punch": "steel", "surroundings": "insulated", "base": "silicon"}
    texts = film | {"radius": "5 mm", "force": ["1 mN", 0.01, "1e-1N"], "thickness": "20 um"}
    numbers = film | {"radius": 5e-3, "force": [1e-3, 0.01, 0.1], "thickness": 2e-5}
    xr.testing.assert_identical(solver.solve(texts), solver.solve(numbers))
    named = xr.DataArray(["5 mm", "2 cm"], dims="punch_radius")
    assert solver.solve(texts | {"radius": named})["radius"].values.tolist() == [5e-3, 2e-2]


def test_a_solution_says_what_no_factor_says() -> None:
    factors = {"volume_fraction": 0.3, "composite": ["laminate", "fibrous"], "radius": 0.05, "load": 1e4, "datum": 2.0}
    for out in (solver.solve(factors), solver.solve_interior(factors, [0], [-1])):
        attrs = dict(out.attrs)
        assert attrs.pop("title").startswith("exact ")
        assert attrs.pop("source").startswith("meecontact: closed-form")
        assert attrs == {
            "composite": "laminate, fibrous", "phases": "BaTiO3, CoFe2O4",
            "defaults": "friction = 0, charge = 0 C m-1, magnetic_charge = 0 Wb m-1, speed = 0 m s-1, "
            "profile = cylinder, electric = conducting, magnetic = conducting, surroundings = insulated",
        }  # fmt: skip


@pytest.mark.parametrize(
    ("case", "words"),
    [
        ({"profile": "sphere", "radius": 1e-3, "force": [1.0, 1e5]}, "in 1 of 2 cases, at worst a half-width of"),
        ({"radius": 1e-3, "load": 1e8}, "strain: a half-width of 0.00122 m is 1.2 of the punch radius 0.001 m"),
        ({"thickness": 1e-4, "base": "rigid", "profile": "flat", "width": 1e-4, "load": 4e6}, "0.22 of the thickness"),
        ({"thickness": 1e-4, "base": "steel", "profile": "sphere", "radius": 0.1, "force": 2e4}, ""),
        ({"radius": 0.05, "load": 1e5}, ""),
    ],
)
def test_contacts_beyond_small_strain_are_told_with_both_numbers(case: dict[str, Any], words: str) -> None:
    """The depth of a film on a base as soft as it is the base's, not a strain of the film."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        answer = solver.solve({"material": "PZT-4", "surroundings": "insulated"} | case)
    assert [warning.category for warning in caught] == [solver.SmallStrainWarning] * bool(words)
    assert all(re.search(words, str(warning.message)) for warning in caught)
    if case.get("base") == "steel":
        assert float(answer["depth"]) > 0.1 * float(answer["thickness"])
