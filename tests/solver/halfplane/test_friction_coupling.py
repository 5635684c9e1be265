"""kap = 0, where the closed form's D_y and B_y have the shape 0/0, and friction going to 0.

The material is made for it: soft in shear and strongly coupled, so that kap changes its sign as c44 grows. The place of
the crossing comes from the oracle's own half-plane.
"""

from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import solver
from tests.solver.cases import CHARGED, assert_agrees
from verification.oracles import precise
from verification.oracles.surface_response import surface_response

MADE = {"c11": 211e9, "c13": 407e9, "c33": 1230e9, "e31": -2.5, "e33": 22.0, "e15": 9.6, "f31": 235.0, "f33": 1180.0}
MADE |= {"f15": 130.0, "eps11": 2.3e-9, "eps33": 9.5e-9, "g11": 0.0, "g33": 5e-9, "mu11": 107e-6, "mu33": 16e-6}
POSITIONS = (-20.0, -1.01, -0.99, -0.4, 0.3, 0.99, 1.01, 4.0)
CONTACT: dict[str, Any] = CHARGED | {"friction": 1.5}


def reduced(c44: float) -> tuple[float, float]:
    """kap/lam and the larger of |d| over sqrt(lam |M_jj|^-1), by Schur complement of the oracle's compliance."""
    surface = surface_response(MADE | {"c44": c44})
    units = np.array([1.0, 1e10, 1e8])
    N, k = surface.normal_compliance / np.outer(units, units), surface.shear_coupling / units
    d = np.linalg.solve(N[1:, 1:], k[1:])
    kap, lam = k[0] - N[0, 1:] @ d, N[0, 0] - N[0, 1:] @ np.linalg.solve(N[1:, 1:], N[0, 1:])
    return float(kap / lam), float(np.max(np.abs(d) / np.sqrt(lam / np.abs(np.diag(N)[1:]))))


@cache
def crossing() -> float:
    """c44 at which kap is zero."""
    return float(brentq(lambda c44: reduced(c44)[0], 12e9, 60e9, xtol=1e-6, rtol=1e-15))


def test_the_made_material_crosses_zero_with_d_not_zero() -> None:
    kap, d = reduced(crossing())
    assert abs(kap) < 1e-14
    assert d > 0.01
    assert reduced(0.9 * crossing())[0] * reduced(1.1 * crossing())[0] < 0


@pytest.mark.sampled(2)
@pytest.mark.parametrize("offset", [0.0, 1e-9, -1e-13, 0.1])
def test_values_at_and_about_the_crossing(offset: float) -> None:
    c44 = crossing() * (1 + offset)
    exact = precise.solve(MADE | {"c44": c44}, positions=POSITIONS, **CONTACT)
    material = solver.Material.from_mapping(MADE | {"c44": c44})
    assert_agrees(solver.solve({"material": material, **CONTACT}, POSITIONS), exact)
