"""The warning that rounding costs digits: never too late, and not for what is computed well."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

import solver
from solver.halfplane.precision import TOLERATED, rounding
from solver.halfplane.speed import limiting_speed
from solver.halfplane.surface import HalfPlane
from solver.material.constants import ANY_SIZE
from verification.cases import constants
from verification.oracles.half_plane import half_plane

CASE = {"radius": 0.05, "load": 1e5, "friction": 0.3}


def orthotropic(c11: float, c33: float, c13: float, c44: float) -> tuple[solver.Material, float, float]:
    """An elastic material with N11 and k1 in closed form (Ting, Anisotropic Elasticity, 1996, section 6.9)."""
    mean = np.sqrt(c11 * c33)
    S21 = np.sqrt(c44 * (mean - c13) / (c33 * (c13 + 2 * c44 + mean)))
    constants = {"c11": f"{c11!r} Pa", "c13": f"{float(c13)!r} Pa", "c33": f"{c33!r} Pa", "c44": f"{c44!r} Pa"}
    material = solver.Material.from_mapping({"name": "orthotropic", **constants})
    return material, 1 / (np.sqrt(c33 / c11) * (mean + c13) * S21), -1 / (mean + c13)


@pytest.mark.sampled(6)
@pytest.mark.parametrize("c44", [2.0, 2e2, 2e5, 2e8, 2e11, 2e20])
@pytest.mark.parametrize("c33", [2e2, 2e11, 2e20])
def test_the_estimate_follows_the_error_of_strongly_anisotropic_materials(c33: float, c44: float) -> None:
    material, lam, kap = orthotropic(2e11, c33, 0.3 * np.sqrt(2e11 * c33), c44)
    half = HalfPlane(material)
    error = max(abs(half.compliance[0, 0] / lam - 1), abs(half.friction_coupling[0] - kap) / lam)
    assert error <= max(30 * rounding(half), 1e-11)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("short", [1e-3, 1e-9, 1e-12, 1e-15])
@pytest.mark.parametrize("name", ["steel", "PZT-5H"])
def test_the_estimate_follows_the_error_next_to_the_limiting_speed(name: str, short: float) -> None:
    material = solver.find(name)
    speed = np.asarray(limiting_speed(material) * (1 - short))
    exact = np.array(half_plane(constants(material), float(speed)).normal_compliance.tolist(), dtype=float)
    half = HalfPlane(material, speed)
    size = np.sqrt(np.abs(np.diag(exact)))
    error = float(np.max(np.abs(half.compliance - exact) / np.outer(size, size)))
    assert error <= max(30 * rounding(half), 1e-11)
    assert (rounding(half) > TOLERATED) == (short < 1e-6)


def test_lost_digits_are_warned_of_in_words() -> None:
    sheared = replace(solver.find("BaTiO3"), c44=np.asarray(43.0), name="sheared", any_size=ANY_SIZE)
    with pytest.warns(solver.PrecisionWarning, match="sheared: constants so far apart that rounding costs digits"):
        solver.solve({"material": sheared, **CASE})
    speed = float(limiting_speed(solver.find("steel"))) * (1 - 1e-14)
    with pytest.warns(solver.PrecisionWarning, match="steel: a speed so near the limiting one that"):
        solver.solve({"material": "steel", "speed": speed, **CASE})


def test_ordinary_materials_are_not_warned_of() -> None:
    with warnings.catch_warnings(action="error"):
        solver.solve({"material": list(solver.materials()), **CASE, "load": 1e3})  # rubber stays in small strain
        solver.solve({"volume_fraction": np.linspace(0, 1, 5), "composite": ["fibrous", "laminate"], **CASE})
