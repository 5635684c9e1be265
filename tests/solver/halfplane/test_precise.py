"""Every quantity and surface field against the 50-digit oracle, to 1e-11 of itself."""

from dataclasses import replace
from typing import Any

import pytest
from mpmath import isnan

import solver
from tests.solver import micromechanics
from tests.solver.cases import CHARGED, assert_agrees
from verification.cases import SIH_SONG, constants
from verification.oracles import precise

POSITIONS = (-1e4, -1.2, -0.999, 0.1, 0.8, 30.0)
UP_TO_THE_EDGES = (-1e4, -3.17, -1 - 1e-7, -1 + 1e-7, -0.5, 0.0, 0.7, 1 - 1e-7, 1 + 1e-7, 1.49, 3.2, 1e4)


def check(factors: dict[str, Any], exact_constants: dict[str, Any], positions: tuple[float, ...]) -> None:
    contact = {name: value for name, value in factors.items() if name in CHARGED}
    exact = precise.solve(exact_constants, positions=positions, **contact)
    assert_agrees(solver.solve(factors, positions), exact)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", list(solver.materials()))
def test_built_in_materials(name: str) -> None:
    check({"material": name} | CHARGED, constants(solver.find(name)), POSITIONS)


MIXES = [("fibrous", 0.0), ("fibrous", 0.6), ("fibrous", 1.0), ("laminate", 0.0), ("laminate", 0.9), ("laminate", 1.0)]


@pytest.mark.sampled(2)
@pytest.mark.parametrize(("composite", "fraction"), MIXES)
def test_composites(composite: str, fraction: float) -> None:
    first, two = (constants(phase) for phase in (solver.find("BaTiO3"), solver.find("CoFe2O4")))
    mix = micromechanics.fibrous if composite == "fibrous" else micromechanics.laminate
    factors = {"composite": composite, "volume_fraction": fraction, **CHARGED, "charge": -1e-6}
    exact = {name: float(value) if abs(value) > 1e-30 else 0.0 for name, value in mix(first, two, fraction).items()}
    check(factors, exact, POSITIONS)


@pytest.mark.parametrize(
    ("name", "friction", "conducted"),
    [(SIH_SONG, 1.3, (1, 2)), (SIH_SONG, 0.0, (1,)), ("PZT-5H", 0.4, ()), ("PZT-5H", 1e-9, (2,))],
)
def test_conduction(name: str, friction: float, conducted: tuple[int, ...]) -> None:
    """A quantity that an insulating punch lacks is NaN by the oracle and absent from the solution."""
    case: dict[str, Any] = {"radius": 0.03, "load": 4e4, "friction": friction, "datum": 0.2}
    case |= {"charge": 1e-6 * (1 in conducted), "magnetic_charge": -2e-3 * (2 in conducted)}
    case |= {"electric" if i == 1 else "magnetic": "insulating" for i in (1, 2) if i not in conducted}
    exact = precise.solve(constants(solver.find(name)), positions=UP_TO_THE_EDGES, **case)
    computed = solver.solve({"material": name, **case}, UP_TO_THE_EDGES)
    absent = {quantity for quantity, value in exact.quantities.items() if isnan(value)}
    assert not absent & set(computed)
    known = {quantity: value for quantity, value in exact.quantities.items() if quantity not in absent}
    assert_agrees(computed, replace(exact, quantities=known, fields={}), 2e-13)
    assert_agrees(computed, replace(exact, quantities={}), 2e-12)


def test_fields_outside_the_very_edges() -> None:
    """Steel under steep friction has a small pressure exponent: rounding of 1/X would show in sigma_xx."""
    positions = (-1 - 1e-9, 1 + 1e-8, 1 + 1e-12)
    check({"material": "steel", **CHARGED, "friction": 10.0}, constants(solver.find("steel")), positions)
