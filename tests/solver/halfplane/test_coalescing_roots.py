"""Materials whose Stroh roots coalesce, exactly or nearly: the eigenvectors fail there, the solver must not."""

import numpy as np
import pytest
from numpy.typing import NDArray

import solver
from tests.solver.cases import CHARGED, assert_agrees
from verification.oracles import precise
from verification.oracles.sample_materials import BARIUM_TITANATE, COBALT_FERRITE, isotropic
from verification.oracles.surface_response import surface_response

POSITIONS = (-3.0, -1.001, -0.999, 0.25, 0.999, 1.001, 50.0)


def squares_of_roots(material: dict[str, float]) -> NDArray[np.complex128]:
    """p^2 of det(Q + p (R + R^T) + p^2 T) = 0, an even polynomial in p: from its values at eight imaginary p."""
    surface, units = surface_response(material), np.array([1.0, 1.0, 1e10, 1e8])
    scale = np.outer(units, units) / 1e11
    Q, R, T = surface.Q * scale, surface.R * scale, surface.T * scale
    squares = np.cos(np.pi * (np.arange(5) + 0.5) / 5)
    p = np.emath.sqrt(squares)[:, None, None]
    values = np.linalg.det(Q + p * (R + R.T) + p**2 * T).real
    polynomial = np.polynomial.chebyshev.cheb2poly(np.polynomial.chebyshev.chebfit(squares, values, 4))
    return np.roots(polynomial[::-1]).astype(np.complex128)


#: Ceramics with c13 moved until a pair of roots coalesces on the imaginary axis, where the discriminant is zero.
COALESCING = {
    "titanate": BARIUM_TITANATE | {"c13": 73530337388.73566},
    "ferrite": COBALT_FERRITE | {"c13": 185950658976.0411},
}


@pytest.mark.parametrize("name", ["titanate", "ferrite"])
def test_the_made_materials_have_a_double_root(name: str) -> None:
    s = squares_of_roots(COALESCING[name])
    gaps = sorted(abs(s[i] - s[j]) for i in range(4) for j in range(i))
    assert gaps[0] < 1e-6 < 1e-2 < gaps[1]


@pytest.mark.sampled(2)
@pytest.mark.parametrize(("name", "offset"), [("titanate", 0.0), ("titanate", 1e-7), ("ferrite", 0.0)])
def test_double_roots_of_coupled_materials(name: str, offset: float) -> None:
    material = COALESCING[name]
    check(material | {"c13": material["c13"] * (1 + offset)})


@pytest.mark.sampled(1)
@pytest.mark.parametrize("offset", [-1e-8, 0.0, 1e-15])
def test_isotropic_and_nearly_isotropic_elasticity(offset: float) -> None:
    material = isotropic(70e9, 0.33)
    check(material | {"c33": material["c33"] * (1 + offset)})


def test_every_block_isotropic_but_coupled_through_the_dielectric_one() -> None:
    check(isotropic(70e9, 0.2) | {"g11": 8e-9, "g33": 8e-9})  # three roots p = i, two of them with one eigenvector


def test_nearly_incompressible_elasticity() -> None:
    check(isotropic(5e6, 0.4999))


def check(material: dict[str, float]) -> None:
    constants = {name: value for name, value in material.items() if name != "rho"}
    exact = precise.solve(constants, positions=POSITIONS, **CHARGED)
    computed = solver.solve({"material": solver.Material.from_mapping(constants), **CHARGED}, POSITIONS)
    assert_agrees(computed, exact)
