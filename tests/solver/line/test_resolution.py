"""Errors of the default resolution, and the limits of thin films."""

from dataclasses import replace

import numpy as np
import pytest

import solver
from solver.arrays import Array
from solver.halfplane.sliding import Sliding
from solver.halfplane.surface import HalfPlane
from solver.line import outputs
from solver.line.assembly import Assembly
from solver.line.kernel import kernel
from solver.line.surface import local_fields
from solver.line.system import System
from solver.line.table import at, table
from solver.stack.layers import Layer, Stack
from tests.solver.line.films import BTO, CFO, FIBROUS, STEEL

SOFT = solver.Material.isotropic(5e9, 0.35)
STEEP = "roots with a large real part"
STACKS = {
    "fibrous on rigid": Stack((Layer(FIBROUS, 1.0),)),
    "BaTiO3 on a base 32 times softer": Stack((Layer(BTO, 1.0),), SOFT),
    STEEP: Stack((Layer(solver.find("PMN-PT 67:33"), 1.0, "grounded"),), STEEL),
    "permittivities 140 times apart": Stack((Layer(BTO, 1.0), Layer(CFO, 1.0)), STEEL),
}


def system(stack: Stack, friction: float, most: float, accuracy: float = 1.0) -> System:
    sliding = Sliding(HalfPlane(stack.top.material), np.array(friction), np.array([True, True]))
    return System(kernel(stack, 2.01 * most * stack.top.thickness), sliding, (True, True), 1, accuracy)


@pytest.mark.sampled(4)
@pytest.mark.parametrize("friction", [0.0, 1.0])
@pytest.mark.parametrize("name", STACKS)
def test_default_resolution_is_1e_8_up_to_30_thicknesses(name: str, friction: float) -> None:
    """Load, displacement and potentials; edge intensities 3e-8, edge stresses 1e-6; at steep roots 100 times that."""
    slack = 100.0 if name == STEEP else 1.0
    half = np.array([0.01, 0.3, 30.0])
    computed, finer = (at(system(STACKS[name], friction, 30.0, accuracy), half) for accuracy in (1.0, 1.5))
    for which, error in ((slice(0, 1), 1e-9), (outputs.DISPLACEMENT, 1e-9), (outputs.INTENSITY, 3e-8),
                         (outputs.EDGE_STRESS, 1e-6)):  # fmt: skip
        miss = np.max(np.abs(computed[:, which, 0] - finer[:, which, 0]), -1)
        assert np.all(miss <= slack * error * np.max(np.abs(finer[:, which, 0]), -1)), (which, miss)


@pytest.mark.filterwarnings("ignore::solver.line.table.SlowWarning")
@pytest.mark.sampled(1)
@pytest.mark.parametrize("most", [30.0, 3.0])
def test_default_tables_are_read_to_1e_8(most: float) -> None:
    """Between the half-lengths of the table, against the system itself; load to 1e-9, the others over their range."""
    tabled = table(STACKS["fibrous on rigid"], 0.3, most=most)
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
