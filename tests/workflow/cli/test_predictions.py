"""How a surrogate's answer is written: a value with the figures that its interval leaves it."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import surrogate
from workflow.cli import main, query


@pytest.mark.parametrize(
    ("numbers", "expected"),
    [
        ((-527.568446, -527.5708, -527.566), "-527.5684 [-527.5708, -527.5660] (95 %)"),
        ((0.0, -2e-9, 2e-9), "0.000 [-2.000e-09, 2.000e-09] (95 %)"),
        ((12345678.0, 12345668.0, 12345688.0), "12345678 [12345668, 12345688] (95 %)"),
        ((1.5, 1.5, 1.5), "1.5 [1.5, 1.5] (95 %)"),
        ((0.0, 0.0, 0.0), "0 [0, 0] (95 %)"),
        ((float("nan"),) * 3, "nan [nan, nan] (95 %)"),
    ],
)
def test_an_interval_is_shown_with_the_figures_that_it_has(numbers: tuple[float, float, float], expected: str) -> None:
    assert query.shown(*numbers) == expected


def test_query_says_that_a_surrogate_is_not_calibrated(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    levels = surrogate.chebyshev_levels(0.0, 1.0, 5)
    path = tmp_path / "raw.nc"
    surrogate.save(surrogate.GridGP().fit(xr.Dataset({"f": ("x", np.exp(levels))}, coords={"x": levels})), path)
    assert main.main(["query", str(path), "--at", "x=0.3"]) == 0
    assert "not calibrated" in capsys.readouterr().err
