"""Films graded with depth: exact exponents, homogeneous limits, staircases, the rough parts of their kernels."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import expm
from scipy.special import gammaln, jv

import solver
from solver.arrays import Array
from solver.halfplane.profile import Profile
from solver.halfplane.sliding import Sliding
from solver.halfplane.surface import HalfPlane
from solver.line.interior import Interior
from solver.line.kernel import graded_response, kernel
from solver.line.system import System
from solver.line.table import SlowWarning, Table, at, table
from solver.line.tractions import TractionTable
from solver.line.windows import Kind, window
from solver.material.constants import UNITS
from solver.stack.electroded import surface as surface_of
from solver.stack.electrodes import Electrode
from solver.stack.fourier import Medium
from solver.stack.grading import Graded, GradedMedium
from solver.stack.layers import Layer, Stack
from solver.stack.reflection import held
from tests.solver.cases import assert_alike
from tests.solver.line.films import BTO, CFO, FIBROUS, STEEL, contact, interior_fields, surface_fields


def linear(depth: Array) -> solver.Material:
    return solver.fibrous(BTO, CFO, 0.2 + 0.6 * depth)


END = (None, "grounded")
CYLINDER = Profile.cylinder(np.array(0.05))


def narrow(stack: Stack, layers: int = 1) -> Table:
    """A table about the contacts of these tests, of a film 0.2 mm thick."""
    return table(stack, 0.3, least=0.5 * layers, most=1.6 * layers, nodes=6)


def exponential(depth: Array) -> solver.Material:
    """Every constant of the fibrous composite falls like exp(-0.8 depth)."""
    factor = np.exp(-0.8 * depth)
    return solver.Material(**{name: getattr(FIBROUS, name) * factor for name in UNITS if name != "rho"})


#: Whose tables are kept from test to test, as those of one stack.
FALLING = {covered: Stack((Graded(exponential, 1.0),), electroded=covered) for covered in (False, True)}
LINEAR = Stack((Graded(linear, 1.0),))
ON_STEEL = Stack((Graded(linear, 2e-4, *END),), STEEL)


def test_exponential_grading_has_its_exact_exponents() -> None:
    stack = FALLING[False]
    medium = GradedMedium(stack.top, stack.scale)  # type: ignore[arg-type]
    surface = Medium(FIBROUS, stack.scale)
    k = np.array([0.03, 0.3, 1.0, 3.0])
    computed = surface.compliance + medium.difference(k, np.zeros((k.size, 4, 4)))
    bend = 0.4 * np.diag([1.0] * 4 + [-1.0] * 4)
    for wavenumber, Y in zip(k, computed, strict=True):
        whole = expm(wavenumber * surface.system + bend)
        exact = whole[:4, 4:] @ np.linalg.inv(whole[4:, 4:])
        np.testing.assert_allclose(Y, exact, atol=1e-8 * np.max(np.abs(exact)))


@pytest.mark.parametrize("covered", [False, True])
def test_electrodes_get_what_exact_exponents_say(*, covered: bool) -> None:
    """Charge of the base's electrode per traction, and the surface's response below a covering one."""
    stack, k = FALLING[covered], np.array([0.03, 0.3, 1.0, 3.0])
    rows, response = Electrode(stack, 1 + covered).rows(k), graded_response(stack).difference(k) + surface_of(stack)
    surface, bend = Medium(FIBROUS, stack.scale), 0.4 * np.diag([1.0] * 4 + [-1.0] * 4)
    for wavenumber, row, computed in zip(k, rows, response, strict=True):
        whole = expm(wavenumber * surface.system + bend)
        down, exact = np.exp(-0.4) * np.linalg.inv(whole[4:, 4:]), whole[:4, 4:] @ np.linalg.inv(whole[4:, 4:])
        if covered:  # D_y at the surface is what keeps phi at zero
            onto = np.eye(4)
            onto[2] = np.where(np.arange(4) == 2, 0.0, -exact[2] / exact[2, 2])
            down, exact = down @ onto, held(exact, (2,))
            computed[2, 2] = 0.0  # kept apart
        np.testing.assert_allclose(row, down[[2, 1]], atol=1e-8 * np.max(np.abs(down)))
        np.testing.assert_allclose(computed, exact, atol=1e-8 * np.max(np.abs(exact)))


def test_electrodes_without_end_have_what_the_depth_averages() -> None:
    """(u', phi', psi') = A (sigma, D, 0), with no voltage between both: D = -int A_ps / int A_pp sigma."""
    stack = Stack((Graded(linear, 1.0),), electroded=True)

    def inverse(depth: float, column: int) -> float:
        return float(np.linalg.inv(linear(np.array(depth)).generalised_stiffness()[2][1:, 1:])[1, column])

    exact = -quad(inverse, 0, 1, (0,), epsabs=0, epsrel=1e-12)[0] / quad(inverse, 0, 1, (1,), epsabs=0, epsrel=1e-12)[0]
    charges = [Electrode(stack, number).whole[0] * stack.scale[1] / stack.scale[2] for number in (1, 2)]
    assert [charges[1], -charges[0]] == pytest.approx([exact, exact], rel=1e-11)


COVER = {"electrode": "top", "magnetic": "insulating", "collector": 2, "patch_size": 1e-4, "patch_position": 3e-5}


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    "options", [{"interface_magnetic": "grounded", "charge": 2e-5}, COVER], ids=["bare", "covered"]
)
def test_a_roller_on_a_film_graded_by_nothing_has_all_that_one_on_a_layer_has(options: dict[str, object]) -> None:
    film: dict[str, object] = {"radius": 0.05, "load": 2e4, "friction": 0.3, "datum": 0.1, "thickness": 2e-4}
    film |= {"volume_fraction": 0.5, "base": "steel", "surroundings": "insulated"} | options
    X = None if options is COVER else [-9.0, -1.3, -1.0001, -0.999, 0.4, 0.9, 1.02, 4.0]
    exact, computed = solver.solve(film, X), solver.solve(film | {"base_volume_fraction": 0.5}, X)
    assert set(exact) == set(computed)
    quantities = [name for name in map(str, exact) if not exact[name].ndim]
    assert_alike(computed, exact, 1e-9, quantities)
    assert_alike(computed, exact, 1e-8)


def uncoupled(depth: Array) -> solver.Material:
    """BaTiO3 without its piezoelectricity; every constant falls like exp(-0.8 depth)."""
    factor = np.exp(-0.8 * depth)
    constants = {name: getattr(BTO, name) * factor for name in UNITS if name != "rho"}
    return solver.Material(**constants | dict.fromkeys(("e31", "e33", "e15"), 0 * factor))


def test_edge_intensity_of_a_graded_dielectric_is_that_of_bessel_functions() -> None:
    """Y(k) is closed: int Y(k) J_2m J_2n dk/k of many terms, whose sum misses by M^-2 and is extrapolated."""
    half = np.array([0.3, 1.0])
    stack = Stack((Graded(uncoupled, 1.0),))
    sliding = Sliding(HalfPlane(stack.top.material), np.array(0.0), np.array([True, True]))
    computed = at(System(kernel(stack, 2.1), sliding, (True, True), 1), half)[:, 6, 1]
    ratio = float(BTO.eps33 / BTO.eps11)
    x, w = np.polynomial.legendre.leggauss(12)
    starts = np.concatenate([np.arange(8) / 4, np.arange(2.0, 300.0)])
    width = np.where(starts < 2, 0.25, 1.0)[:, None] / 2
    z, weights = (starts[:, None] + width * (1 + x)).ravel(), (width * w).ravel()
    bessel = jv(2 * np.arange(50)[:, None], z)
    m, n = np.arange(1, 201)[:, None], np.arange(201)
    # int J_2m J_2n z^-2 dz
    tail = np.exp(gammaln(m + n - 0.5) - gammaln(m + n + 1.5)) * (-1.0) ** (m - n) / (4 * np.pi * (0.25 - (m - n) ** 2))
    for h, intensity in zip(half, computed, strict=True):
        root = np.sqrt(0.64 + 4 * (z / h) ** 2 / ratio)
        fall = np.exp(-root)
        response = z / h * (1 - fall) / ((root - 0.8) / 2 + (root + 0.8) / 2 * fall)
        matrix = 0.4 * ratio * h * tail
        matrix[:49, :50] += ((response - np.sqrt(ratio)) / z - 0.4 * ratio * h / z**2) * weights * bessel[1:] @ bessel.T
        matrix[m[:, 0] - 1, m[:, 0]] += np.sqrt(ratio) / (4 * m[:, 0])
        matrix *= (-1.0) ** (m + n)
        sums = 1 + np.cumsum(np.linalg.solve(matrix[:, 1:], -matrix[:, 0]))
        assert -np.sqrt(np.pi) * intensity == pytest.approx((4 * sums[199] - sums[99]) / 3, rel=1e-7)


def test_contact_on_a_graded_film_is_read_from_a_table() -> None:
    film = contact(narrow(ON_STEEL), CYLINDER, 1e5, (2e-5, 1e-2), 0.1)
    step = 10.0
    ends = [
        type(film)(film.table, film.profile, film.load + s * step, film.charges, film.datum).response[0]
        for s in (1, -1)
    ]
    np.testing.assert_allclose(film.tangents[0][:, 0], (ends[0] - ends[1]) / (2 * step), rtol=1e-6)
    # inside, by extrapolated sublayers: up to the surface, and through the film as its sublayers grow thinner
    h, names = float(film.half_width[0]), ("stress_xx", "stress_yy", "stress_xy")
    X, Y = np.array([-0.4, 0.5]), -np.array([1e-9, 1e-4, 1.99e-4]) / h
    inside, surface = interior_fields(film, X, Y, names)[0], surface_fields(film, X)
    np.testing.assert_allclose(inside[1, 0], -surface["contact_pressure"][0], rtol=2e-4)
    np.testing.assert_allclose(inside[0, 0], surface["stress_xx"][0], rtol=2e-4)
    finer = Interior(TractionTable(film.table).read(film), 36).fields(X[None], Y[None, 1:], names)[0, ..., 0]
    np.testing.assert_allclose(inside[:, 1:], finer, atol=1e-4 * float(np.max(np.abs(finer))))


def test_too_large_loads_on_graded_films_are_refused_by_homogeneous_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(kind: Kind, number: int, *, rough: bool = False) -> Table:
        assert not kind.graded, "a graded film's own wide table takes a minute"
        return window(kind, number, rough=rough)

    monkeypatch.setattr("solver.line.similar.window", refuse)
    case = {"volume_fraction": 0.8, "base_volume_fraction": 0.2, "thickness": 1e-4, "base": "rigid", "radius": 0.05}
    with pytest.raises(solver.CaseError, match=r"wider than the resolved range, 0\.0001 to 60 of half-length"):
        solver.solve(case | {"load": 1e11})


def test_tables_that_take_long_say_so_first(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("solver.line.table._LONG", 0.0)
    monkeypatch.setattr("solver.line.table.at", lambda *_: np.zeros(()))
    with pytest.warns(SlowWarning, match=r"a table of half-lengths from 1 to 2 thicknesses of this film takes about"):
        _ = table(Stack((Layer(BTO, 1.0),)), least=1.0, most=2.0, nodes=4).at_nodes
