"""Limits and alternatives: what the library holds, how strictly they are read, and what the entries claim of them."""

import re
from typing import Any

import numpy as np
import pytest

import solver
from solver.material.constants import UNITS
from solver.material.punches import punches
from solver.names import EVERY_FILM_QUANTITY, EVERY_QUANTITY, LIMITED, LIMITS
from tests.solver.cases import BTO, CFO, free_body
from verification.cases import constants

#: Orders of magnitude that a solid can have.
SENSIBLE = {
    "tensile_strength": (1e6, 1e9), "yield_strength": (1e7, 1e9), "depoling_stress": (1e6, 1e9),
    "coercive_field": (1e5, 1e9), "breakdown_field": (1e6, 1e9),
}  # fmt: skip


def test_limits_bound_quantities_of_their_own_unit() -> None:
    quantities = EVERY_QUANTITY | EVERY_FILM_QUANTITY
    assert list(LIMITED) == list(LIMITS)
    for name, bounded in LIMITED.items():
        assert {quantities[quantity].units for quantity in bounded} == {LIMITS[name].units}


@pytest.mark.parametrize("name", list(solver.materials()))
def test_entries_say_where_everything_comes_from(name: str) -> None:
    material = solver.find(name)
    for kind, limit in material.limits.items():
        low, high = SENSIBLE[kind]
        assert low <= limit.value <= high, kind
        assert "read" in limit.source or "recalled" in limit.source, kind
        assert re.search(r"\b(19|20)\d\d\b", limit.source) or "recalled" in limit.source, kind
    if {"coercive_field", "breakdown_field"} <= set(material.limits):
        assert material.limits["coercive_field"].value < material.limits["breakdown_field"].value
    for variant, other in zip(material.variants(), material.alternatives, strict=True):
        variant.check()
        assert solver.find(variant.name).source == other.source
        for constant in UNITS:
            value = other.constants.get(constant, float(getattr(material, constant)))
            np.testing.assert_array_equal(getattr(variant, constant), value)
            if constant in other.constants:
                low, high = material.spread[constant]
                assert low <= value <= high
                assert low < high


#: Sizes of thermal constants in SI of any solid of the library.
WARM = {
    "pyroelectric": (1e-6, 1e-3), "expansion": (1e-6, 4e-4), "conductivity": (0.1, 500), "heat_capacity": (1e6, 5e6),
}  # fmt: skip


def test_constants_for_heat_have_sources_and_sizes_of_solids() -> None:
    bodies = {name: material.thermal for name, material in solver.materials().items()}
    bodies |= {f"punch {name}": punch.thermal for name, punch in punches().items()}
    for name, thermal in bodies.items():
        for kind, known in thermal.items():
            low, high = WARM[kind]
            assert low <= abs(known.value) <= high, (name, kind)
            assert "read" in known.source or "recalled" in known.source, (name, kind)
            assert known.value > 0 or kind == "pyroelectric", (name, kind)  # expansions of the library are positive
    assert {name for name, thermal in bodies.items() if "pyroelectric" in thermal} == {
        name for name, body in solver.materials().items() if body.e33 and body.thermal.get("pyroelectric")
    }  # only what is polar
    polymer = solver.find("PVDF")
    assert solver.Material.from_mapping(polymer.plain()).thermal == polymer.thermal
    assert polymer.variants()[0].thermal == polymer.thermal


@pytest.mark.parametrize("law", [solver.fibrous, solver.laminate])
def test_composites_mix_constants_for_heat_by_the_relation_of_levin(law: Any) -> None:
    polar, spinel = BTO, CFO
    ends = [law(polar, spinel, fraction).thermal for fraction in (0.0, 1.0)]
    for name, phase in (("expansion", spinel), ("conductivity", spinel), ("heat_capacity", spinel)):
        assert ends[0][name].value == pytest.approx(phase.thermal[name].value, rel=1e-9)
    for name, known in polar.thermal.items():
        assert ends[1][name].value == pytest.approx(known.value, rel=1e-9)
    assert not law(polar, solver.find("PMN-PT 67:33"), 0.5).thermal  # a phase of which nothing is known
    assert not law(polar, spinel, [0.2, 0.5]).thermal


def test_a_laminate_is_pyroelectric_as_its_layers_in_series() -> None:
    v, polar, spinel = 0.4, BTO, solver.find("glass")  # no magnetic coupling
    free = solver.laminate(polar, spinel, v)
    p = {name: known.value for name, known in free.thermal.items()}
    # unknowns per kelvin: strain across, strain along and field of each layer; shared: strain across, stress, D
    rows, right = np.zeros((5, 5)), np.zeros(5)
    layers = [constants(m) | {name: known.value for name, known in m.thermal.items()} for m in (polar, spinel)]
    for k, (c, share) in enumerate(zip(layers, (v, 1 - v), strict=True)):
        alpha, upright, field = c["expansion"], 1 + k, 3 + k
        rows[0, [0, upright, field]] += np.array([c["c11"] + c["c12"], c["c13"], -c["e31"] * 1e9]) * share
        right[0] += share * (c["c11"] + c["c12"] + c["c13"]) * alpha
        rows[1 + k, [0, upright, field]] = 2 * c["c13"], c["c33"], -c["e33"] * 1e9  # no stress along the axis
        right[1 + k] = (2 * c["c13"] + c["c33"]) * alpha
        rows[3, field] = share  # no voltage
        sign = 1e9 * (1 - 2 * k)
        rows[4, [0, upright, field]] += sign * np.array([2 * c["e31"], c["e33"], c["eps33"] * 1e9])
        right[4] -= sign * (c.get("pyroelectric", 0.0) - (2 * c["e31"] + c["e33"]) * alpha)
    across, along, _, induced, _ = np.linalg.solve(rows, right)
    c = layers[0]
    induction = (
        c["pyroelectric"] + 2 * c["e31"] * (across - c["expansion"]) + c["e33"] * (along - c["expansion"])
    ) + c["eps33"] * 1e9 * induced
    assert p["expansion"] == pytest.approx(across, rel=1e-9)
    assert p["pyroelectric"] == pytest.approx(induction, rel=1e-7)


@pytest.mark.parametrize("name", ["BaTiO3", "steel", "P(VDF-TrFE) 75:25", "CoFe2O4"])
def test_plain_values_come_back_to_the_last_bit(name: str) -> None:
    material = solver.find(name)
    again = solver.Material.from_mapping(material.plain())
    for key in UNITS:
        np.testing.assert_array_equal(getattr(again, key), getattr(material, key))
    for key in ("name", "source", "note", "limits", "alternatives"):
        assert getattr(again, key) == getattr(material, key)


def test_what_the_entries_say_of_their_alternatives() -> None:
    """Voltage 10 % higher (BaTiO3) and 2 % lower (PZT-4) at else the same contact; d33 of PMN-PT as its source has."""
    contact: dict[str, Any] = {"radius": 0.05, "load": 1e4, "friction": 0.3}
    for name, voltage in {"BaTiO3": 1.10, "PZT-4": 0.977}.items():
        solution = solver.solve({"material": [name, f"{name} (alternative 1)"], **contact})
        assert float(solution.voltage[1] / solution.voltage[0]) == pytest.approx(voltage, abs=2e-3)
        for same in ("contact_trailing", "peak_pressure", "charge_per_force", "trailing_tension"):
            assert float(solution[same][1] / solution[same][0]) == pytest.approx(1, abs=4e-3)
    s, d = free_body(solver.find("PMN-PT 67:33 (alternative 1)"))
    assert np.diag(s)[[0, 2]] * 1e12 == pytest.approx([69.0, 119.6], rel=2e-3)
    assert d[[0, 2]] * 1e12 == pytest.approx([-1330, 2820], rel=2e-3)


def test_pvdf_has_the_strain_constants_of_its_source() -> None:
    """e = d c with the orthotropic c and d, written out: along the stretch, and across it as the alternative."""
    c = np.array([[3.61, 1.61, 1.42], [1.61, 3.13, 1.31], [1.42, 1.31, 1.63]])
    e = c @ np.array([21, 1.5, -32.5])
    along, across = solver.find("PVDF"), solver.find("PVDF (alternative 1)")
    assert [float(along.e31), float(across.e31), float(along.e33)] == pytest.approx(e * 1e-3, rel=1e-9)
    assert float(along.e15) == pytest.approx(0.59e9 * -27e-12, rel=1e-9)
    assert float(across.e15) == pytest.approx(0.55e9 * -23e-12, rel=1e-9)


def test_sets_agree_with_what_their_sources_measure() -> None:
    """AlN films have a k_t^2 of 6 to 6.5 %; the vendor's set of PIC255 has its data sheet's d33 and s11."""
    nitride = solver.find("AlN")
    stiffened = float(nitride.e33**2 / nitride.eps33)
    assert 0.06 < stiffened / (float(nitride.c33) + stiffened) < 0.065
    (fit, _), (s, d) = (free_body(solver.find(name)) for name in ("PIC255", "PIC255 (alternative 1)"))
    np.testing.assert_allclose(np.diag(s)[[0, 2]] * 1e12, [15.9, 21.0], rtol=5e-3)  # pm2/N, as the data sheet prints
    np.testing.assert_allclose(d[[2, 0]] * 1e12, [393, -174], rtol=5e-3)  # pC/N
    assert fit[0, 0] / s[0, 0] == pytest.approx(1.27, abs=0.01)
