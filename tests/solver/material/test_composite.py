"""Composites against the three-dimensional tensors, and the statements of theory section 7."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given

import solver
from solver.material import laws
from solver.material.constants import UNITS
from solver.names import COMPOSITES
from tests.solver import micromechanics
from tests.solver.strategies import between, phases, property_based
from verification.oracles.half_plane import CONSTANTS
from workflow.study.layered import BodyLayer

PHASES = solver.find("BaTiO3"), solver.find("CoFe2O4")
BOTH = pytest.mark.parametrize("kind", ["fibrous", "laminate"])
MIX: dict[str, Any] = {"fibrous": solver.fibrous, "laminate": solver.laminate}
EXACT: dict[str, Any] = {"fibrous": micromechanics.fibrous, "laminate": micromechanics.laminate}


def solid(material: solver.Material) -> dict[str, float]:
    return {name: float(getattr(material, name)) for name in (*CONSTANTS, "c12")}


def assert_exact(kind: str, first: solver.Material, second: solver.Material, fraction: float, rtol: float) -> None:
    mixed, exact = MIX[kind](first, second, fraction), EXACT[kind](solid(first), solid(second), fraction)
    for name, value in exact.items():
        floor = 1e-3 * rtol * size(name, exact)
        np.testing.assert_allclose(float(getattr(mixed, name)), float(value), rtol=rtol, atol=floor, err_msg=name)


def size(name: str, c: dict[str, Any]) -> float:
    """Geometric mean of the two diagonal terms that a constant couples: what its rounding is measured by."""
    electric, magnetic = ("eps11", "mu11") if name in ("e15", "f15", "g11") else ("eps33", "mu33")
    elastic = {"c12": "c11", "e31": "c11", "f31": "c11", "e15": "c44", "f15": "c44"}.get(name, "c33")
    couples = {"c12": (elastic, "c11"), "c13": (elastic, "c11"), "g": (electric, magnetic)}
    couples |= {"e": (elastic, electric), "f": (elastic, magnetic)}
    first, second = couples.get(name, couples.get(name.rstrip("135"), (name, name)))
    return float(np.sqrt(float(abs(c[first] * c[second]))))


@BOTH
@pytest.mark.parametrize("fraction", [0.0, 1e-9, 0.37, 1.0])
def test_composites_are_those_of_the_full_tensors(kind: str, fraction: float) -> None:
    first, second = PHASES
    assert_exact(kind, first, second, fraction, 1e-12)
    assert_exact(kind, second, first, fraction, 1e-12)


@BOTH
@property_based
@given(first=phases(), second=phases(), fraction=between(0.0, 1.0))
def test_composites_of_any_admissible_phases(
    kind: str, first: solver.Material, second: solver.Material, fraction: float
) -> None:
    """The check of a material is that of its energy."""
    assert_exact(kind, first, second, fraction, 1e-11)
    MIX[kind](first, second, fraction).check()


def test_published_table_follows_from_fibrous_mori_tanaka() -> None:
    mix = solver.fibrous(*PHASES, 0.5)
    assert float(mix.g33) == pytest.approx(2.75e-9, abs=0.005e-9)
    assert float(mix.eps33) == pytest.approx(6.37e-9, abs=0.005e-9)
    assert float(mix.mu33) == pytest.approx(8.39e-5, abs=0.005e-5)
    assert float(mix.g11) == pytest.approx(-5.23e-12, abs=0.005e-12)


@BOTH
def test_fractions_and_phases_broadcast(kind: str) -> None:
    first, second = PHASES
    fractions = np.linspace(0, 1, 6).reshape(2, 3)
    mix = MIX[kind](first, second, fractions)
    assert mix.shape == (2, 3)
    single = MIX[kind](first, second, float(fractions[1, 1]))
    assert float(single.rho) == pytest.approx(0.8 * 5800 + 0.2 * 5300, rel=1e-15)
    for name in UNITS:
        values = np.broadcast_to(getattr(mix, name), (2, 3))
        np.testing.assert_allclose(values[1, 1], getattr(single, name), rtol=4e-16, err_msg=name)


def test_two_readings_of_a_laminate_of_a_laminate() -> None:
    """Layers of A-B over layers of C are layers of A, B, C in whatever order they are taken together."""
    a, b, c = (solver.find(name) for name in ("BaTiO3", "CoFe2O4", "PZT-4"))
    nested = solver.laminate(solver.laminate(a, b, 0.25), c, 0.8)  # 0.2 A, 0.6 B, 0.2 C
    flat = solver.laminate(a, solver.laminate(b, c, 0.75), 0.2)
    for name, value in solid(nested).items():
        np.testing.assert_allclose(value, float(getattr(flat, name)), rtol=1e-13, atol=1e-26, err_msg=name)


def test_a_name_without_law_is_refused_and_a_new_law_serves_the_layers_of_a_study(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with pytest.raises(solver.MaterialError, match="'woven' is not one of fibrous, laminate, AlScN"):
        laws.compose("woven", PHASES, 0.3)
    layer = BodyLayer(composite="laminate", volume_fraction=0.3, thickness=1e-4)
    woven = layer.model_copy(update={"composite": "woven"})
    monkeypatch.setitem(COMPOSITES, "woven", "volume_fraction")

    with pytest.raises(solver.MaterialError, match="woven"):  # a third law is no laminate
        woven.compose({}, {}, ("BaTiO3", "CoFe2O4"))
    monkeypatch.setitem(laws._LAWS, "woven", lambda phases, fraction: phases[0])
    assert woven.compose({}, {}, ("BaTiO3", "CoFe2O4")).material == PHASES[0]
