"""Contacts with air: finite elements of somebody else, the theorem of half-planes, no air, tangents, refusals."""

import numpy as np
import pytest

from solver.gap.charges import FAR
from solver.gap.tractions import Solved
from solver.halfplane.sliding import Punch
from solver.line.interior import fields_of
from solver.material.constants import Material
from tests.solver.gap.airy import BTO, FIBROUS, PZT, RADIUS, THICKNESS, airy, half_plane, on_steel
from verification.cases import constants
from verification.oracles.fem_film import ELECTRIC, Layer
from verification.oracles.fem_film import Punch as Cylinder
from verification.oracles.fem_gap import GapContact
from verification.oracles.sample_materials import isotropic
from verification.oracles.surface_response import surface_response


@pytest.mark.soak  # the same at order 4, with fields inside: film_air of tests/verification/test_verification.py
@pytest.mark.parametrize("elastic", [False, True])
def test_finite_elements_of_body_gap_and_punch_agree(elastic: bool) -> None:
    """On steel their mesh ends far away; the load and V are those of order 6, whose own misses these are."""
    punch = Punch.isotropic(210e9, 0.3) if elastic else Punch()
    contact = airy(on_steel(PZT), 2e4, friction=0.3, charges=(1e-7, 0.0), conducts=(True, False), punch=punch)
    state = contact.state
    other = GapContact(
        [Layer(constants(PZT), THICKNESS, (ELECTRIC,))], isotropic(200e9, 0.3),
        Cylinder(RADIUS, 0.3, 1e-7, 0.0, (ELECTRIC,)), state.half * THICKNESS, order=6,
        elastic=isotropic(210e9, 0.3) if elastic else None,
    )  # fmt: skip
    assert other.load == pytest.approx(2e4, rel=2e-5)
    assert other.centre == pytest.approx(state.centre * state.half * THICKNESS, rel=1e-4)
    voltage = state.response[1] * state.problem.contact.scale[2] * THICKNESS
    assert other.potential(ELECTRIC) == pytest.approx(voltage, rel=1e-4)
    X, phi = other.beside(ELECTRIC)
    tractions, datum = Solved(state, np.array([1.0, -1.0]), FAR).tractions, contact.contact.datum
    compared = np.flatnonzero(np.abs(X) < 10)[::3]
    ours = fields_of(tractions, X[compared], np.zeros(1), ("electric_potential",), datum)[0, 0, 0] * THICKNESS
    np.testing.assert_allclose(phi[compared], ours, rtol=0, atol=1e-4 * abs(voltage))


@pytest.mark.parametrize("material", [BTO, FIBROUS])
def test_half_plane_without_potentials_does_not_see_the_air(material: Material) -> None:
    """Theorem: the whole surface has the punch's potential, so that the charges per force are those without a gap."""
    contact = airy(half_plane(material), held=(True, True))
    N = surface_response(constants(material)).normal_compliance
    screening = np.linalg.solve(N[1:, 1:], N[1:, 0])
    state, scale = contact.state, contact.contact.scale
    charge = state.loads[1] / state.loads[0] * scale[1] / scale[2]
    assert charge == pytest.approx(-screening[0], rel=1e-9)
    assert np.max(np.abs(state.densities)) < 1e-8 * state.loads[0] / state.half
    assert state.half == pytest.approx(float(contact.contact.half_width[0]), rel=1e-12)


def test_half_plane_keeps_its_pressure_whatever_the_charges() -> None:
    contact = airy(half_plane(FIBROUS), friction=0.4, charges=(3e-7, 1e-4))
    assert contact.state.half == pytest.approx(float(contact.contact.half_width[0]), rel=1e-12)
    assert np.max(np.abs(contact.state.densities)) > 1e-6 * contact.state.loads[0] / contact.state.half
