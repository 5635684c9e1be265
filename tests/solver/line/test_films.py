"""Films under a long punch: reflection, kernels and their tables, fields inside and their largest values."""

from dataclasses import replace
from itertools import cycle, product
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad_vec

import solver
from solver.arrays import Array
from solver.line import outputs
from solver.line.fields import local_fields
from solver.line.kernel import ENTRIES, Kernel, kernel
from solver.line.outputs import Assembly
from solver.line.table import SlowWarning, at, table
from solver.names import FILM_PEAKS
from solver.stack.layers import RIGID, Layer, Stack
from solver.stack.reflection import waves
from tests.solver.cases import BTO, CFO, FIBROUS, STEEL

#: Roots with a large real part put singularities beside the first panels.
AXIAL = [name for name, material in solver.materials().items() if material.axial]
STEEP = ["PMN-PT 67:33", "PMN-PT 67:33 (alternative 1)"]


def of(material: solver.Material, base: str, ratio: float) -> Kernel:
    """Kernel of a film of unit thickness, for contacts of a half-length over it."""
    stack = Stack((Layer(material, 1.0, "grounded"),), RIGID if base == "rigid" else solver.find(base))
    return kernel(stack, 2.1 * ratio)


@pytest.mark.sampled(10)
@pytest.mark.parametrize(
    ("name", "base"), [*product(STEEP, ["rigid", "steel"]), *zip(AXIAL, cycle(["rigid", "steel"]))]
)
def test_no_built_in_material_is_refused(name: str, base: str) -> None:
    for ratio in (1e-3, 1.0, 30.0):
        table = of(solver.find(name), base, ratio)
        size = np.max(np.abs(table.positive.series[..., :10]))
        assert np.max(np.abs(table.positive.series[:, -2:])) < 1e-11 * size


def test_no_composition_is_refused() -> None:
    assert of(solver.aluminium_scandium_nitride(0.5), "steel", 30.0).reach > 60


def test_values_are_the_integrals() -> None:
    """Adaptive quadrature of the whole integrals; 1e-10 of the largest: its own tolerance is 1e-12."""
    table, x = of(solver.find(STEEP[0]), "steel", 1.0), 0.9
    size = np.max(np.abs(table.positive.series[..., :10]))

    def density(k: float) -> Array:
        difference = waves(table.stack, np.array([k]))[0].difference[0]
        return np.array([difference[i, j] * (np.sin(k * x) if j or not i else np.cos(k * x)) for i, j in ENTRIES])

    whole = quad_vec(density, 1e-12, 40 / table.width, epsabs=1e-12 * size, norm="max")[0]
    np.testing.assert_allclose(table.at(np.array([x]))[0, :10], -whole / np.pi, rtol=0, atol=1e-10 * size)


@pytest.mark.filterwarnings("ignore::solver.line.table.SlowWarning")
@pytest.mark.sampled(1)
@pytest.mark.parametrize("most", [3.0, 30.0])
def test_default_tables_are_read_to_1e_8(most: float) -> None:
    """Between the half-lengths of the table, against the system itself; load to 1e-9, the others over their range."""
    tabled = table(Stack((Layer(FIBROUS, 1.0),)), 0.3, most=most)
    half = np.exp(np.linspace(np.log(0.0102), np.log(0.98 * most), 7))
    read = tabled.interval.read(np.log(half), tabled.series)
    exact = at(tabled.system, half)
    size = np.max(np.abs(exact), axis=0)
    assert np.all(np.abs(read - exact)[:, : outputs.EDGE_STRESS.start] <= 3e-8 * size[: outputs.EDGE_STRESS.start])
    assert np.max(np.abs(read[:, 0, 0] / exact[:, 0, 0] - 1)) < 1e-9


@pytest.mark.parametrize(("material", "half"), [("PMN-PT 67:33", 9.0), ("PMN-PT 67:33", 30.0), ("LiNbO3", 30.0)])
def test_tractions_of_wide_contacts_are_those_of_many_more_terms(material: str, half: float) -> None:
    """D_y and the pressure at 1e-8 of the largest, whatever the roots of the film's material."""
    tabled = table(Stack((Layer(solver.find(material), 1.0),), STEEL), 0.2, least=half / 2, most=half, accuracy=1.25)
    X: Array = np.array([-0.97, -0.6, 0.0, 0.3, 0.8, 0.99])
    tractions = []
    for system in (tabled.system, replace(tabled.system, accuracy=2 * tabled.system.accuracy)):
        assembly = Assembly(system, system.basis(half), np.array([half]), X)
        tractions.append(np.einsum("hfpu,huc->fpc", local_fields(assembly)[:, :2], assembly.unknowns)[..., 0])
    few, many = tractions
    np.testing.assert_array_less(np.max(np.abs(few - many), 1), 1.5e-8 * np.max(np.abs(many), 1))


def test_tables_that_take_long_say_so_first(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("solver.line.table._LONG", 0.0)
    monkeypatch.setattr("solver.line.table.at", lambda *_: np.zeros(()))
    with pytest.warns(SlowWarning, match=r"a table of half-lengths from 1 to 2 thicknesses of this film takes about"):
        _ = table(Stack((Layer(BTO, 1.0),)), least=1.0, most=2.0, nodes=4).at_nodes


K = np.geomspace(0.01, 10.0, 25)


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.49])
def test_isotropic_layer_on_a_rigid_base_is_the_closed_multiplier(poisson: float) -> None:
    stack = Stack((Layer(solver.Material.isotropic(7e10, poisson), 1.0),))
    compliance = stack.media[0].compliance[1, 1]
    computed = 1 + waves(stack, K)[0].difference[:, 1, 1] / compliance
    kappa, u = 3 - 4 * poisson, K
    exact = (2 * kappa * np.sinh(2 * u) - 4 * u) / (2 * kappa * np.cosh(2 * u) + 1 + kappa**2 + 4 * u**2)
    np.testing.assert_allclose(computed, exact, rtol=1e-11)


def test_stacks_are_equal_by_their_content() -> None:
    film = Stack([Layer("PZT-4", "20 um", "grounded")], "steel")
    stated = Stack([Layer(solver.find("PZT-4"), 20e-6, "grounded")], STEEL)
    assert (film, film.name) == (stated, stated.name)
    others = [
        Stack([Layer("PZT-4", "21 um", "grounded")], "steel"),
        Stack([Layer("PZT-4", "20 um", "bonded")], "steel"),
        Stack([Layer("PZT-4", "20 um", "grounded")]),
    ]
    assert len({film, *others}) == 1 + len(others)


ON_STEEL = Stack((Layer(FIBROUS, 2e-4, magnetic="grounded"),), "steel")
BONDED = Stack((Layer(FIBROUS, 2e-4, "bonded", "bonded"),), CFO)
BETWEEN = Stack((Layer(BTO, 1e-4, "grounded"), Layer(FIBROUS, 1e-4), Layer(CFO, 1e-4)), CFO)


@pytest.mark.parametrize("stack", [ON_STEEL, BONDED, BETWEEN], ids=["grounded", "bonded", "electrode between"])
def test_potentials_are_the_punch_s_on_it_meet_at_interfaces_and_have_the_fields_as_gradients(stack: Stack) -> None:
    case = {"body": stack, "radius": 0.05, "friction": 0.3, "load": 1e5, "surroundings": "insulated"}
    case |= {"charge": 2e-5, "magnetic_charge": 1e-2, "datum": 0.01}
    punch, potentials = solver.solve(case), ["electric_potential", "magnetic_potential"]
    h, X, step = float(punch["contact_trailing"] + punch["contact_leading"]) / 2, np.array([-0.9, 0.0, 0.5]), 1e-3

    def fields(x: Array, y: Array, names: list[str]) -> Array:
        """Fields inside, (name, y, x)."""
        inside = solver.solve_interior(case, x, y, fields=names)
        return np.stack([inside[name].values.squeeze() for name in names])

    within = fields(X, np.array([0.0, -0.1 * stack.thickness / h]), potentials)
    for potential, strength in zip(within, (punch["voltage"], punch["magnetic_potential"]), strict=True):
        np.testing.assert_allclose(potential[0], float(strength), rtol=1e-9)
    size = np.max(np.abs(within), axis=(1, 2))
    ends = np.cumsum([layer.thickness for layer in stack.layers]) / h
    for end in ends:
        above, below = np.moveaxis(fields(X, -end * np.array([1.0, 1 + 1e-9]), potentials), 1, 0)
        assert np.all(np.max(np.abs(above - below), axis=1) < 1e-8 * size)
    stencil, offsets = np.array([1, -8, 0, 8, -1]) / (12 * step), np.linspace(-2 * step, 2 * step, 5)
    for y in (-0.4 * ends[0], -(ends[-1] + 0.4)):
        around = fields(0.4 + offsets, y + offsets, potentials) / h
        for k, kind in enumerate(("electric", "magnetic")):
            field = fields(np.array([0.4]), np.array([y]), [f"{kind}_field_x", f"{kind}_field_y"])
            gradient = np.array([around[k, 2] @ stencil, around[k, :, 2] @ stencil])
            np.testing.assert_allclose(gradient, -field, atol=1e-7 * size[k] / h)


FILM: dict[str, Any] = {"surroundings": "insulated", "thickness": 2e-4, "radius": 0.05}


def test_of_two_hills_of_the_pressure_the_higher_is_given() -> None:
    case = FILM | {"material": "PZT-5H", "base": "polyimide", "friction": 0.1, "load": 2.495e5}
    assert float(solver.solve(case)["peak_pressure"]) == pytest.approx(69.682e6, abs=5e2)


def test_a_sweep_of_the_load_has_no_steps_where_tables_change() -> None:
    """Loads about the change of tables at a half-length of one thickness: third differences are steps."""
    case = FILM | {"material": "BaTiO3", "base": "steel", "thickness": 1e-4, "friction": 0.2}
    coarse = np.geomspace(1e2, 1e5, 50)
    trial = solver.solve(case | {"load": coarse})
    half = ((trial["contact_trailing"] + trial["contact_leading"]) / 2).values.ravel()
    load = np.interp(0.0, np.log(half / 1e-4), np.log(coarse))
    swept = solver.solve(case | {"load": np.exp(load + 0.001 * np.linspace(-1, 1, 50))}, peaks=True)
    half = ((swept["contact_trailing"] + swept["contact_leading"]) / 2).values.ravel()
    assert half[0] < 1e-4 < half[-1]
    for name in ("peak_pressure", *FILM_PEAKS):
        if not name.endswith("position"):
            values = swept[name].values.ravel()
            assert np.max(np.abs(np.diff(values, 3))) <= 1e-8 * np.max(values), name


@pytest.mark.parametrize(
    ("case", "largest"),
    [
        ({"load": 1e6}, 6.22e6),  # 5.3 half-lengths from the middle: the base bends with the width of the contact
        ({"load": 1e4, "friction": 0.01, "base": "steel"}, None),  # 220 half-lengths from the middle
    ],
)
def test_the_base_is_searched_as_far_as_its_tension_rises(case: dict[str, Any], largest: float | None) -> None:
    factors = {"material": "BaTiO3", "thickness": 1e-4, "base": "aluminium oxide", "radius": 0.05, "friction": 0.05}
    factors |= {"surroundings": "insulated", "magnetic": "insulating"} | case
    answer = solver.solve(factors, peaks=["base_peak_principal_tension"])
    half = float(answer["contact_trailing"] + answer["contact_leading"]) / 2
    far = 1 + np.geomspace(0.01, 400.0, 120)
    x: Array = np.concatenate([-far[::-1], np.linspace(-0.99, 0.99, 21), far])
    x = x[np.abs(x) * half < 500e-4]  # fields inside end some hundred thicknesses away
    top = 1e-4 / half
    depths = np.geomspace(top * (1 + 1e-9), 2 + 2 * top, 8)
    inside = solver.solve_interior(factors, x, -depths, fields=["principal_tension"])
    tension = inside["principal_tension"].values.squeeze()
    computed = float(answer["base_peak_principal_tension"])
    assert np.max(tension) * (1 - 1e-6) <= computed <= np.max(tension) * 1.03
    if largest is not None:
        assert computed == pytest.approx(largest, rel=1e-3)
