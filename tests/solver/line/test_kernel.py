"""Stacks in Fourier space, tables of kernels and their resolution: closed forms, integrals, finer systems."""

from dataclasses import replace
from itertools import cycle, product

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
from solver.stack.layers import RIGID, Layer, Stack
from solver.stack.reflection import waves
from tests.solver.cases import BTO, FIBROUS, STEEL

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
