"""Films on the page: times with tables, absolute quantities, and a drawing."""

from typing import Any

import numpy as np
import pytest
import xarray as xr

import solver
from tests.studies import fitted, made, shipped
from workflow.dataset import factorial
from workflow.learning import timing
from workflow.report import exact, page, whatif
from workflow.study.datum import hanging
from workflow.study.model import Study

FILM = """\
title: A film
fixed: {surroundings: insulated, composite: fibrous, radius: 0.05, friction: 0.1, load: 3e4}
categories: {base: [rigid, steel]}
factors:
  volume_fraction: {low: 0.5, high: 0.6, levels: 3}
  thickness: {low: 2e-4, high: 3e-4, levels: 4, scale: log}
surrogate: {outputs: [contact_trailing, contact_leading, pressure_exponent, peak_pressure, voltage, depth]}
validation: {cases: 40, calibration: 60, tolerance: 1e-3}
"""


@pytest.fixture(scope="module")
def study() -> Study:
    return made(FILM)


def test_times_hold_tables_and_the_panel_knows_no_closed_form(study: Study, monkeypatch: pytest.MonkeyPatch) -> None:
    quantities = factorial.exact(study, factorial.axes(study))
    model = fitted(study, calibrated=True)
    cases, solved, calls = factorial.cases(study, "validation"), factorial.exact, []

    def counted(study: Study, axes: dict[str, Any], **options: Any) -> xr.Dataset:
        calls.append(np.unique(axes["volume_fraction"]))
        return solved(study, axes, **options)

    monkeypatch.setattr(factorial, "exact", counted)
    times = timing.timing(study, quantities, cases, model)
    assert all(value > 0 for value in times.values())
    # one composition for the thicknesses of the factorial, one for every scattered case, none that has tables already
    assert [quantity.size for quantity in calls] == [1, 8, 1]
    assert np.unique(np.concatenate([*calls, cases["volume_fraction"].values])).size == 10 + 4
    drawings = page._problem(study), page._problem(shipped("paper"))
    assert ["half-plane</title>" in drawn for drawn in drawings] == [False, True]
    assert all("film on its base" in drawn for drawn in drawings)
    hangs = hanging(study)
    content = whatif.content(study, model, quantities, [], hangs)
    assert content is not None
    assert not any(kind["pressure"] for kind in content["kinds"])
    words = {quantity["name"]: quantity["long_name"] for quantity in content["quantities"]}
    assert (words["voltage"], words["depth"]) == (
        "electric potential of the punch", "indentation depth relative to the datum"
    )  # fmt: skip


def test_what_hangs_on_the_datum_is_said_of_the_base_where_it_does(study: Study) -> None:
    rows = {row["name"]: row for row in exact.changes(study)}
    assert all(name.endswith("[steel]") for name in rows)
    case = {
        **study.fixed,
        "volume_fraction": 0.55,
        "thickness": np.sqrt(2e-4 * 3e-4),
        "surroundings": "insulated",
        "base": "steel",
    }
    depths = solver.solve({**case, "datum": [0.1, 1.0, 10.0]})["depth"]
    np.testing.assert_allclose(rows["depth[steel]"]["values"], depths, rtol=1e-12)
    assert np.isfinite(rows["depth[steel]"]["slope"])
