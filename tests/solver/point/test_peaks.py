"""Largest stresses below points: Huber's, those of a scan of the fields inside, and where there are none."""

from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import solver
from solver.material.constants import Material

NU = 0.3
BALL: dict[str, Any] = {"material": "BaTiO3", "profile": "sphere", "radius": 5e-3, "force": 10.0}


def test_von_mises_below_a_ball_is_huber_s() -> None:
    """On the axis, where sigma_rr and sigma_yy are closed; the depth is that of the top."""
    solution = solver.solve(BALL | {"material": Material.isotropic(200e9, NU, name="isotropic")}, peaks=True)
    top = minimize_scalar(
        lambda z: -abs(1.5 / (1 + z**2) - (1 + NU) * (1 - z * np.arctan(1 / z))),
        bounds=(0.3, 0.7), method="bounded", options={"xatol": 1e-9},
    )  # fmt: skip
    assert float(solution["peak_von_mises"] / solution["peak_pressure"]) == pytest.approx(-top.fun, rel=1e-9)
    assert float(solution["peak_von_mises_depth"] / solution["contact_radius"]) == pytest.approx(top.x, rel=1e-6)
