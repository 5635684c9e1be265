"""Contacts on films: figures found by other methods, the closed form of the half-plane, limits, laws and refusals."""

import numpy as np
import pytest

import solver
from solver.film.contact import FilmContact
from solver.film.extent import TensionError
from solver.film.stack import Layer, Stack
from solver.film.table import LengthsError, RangeError, Table, table
from solver.halfplane.contact import Contact
from solver.halfplane.pressing import ContactError
from solver.halfplane.profile import Profile
from solver.halfplane.response import Response
from solver.halfplane.sliding import Sliding
from solver.halfplane.surface import HalfPlane
from tests.solver.film.films import (
    BTO,
    FIBROUS,
    ON_STEEL,
    SILICON,
    STEEL,
    cases,
    contact,
    cylinder,
    require_closed_form,
)

#: Theory of films, section 9: stack, friction, charges, datum; a, b, depth, V, Psi, K_D(a, -b), K_B(a, -b).
FIGURES = {
    "BaTiO3 on rigid": (
        (Stack((Layer(BTO, 0.5e-3),)), 0.0, (0.0, 0.0), 1.0),
        (2.103852975e-04, 2.103852975e-04, 6.959044108e-07, -5.393112137e02, 0.0),
        (6.164540932e-04, 6.164540932e-04, 0.0, 0.0),
    ),
    "fibrous on rigid": (
        (Stack((Layer(FIBROUS, 0.2e-3),)), 0.3, (2e-5, 1e-2), 1.0),
        (1.741186380e-04, 1.750310824e-04, 4.900432047e-07, 1.082552282e03, 3.756287613e01),
        (-3.643389579e-04, -3.499955974e-04, -3.971580532e-01, -3.965508806e-01),
    ),
    "fibrous on steel": (
        (ON_STEEL, 0.3, (0.0, 0.0), 0.2e-3),
        (2.003603865e-04, 1.857207118e-04, 4.444201344e-07, -2.715383908e02, -5.303018923e-01),
        (6.379179498e-05, 9.308101282e-05, 6.050401959e-03, 6.063045377e-03),
    ),
}


@pytest.mark.parametrize("name", FIGURES)
def test_published_figures_are_hit(name: str) -> None:
    (stack, friction, charges, datum), response, intensities = FIGURES[name]
    found = cylinder(stack, friction, 1e5, charges, datum)
    np.testing.assert_allclose([found.trailing[0], found.leading[0], *found.response[0]], response, rtol=2e-9)
    trailing, leading = found.edge_intensity(1.0)[0], found.edge_intensity(-1.0)[0]
    found_intensities = [trailing[0], leading[0], trailing[1], leading[1]]
    np.testing.assert_allclose(found_intensities, intensities, rtol=2e-9)


#: Section 9: a/h; P R/a^2 [Pa], charge/load [pC/N], depth R/a^2 of PZT-4; P R/a^2, charge/load of BaTiO3.
SHORT_CIRCUIT = {
    0.05: (6.765708e10, 217.0654, 1.836732, 1.016044e11, 154.2390),
    0.5: (7.708279e10, 183.3418, 0.810513, 1.177911e11, 137.9928),
    2.0: (1.655475e11, 148.7037, 0.545221, 2.550877e11, 121.8530),
    10.0: (7.66574e11, 132.654, 0.501589, 1.112011e12, 115.329),
}


@pytest.mark.parametrize("ratio", SHORT_CIRCUIT)
def test_table_of_short_circuited_films_is_hit_to_every_digit(ratio: float) -> None:
    """The charge that holds the punch at zero volts, at a given half-length: found from the load that it needs."""
    h, R = 1e-3, 0.05
    digits = 6 if ratio == 10.0 else 7
    found = []
    for name in ("PZT-4", "BaTiO3"):
        of = table(Stack((Layer(solver.find(name), h),)), least=ratio / 1.3, most=ratio * 1.3, nodes=14)
        half = ratio * h
        state = FilmContact(of, Profile.cylinder(np.array(R)), cases(1e5), np.zeros((1, 2)), np.array(1.0))
        # the load and charge of the half-length, from the outputs' linearity
        read = np.einsum("n,noc->oc", of.polynomials(np.log(cases(half)))[0], of.series)
        charge = -read[4, 0] / read[4, 1] * half / R / state.scale[1]
        load = (read[0, 0] * half / R / state.scale[1] + read[0, 1] * charge) * half / state.scale[1]
        charge *= half / state.scale[2]
        short = FilmContact(of, state.profile, cases(load), np.array([[charge, 0.0]]), np.array(1.0))
        np.testing.assert_allclose(short.half_width, half, rtol=1e-9)
        own = solver.solve(
            {"material": name, "thickness": h, "surroundings": "insulated", "base": "rigid", "radius": R, "load": load}
        )
        assert own["charge_sensitivity"].item() == pytest.approx(charge / load, rel=1e-8)  # between tabled half-lengths
        found.append((load * R / half**2, charge / load * 1e12, float(short.depth[0]) * R / half**2))
    printed = [f"{v:.{digits - 1}e}" for v in (*found[0], *found[1][:2])]
    expected = [f"{v:.{digits - 1}e}" for v in SHORT_CIRCUIT[ratio]]
    for one, other in zip(printed, expected, strict=True):
        assert abs(float(one) / float(other) - 1) < 0.6 * 10.0 ** (1 - digits), (printed, expected)


PROFILES = {
    "cylinder": (Profile.cylinder(np.array(0.05)), 1),
    "tilted flat": (Profile.flat(np.array(4e-4), np.array(2e-4)), 0),
    "flat under a moment": (Profile.flat(np.array(4e-4), np.array(0.0), np.array(3.0)), 0),
    "wedge": (Profile.wedge(np.array(0.004), "trailing"), 0),
    "half cylinder": (Profile.half_cylinder(np.array(0.05)), 1),
    "cubic": (Profile.polynomial([1e-4, 15.0, 1e4, 2e7]), 3),
}


@pytest.mark.sampled(8)
@pytest.mark.parametrize("conducts", [(True, True), (True, False), (False, True), (False, False)])
@pytest.mark.parametrize("name", PROFILES)
def test_film_of_its_own_base_is_the_closed_form(name: str, conducts: tuple[bool, bool]) -> None:
    profile, degree = PROFILES[name]
    charges = np.array([2e-6, -3e-3]) * conducts
    sliding = Sliding(HalfPlane(FIBROUS), np.array(0.4), np.array(conducts))
    exact = Contact(sliding, profile, cases(1e5), charges[None])
    response = Response(exact, np.array(0.2))
    stack = Stack((Layer(FIBROUS, 2e-4, "bonded", "bonded"),), FIBROUS)
    of = table(stack, 0.4, conducts, smooth=profile.smooth, degree=degree, least=0.3, most=4.0, nodes=8)
    half = float(np.ravel(exact.half_width)[0])
    found = FilmContact(of.narrowed(half), profile, cases(1e5), charges[None], np.array(0.2))
    require_closed_form(found, exact, response)


@pytest.mark.parametrize(("base", "slope"), [("rigid", 0.37), (SILICON, 0.085)])
def test_thick_film_tends_to_the_closed_form_like_the_square_of_its_thinness(base: object, slope: float) -> None:
    """Section 9: the half-length misses by -0.37 (hc/h)^2 on a rigid base, by -0.085 (hc/h)^2 bonded to silicon."""
    exact = Contact(
        Sliding(HalfPlane(FIBROUS), np.array(0.3), np.array([True, True])),
        Profile.cylinder(np.array(0.05)), cases(1e5), np.zeros((1, 2)),
    )  # fmt: skip
    miss = []
    for ratio in (10.0, 100.0):
        thickness = ratio * float(exact.half_width[0])
        electric = "bonded" if base is SILICON else None
        stack = Stack((Layer(FIBROUS, thickness, electric),), base)  # type: ignore[arg-type]
        of = table(stack, 0.3, least=0.5 / ratio, most=2.0 / ratio, nodes=12)
        found = contact(of, Profile.cylinder(np.array(0.05)), 1e5)
        miss.append(float(found.half_width[0] / exact.half_width[0] - 1) * ratio**2)
    np.testing.assert_allclose(miss, -slope, rtol=0.03)


def test_betti_holds_at_a_fixed_contact_between_corners() -> None:
    stack = Stack((Layer(FIBROUS, 2e-4), Layer(BTO, 1e-4)), STEEL)
    of = table(stack, smooth=(False, False), degree=0, least=0.3, most=4.0, nodes=4)
    flat = FilmContact(of.narrowed(2e-4), Profile.flat(np.array(4e-4), np.array(0.0)), cases(1e5), np.zeros((1, 2)),
                       np.array(0.1))  # fmt: skip
    tangents = flat.tangents[0]
    symmetric = tangents * np.array([[-1.0], [1.0], [1.0]])  # work of depth and load, of potential and charge
    symmetric[0] *= -1
    # d depth/dT = -dV/dP and so on: Q dV + P d depth is exact
    np.testing.assert_allclose(symmetric[0, 1:], -symmetric[1:, 0], rtol=1e-12)
    assert symmetric[1, 2] == pytest.approx(symmetric[2, 1], rel=1e-12)


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


def test_tangents_are_derivatives_with_the_moving_edges() -> None:
    film = cylinder(ON_STEEL, 0.3, 1e5, (2e-5, 1e-2), 0.1)
    steps = np.array([10.0, 1e-8, 1e-4])
    for j in range(3):
        change = np.eye(3)[j] * steps[j]
        ends = [
            FilmContact(film.table, film.profile, film.load + s * change[0], film.charges + s * change[1:], film.datum)
            for s in (1, -1)
        ]
        numerical = (ends[0].response[0] - ends[1].response[0]) / (2 * steps[j])
        np.testing.assert_allclose(film.tangents[0][:, j], numerical, rtol=2e-7)


def test_similar_contacts_are_one() -> None:
    one = cylinder(ON_STEEL, 0.3, 1e5, (2e-5, 1e-2), 0.1)
    bigger = Stack((Layer(FIBROUS, 0.6e-3, magnetic="grounded"),), STEEL)
    of = table(bigger, 0.3, least=0.3, most=4.0, nodes=16)
    other = contact(of, Profile.cylinder(np.array(0.15)), 3e5, (6e-5, 3e-2), 0.3)
    np.testing.assert_allclose(other.half_width, 3 * one.half_width, rtol=1e-11)
    np.testing.assert_allclose(other.response, 3 * one.response, rtol=1e-10)
    np.testing.assert_allclose(other.edge_intensity(1.0), np.sqrt(3) * one.edge_intensity(1.0), rtol=1e-10)
    np.testing.assert_allclose(other.at_fixed_contact, one.at_fixed_contact, rtol=1e-10)


@pytest.fixture(scope="module")
def wide_table() -> Table:
    return table(Stack((Layer(FIBROUS, 2e-4),)), 0.3, most=10.0)


def test_cases_are_vectors(wide_table: Table) -> None:
    rng = np.random.default_rng(0)
    count = 40
    profile = Profile.cylinder(rng.uniform(0.02, 0.1, count))
    load = rng.uniform(5e4, 2e5, count)
    charges = rng.uniform(-1, 1, (count, 2)) * [1e-5, 1e-3]
    many = FilmContact(wide_table, profile, load, charges, np.array(1.0))
    for i in (0, 17):
        alone = FilmContact(many.table, Profile.cylinder(profile.slope[1][i] ** -1), load[i : i + 1],
                            charges[i : i + 1], np.array(1.0))  # fmt: skip
        np.testing.assert_allclose(alone.response[0], many.response[i], rtol=1e-12)
        exact = contact(many.table, alone.profile, float(load[i]), charges[i])
        np.testing.assert_allclose(exact.response[0], many.response[i], rtol=2e-8)


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
