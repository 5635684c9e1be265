"""Largest stresses from tables against plain searches over the fields."""

import numpy as np
import pytest

from solver.arrays import Array
from solver.film.contact import FilmContact
from solver.film.interior import interior_fields
from solver.film.peaks import DEPTH, PeakTable
from solver.film.stack import Layer, Stack, StackError
from solver.film.table import table
from solver.halfplane.profile import Profile
from tests.solver.film.films import FIBROUS, ON_STEEL, cases

THICKNESS = 0.2e-3


@pytest.fixture(scope="module", params=["rigid", "steel"])
def read(request: pytest.FixtureRequest) -> tuple[PeakTable, FilmContact]:
    stack = Stack((Layer(FIBROUS, THICKNESS),)) if request.param == "rigid" else ON_STEEL
    of = table(stack, 0.3, least=0.5, most=1.2, nodes=8)
    loads = np.array([4e4, 1e5])
    charges = np.stack([loads * 1e-10, loads * -3e-8], -1)
    return PeakTable(of), FilmContact(of, Profile.cylinder(np.array(0.05)), loads, charges, np.array(1.0))


def one(film: FilmContact, case: int) -> FilmContact:
    return FilmContact(film.table, film.profile, film.load[[case]], film.charges[[case]], film.datum)


def zoomed(film: FilmContact, name: str, sign: float, X: float, depths: Array) -> float:
    """Largest value of a field near X at depths over h."""
    near: Array = np.asarray(X + max(1.0, X * X) * np.linspace(-0.03, 0.03, 241), dtype=np.float64)
    return float(np.max(sign * interior_fields(film, near, -depths, (name,))[0, 0]))


def test_interface_is_searched(read: tuple[PeakTable, FilmContact]) -> None:
    peaks, film = read
    found = peaks.interface(film)
    for case in (0, 1):
        state, h = one(film, case), film.half_width[case]
        edge = THICKNESS / h
        X = np.concatenate([np.linspace(-1, 1, 201), 1 + np.geomspace(1e-3, 10 * edge, 200)])
        X = np.unique(np.concatenate([X, -X]))
        shear, normal = interior_fields(state, X, np.array([-edge]), ("stress_xy", "stress_yy"))[0][:, 0]
        at = int(np.argmax(np.abs(shear)))
        largest = zoomed(state, "stress_xy", np.sign(shear[at]), float(X[at]), np.array([edge]))
        assert found.shear[case] == pytest.approx(largest, rel=1e-6)
        assert found.shear_position[case] == pytest.approx(X[at], abs=0.02)
        if np.max(normal) > 0:
            at = int(np.argmax(normal))
            pulled = zoomed(state, "stress_yy", 1.0, float(X[at]), np.array([edge]))
            assert found.tension[case] == pytest.approx(pulled, rel=1e-4, abs=1e-6 * largest)
        else:
            assert found.tension[case] == 0.0
            assert np.isnan(found.tension_position[case])


def test_film_is_searched(read: tuple[PeakTable, FilmContact]) -> None:
    peaks, film = read
    found = peaks.film(film)
    state, h = one(film, 1), film.half_width[1]
    edge = THICKNESS / h
    X, Y = np.linspace(-1.6, 1.6, 161), -DEPTH * (edge / DEPTH) ** np.linspace(0, 1, 25)
    fields = interior_fields(state, X, Y, ("von_mises", "principal_tension"))[0]
    for name, values, largest in zip(("von_mises", "principal_tension"), fields, (found.von_mises[1],
                                     found.principal_tension[1]), strict=True):  # fmt: skip
        depth, across = np.unravel_index(np.argmax(values), values.shape)
        near: Array = np.clip(-Y[depth] * np.linspace(0.95, 1.05, 41), DEPTH, edge)
        assert largest == pytest.approx(zoomed(state, name, 1.0, float(X[across]), near), rel=3e-5)


def test_base_is_searched(read: tuple[PeakTable, FilmContact]) -> None:
    peaks, film = read
    if film.table.system.kernel.stack.rigid:
        with pytest.raises(StackError, match="a rigid base has no stresses"):
            peaks.base(film)
        return
    found, edge = peaks.base(film), THICKNESS / film.half_width[1]
    X, Y = np.linspace(-2.0, 2.0, 161), -edge * (1 + np.linspace(1e-8, 2.0, 41))
    fields = interior_fields(one(film, 1), X, Y, ("von_mises", "principal_tension"))[0]
    for values, largest in zip(fields, (found.von_mises[1], found.principal_tension[1]), strict=True):
        assert np.max(values) <= largest * (1 + 1e-6)
        assert largest == pytest.approx(np.max(values), rel=2e-3)


def test_contacts_without_a_film_below_the_least_depth_are_refused() -> None:
    of = table(ON_STEEL, least=1.0, most=12.0, nodes=4)
    film = FilmContact(of, Profile.cylinder(np.array(0.05)), cases(1e6), np.zeros((1, 2)), np.array(1.0))
    with pytest.raises(StackError, match="wider than 10 thicknesses"):
        PeakTable(of).film(film)
