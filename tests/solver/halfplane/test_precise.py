"""Every quantity and surface field against the 50-digit oracle, to 1e-11 of itself."""

from typing import Any

import pytest

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


@pytest.mark.sampled(3)
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


@pytest.mark.sampled(2)
@pytest.mark.parametrize("friction", [0.0, 1e-12, 0.3, 2.0, 10.0])
def test_friction_and_positions_up_to_the_edges(friction: float) -> None:
    check({"material": SIH_SONG, **CHARGED, "friction": friction}, constants(solver.find(SIH_SONG)), UP_TO_THE_EDGES)


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("radius", "load"), [(1e-6, 1e-6), (1e-6, 1e6), (1e6, 1e-6), (1e6, 1e6)], ids=lambda value: f"{value:g}"
)
def test_radii_and_loads_over_twelve_decades(radius: float, load: float) -> None:
    factors = {"material": SIH_SONG, "radius": radius, "load": load, "friction": 0.6, "datum": 3e5}
    factors |= {"charge": -1e-11 * load, "magnetic_charge": 2e-8 * load}
    check(factors, constants(solver.find(SIH_SONG)), POSITIONS)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("friction", [10.0, 0.3])
def test_fields_outside_the_very_edges(friction: float) -> None:
    """Steel under steep friction has a small pressure exponent: rounding of 1/X would show in sigma_xx."""
    positions = (-1 - 1e-9, 1 + 1e-8, 1 + 1e-12)
    check({"material": "steel", **CHARGED, "friction": friction}, constants(solver.find("steel")), positions)
