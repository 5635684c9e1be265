"""The four combinations of conducting and insulating punches against 50 digits, alone and mixed along an axis."""

from typing import Any

import numpy as np
import pytest
from mpmath import isnan

import solver
from verification.cases import SIH_SONG, constants
from verification.oracles import precise

POSITIONS = [-250.0, -1.7, -1.0001, -0.95, 0.2, 0.95, 1.0001, 4.0]
KINDS = ("conducting", "insulating")


@pytest.mark.sampled(4)
@pytest.mark.parametrize("magnetic", KINDS)
@pytest.mark.parametrize("electric", KINDS)
@pytest.mark.parametrize(("name", "friction"), [(SIH_SONG, 0.0), (SIH_SONG, 1.3), ("PZT-5H", 0.4), ("CoFe2O4", 1e-9)])
def test_conduction_agrees_with_50_digits(name: str, friction: float, electric: str, magnetic: str) -> None:
    case: dict[str, Any] = {"radius": 0.03, "load": 4e4, "friction": friction, "datum": 0.2}
    case |= {"charge": 1e-6 * (electric == KINDS[0]), "magnetic_charge": -2e-3 * (magnetic == KINDS[0])}
    kinds: dict[str, Any] = {"electric": electric, "magnetic": magnetic}
    computed = solver.solve({"material": name, **case, **kinds}, POSITIONS)
    exact = precise.solve(constants(solver.find(name)), **case, **kinds, positions=POSITIONS)
    for quantity, value in exact.quantities.items():
        if isnan(value):
            assert quantity not in computed
        else:
            np.testing.assert_allclose(
                computed[quantity].item(), float(value), rtol=2e-13, atol=1e-70, err_msg=quantity
            )
    for field, values in exact.fields.items():
        np.testing.assert_allclose(computed[field], np.array(values, float), rtol=2e-12, atol=1e-30, err_msg=field)
