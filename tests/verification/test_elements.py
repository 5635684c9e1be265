"""The finite elements of films and of points with air against boundary elements and the page on other codes."""

import pytest

import solver
from verification.cases import constants
from verification.oracles.fem_film import ELECTRIC, Layer, Punch
from verification.oracles.fem_gap import GapContact
from verification.oracles.fem_point import PointContact
from workflow.run.provenance import ROOT

BTO = solver.find("BaTiO3")
LAYER = Layer(constants(BTO) | {"c12": float(BTO.c12)}, 1e-4)
SPHERE, RADIUS = 5e-3, 1e-4


def test_elements_of_order_two_are_as_good_as_the_page_on_other_codes_says() -> None:
    idle, charged = (PointContact([LAYER], None, SPHERE, RADIUS, T, permittivity=0.0, order=2) for T in (0.0, 1e-9))
    share = idle.voltage / (idle.voltage - charged.voltage)  # of the charge that leaves zero volts
    charge_per_force = abs(share * 1e-9 / ((1 - share) * idle.force + share * charged.force))
    assert abs(charge_per_force / 142.205125e-12 - 1) == pytest.approx(1e-3, rel=0.2)
    page = " ".join((ROOT / "docs/others.md").read_text(encoding="utf-8").split())
    assert f"reach 1e-3 with {4 * len(idle.body.places):,} unknowns of order 2" in page
    assert "142.205125 pC/N" in page


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
