"""Tables of cases are rows, and a cell that is masked or missing is none."""

from typing import Any

import numpy as np
import pandas as pd
import pytest

import solver

TABLE = pd.DataFrame(
    {"material": ["PZT-4", "BaTiO3", "PZT-4"], "radius": ["50 mm", 0.06, 0.07], "load": [1e4, 2e4, 3e4]},
    index=["a", "b", "c"],
)
CASE: dict[str, Any] = {"material": "PZT-4", "radius": 0.05, "load": 1e4}
MASKED = np.ma.array([0.05, 1e37], mask=[False, True])


@pytest.mark.parametrize("table", [TABLE, TABLE.to_dict("records"), TABLE.astype({"material": "category"})])
def test_every_row_of_a_table_is_a_case(table: Any) -> None:
    rows = solver.solve(table)
    assert dict(rows.sizes) == {"case": 3}
    for place, row in enumerate(TABLE.to_dict("records")):
        assert float(rows["voltage"][place]) == pytest.approx(float(solver.solve(row)["voltage"]), rel=1e-12)


def test_series_with_one_index_are_columns_of_a_table() -> None:
    columns = {name: TABLE[name] for name in ("radius", "load")}
    rows = solver.solve({"material": "PZT-4", "friction": [0.0, 0.1]} | columns)
    assert dict(rows["voltage"].sizes) == {"friction": 2, "case": 3}
    assert list(rows["case"].values) == ["a", "b", "c"]
    for place, (_, row) in enumerate(TABLE[["radius", "load"]].iterrows()):
        alone = solver.solve({"material": "PZT-4"} | dict(row))
        assert float(rows["voltage"][0, place]) == pytest.approx(float(alone["voltage"]), rel=1e-12)
    with pytest.raises(solver.FactorError, match=r"^load: its rows are not those of radius: Series are columns"):
        solver.solve(columns | {"material": "PZT-4", "load": TABLE["load"].iloc[::-1]})


def test_rows_have_the_labels_of_their_frame_and_may_lack_what_is_optional() -> None:
    assert list(solver.solve(TABLE)["case"].values) == ["a", "b", "c"]
    rows = solver.solve([CASE, CASE | {"thickness": "1 mm", "base": "steel", "surroundings": "insulated"}])
    assert float(rows["voltage"][0]) == pytest.approx(float(solver.solve(CASE)["voltage"]), rel=1e-12)
    levels = TABLE.set_index(pd.MultiIndex.from_tuples([(1, 2), (1, 3), (2, 4)]))
    assert solver.solve(levels)["case"].values.tolist() == [0, 1, 2]


@pytest.mark.parametrize(
    ("table", "word"),
    [
        (TABLE.iloc[:0], "without rows"),
        ([], "no list of mappings"),
        ("PZT-4", "no list of mappings"),
        (pd.concat([TABLE, TABLE[["load"]]], axis=1), "load: two columns"),
        (TABLE.assign(load=pd.array([1e4, None, 2e4], dtype="Float64")), "load: nan"),
        (TABLE.assign(material=["PZT-4", None, "PZT-4"]), "material: 'n"),
        (TABLE.assign(colour=1), "colour: unknown factor"),
    ],
)
def test_what_is_no_table_of_cases_is_refused(table: Any, word: str) -> None:
    with pytest.raises(solver.FactorError, match=word):
        solver.solve(table)


@pytest.mark.parametrize("radius", [MASKED, list(MASKED), np.ma.masked, np.ma.array([1, 9], mask=[False, True])])
def test_a_masked_factor_is_refused_as_nan_is(radius: Any) -> None:
    case = CASE | {"radius": radius}
    with pytest.raises(solver.FactorError, match="radius: nan is not"):
        solver.solve(case)
    with pytest.raises(solver.FactorError, match="radius: nan is not"):
        solver.solve_interior(case, [0.0], [-0.5])


def test_masked_names_positions_and_constants_are_refused() -> None:
    hidden = np.ma.array([0.5, 2.0], mask=[False, True])
    constants = {name: getattr(solver.find("PZT-4"), name) for name in ("c11", "c13", "c33", "c44")}
    with pytest.raises(solver.FactorError, match="material: 'n"):
        solver.solve(CASE | {"material": np.ma.array(["PZT-4", "BaTiO3"], mask=[False, True])})
    with pytest.raises(solver.FactorError, match="positions: nan"):
        solver.solve(CASE, hidden)
    with pytest.raises(solver.FactorError, match="x: not a list"):
        solver.solve_interior(CASE, hidden, [-0.5])
    with pytest.raises(solver.MaterialError, match="c33: not a finite number"):
        solver.solve(CASE | {"material": solver.Material(**constants | {"c33": np.ma.array(1e11, mask=True)})})
    with pytest.raises(solver.MaterialError, match="nan is not within"):
        solver.fibrous(solver.find("BaTiO3"), solver.find("CoFe2O4"), hidden)
