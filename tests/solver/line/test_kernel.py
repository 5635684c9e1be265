"""Tables of kernels: every material of the library resolves, values are integrals (films, F3.2), one serves punches."""

from itertools import cycle, product
from unittest.mock import Mock

import numpy as np
import pytest
from scipy.integrate import quad_vec

import solver
from solver.arrays import Array
from solver.halfplane.profile import Profile
from solver.halfplane.sliding import Punch
from solver.line import kernel as module
from solver.line.contact import FilmContact
from solver.line.kernel import ENTRIES, Kernel, kernel
from solver.line.table import table
from solver.stack.layers import RIGID, Layer, Stack, StackError
from solver.stack.reflection import waves
from tests.solver.line.films import FIBROUS, ON_STEEL, cases

#: Roots with a large real part put singularities beside the first panels.
STEEP = ["PMN-PT 67:33", "PMN-PT 67:33 (alternative 1)"]


def of(material: solver.Material, base: str, ratio: float) -> Kernel:
    """Kernel of a film of unit thickness, for contacts of a half-length over it."""
    stack = Stack((Layer(material, 1.0, "grounded"),), RIGID if base == "rigid" else solver.find(base))
    return kernel(stack, 2.1 * ratio)


@pytest.mark.parametrize(
    ("name", "base"),
    [*zip(solver.materials(), cycle(["rigid", "steel"])), *product(STEEP, ["rigid", "steel"])],
)
def test_no_built_in_material_is_refused(name: str, base: str) -> None:
    for ratio in (1e-3, 1.0, 30.0):
        table = of(solver.find(name), base, ratio)
        size = np.max(np.abs(table.positive.series[..., :10]))
        assert np.max(np.abs(table.positive.series[:, -2:])) < 1e-11 * size


@pytest.mark.parametrize("fraction", [0.44, 0.5])
def test_no_composition_is_refused(fraction: float) -> None:
    assert of(solver.aluminium_scandium_nitride(fraction), "steel", 30.0).reach > 60


def test_what_the_panels_do_not_resolve_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without their halving, which PMN-PT needs: the message names what makes tables hard, the critical speed too."""
    monkeypatch.setattr(module, "_HALVINGS", 0)
    with pytest.raises(StackError, match=r"does not resolve this stack: .* \(or a speed next to the critical one\)"):
        of(solver.find(STEEP[0]), "steel", 1.07)  # of no other test's reach: tables are kept
    assert of(solver.find("PZT-4"), "steel", 1.07).reach > 2


def test_values_are_the_integrals() -> None:
    """Adaptive quadrature of the whole integrals; 1e-10 of the largest: its own tolerance is 1e-12."""
    table, x = of(solver.find(STEEP[0]), "steel", 1.0), 0.9
    size = np.max(np.abs(table.positive.series[..., :10]))

    def density(k: float) -> Array:
        difference = waves(table.stack, np.array([k]))[0].difference[0]
        return np.array([difference[i, j] * (np.sin(k * x) if j or not i else np.cos(k * x)) for i, j in ENTRIES])

    whole = quad_vec(density, 1e-12, 40 / table.width, epsabs=1e-12 * size, norm="max")[0]
    np.testing.assert_allclose(table.at(np.array([x]))[0, :10], -whole / np.pi, rtol=0, atol=1e-10 * size)


def test_silicone_on_a_stiff_film_is_the_silicone_of_hertz() -> None:
    """The film is 1e5 times as stiff: it adds 1e-5 of the compliance."""
    soft, profile = Punch.isotropic(2e6, 0.49), Profile.cylinder(np.array(0.05))
    tabled = table(ON_STEEL, 0.0, least=0.3, most=4.0, punch=soft)
    computed = FilmContact(tabled, profile, cases(3.0), np.zeros((1, 2)), np.array(1.0))
    hertz = np.sqrt(2 * float(soft.compliance) * 0.05 * 3.0 / np.pi)
    assert float(computed.half_width[0]) == pytest.approx(hertz, rel=2e-5)


def test_one_table_of_a_stack_serves_every_punch(monkeypatch: pytest.MonkeyPatch) -> None:
    stack = Stack((Layer(FIBROUS, 2e-4),))
    computed = Mock(wraps=module._transforms)
    monkeypatch.setattr(module, "_transforms", computed)
    for punch in (Punch(), Punch.isotropic(210e9, 0.3), Punch.isotropic(630e9, 0.22)):
        for friction in (0.0, 0.3):
            table(stack, friction, least=0.3, most=1.0, nodes=4, punch=punch)
    assert computed.call_count == 1
