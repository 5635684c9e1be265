"""Largest stresses from tables against plain searches over the fields."""

from typing import Any

import numpy as np
import pytest

import solver
from solver.arrays import Array
from solver.halfplane.profile import Profile
from solver.line.contact import FilmContact
from solver.line.peaks import PeakTable
from solver.line.stressnets import DEPTH
from solver.line.table import table
from solver.names import FILM_PEAKS
from solver.stack.layers import Layer, Stack
from tests.solver.line.films import FIBROUS, ON_STEEL, interior_fields

THICKNESS = 0.2e-3
FILM: dict[str, Any] = {"surroundings": "insulated", "thickness": THICKNESS, "radius": 0.05}


@pytest.fixture(scope="module", params=["steel", pytest.param("rigid", marks=pytest.mark.soak)])
def read(request: pytest.FixtureRequest) -> tuple[PeakTable, FilmContact]:
    stack = Stack((Layer(FIBROUS, THICKNESS),)) if request.param == "rigid" else ON_STEEL
    tabled = table(stack, 0.3, least=0.5, most=1.2, nodes=8)
    loads = np.array([4e4, 1e5])
    charges = np.stack([loads * 1e-10, loads * -3e-8], -1)
    return PeakTable(tabled), FilmContact(tabled, Profile.cylinder(np.array(0.05)), loads, charges, np.array(1.0))


def one(film: FilmContact, case: int) -> FilmContact:
    return FilmContact(film.table, film.profile, film.load[[case]], film.charges[[case]], film.datum)


def zoomed(film: FilmContact, name: str, sign: float, X: float, depths: Array) -> float:
    """Largest value of a field near X at depths over h."""
    near: Array = np.asarray(X + max(1.0, X * X) * np.linspace(-0.03, 0.03, 241), dtype=np.float64)
    return float(np.max(sign * interior_fields(film, near, -depths, (name,))[0, 0]))


def test_of_two_hills_of_the_pressure_the_higher_is_given() -> None:
    case = FILM | {"material": "PZT-5H", "base": "polyimide", "friction": 0.1, "load": 2.495e5}
    assert float(solver.solve(case)["peak_pressure"]) == pytest.approx(69.682e6, abs=5e2)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("material", "base"), [("BaTiO3", "steel"), ("PZT-5H", "polyimide")])
def test_a_sweep_of_the_load_has_no_steps_where_tables_change(material: str, base: str) -> None:
    """2,000 loads about the change of tables at a half-length of one thickness: third differences are steps."""
    case = FILM | {"material": material, "base": base, "thickness": 1e-4, "friction": 0.2}
    coarse = np.geomspace(1e2, 1e5, 200)
    trial = solver.solve(case | {"load": coarse})
    half = ((trial["contact_trailing"] + trial["contact_leading"]) / 2).values.ravel()
    load = np.interp(0.0, np.log(half / 1e-4), np.log(coarse))
    swept = solver.solve(case | {"load": np.exp(load + 0.01 * np.linspace(-1, 1, 2000))}, peaks=True)
    half = ((swept["contact_trailing"] + swept["contact_leading"]) / 2).values.ravel()
    assert half[0] < 1e-4 < half[-1]
    for name in ("peak_pressure", *FILM_PEAKS):
        if not name.endswith("position"):
            values = swept[name].values.ravel()
            assert np.max(np.abs(np.diff(values, 3))) <= 1e-8 * np.max(values), name


def test_film_is_searched(read: tuple[PeakTable, FilmContact]) -> None:
    peaks, film = read
    computed = peaks.peaks(film, "film")
    state, h = one(film, 1), film.half_width[1]
    edge = THICKNESS / h
    X, Y = np.linspace(-1.6, 1.6, 161), -DEPTH * (edge / DEPTH) ** np.linspace(0, 1, 25)
    fields = interior_fields(state, X, Y, ("von_mises", "principal_tension"))[0]
    for name, values in zip(("von_mises", "principal_tension"), fields, strict=True):
        depth, across = np.unravel_index(np.argmax(values), values.shape)
        near: Array = np.clip(-Y[depth] * np.linspace(0.95, 1.05, 41), DEPTH, edge)
        assert computed[f"film_peak_{name}"][1] == pytest.approx(
            zoomed(state, name, 1.0, float(X[across]), near), rel=3e-5
        )


@pytest.mark.parametrize(
    ("case", "largest"),
    [
        ({"load": 1e6}, 6.22e6),  # 5.3 half-lengths from the middle: the base bends with the width of the contact
        ({"load": 1e4, "friction": 0.01, "base": "steel"}, None),  # 220 half-lengths from the middle
        ({"load": 3e4, "base": "polyimide", "punch_modulus": 2e11, "punch_poisson": 0.3}, None),
    ],
)
def test_the_base_is_searched_as_far_as_its_tension_rises(case: dict[str, Any], largest: float | None) -> None:
    factors = {"material": "BaTiO3", "thickness": 1e-4, "base": "aluminium oxide", "radius": 0.05, "friction": 0.05}
    factors |= {"surroundings": "insulated", "magnetic": "insulating"} | case
    answer = solver.solve(factors, peaks=["base_peak_principal_tension"])
    half = float(answer["contact_trailing"] + answer["contact_leading"]) / 2
    far = 1 + np.geomspace(0.01, 400.0, 120)
    x: Array = np.concatenate([-far[::-1], np.linspace(-0.99, 0.99, 21), far])
    x = x[np.abs(x) * half < 500e-4]  # fields inside end some hundred thicknesses away
    top = 1e-4 / half
    depths = np.geomspace(top * (1 + 1e-9), 2 + 2 * top, 8)
    inside = solver.solve_interior(factors, x, -depths, fields=["principal_tension"])
    tension = inside["principal_tension"].values.squeeze()
    computed = float(answer["base_peak_principal_tension"])
    assert np.max(tension) * (1 - 1e-6) <= computed <= np.max(tension) * 1.03
    if largest is not None:
        assert computed == pytest.approx(largest, rel=1e-3)
