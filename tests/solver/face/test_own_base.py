"""A film on a base of its own material is that body without a film: the closed form, whatever presses and slides."""

from itertools import product
from typing import Any

import numpy as np
import pytest

import solver
from solver.fields import EVERY_INTERIOR
from tests.solver.cases import assert_alike
from verification.cases import bonded

MIX = "BaTiO3-CoFe2O4 50:50"
ALL = [(True, True), (True, False), (False, True), (False, False)]
#: Materials: every constant, those of isotropic bodies, whose roots coincide, and one dielectric alone.
LINE: dict[str, Any] = {"material": MIX, "friction": 0.4, "load": 1e5, "datum": 0.4}
LINES: dict[str, dict[str, Any]] = {
    "cylinder": {"radius": 0.05},
    "flat": {"profile": "flat", "width": 3e-4, "slope": 1e-4},
    "tilted by a moment": {"profile": "flat", "width": 3e-4, "moment": 0.5},
    "wedge": {"profile": "wedge", "slope": 2e-3},
    "half cylinder": {"profile": "half_cylinder", "radius": 0.05, "corner": "trailing"},
    "own": {"profile": solver.Profile.polynomial([0.0, 20.0, 0.0, 1e9])},
    "elastic": {"radius": 0.05, "punch": "steel"},
    "elastic wedge": {"profile": "wedge", "slope": 2e-3, "punch": "brass", "material": "PZT-4"},
    "isotropic": {"radius": 0.05, "material": "glass"},
}
POINT: dict[str, Any] = {"material": MIX, "force": 10.0}
POINTS: dict[str, dict[str, Any]] = {
    "sphere": {"profile": "sphere", "radius": 5e-3},
    "sliding": {"profile": "sphere", "radius": 5e-3, "friction": 0.3},
    "elastic sphere": {"profile": "sphere", "radius": 5e-3, "friction": 0.2, "punch": "steel"},
    "cone": {"profile": "cone", "slope": 0.1},
    "disc": {"profile": "disc", "width": 1e-4, "friction": 0.3},
    "power": {"profile": "power", "exponent": 4.0, "coefficient": 1e9},
}
#: From far away to next to the edges; an interface at 0.9 to 1.7 of the contact's half-length.
X, Y = np.array([-30.0, -1.2, -1.001, -0.99, -0.5, 0.1, 0.9, 1.01, 2.5]), np.array([-0.02, -0.5, -0.95, -1.5, -4.0])


def told(factors: dict[str, Any], conducts: tuple[bool, bool], charges: tuple[str, str]) -> dict[str, Any]:
    """The case of a punch that conducts what it is told to, with charges where it does."""
    sizes = {"charge": 2e-6, "magnetic_charge": 1e-3, "total_charge": 3e-10, "total_flux": -2e-8}
    for field, charge, first in zip(("electric", "magnetic"), charges, conducts, strict=True):
        factors = factors | ({charge: sizes[charge]} if first else {field: "insulating"})
    return factors


@pytest.mark.sampled(10)
@pytest.mark.parametrize("conducts", ALL)
@pytest.mark.parametrize("name", LINES)
def test_lines(name: str, conducts: tuple[bool, bool]) -> None:
    case = told(LINE | LINES[name], conducts, ("charge", "magnetic_charge"))
    film = bonded(case, 3e-4)
    assert_alike(solver.solve(film, X, regular=True), solver.solve(case, X, regular=True), 3e-11)
    inside, exact = (solver.solve_interior(problem, X, Y, fields=list(EVERY_INTERIOR)) for problem in (film, case))
    assert_alike(inside, exact, 3e-10)


@pytest.mark.sampled(5)
@pytest.mark.parametrize(("name", "conducts"), [*product(["sphere"], ALL), *product(POINTS, [(True, True)])])
def test_points(name: str, conducts: tuple[bool, bool]) -> None:
    case = told(POINT | POINTS[name], conducts, ("total_charge", "total_flux"))
    for thickness in (1e-5, 1e-3):
        assert_alike(solver.solve(bonded(case, thickness)), solver.solve(case), 1e-11)


def test_fields_of_points() -> None:
    case = told(POINT | POINTS["sliding"] | {"material": "BaTiO3"}, (True, False), ("total_charge", "total_flux"))
    x, y = [-1.3, 0.0, 0.4, 2.5], [-0.01, -0.3, -0.95, -1.05, -4.0]
    # sums over b cancel to the depth 1e-3 a above which fields are extrapolated: rounding moves them by 1e-10 at x = 0
    assert_alike(solver.solve(bonded(case, 6.6e-5), x, regular=True), solver.solve(case, x, regular=True), 3e-10)
    assert_alike(solver.solve_interior(bonded(case, 6.6e-5), x, y), solver.solve_interior(case, x, y), 1e-11)


@pytest.mark.parametrize("charge", [0.0, 8e-10])
def test_points_that_slide_in_air(charge: float) -> None:
    """Two charges: above the field at which the surface gives way, and below it."""
    case = told(POINT | POINTS["sliding"], (True, False), ("total_charge", "total_flux"))
    case |= {"material": "BaTiO3", "surroundings": "air", "total_charge": charge}
    turned = ["contact_offset", "trailing_tension", "peak_pressure", "peak_displacement", "gap_field"]
    film = case | {"thickness": 6e-5, "base": "BaTiO3", "interface_electric": "bonded"}
    computed, exact = solver.solve(film), solver.solve(case)
    np.testing.assert_allclose([computed[name] for name in turned], [exact[name] for name in turned], rtol=1e-8)
