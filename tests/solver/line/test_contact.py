"""Contacts on films: figures found by other methods, the closed form of the half-plane, limits, laws and refusals."""

import numpy as np
import pytest

from solver.halfplane.pressing import ContactError
from solver.halfplane.profile import Profile
from solver.line.contact import FilmContact
from solver.line.extent import TensionError
from solver.line.table import LengthsError, RangeError, Table, table
from solver.stack.layers import Layer, Stack
from tests.solver.line.films import FIBROUS, ON_STEEL, cases, cylinder

PROFILES = {
    "cylinder": (Profile.cylinder(np.array(0.05)), 1),
    "tilted flat": (Profile.flat(np.array(4e-4), np.array(2e-4)), 0),
    "flat under a moment": (Profile.flat(np.array(4e-4), np.array(0.0), np.array(3.0)), 0),
    "wedge": (Profile.wedge(np.array(0.004), "trailing"), 0),
    "half cylinder": (Profile.half_cylinder(np.array(0.05)), 1),
    "cubic": (Profile.polynomial([1e-4, 15.0, 1e4, 2e7]), 3),
}


def test_betti_holds_between_smooth_edges_and_not_at_a_fixed_load() -> None:
    film = cylinder(Stack((Layer(FIBROUS, 3e-4),)), 0.0, 2e5)
    tangents = film.tangents[0]
    assert abs(tangents[0, 1] / -tangents[1, 0] - 1) > 0.02  # the edges move
    first = len(film.table.system.powers)
    read = np.einsum("n,noc->oc", film.table.polynomials(np.log(film.half_width))[0], film.table.series)
    load, depth, V, Psi = read[0], read[3], read[4], read[5]
    T, J = first, first + 1
    # the works of state T on state J and the other way round; the pressures carry loads of their own
    np.testing.assert_allclose(load[T] * depth[J] + V[J], load[J] * depth[T] + Psi[T], rtol=1e-12)


@pytest.fixture(scope="module")
def wide_table() -> Table:
    return table(Stack((Layer(FIBROUS, 2e-4),)), 0.3, most=10.0)


@pytest.mark.parametrize(
    ("radius", "load", "charge", "error", "said"),
    [
        (0.05, 1e9, 0.0, RangeError, "wider than the resolved range, 0.01 to 10"),
        (0.05, 1e-3, 0.0, RangeError, "narrower than the resolved range"),
        (5e4, 4300.0, -1e-5, LengthsError, "more than one length"),
        (0.05, 100.0, 1e-4, TensionError, "tension"),
    ],
)
def test_contacts_that_are_not_one_are_refused(
    wide_table: Table, radius: float, load: float, charge: float, error: type[Exception], said: str
) -> None:
    profile = Profile.cylinder(np.array(radius))
    film = FilmContact(wide_table, profile, cases(load), np.array([[charge, 0.0]]), np.array(1.0))
    assert issubclass(error, ContactError)
    with pytest.raises(error, match=said):
        _ = film.half_width


@pytest.mark.parametrize(("least", "most"), [(0.0, 1.0), (2.0, 1.0), (0.1, 1e3)])
def test_ranges_that_cannot_be_resolved_are_refused(least: float, most: float) -> None:
    with pytest.raises(RangeError, match="range"):
        table(ON_STEEL, least=least, most=most)
