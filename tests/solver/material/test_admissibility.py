"""Every material with a positive definite energy is solved, and no other."""

from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import solver
from tests.solver.cases import assert_finite
from tests.solver.strategies import between, constants, loads, property_based

POSITIONS = (-1e3, -1.001, -0.5, 0.999, 4.0)


def energies(c: dict[str, float]) -> list[np.typing.NDArray[np.float64]]:
    """The blocks of the energy, each with unit diagonal: stiffness (in the plane, or in space) and both dielectric."""
    n = {"c12": float("nan"), "g11": 0.0, "g33": 0.0} | c
    full = [[n["c11"], n["c12"], n["c13"]], [n["c12"], n["c11"], n["c13"]], [n["c13"], n["c13"], n["c33"]]]
    plane = [[n["c11"], n["c13"]], [n["c13"], n["c33"]]]
    blocks = [np.array(plane if np.isnan(n["c12"]) else full)]
    blocks += [np.array([[n["eps" + a], n["g" + a]], [n["g" + a], n["mu" + a]]]) for a in ("11", "33")]
    return [block / np.sqrt(np.outer(np.diag(block), np.diag(block))) for block in blocks]


@property_based
@given(c=constants(), case=loads(friction=5.0))
def test_admissible_materials_are_solved(c: dict[str, float], case: dict[str, Any]) -> None:
    out = solver.solve({"material": solver.Material.from_mapping(c), **case}, POSITIONS, regular=True)
    assert_finite(out)
    assert out.contact_trailing.item() > 0
    assert out.contact_leading.item() > 0
    assert 0 < out.pressure_exponent.item() < 1
    assert out.peak_pressure.item() > 0
    alpha, width = out.pressure_exponent.item(), (out.contact_trailing + out.contact_leading).item()
    lam = np.pi * alpha * (1 - alpha) * width**2 / (2 * case["radius"] * case["load"])
    assert 0 < lam < 1e3 / min(c["c11"], c["c33"], c["c44"])


_BREAKABLE = {"c13": ("c11", "c33"), "c12": ("c11", "c11"), "g11": ("eps11", "mu11"), "g33": ("eps33", "mu33")}


@property_based
@given(c=constants(), name=st.sampled_from(sorted(_BREAKABLE)), share=between(-1.5, 1.5))
def test_the_check_is_that_of_the_eigenvalues(c: dict[str, float], name: str, share: float) -> None:
    """One off-diagonal constant anywhere within or beyond its bound: accepted exactly where the energy is positive."""
    first, second = _BREAKABLE[name]
    c = c | {name: share * (c[first] * c[second]) ** 0.5}
    least = min(float(np.linalg.eigvalsh(block)[0]) for block in energies(c))
    assume(abs(least) > 1e-12)
    if least > 0:
        solver.Material.from_mapping(c)
    else:
        with pytest.raises(solver.MaterialError):
            solver.Material.from_mapping(c)


@pytest.mark.parametrize("name", sorted(_BREAKABLE))
@pytest.mark.parametrize("sign", [-1, 1])
def test_the_bound_itself(name: str, sign: int) -> None:
    c = {"c11": 2e11, "c13": 0.0, "c33": 1.5e11, "c44": 5e10}
    c |= {"eps11": 5e-9, "eps33": 7e-9, "mu11": 1e-4, "mu33": 3e-4}
    first, second = _BREAKABLE[name]
    bound = sign * (c[first] * c[second]) ** 0.5
    solver.Material.from_mapping(c | {name: bound * (1 - 1e-12)})
    with pytest.raises(solver.MaterialError, match=f"{name} = "):
        solver.Material.from_mapping(c | {name: bound * (1 + 1e-12)})


def test_one_bad_case_of_many_is_named() -> None:
    steel, rubber = solver.find("steel"), solver.Material.isotropic(1e6, 0.45, name="rubber")
    broken = solver.Material(
        c11=np.array(1e9), c13=np.array(2e9), c33=np.array(1e9), c44=np.array(1e9), name="broken"
    )  # fmt: skip
    with pytest.raises(solver.MaterialError, match="broken: c13"):
        solver.solve({"material": [steel, broken, rubber], "radius": 0.1, "load": 1.0})
