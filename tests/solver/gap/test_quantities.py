"""Quantities by name through windows of half-lengths, and what is refused."""

import numpy as np
import pytest

from solver.gap.quantities import quantities
from solver.gap.refusal import SurroundingsError
from solver.halfplane.profile import Profile
from solver.line.powerlaw import constants_of
from solver.line.quantities import quantities as without
from solver.line.similar import Films
from solver.line.windows import Coat, Kind
from tests.solver.gap.airy import FIBROUS, RADIUS, THICKNESS, airy, on_rigid

CASES = np.array([5e3, 5.5e3])


def films(conducts: tuple[bool, bool]) -> Films:
    kind = Kind((Coat(constants_of(FIBROUS)),), None, 0.0, conducts, (True, True), 1)
    return Films(kind, Profile.cylinder(np.array([RADIUS])), CASES, np.zeros((2, 2)), np.ones(2), np.full(2, THICKNESS))


def test_windows_give_what_a_table_about_the_case_gives() -> None:
    result = quantities(films((True, False)), np.ones(2))
    contact = airy(on_rigid(FIBROUS), conducts=(True, False))
    state, scale = contact.state, contact.contact.scale
    assert result["contact_trailing"][0] == pytest.approx(THICKNESS * state.half, rel=1e-8)
    assert result["voltage"][0] == pytest.approx(THICKNESS * state.response[1] * scale[2], rel=1e-6)
    assert result["capacitance_per_length"][0] == pytest.approx(1 / state.at_fixed_contact[1, 0], rel=1e-6)
    assert result["capacitance_at_load"][0] == pytest.approx(1 / state.tangents[1, 1], rel=1e-6)
    bare = without(films((True, False)))
    gone = {name for name in bare if "_edge_intensity_" in name}
    new = {"capacitance_at_load", "peak_displacement", "gap_field"}
    assert result.keys() == (bare.keys() - gone) | new


def test_insulating_punch_has_no_air() -> None:
    with pytest.raises(SurroundingsError, match="surroundings: 'air' is not allowed: the punch conducts no field"):
        quantities(films((False, False)), np.ones(2))
