"""Surface fields of films: figures, the closed form, the integral equations and balances by another quadrature."""

import numpy as np
import pytest

from solver.arrays import Array
from solver.line.contact import FilmContact
from solver.stack.layers import Layer, Stack
from solver.stack.reflection import waves
from tests.solver.line.films import BTO, FIBROUS, STEEL, cylinder, surface_fields
from tests.solver.quadrature import rule

CASES = {
    "rigid": (Stack((Layer(FIBROUS, 0.2e-3),)), 0.3, (2e-5, 1e-2)),
    "flux sideways": (Stack((Layer(FIBROUS, 0.1e-3, magnetic="insulated"),)), 0.3, (2e-5, 1e-4)),
    "two layers on steel": (Stack((Layer(BTO, 0.1e-3), Layer(FIBROUS, 0.1e-3, "bonded")), STEEL), 0.6, (2e-5, 0.0)),
}


@pytest.fixture(scope="module", params=CASES)
def state(request: pytest.FixtureRequest) -> tuple[FilmContact, dict[str, Array]]:
    stack, friction, charges = CASES[request.param]
    computed = cylinder(stack, friction, 1e5, charges)
    return computed, surface_fields(computed, rule().X)


def test_integral_equations_hold_by_another_quadrature(state: tuple[FilmContact, dict[str, Array]]) -> None:
    """A double exponential rule in X and one of equal panels in k; the principal value with its pole taken out."""
    film, fields = state
    stack, h = film.table.system.kernel.stack, film.half_width[0]
    points = np.array([-0.83, -0.31, 0.12, 0.77])
    at_points = surface_fields(film, points)
    half, scale = film.table.system.sliding.halfplane, film.scale
    nodes = rule()

    def tractions(tabled: dict[str, Array]) -> Array:
        rows = (
            tabled["shear_traction"],
            -tabled["contact_pressure"],
            tabled["electric_displacement_y"],
            tabled["magnetic_induction_y"],
        )
        return np.array([row[0] for row in rows]) * scale[:, None]

    root = np.sqrt((1 - nodes.X) * (1 + nodes.X))  # rounded as that by which the fields were divided
    t, regular = tractions(fields) * root, tractions(at_points) * np.sqrt(1 - points**2)
    gap = nodes.X - points[:, None]
    H = np.einsum("s,jps->jp", nodes.weight / np.pi, (t[:, None] - regular[..., None]) / gap)
    far = 40 / (2 * stack.top.thickness * float(stack.media[0].slowest))
    x, w = np.polynomial.legendre.leggauss(40)
    edges = np.concatenate([[0.0], np.geomspace(1e-7, 1e-3, 12), np.linspace(1e-3, 1.0, 60)[1:]]) * far
    k = ((edges[1:] + edges[:-1])[:, None] / 2 + (edges[1:] - edges[:-1])[:, None] / 2 * x).ravel()
    weights = ((edges[1:] - edges[:-1])[:, None] / 2 * w).ravel()
    Delta = waves(stack, k)[0].difference[:, 1:] * weights[:, None, None]
    residual, size = np.zeros((3, points.size)), np.zeros(3)
    pair = scale[1:, None] * scale[1:]
    for p, X0 in enumerate(points):
        kx = k[:, None] * h * (X0 - nodes.X)
        total = h * nodes.weight
        sines, cosines = np.sin(kx) @ (total * t[1:]).T, np.cos(kx) @ (total * t[0])
        smooth = -(np.einsum("koj,kj->o", Delta[..., 1:], sines) + Delta[..., 0].T @ cosines) / np.pi
        local = half.compliance / pair @ H[1:, p] + half.friction_coupling / (scale[1:] * scale[0]) * (
            regular[0, p] / np.sqrt(1 - X0**2)
        )
        slope = np.array([(film.offset[0] + h * X0) / 0.05 / scale[1], 0.0, 0.0])
        residual[:, p] = local + smooth - slope
        size = np.maximum(size, np.abs(half.compliance / pair) @ np.abs(H[1:, p]))
    error = np.max(np.abs(residual) / size[:, None])
    assert error < 1e-9, error
