"""Tables of films on the command line: solved beside half-planes, refused in one line with the row at fault."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import solver
from solver.names import QUANTITIES
from storage.netcdf import read_whole
from workflow.cli import main
from workflow.run.provenance import ROOT


@pytest.fixture
def films(tmp_path: Path) -> Path:
    """The example without air, which takes long."""
    header, *rows = (ROOT / "examples/films.csv").read_text(encoding="utf-8").splitlines()
    text = [f"{header},surroundings", *(f"{row},{'insulated' if ',,,' not in row else ''}" for row in rows)]
    path = tmp_path / "cases.csv"
    path.write_text("\n".join(text), encoding="utf-8")
    return path


def test_the_example_mixes_films_and_half_planes(
    films: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "films.nc"
    assert main.main(["solve", str(films), "-o", str(out), "--positions=-0.5,2"]) == 0
    assert "empty where a case has no such quantity: " in capsys.readouterr().err
    data = read_whole(out)
    assert set(QUANTITIES) <= set(data.data_vars)
    np.testing.assert_array_equal(data["thickness"], [2e-4, 5e-4, 5e-4, 2e-4, np.nan])
    assert list(data["base"].values) == ["rigid", "rigid", "steel", "steel", ""]
    punch: dict[str, Any] = {"radius": 0.05, "friction": 0.3, "load": 1e5}
    rows: dict[int, dict[str, Any]] = {
        1: {"material": "PZT-4", "thickness": 5e-4, "base": "rigid"},
        3: {"volume_fraction": 0.5, "thickness": 2e-4, "base": "steel", "interface_magnetic": "grounded",
            "charge": 1e-6},
        4: {"material": "PZT-4"},
    }  # fmt: skip
    for row, factors in rows.items():
        exact = solver.solve(
            punch | factors | ({"surroundings": "insulated"} if "thickness" in factors else {}), [-0.5, 2.0]
        )
        for name in exact.data_vars:
            np.testing.assert_allclose(data[name][row], exact[name], rtol=1e-9, err_msg=str(name))


def test_fields_inside_films_and_half_planes(films: Path, tmp_path: Path) -> None:
    out = tmp_path / "inside.nc"
    example, grid = str(films), ["--x=0,0.5", "--y=-4,-0.5", "--fields=stress_yy,von_mises"]
    assert main.main(["interior", example, "-o", str(out), *grid]) == 0
    data = read_whole(out)
    rigid = data["base"].values == "rigid"
    assert np.all(np.isnan(data["von_mises"].values[rigid][:, 0]))
    assert np.all(np.isfinite(data["von_mises"].values[~rigid]))
    assert np.all(data["stress_yy"].values[:, 1] < 0)
