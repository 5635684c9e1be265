"""Points on graded films: Galerkin's equations, a closed multiplier, staircases, Irwin's relation; what is refused."""

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.integrate import quad
from scipy.special import gammainc, spherical_jn, xlogy

import solver
from solver.arrays import Array
from solver.fields import POINT_FIELDS
from solver.line.kernel import graded_response
from solver.line.powerlaw import PowerLaw, constants_of
from solver.line.windows import Coat
from solver.point.galerkin import Added
from solver.point.gradedterms import GradedTerms
from solver.point.halfspace import halfspace
from solver.point.interactions import interactions
from solver.point.pieces import Pieces
from solver.point.profile import Shape
from solver.point.quantities import quantities
from solver.point.surface import surface_fields
from solver.point.surfacekernel import normal_kernel
from solver.stack.grading import local_tails
from solver.stack.layers import Layer, Stack
from tests.solver.line.test_grading import linear, uncoupled
from tests.solver.point.points import BTO, CFO, FIBROUS, STEEL, of_coats, on_film


def constant(depth: Array) -> solver.Material:
    return solver.fibrous(BTO, CFO, 0.5 + 0 * depth)


LINEAR, CONSTANT, PLAIN = (of_coats((Coat(of),), STEEL) for of in (linear, constant, constants_of(FIBROUS)))
STACK = LINEAR.stack()
BALL: dict[str, Any] = {"surroundings": "insulated", "profile": "sphere", "radius": 5e-3, "force": 1.0}
GRADED: dict[str, Any] = BALL | {
    "volume_fraction": 0.2,
    "base_volume_fraction": 0.8,
    "thickness": 1e-4,
    "base": "steel",
}


def solved(stack: Stack, exponent: float, radii: Array) -> tuple[Array, Array]:
    """Loads over a, and strengths times a, of u0 and of (r/a)^e; (radius, 3, 4) each."""
    N, shape = stack.media[0].compliance[1:, 1:], Shape(exponent)
    terms, own = GradedTerms(stack, np.array([True, True]), N, shape, radii), halfspace(N, shape)
    loads, edges = (np.einsum("aind,n->aid", terms.coefficients, shares) for shares in (terms.loads, terms.edges))
    return own.loads + 2 * np.pi * loads, own.edges + edges


def in_legendre(
    compliance: Array, difference: Callable[[Array], Array], tails: Array, exponent: float, a: float, count: int
) -> Array:
    """Loads over a by Legendre functions (P4.2), int Delta j_2m j_2n ds summed to 4000; (3, 4).

    Beyond, j_2m j_2n is (-1)^(m + n) / (2 s^2) and a wave. Loads miss by count^-6: two counts are extrapolated.
    """
    starts = np.append(0.0, np.geomspace(1e-4, 4000.0 / a, 60))
    x, w = np.polynomial.legendre.leggauss(16)
    k, weights = [], []
    for start, end in pairwise(starts.tolist()):
        parts = int(np.ceil((end - start) * a / 6))
        half = (end - start) / parts / 2
        k.append((start + half * (2 * np.arange(parts)[:, None] + 1 + x)).ravel())
        weights.append(np.tile(half * w, parts))
    nodes, rule = np.concatenate(k), np.concatenate(weights)
    bessel, signs = np.array([spherical_jn(2 * n, a * nodes) for n in range(count)]), (-1.0) ** np.arange(count)
    K = a * np.einsum("mk,kij,nk->ijmn", bessel, difference(nodes) * rule[:, None, None], bessel, optimize=True)
    beyond = tails[0] * a / 4 / 4000.0**2 + tails[1] * a**2 / 6 / 4000.0**3
    K += beyond[:, :, None, None] * signs[:, None] * signs
    own = halfspace(compliance, Shape(exponent)).loads
    half, whole = (
        own + 2 * np.pi * Added(compliance, K[None, :, :, :some, :some], Shape(exponent)).coefficients[0, :, 0]
        for some in (count // 2, count)
    )
    return np.asarray(whole + (whole - half) / 63)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("exponent", [2.0, 1.0, 0.0])
def test_loads_are_those_of_legendre_functions(exponent: float) -> None:
    radii, response = np.array([0.1, 1.0]), graded_response(STACK)
    loads, _ = solved(STACK, exponent, radii)
    for a, own in zip(radii.tolist(), loads, strict=True):
        exact = in_legendre(
            STACK.media[0].compliance[1:, 1:],
            lambda k: response.difference(k)[:, 1:, 1:],
            response.tails[:, 1:, 1:],
            exponent,
            a,
            32,
        )
        np.testing.assert_allclose(own, exact, atol=2e-10 * np.max(np.abs(exact)))


def test_loads_on_a_graded_dielectric_are_those_of_its_closed_multiplier() -> None:
    stack = of_coats((Coat(uncoupled),)).stack()
    ratio = float(BTO.eps33 / BTO.eps11)

    def difference(k: Array) -> Array:
        root = np.sqrt(0.64 + 4 * k**2 / ratio)
        fall = np.exp(-root)
        return np.asarray(k * (1 - fall) / ((root - 0.8) / 2 + (root + 0.8) / 2 * fall) - np.sqrt(ratio))

    N = np.diag([1.0, np.sqrt(ratio), 1.0])
    tails = np.zeros((2, 3, 3))
    tails[:, 1, 1] = 0.4 * ratio, 0.08 * ratio**1.5
    only = np.diag([0.0, 1.0, 0.0])
    for a in (0.2, 3.0):
        exact = in_legendre(N, lambda k: difference(k)[:, None, None] * only, tails, 0.0, a, 32)[1, 1]
        loads, _ = solved(stack, 0.0, np.array([a]))
        assert -loads[0, 1, 1] / stack.scale[2] ** 2 / float(BTO.eps33) == pytest.approx(exact, rel=1e-10)


@pytest.mark.parametrize("a", [0.03, 1.0, 10.0])
def test_moving_the_edge_releases_what_its_strengths_say(a: float) -> None:
    """Irwin's relation (P3.4) of loads and edges, which are read in different ways; the loads are another test's."""
    N, step = STACK.media[0].compliance[1:, 1:], 0.01
    radii = a * np.exp(step * np.arange(-3, 4))
    loads, edges = solved(STACK, 2.0, radii)
    whole = (radii[:, None, None] * loads)[..., :3]
    rate = np.tensordot([-1, 9, -45, 0, 45, -9, 1], whole, 1) / (60 * step)
    released = np.pi**2 * a * edges[3, :, :3].T @ N @ edges[3, :, :3]
    np.testing.assert_allclose(rate, released, atol=2e-10 * np.max(np.abs(released)))


def test_staircases_tend_to_the_graded_film() -> None:
    exact, _ = solved(of_coats((Coat(linear),)).stack(), 2.0, np.array([0.5]))
    found = []
    for count in (6, 12, 24):
        middles = (np.arange(count) + 0.5) / count
        stack = Stack(tuple(Layer(linear(np.array(z)), 1.0 / count) for z in middles))
        N, ours = stack.media[0].compliance[1:, 1:], STACK.scale[1:] / stack.scale[1:]
        added = Added(N, interactions(stack, np.array([0.5]), 40), Shape(2.0)).coefficients[0, :, 0]
        loads = halfspace(N, Shape(2.0)).loads + 2 * np.pi * added
        found.append((loads[:, :3] * ours[:, None] * ours)[:2, :2])
    first, second = found[1] - found[0], found[2] - found[1]
    limit = found[2] + second / (first / second - 1)  # nearly of second order: the top layer's own material differs
    np.testing.assert_allclose(limit, exact[0, :2, :2], rtol=1e-4)
    assert np.all(np.abs(found[2] / exact[0, :2, :2] - 1) < 1.5e-3)


def test_pressure_and_charge_below_a_ball_carry_its_loads() -> None:
    pressed = on_film(LINEAR, 1e-4, 2.0, 100.0, [3.0, 6.0])
    x, w = np.polynomial.legendre.leggauss(60)
    x, w = (1 + x) / 2, w / 2
    fields = surface_fields(pressed, np.sqrt((1 - x) * (1 + x)))
    areas = 2 * np.pi * pressed.charged.radius[:, None] ** 2 * x * w
    np.testing.assert_allclose(np.sum(areas * fields["contact_pressure"], 1), pressed.force, rtol=1e-8)
    peak = quantities(pressed)["peak_pressure"]
    middle = surface_fields(pressed, np.zeros(1))["contact_pressure"][:, 0]
    np.testing.assert_allclose(peak, middle, rtol=1e-9)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("exponent", "coefficient"), [(2.0, 100.0), (3.0, 1e5)])
def test_tangents_are_differences(exponent: float, coefficient: float) -> None:
    step = 1e-4
    forces = 5 * np.array([1 - step, 1.0, 1 + step])
    found = quantities(on_film(LINEAR, 1e-4, exponent, coefficient, forces, (1e-10, 0.0)))
    change = found["depth"][2] - found["depth"][0]
    assert 10 * step / change == pytest.approx(found["contact_stiffness_open"][1], rel=1e-7)


def test_local_tails_are_cosine_transforms() -> None:
    for x in (0.01, 0.7, 4.0):
        for order, found in enumerate(local_tails(np.array([x]), 0.4)[:, 0], 1):
            near = quad(lambda k, j=order, x=x: gammainc(j, 0.4 * k) / k**j * np.cos(k * x), 0, 50 / x, limit=500)[0]
            far = quad(lambda k, j=order: gammainc(j, 0.4 * k) / k**j, 50 / x, np.inf, weight="cos", wvar=x)[0]
            assert found == pytest.approx(near + far, abs=1e-8), (x, order)


def test_spread_of_a_constant_profile_is_that_of_a_layer() -> None:
    x = np.array([1e-3, 0.1, 0.9, 4.0, 19.0])
    exact, found = normal_kernel(PLAIN.stack()).at(x), normal_kernel(CONSTANT.stack(), 20.0).at(x)
    np.testing.assert_allclose(found, exact, atol=1e-11 * np.max(np.abs(exact)))


@pytest.mark.parametrize("kinked", [False, True])
def test_pieces_integrate_logarithms_and_read_what_is_singular_at_the_edge(*, kinked: bool) -> None:
    pieces = Pieces(kinked)
    b, places = pieces.nodes, np.append(pieces.nodes, 1.0)
    found = pieces.integrated(np.log(np.abs(pieces.points.distances))[:, None])[..., 0] @ (1 - b**2)
    plain = xlogy(1 + places, 1 + places) + xlogy(1 - places, 1 - places) - 2  # int log|b - s| ds
    squared = xlogy(1 + places**3, 1 + places) + xlogy(1 - places**3, 1 - places) - 2 / 3 - 2 * places**2
    np.testing.assert_allclose(found, plain - squared / 3, atol=2e-12)
    phi = (1 - b**2) * np.log(1 - b**2)
    assert pieces.weights @ phi == pytest.approx(4 / 3 * np.log(2) - 10 / 9, abs=1e-12)
    top = np.array([0.1, 0.7])
    own = pieces.bounded(top) @ np.append(phi, 0.0)
    # with tau = sqrt(b^2 - r^2): -2 int_0^x (1 + log(x^2 - tau^2)) dtau
    np.testing.assert_allclose(own, -2 * (2 * np.log(2) - 1 + 2 * np.log(top)) * top, atol=1e-9)


def test_two_ways_to_a_graded_film_are_one() -> None:
    found = solver.solve(GRADED | {"force": [2.0, 5.0]})
    profile = solver.Graded(PowerLaw("fibrous", (constants_of(BTO), constants_of(CFO)), 0.2, 0.8, 1.0), 1e-4)
    other = solver.solve(BALL | {"force": [2.0, 5.0], "body": solver.Stack((profile,), solver.find("steel"))})
    assert {"voltage", "charge_per_force", "contact_stiffness", "nominal_field"} <= set(found)
    for name in found:
        np.testing.assert_allclose(found[name], other[name], rtol=1e-12, err_msg=str(name))
    assert "trailing_tension" not in solver.solve(GRADED | {"friction": 0.0})


def test_largest_stresses_are_those_of_the_fields_inside() -> None:
    """On the interface and below it."""
    found = solver.solve(GRADED, peaks=["interface_shear", "interface_shear_position", "base_peak_von_mises"])
    depth = float(GRADED["thickness"] / found["contact_radius"])
    names, place = ["stress_xy", "von_mises"], float(found["interface_shear_position"])
    around = place + np.array([-0.05, 0.0, 0.05])
    shear = np.abs(solver.solve_interior(GRADED, around, [-depth], fields=names[:1])["stress_xy"].values.squeeze())
    assert shear[1] == pytest.approx(float(found["interface_shear"]), rel=1e-6)
    assert shear[1] > max(shear[0], shear[2])
    below = solver.solve_interior(GRADED, np.linspace(-1.5, 1.5, 13), [-1.0001 * depth], fields=names[1:])
    assert 0.97 < float(below["von_mises"].max() / found["base_peak_von_mises"]) < 1


FALLING = solver.Graded(lambda depth: solver.fibrous(BTO, CFO, 0.8 - 0.6 * depth), 1e-4)
PRESSED: dict[str, Any] = {"surroundings": "insulated", "profile": "sphere", "radius": 5e-3, "force": 10.0}


def inside(layers: Sequence[solver.Layer], x: list[float], y: list[float], fields: Sequence[str]) -> xr.Dataset:
    """At depths over the thickness."""
    case = PRESSED | {"body": solver.Stack(layers, base="steel")}
    a = float(solver.solve(case)["contact_radius"])
    return solver.solve_interior(case, x, (np.array(y) * 1e-4 / a).tolist(), fields=list(fields)).squeeze()


def test_fields_inside_obey_the_material_at_their_depth_and_meet_the_surface() -> None:
    """Hooke's law of the material there; pressure and charge of the punch on top, its potential on the contact."""
    depth, case = 0.4, PRESSED | {"body": solver.Stack([FALLING], base="steel")}
    names = (
        "strain_xx",
        "strain_yy",
        "stress_xx",
        "stress_yy",
        "stress_zz",
        "electric_field_y",
        "electric_displacement_y",
    )
    found = {name: float(value) for name, value in inside([FALLING], [0.7], [-depth], names).data_vars.items()}
    m, E = FALLING.profile(np.array(depth)), found["electric_field_y"]
    xx, yy = found["strain_xx"], found["strain_yy"]
    magnetic = solver.solve_interior(case, [0.7], [-depth * 1e-4 / float(solver.solve(case)["contact_radius"])],
                                     fields=["magnetic_field_y"])  # fmt: skip
    H = float(magnetic["magnetic_field_y"].squeeze())
    zz = (found["stress_yy"] - m.c33 * yy + m.e33 * E + m.f33 * H) / m.c13 - xx
    for name, along, across in (("stress_xx", xx, zz), ("stress_zz", zz, xx)):
        law = m.c11 * along + m.c12 * across + m.c13 * yy - m.e31 * E - m.f31 * H
        assert found[name] == pytest.approx(float(law), rel=1e-9)
    surface = solver.solve(case, [0.3, 1.5])
    top = solver.solve_interior(
        case, [0.3, 1.5], [0.0], fields=["stress_yy", "electric_displacement_y", "electric_potential"]
    )
    size = float(surface["contact_pressure"].max())
    np.testing.assert_allclose(top["stress_yy"].squeeze(), -surface["contact_pressure"], atol=1e-6 * size)
    assert float(top["electric_potential"][0, 0]) == pytest.approx(float(surface["voltage"]), rel=1e-4)
    assert set(POINT_FIELDS) <= set(surface.data_vars)


def test_fields_inside_are_those_of_staircases_extrapolated() -> None:
    """Stacks of 8 and 16 layers, each with the contact of its own; what is continuous across their steps."""
    names = ("stress_yy", "stress_xy", "electric_displacement_y", "electric_potential")
    places = [-1.3, 0.4], [-0.11, -0.52, -1.3]

    def steps(count: int) -> xr.Dataset:
        own = [FALLING.profile(np.array((i + 0.5) / count)) for i in range(count)]
        upper = [solver.Layer(one, 1e-4 / count, "bonded", "bonded") for one in own[:-1]]
        return inside([*upper, solver.Layer(own[-1], 1e-4 / count)], *places, names)

    found, coarse, fine = inside([FALLING], *places, names), steps(8), steps(16)
    for name in names:
        other = fine[name].values + (fine[name].values - coarse[name].values) / 3
        np.testing.assert_allclose(
            found[name].values, other, rtol=0, atol=2e-3 * float(np.abs(other).max()), err_msg=name
        )
