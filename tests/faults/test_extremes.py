"""Numerical extremes: every case is finite or a named error, and no file ever holds a NaN or an infinity."""

from itertools import product
from typing import Any

import numpy as np
import pytest

from solver import FactorError, MaterialError, solve
from solver.fields import FIELDS
from solver.names import QUANTITIES
from storage.netcdf import read_whole
from tests.programs import Command

FRICTIONS = [0.0, 1e-12, 1e-2, 10.0]
RADII = [1e-9, 1e-3, 1e3]
LOADS = [1e-3, 1.0, 1e3, 1e6, 1e9]
FRACTIONS = [0.0, 1e-15, 0.5, 1.0]
POSITIONS = [-1e6, -1 - 1e-12, -1 + 1e-12, 0.0, 1 - 1e-12, 1 + 1e-12, 1e6]


def finite_or_named(factors: dict[str, Any], varied: str) -> list[bool]:
    """Solve cases along one factor; finite, or an error in one line that names a factor or a quantity; which are."""
    try:
        out = solve(factors, POSITIONS)
    except (FactorError, MaterialError) as error:
        values, said = np.atleast_1d(np.asarray(factors[varied])), str(error)
        if values.size > 1:  # one that has no answer refuses the table: each on its own
            return [held for value in values for held in finite_or_named({**factors, varied: float(value)}, varied)]
        assert said.partition(":")[0] in {*QUANTITIES, *FIELDS, *factors}, said
        assert "\n" not in said
        return [False]
    for variable, array in out.data_vars.items():
        assert np.isfinite(array.values).all(), (variable, factors)
    return [True] * np.size(factors[varied])


@pytest.mark.sampled(1)
@pytest.mark.parametrize("composite", ["fibrous", "laminate"])
def test_factors_over_twelve_decades(composite: str) -> None:
    solved: list[bool] = []
    for eta, R, v in product(FRICTIONS, RADII, FRACTIONS):
        case = {"friction": eta, "radius": R, "load": LOADS, "volume_fraction": v, "composite": composite}
        solved += finite_or_named(case, "load")
    assert len(solved) == len(FRICTIONS) * len(RADII) * len(LOADS) * len(FRACTIONS)
    assert np.mean(solved) > 0.9  # an error is the exception: a contact as wide as the datum


def test_no_file_holds_what_is_not_finite(command: Command) -> None:
    written = 0
    for number, (eta, R, P, charge) in enumerate(product([0.0, 10.0], [1e-300, 1e3], [1e-300, 1e300], [0.0, 1e300])):
        text = f"volume_fraction,friction,radius [m],load [N/m],charge [C/m]\n0.5,{eta},{R},{P},{charge}\n"
        table = command.file(f"{number}.csv", text)
        file = table.with_suffix(".nc")
        status = command.status("solve", table, "-o", file, "--positions=-1.5,0.5")
        said = command.capsys.readouterr().err
        if status == 2:
            assert said.startswith(f"meecontact: {table}: ")
            assert said.count("\n") == 1
            assert not file.exists()
        else:
            written += 1
            data = read_whole(file)
            assert all(np.isfinite(data[variable].values).all() for variable in data.data_vars)
    assert written > 0
