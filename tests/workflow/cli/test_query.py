"""Points of a table or of the command line, and what a surrogate answers, refuses and writes."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from surrogate import GridGP, Input, save
from tests.programs import Command
from workflow.cli import query

ESCAPE = "\x1b]0;owned\x07\x1b[31m"


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A surrogate's file whose output and unit command the terminal."""
    inputs = [Input("radius", 0.01, 0.2, "log", "m"), Input("friction", 0.0, 0.5, units="1")]
    axes = {axis.name: axis.levels(5) for axis in inputs}
    values = np.exp(axes["friction"]) * np.log(axes["radius"])[:, None]
    attrs = {"units": f"Pa{ESCAPE}"}
    data = xr.Dataset({f"depth{ESCAPE}": (("radius", "friction"), values, attrs)}, coords=axes)
    path = tmp_path_factory.mktemp("points") / "surrogate.nc"
    save(GridGP(inputs=inputs, outputs=[f"depth{ESCAPE}"]).fit(data), path)
    return path


def test_names_cannot_command_the_terminal(model: Path, command: Command) -> None:
    shown, _ = command("query", model, "--at", "radius=0.3,friction=0.1", "--extrapolate")
    assert "extrapolated" in shown
    assert "depth\\x1b]0;owned\\x07\\x1b[31m" in shown
    assert all(line.isprintable() for line in shown.split("\n"))


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
