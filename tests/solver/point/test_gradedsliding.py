"""Points that slide on graded films, and what electrodes of these get: homogeneous limits, staircases, quadrature."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import solver
from solver.arrays import Array
from solver.line.powerlaw import constants_of
from solver.line.windows import Coat
from solver.point.density import Density
from solver.point.galerkin import Added
from solver.point.gradedsliding import GradedLayers, hilbert, odd_rates, odd_shares
from solver.point.gradedterms import GradedTerms, pieces, pieces_below
from solver.point.halfspace import halfspace
from solver.point.interactions import interactions
from solver.point.profile import Shape
from solver.point.response import Response, contact_coupling, legendre
from solver.point.slidingtable import Layers
from solver.stack.electroded import difference, surface
from solver.stack.layers import Stack
from solver.stack.wavenumbers import strip, wavenumbers
from tests.solver.line.test_grading import linear
from tests.solver.point.points import STEEL, of_coats
from tests.solver.point.test_graded import CONSTANT, GRADED, LINEAR, PLAIN

BOTH = np.array([True, True])
PLACES = np.array([0.05, 0.4, 0.8, 0.97])
COUNT = 40  # Legendre functions and nodes of homogeneous layers


def rubbed(stack: Stack, exponent: float, radius: float) -> tuple[Array, Array]:
    """c/a and psi at places per eta, of the profile, SI over C a^(e-1); (1,) and (3, place)."""
    shape, N, at = Shape(exponent), surface(stack)[1:, 1:], np.array([radius])
    terms = (
        GradedTerms(stack, BOTH, N, shape, at) if stack.top.graded else Added(N, interactions(stack, at, COUNT), shape)
    )
    found, own = terms.coefficients[0], halfspace(N, shape)
    edges = own.edges + np.einsum("ind,n->id", found, terms.edges)
    causes = np.eye(4)[3:] - edges[0, 3] / edges[0, 0] * np.eye(4)[:1]
    strengths = causes @ edges.T
    strengths[:, 0] = 0.0
    form = causes[:, 3:] * (-2 / np.pi * np.linalg.inv(N)[:, 0])
    series = np.einsum("ind,cd->cin", found, causes)
    density = Density(shape, strengths, form, series, pieces_below(stack, shape))
    response = Response(N, contact_coupling(-surface(stack)[0, 1:], stack.scale, 0.0, BOTH), shape)
    if stack.top.graded:
        solved = GradedLayers(stack, BOTH, shape, 2 * radius).solved(response, density, radius)[0]
        basis = odd_shares(pieces(kinked=exponent % 2 != 0, odd=True), PLACES)
    else:
        k, weights = wavenumbers(stack, 2 * radius, strip(stack))
        added = difference(stack, k)
        solved = Layers(k, weights, added[:, 1:, 1:], added[:, 1:, 0]).solved(response, density, radius, COUNT)[0]
        basis = legendre(PLACES, COUNT)
    psi = response.closed(density.turned(PLACES)[:, 0], PLACES, solved[:1])[0] + solved[1:].reshape(3, -1) @ basis.T
    return solved[:1], psi / stack.scale[1:, None] / stack.scale[1]


@pytest.mark.soak  # the ball below has it in every quantity
@pytest.mark.parametrize(("exponent", "covered"), [(1.0, False), (2.0, True)])
def test_friction_on_what_is_graded_by_nothing_is_that_on_a_layer(exponent: float, *, covered: bool) -> None:
    kinds = (replace(kind, electroded=covered) for kind in (CONSTANT, PLAIN))
    (shift, psi), (other, own) = (rubbed(kind.stack(), exponent, 0.7) for kind in kinds)
    assert float(shift[0]) == pytest.approx(float(other[0]), rel=1e-10)
    size = np.max(np.abs(own), -1, keepdims=True) + 1e-300  # an electrode leaves no D_y to the punch
    np.testing.assert_allclose(psi / size, own / size, atol=1e-9)


def test_staircases_tend_to_what_friction_does_on_a_graded_film() -> None:
    """Layers of the shipped stacks, of second order in their steps; no multiplier of graded films has part in them."""

    def away(stack: Stack, radius: float) -> Array:
        """c/a and psi but beside the edge, where steps are seen one by one."""
        shift, psi = rubbed(stack, 2.0, radius)
        return np.append(psi[:, :-1].ravel(), shift)

    exact, found = away(LINEAR.stack(), 0.5), list[Array]()
    for count in (4, 8, 16):
        middles = ((np.arange(count) + 0.5) / count).tolist()
        between = [("bonded", "bonded")] * (count - 1) + [(None, None)]
        coats = [Coat(constants_of(linear(np.array(z))), 1.0, *own) for z, own in zip(middles, between, strict=True)]
        found.append(away(of_coats(tuple(coats), STEEL).stack(), 0.5 * count))
    first, second, third = (part / exact - 1 for part in found)
    assert np.all((first / second > 2.5) & (second / third > 3.3))
    np.testing.assert_allclose(found[2] + (found[2] - found[1]) / 3, exact, rtol=5e-3)


@pytest.mark.parametrize("kinked", [False, True])
def test_odd_pieces_integrate_and_read_what_friction_makes(*, kinked: bool) -> None:
    """Hilbert's transform of 1 - b^2, int log|b - s| s^3 ds, and the pressure of b^3."""
    of = pieces(kinked=kinked, odd=True)
    b, places = of.nodes, np.append(of.nodes, 1.0)
    turned = (hilbert(kinked=kinked) @ (1 - b**2))[:-1]
    np.testing.assert_allclose(turned, 2 / np.pi * (b + (1 - b**2) * np.arctanh(b)), atol=1e-12)
    kernel = np.log(np.abs(of.points.distances))[:, None]
    cubed = of.summed(kernel * of.points.sources[:, None] ** 3)[:, 0]
    np.testing.assert_allclose(of.integrated(kernel)[..., 0] @ b**3, cubed, atol=1e-13)
    inner = places[:-1]
    exact = (inner**4 - 1) / 4 * np.log((1 + inner) / (1 - inner)) - inner**3 / 2 - inner / 6
    np.testing.assert_allclose(cubed[:-1], exact, atol=1e-12)
    top = np.array([0.1, 0.7])
    square = 1 - top**2
    own = odd_rates(of, tuple(top.tolist())) @ np.append(b**3, 1.0)
    np.testing.assert_allclose(own, 3 * (square * top + top**3 / 3) / np.sqrt(square), atol=1e-12)


def test_a_ball_that_slides_on_a_film_graded_by_nothing_has_all_that_one_on_a_layer_has() -> None:
    """Through the face: friction, a patch of the electrode below, fields inside."""
    case: dict[str, Any] = GRADED | {"friction": 0.3, "volume_fraction": 0.5}
    read = {"collector": 1, "patch_size": 1e-4, "patch_position": 3e-5, "patch_pitch": 1.5e-4}
    plain = {name: value for name, value in case.items() if name != "base_volume_fraction"}
    found, exact = (solver.solve(own | read) for own in (case | {"base_volume_fraction": 0.5}, plain))
    assert {"contact_offset", "patch_charge_per_force", "crosstalk", "electrode_pressure"} <= set(found)
    assert set(exact) - set(found) == {"trailing_tension"}
    for name in found:
        assert float(found[name]) == pytest.approx(float(exact[name]), rel=1e-9), name
    one, other = (
        solver.solve_interior(own, [-0.5, 0.5], [-0.4], fields=["stress_xy", "electric_displacement_y"])
        for own in (case | {"base_volume_fraction": 0.5}, plain)
    )
    for name, values in other.items():
        np.testing.assert_allclose(one[name], values, rtol=1e-8)
