"""Answers to tables of cases: CSV for a spreadsheet, and what is told of quantities that are left out."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import solver
from workflow.cli.main import main
from workflow.cli.solve import as_csv

BALLS = """\
material,profile,radius [mm],force,thickness,base,surroundings
PZT-4,sphere,1,0.1 N,20 um,steel,insulated
PVDF,sphere,2,0.2,20 um,glass,insulated
"""


def test_a_csv_has_the_columns_of_the_cases_and_a_number_a_case(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cases, out = tmp_path / "cases.csv", tmp_path / "out.csv"
    cases.write_text(BALLS, encoding="utf-8")
    assert main(["solve", str(cases), "-o", str(out)]) == 0
    printed = capsys.readouterr().err
    assert printed == f"wrote {out}: 2 cases, 20 quantities\n"  # nobody misses what electrodes have
    frame = pd.read_csv(out)
    assert list(frame.columns[:6]) == ["material", "profile", "radius [m]", "force [N]", "thickness [m]", "base"]
    for row, (material, radius, force, base) in enumerate(
        [("PZT-4", 1e-3, 0.1, "steel"), ("PVDF", 2e-3, 0.2, "glass")]
    ):
        ball = {"profile": "sphere", "radius": radius, "force": force}
        alone = solver.solve(
            ball | {"material": material, "thickness": 20e-6, "base": base, "surroundings": "insulated"}
        )
        for name in ("voltage", "contact_radius", "charge_per_force"):
            column = f"{name} [{alone[name].attrs['units']}]"
            np.testing.assert_allclose(frame[column][row], alone[name].item(), rtol=1e-12)  # rounding, in a batch


def test_a_name_that_a_spreadsheet_would_calculate_stays_a_name(tmp_path: Path) -> None:
    as_csv(xr.Dataset(coords={"material": ("case", np.array(["=1+1"], dtype=object))}), tmp_path / "out.csv")
    assert (tmp_path / "out.csv").read_text(encoding="utf-8") == "material\n'=1+1\n"
