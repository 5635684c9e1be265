"""The integral equations (2.2) and the free surface outside, by quadrature of the tractions that ``solve`` returns."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given

import solver
from tests.solver.quadrature import Array, rule
from tests.solver.strategies import constants, loads, property_based
from verification.oracles.surface_response import surface_response

_RULE = rule()
_INSIDE = np.array([-0.93, -0.41, 0.07, 0.55, 0.9])
_OUTSIDE = np.array([-25.0, -2.0, -1.3, 1.3, 4.0])


def tractions(case: dict[str, Any]) -> tuple[Array, Array, Array]:
    """(sigma_xy, sigma_yy, D_y, B_y) times sqrt(1 - X^2) at the rule's nodes; themselves at ``_INSIDE``; x there."""
    out = solver.solve(case, np.concatenate([_RULE.X, _INSIDE]), regular=True)
    root = np.sqrt(1 - out.coords["position"].values ** 2)
    root[: _RULE.X.size] = _RULE.root
    rows = [out.shear_traction * root, -out.contact_pressure * root]
    rows += [out.electric_displacement_y_regular, out.magnetic_induction_y_regular]
    t = np.stack([row.values for row in rows])
    a, b = out.contact_trailing.item(), out.contact_leading.item()
    x = (a - b) / 2 + (a + b) / 2 * _INSIDE
    return t[:, : _RULE.X.size], t[:, _RULE.X.size :] / np.sqrt(1 - _INSIDE**2), x


def transforms_inside(regular: Array, within: Array) -> Array:
    """(1/pi) PV int t(s)/(s - X) ds at ``_INSIDE``, the singularity taken out."""
    quotient = (regular[:, None, :] - within[:, :, None] * _RULE.root) / (_RULE.X - _INSIDE[:, None])
    return np.asarray((quotient @ _RULE.weight + within * np.log((1 - _INSIDE) / (1 + _INSIDE))) / np.pi)


@property_based
@given(c=constants(), case=loads())
def test_the_integral_equations_hold(c: dict[str, float], case: dict[str, Any]) -> None:
    surface = surface_response({"g11": 0.0, "g33": 0.0} | c)
    regular, within, x = tractions({"material": solver.Material.from_mapping(c), **case})
    transform = transforms_inside(regular, within)
    N, k = surface.normal_compliance, surface.shear_coupling
    residual = np.outer(k, within[0]) + N @ transform[1:]
    residual[0] -= x / case["radius"]
    size = np.abs(N) @ np.max(np.abs(within[1:]), axis=1) + np.abs(k) * np.max(np.abs(within[0]))
    assert np.all(np.abs(residual) <= 1e-11 * size[:, None])


@property_based
@given(c=constants(), case=loads())
def test_fields_along_the_surface_follow_from_the_tractions(c: dict[str, float], case: dict[str, Any]) -> None:
    """sigma_xx, D_x and B_x by (2.1), a quadrature and the constitutive law alone, under the punch and beside it."""
    surface = surface_response({"g11": 0.0, "g33": 0.0} | c)
    material = solver.Material.from_mapping(c)
    regular, within, _ = tractions({"material": material, **case})
    outside = (regular * _RULE.weight) @ (1 / (_RULE.X[:, None] - _OUTSIDE)) / np.pi
    t = np.concatenate([within, np.zeros_like(outside)], axis=1)
    along = surface.along_surface(t, np.concatenate([transforms_inside(regular, within), outside], axis=1))
    out = solver.solve({"material": material, **case}, np.concatenate([_INSIDE, _OUTSIDE]))
    for name, row in (("stress_xx", 0), ("electric_displacement_x", 2), ("magnetic_induction_x", 3)):
        size = float(np.max(np.abs(out[name])))
        assert out[name].values == pytest.approx(along[row], rel=1e-9, abs=1e-10 * size), name
