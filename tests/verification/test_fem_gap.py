"""The finite elements with air and an elastic punch: against those without, closed forms, and figures of others."""

from functools import partial

import numpy as np
import pytest

import solver
from verification.cases import constants
from verification.oracles.fem_film import ELECTRIC, MAGNETIC, FilmContact, Layer, Punch
from verification.oracles.fem_gap import GapContact
from verification.oracles.sample_materials import BARIUM_TITANATE, isotropic

FILM, PUNCH, HALF = Layer(BARIUM_TITANATE, 0.5e-3), Punch(0.05, 0.3, 1e-5), 2.1e-4
solved = partial(GapContact, half_length=HALF, order=4)


@pytest.fixture(scope="module")
def none() -> GapContact:
    """Without air."""
    return solved([FILM], None, PUNCH, permittivity=0.0)


def test_without_air_and_rigid_it_is_the_other_oracle(none: GapContact) -> None:
    bare, gap_contact = FilmContact([FILM], None, PUNCH, HALF, order=4), none
    expected = [bare.load, bare.centre, bare.depth, bare.potential(ELECTRIC)]
    np.testing.assert_allclose(
        [gap_contact.load, gap_contact.centre, gap_contact.depth, gap_contact.potential(ELECTRIC)], expected, rtol=1e-9
    )


def test_little_air_changes_little(none: GapContact) -> None:
    bare, little = none, solved([FILM], None, PUNCH, permittivity=1e-6)
    assert little.potential(ELECTRIC) == pytest.approx(bare.potential(ELECTRIC), rel=1e-5)
    assert little.load == pytest.approx(bare.load, rel=1e-7)


@pytest.mark.soak
def test_air_has_the_figures_of_boundary_elements() -> None:
    """Fibrous 0.8, 0.3 mm on a rigid grounded base, R = 100 mm, 5 kN/m: charge per force 74.4 -> 85.9 pC/N."""
    mix = constants(solver.fibrous(solver.find("BaTiO3"), solver.find("CoFe2O4"), 0.8))
    rate = {}
    for charge in (0.0, 4e-7):
        contact = GapContact([Layer(mix, 3e-4)], None, Punch(0.1, charge=charge), 6.48e-5, order=6)
        rate[charge] = contact.potential(ELECTRIC) / contact.load, charge / contact.load
    (idle, none), (charged, charged_rate) = rate.values()
    assert none - idle * (charged_rate - none) / (charged - idle) == pytest.approx(85.9e-12, rel=5e-3)
    assert 1e6 < contact.gap_field < 1e9


@pytest.mark.parametrize("friction", [pytest.param(0.0, marks=pytest.mark.soak), 0.5])
def test_a_punch_of_the_body_s_own_material_is_twice_as_compliant(friction: float) -> None:
    """Two equal isotropic half-planes: the centre stays, alpha = 1/2 at any friction, a^2 = 8 P R (1 - nu^2)/(pi E)."""
    young, poisson = 200e9, 0.3
    steel = isotropic(young, poisson)
    layers, punch = [Layer(steel, 3e-4, ())], Punch(0.05, friction, conducted=())
    contact = solved(layers, steel, punch, permittivity=0.0, elastic=steel)
    expected = np.pi * young * HALF**2 / (8 * punch.radius * (1 - poisson**2))
    assert contact.load == pytest.approx(expected, rel=1e-4)
    assert abs(contact.centre) < 1e-4 * HALF


def test_a_field_that_a_film_s_magnets_make_meets_the_gap_too() -> None:
    mix = constants(solver.fibrous(solver.find("BaTiO3"), solver.find("CoFe2O4"), 0.5))
    bare, airy = (solved([Layer(mix, 3e-4)], None, Punch(0.05), permittivity=e) for e in (0.0, 1.0))
    assert np.abs(airy.potential(MAGNETIC)) < 0.9 * np.abs(bare.potential(MAGNETIC))
