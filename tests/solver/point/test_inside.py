"""Fields inside below points: textbooks, balance, bodies that are the same, and integrals by another way."""

from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.linalg import expm
from scipy.optimize import minimize_scalar
from scipy.special import jv

import solver
from solver.material.constants import Material
from solver.stack.fourier import Medium
from tests.solver.cases import BTO, FIBROUS

BALL: dict[str, Any] = {"material": "BaTiO3", "profile": "sphere", "radius": 5e-3, "force": 10.0}
COAT: dict[str, Any] = {"thickness": 8e-5, "surroundings": "insulated", "base": "steel"}
NU = 0.3
STEEL = Material.isotropic(200e9, NU, name="isotropic")


def inside(case: dict[str, Any], x: list[float], y: list[float], fields: list[str] | None = None) -> xr.Dataset:
    return solver.solve_interior(case, x, y, fields=fields)


@pytest.mark.parametrize("body", [{}, COAT | {"thickness": 1.2e-4}], ids=["half-space", "film"])
def test_fields_are_in_balance_and_obey_the_material(body: dict[str, Any]) -> None:
    """Differences: parts that do not depend on the angle balance in space; stresses and fields obey the material.

    Mirrored points separate the parts of 1 and of cos(angle).
    """
    step, X, Y = 5e-4, 0.7, -0.6
    case = BALL | {"friction": 0.3} | body
    positions = [-X - step, -X, -X + step, X - step, X, X + step]
    fields = inside(case, positions, [Y - step, Y, Y + step])

    def parts(name: str, mirrored: int = 1) -> tuple[Any, Any]:
        """Parts of 1 and of cos(angle) over (y, x) about X; -1 for a component along r, which x is opposite to."""
        values = fields[name].values.squeeze()
        right, left = values[:, 3:], mirrored * values[:, 2::-1]
        return (right + left) / 2, (right - left) / 2

    def dr(values: Any) -> float:
        return float(values[1, 2] - values[1, 0]) / (2 * step)

    def dy(values: Any) -> float:
        return float(values[2, 1] - values[0, 1]) / (2 * step)

    radial, hoop, normal = (parts(f"stress_{name}") for name in ("xx", "zz", "yy"))
    shear, displacement = parts("stress_xy", -1), parts("electric_displacement_x", -1)
    size = float(np.abs(fields["stress_yy"]).max())
    first = 0  # without friction nothing depends on the angle
    assert abs(dr(radial[first]) + dy(shear[first]) + (radial[first] - hoop[first])[1, 1] / X) < 1e-4 * size
    assert abs(dr(shear[first]) + dy(normal[first]) + shear[first][1, 1] / X) < 1e-4 * size
    up = parts("electric_displacement_y")
    flux = float(np.abs(up[first]).max())
    assert abs(dr(displacement[first]) + dy(up[first]) + displacement[first][1, 1] / X) < 1e-4 * flux
    field_r, field_y = parts("electric_field_x", -1), parts("electric_field_y")
    for part in (0, 1):  # the curl of the electric field is zero in both
        assert abs(dy(field_r[part]) - dr(field_y[part])) < 1e-4 * float(np.abs(field_y[part]).max())
    m = BTO
    positions = [0.7, -0.3]
    strained = ["strain_xx", "strain_yy", "strain_xy"]
    at_points = inside(case, positions, [Y], strained).squeeze(), inside(case, positions, [Y]).squeeze()
    xx, yy, xy = (at_points[0][name].values for name in strained)
    stress, E, D = at_points[1], at_points[1]["electric_field_y"].values, at_points[1]["electric_displacement_y"]
    zz = (stress["stress_yy"].values - m.c33 * yy + m.e33 * E) / m.c13 - xx
    for name, along, other in (("stress_xx", xx, zz), ("stress_zz", zz, xx)):
        np.testing.assert_allclose(stress[name], m.c11 * along + m.c12 * other + m.c13 * yy - m.e31 * E, rtol=1e-9)
    np.testing.assert_allclose(D, m.e31 * (xx + zz) + m.e33 * yy + m.eps33 * E, rtol=1e-9, atol=1e-9 * flux)
    along = stress["electric_field_x"].values
    np.testing.assert_allclose(stress["stress_xy"], 2 * m.c44 * xy - m.e15 * along, rtol=1e-9)


def test_stresses_of_a_film_are_integrals_of_its_system() -> None:
    """On a rigid base: its 8 x 8 system by matrix exponentials, and the pressure's own transform, over k."""
    h, x, y = 1e-4, 0.8, -0.7
    case = BALL | COAT | {"thickness": h, "base": "rigid", "electric": "insulating", "magnetic": "insulating"}
    a = float(solver.solve(case)["contact_radius"])
    medium = Medium(BTO, Medium(BTO, np.ones(4)).halfplane.scale)
    angle, shares = np.polynomial.legendre.leggauss(80)
    angle, shares = np.pi / 4 * (1 + angle), np.pi / 4 * shares
    s = np.sin(angle)
    pressure = solver.solve(case, s)["contact_pressure"].values
    k, weights = np.polynomial.legendre.leggauss(120)
    k, weights = 20 * (1 + k), 20 * weights  # over h: beyond, exponentials of the reference lose their digits
    transform = jv(0, np.outer(k, s) * a / h) @ (shares * np.cos(angle) * s * pressure)
    depth, integral = -y * a / h, 0.0
    for q, weight, t in zip(k, weights, transform, strict=True):
        down = expm(-q * medium.system)  # of [k u; t] from the surface to the base: u = 0 there
        traction = np.array([0.0, -t * medium.scale[1], 0.0, 0.0])
        surface = np.concatenate([np.linalg.solve(down[:4, :4], -down[:4, 4:] @ traction), traction])
        state = expm(-q * depth * medium.system) @ surface
        integral += weight * q * (a / h) ** 2 * state[5] / medium.scale[1] * jv(0, q * x * a / h)
    solved = float(inside(case, [x], [y], ["stress_yy"])["stress_yy"].squeeze())
    assert solved == pytest.approx(integral, rel=2e-8)


CHARGED: dict[str, Any] = BALL | {"material": FIBROUS, "friction": 0.3, "total_charge": 1e-9, "total_flux": 1e-9}


END: dict[str, Any] = {"profile": "disc", "width": 2e-4}
SLID = {"half-space": CHARGED, "film": CHARGED | COAT, "disc": CHARGED | END, "disc on a film": CHARGED | END | COAT}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("case", SLID.values(), ids=SLID)
def test_potentials_fall_as_the_fields_say_and_are_the_punch_s_on_the_contact(case: dict[str, Any]) -> None:
    """Central differences, near the surface and deep; at 0.01 a and above the half-space's part is closed."""
    case, step = {name: value for name, value in case.items() if name != "radius" or "width" not in case}, 3e-4
    punch = solver.solve(case)
    a = float(punch["contact_radius"])
    for kind, strength in (("electric", punch["voltage"]), ("magnetic", punch["magnetic_potential"])):
        potential, along, across = f"{kind}_potential", f"{kind}_field_x", f"{kind}_field_y"
        for X, Y in ((-0.4, -0.02), (1.4, -0.02), (0.6, -0.3)):
            points = [X - step, X, X + step], [Y - step, Y, Y + step]
            fields = inside(case, *points, [potential, along, across])
            values = fields[potential].values.squeeze() / (2 * step * a)
            field = [fields[name].values.squeeze()[1, 1] for name in (along, across)]
            falls = [values[1, 0] - values[1, 2], values[0, 1] - values[2, 1]]
            np.testing.assert_allclose(falls, field, atol=1e-5 * float(np.hypot(*field)), rtol=0)
        surface = inside(case, [-0.7, 0.0, 0.95], [0.0], [potential])[potential].values.ravel()
        np.testing.assert_allclose(surface, float(strength), rtol=2e-9)


def test_von_mises_below_a_ball_is_huber_s() -> None:
    """On the axis, where sigma_rr and sigma_yy are closed; the depth is that of the top."""
    solution = solver.solve(BALL | {"material": STEEL}, peaks=True)
    top = minimize_scalar(
        lambda z: -abs(1.5 / (1 + z**2) - (1 + NU) * (1 - z * np.arctan(1 / z))),
        bounds=(0.3, 0.7), method="bounded", options={"xatol": 1e-9},
    )  # fmt: skip
    assert float(solution["peak_von_mises"] / solution["peak_pressure"]) == pytest.approx(-top.fun, rel=1e-9)
    assert float(solution["peak_von_mises_depth"] / solution["contact_radius"]) == pytest.approx(top.x, rel=1e-6)
