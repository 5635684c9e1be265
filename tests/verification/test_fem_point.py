"""The finite elements of a sphere with air: without it, and with a little of it, against figures of others."""

import pytest

import solver
from verification.cases import constants
from verification.oracles.fem_film import Layer
from verification.oracles.fem_point import PointContact
from workflow.run.provenance import ROOT

BTO = solver.find("BaTiO3")
LAYER = Layer(constants(BTO) | {"c12": float(BTO.c12)}, 1e-4)
SPHERE, RADIUS = 5e-3, 1e-4


def contact(charge: float, permittivity: float = 0.0) -> PointContact:
    """Contact as wide as the film is thick."""
    return PointContact([LAYER], None, SPHERE, RADIUS, charge, permittivity, order=6)


def test_grounded_without_air_it_has_the_figures_of_two_other_programs() -> None:
    """BaTiO3 on a rigid grounded base, a/h = 1 (docs/theory-points.md, section 4)."""
    idle, charged = ((state.voltage, state.force, state.depth) for state in (contact(0.0), contact(1e-9)))
    share = idle[0] / (idle[0] - charged[0])  # of the charge, in which everything is linear
    force, depth = ((1 - share) * a + share * b for a, b in zip(idle[1:], charged[1:], strict=True))
    assert force * SPHERE / RADIUS**3 == pytest.approx(2.154751e11, rel=1e-5)
    assert abs(share * 1e-9 / force) == pytest.approx(142.2051e-12, rel=1e-5, abs=0)
    assert depth * SPHERE / RADIUS**2 == pytest.approx(0.646322, rel=1e-5)


def test_elements_of_order_two_are_as_good_as_the_page_on_other_codes_says() -> None:
    idle, charged = (PointContact([LAYER], None, SPHERE, RADIUS, T, permittivity=0.0, order=2) for T in (0.0, 1e-9))
    share = idle.voltage / (idle.voltage - charged.voltage)  # of the charge that leaves zero volts
    charge_per_force = abs(share * 1e-9 / ((1 - share) * idle.force + share * charged.force))
    assert abs(charge_per_force / 142.205125e-12 - 1) == pytest.approx(1e-3, rel=0.2)
    page = " ".join((ROOT / "docs/others.md").read_text(encoding="utf-8").split())
    assert f"reach 1e-3 with {4 * len(idle.body.places):,} unknowns of order 2" in page
    assert "142.205125 pC/N" in page
