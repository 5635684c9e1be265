"""Surface fields of films: figures, the closed form, the integral equations and balances by another quadrature."""

import numpy as np
import pytest

from solver.arrays import Array
from solver.film.contact import FilmContact
from solver.film.reflection import waves
from solver.film.stack import Layer, Stack, StackError
from solver.film.table import table
from solver.halfplane.contact import Contact
from solver.halfplane.fields import surface_fields as exact_fields
from solver.halfplane.sliding import Sliding
from solver.halfplane.surface import HalfPlane
from tests.solver.film.films import BTO, FIBROUS, ON_STEEL, STEEL, cases, contact, cylinder, surface_fields
from tests.solver.film.test_contact import PROFILES
from tests.solver.quadrature import rule

FIELDS = (
    "contact_pressure", "shear_traction", "electric_displacement_y", "magnetic_induction_y", "stress_xx",
    "electric_displacement_x", "magnetic_induction_x",
)  # fmt: skip
POSITIONS = np.array([-30.0, -1.2, -1.001, -0.99, -0.5, 0.0, 0.3, 0.9, 1.01, 2.5, 100.0])


@pytest.mark.sampled(4)
@pytest.mark.parametrize("conducts", [(True, True), (False, False)])
@pytest.mark.parametrize("name", ["cylinder", "tilted flat", "wedge", "cubic"])
def test_film_of_its_own_base_is_the_closed_form(name: str, conducts: tuple[bool, bool]) -> None:
    profile, degree = PROFILES[name]
    charges = np.array([[2e-6, -3e-3]]) * conducts
    exact = Contact(Sliding(HalfPlane(FIBROUS), np.array(0.4), np.array(conducts)), profile, cases(1e5), charges)
    of = table(Stack((Layer(FIBROUS, 2e-4, "bonded", "bonded"),), FIBROUS), 0.4, conducts, smooth=profile.smooth,
               degree=degree, least=0.3, most=4.0, nodes=8)  # fmt: skip
    found = surface_fields(
        FilmContact(of.narrowed(float(np.ravel(exact.half_width)[0])), profile, cases(1e5), charges, np.array(1.0)),
        POSITIONS,
    )
    expected = exact_fields(exact, POSITIONS)
    for field in FIELDS:
        value = getattr(expected, field)
        values = np.ravel(getattr(value, "values", value))
        size = np.max(np.abs(values))
        np.testing.assert_allclose(found[field][0], values, rtol=1e-10, atol=1e-12 * size, err_msg=field)


#: Theory of films, section 9: p, D_y, B_y at X = -0.5, 0, 0.5; sigma_xx at X = 1.2, -1.2.
FIGURES = [
    ((Stack((Layer(BTO, 0.5e-3),)), 0.0),
     (2.620449157e08, 3.033895065e08, 2.620449157e08), (-1.384260933e-02, -2.405493644e-02, -1.384260933e-02),
     (0.0, 0.0, 0.0), (6.549891077e07, 6.549891077e07)),
    ((Stack((Layer(FIBROUS, 0.2e-3),)), 0.3, 1e5, (2e-5, 1e-2)),
     (3.116981669e08, 3.767103051e08, 3.179218122e08), (-5.408774763e-02, -5.833231139e-02, -5.521730464e-02),
     (-2.177424521e01, -1.956580057e01, -2.181913629e01), (1.555208861e08, -2.764407038e07)),
    ((ON_STEEL, 0.3),
     (2.801686084e08, 3.312695878e08, 2.905574954e08), (-6.404062368e-04, -4.426843698e-03, -3.044442030e-03),
     (-1.272829867e-01, -2.468574397e-01, -1.563876997e-01), (1.134370442e08, -9.345979507e07)),
]  # fmt: skip


@pytest.mark.parametrize("case", FIGURES)
def test_published_figures_are_hit(case: tuple[tuple[object, ...], ...]) -> None:
    arguments, pressure, electric, magnetic, stretch = case
    found = surface_fields(cylinder(*arguments), np.array([-0.5, 0.0, 0.5, 1.2, -1.2]))  # type: ignore[arg-type]
    for values, printed in (
        (found["contact_pressure"][0, :3], pressure),
        (found["electric_displacement_y"][0, :3], electric),
        (found["magnetic_induction_y"][0, :3], magnetic),
        (found["stress_xx"][0, 3:], stretch),
    ):
        np.testing.assert_allclose(values, np.array(printed, dtype=np.float64), rtol=2e-9)


CASES = {
    "rigid": (Stack((Layer(FIBROUS, 0.2e-3),)), 0.3, (2e-5, 1e-2)),
    "flux sideways": (Stack((Layer(FIBROUS, 0.1e-3, magnetic="insulated"),)), 0.3, (2e-5, 1e-4)),
    "two layers on steel": (Stack((Layer(BTO, 0.1e-3), Layer(FIBROUS, 0.1e-3, "bonded")), STEEL), 0.6, (2e-5, 0.0)),
}


@pytest.fixture(scope="module", params=CASES)
def state(request: pytest.FixtureRequest) -> tuple[FilmContact, dict[str, Array]]:
    stack, friction, charges = CASES[request.param]
    found = cylinder(stack, friction, 1e5, charges)
    return found, surface_fields(found, rule().X)


def test_tractions_balance_the_loads(state: tuple[FilmContact, dict[str, Array]]) -> None:
    film, fields = state
    length = film.half_width[0] * rule().weight
    for values, total in (
        (fields["contact_pressure"], film.load[0]),
        (-fields["electric_displacement_y"], film.charges[0, 0]),
        (-fields["magnetic_induction_y"], film.charges[0, 1]),
    ):
        size = length @ np.abs(values[0] * rule().root)
        assert abs(length @ (values[0] * rule().root) - total) <= 1e-12 * size


def test_integral_equations_hold_by_another_quadrature(state: tuple[FilmContact, dict[str, Array]]) -> None:
    """A double exponential rule in X and one of equal panels in k; the principal value with its pole taken out."""
    film, fields = state
    stack, h = film.table.system.kernel.stack, film.half_width[0]
    points = np.array([-0.83, -0.31, 0.12, 0.77])
    at = surface_fields(film, points)
    half, scale = film.table.system.sliding.halfplane, film.scale
    nodes = rule()

    def tractions(of: dict[str, Array]) -> Array:
        rows = (
            of["shear_traction"],
            -of["contact_pressure"],
            of["electric_displacement_y"],
            of["magnetic_induction_y"],
        )
        return np.array([row[0] for row in rows]) * scale[:, None]

    t, own = tractions(fields) * rule().root, tractions(at) * np.sqrt(1 - points**2)
    gap = nodes.X - points[:, None]
    H = np.einsum("s,jps->jp", nodes.weight / np.pi, (t[:, None] - own[..., None]) / gap)
    far = 40 / (2 * stack.top.thickness * float(stack.media[0].slowest))
    x, w = np.polynomial.legendre.leggauss(40)
    edges = np.concatenate([[0.0], np.geomspace(1e-7, 1e-3, 12), np.linspace(1e-3, 1.0, 60)[1:]]) * far
    k = ((edges[1:] + edges[:-1])[:, None] / 2 + (edges[1:] - edges[:-1])[:, None] / 2 * x).ravel()
    weights = ((edges[1:] - edges[:-1])[:, None] / 2 * w).ravel()
    Delta = waves(stack, k)[0].difference[:, 1:] * weights[:, None, None]
    residual, size = np.zeros((3, points.size)), np.zeros(3)
    both = scale[1:, None] * scale[1:]
    for p, X0 in enumerate(points):
        kx = k[:, None] * h * (X0 - nodes.X)
        total = h * nodes.weight
        sines, cosines = np.sin(kx) @ (total * t[1:]).T, np.cos(kx) @ (total * t[0])
        smooth = -(np.einsum("koj,kj->o", Delta[..., 1:], sines) + Delta[..., 0].T @ cosines) / np.pi
        local = half.compliance / both @ H[1:, p] + half.friction_coupling / (scale[1:] * scale[0]) * (
            own[0, p] / np.sqrt(1 - X0**2)
        )
        slope = np.array([(film.offset[0] + h * X0) / 0.05 / scale[1], 0.0, 0.0])
        residual[:, p] = local + smooth - slope
        size = np.maximum(size, np.abs(half.compliance / both) @ np.abs(H[1:, p]))
    error = np.max(np.abs(residual) / size[:, None])
    assert error < 1e-9, error


def test_positions_beyond_what_can_be_resolved_are_refused() -> None:
    film = contact(table(ON_STEEL, nodes=12), PROFILES["cylinder"][0], 1e5)
    with pytest.raises(StackError, match="beyond the range"):
        surface_fields(film, np.array([1e7]))
