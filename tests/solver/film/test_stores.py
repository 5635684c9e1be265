"""Capacitance and permeance are those between two solved states of one contact."""

import pytest
from scipy.optimize import brentq

import solver

#: A bonded active base, whose far field carries load and charge alike, and a grounded film.
ACTIVE = {"material": "BaTiO3", "base": "PZT-5H", "thickness": 0.7e-3, "radius": 0.05, "interface_electric": "bonded"}
GROUNDED = {"composite": "fibrous", "volume_fraction": 0.6, "base": "steel", "thickness": 0.7e-3, "radius": 0.05}
MAGNETIC = {**GROUNDED, "base": "CoFe2O4", "interface_magnetic": "bonded"}


@pytest.mark.parametrize(
    ("body", "load", "charge", "potential", "store", "size"),
    [
        (ACTIVE, 3e6, "charge", "voltage", "capacitance", 1e-6),
        (ACTIVE | {"friction": 0.3}, 3e6, "charge", "voltage", "capacitance", 1e-6),
        (GROUNDED | {"friction": 0.3}, 1e5, "charge", "voltage", "capacitance", 1e-7),
        (MAGNETIC, 1e5, "magnetic_charge", "magnetic_potential", "permeance", 1e-7),
    ],
    ids=["bonded", "bonded, friction", "grounded, friction", "bonded, magnetic"],
)
def test_stores_are_those_between_two_states_of_one_width(
    body: dict[str, float], load: float, charge: str, potential: str, store: str, size: float
) -> None:
    """The potential is affine in the charge at one width: a secant is the tangent but for rounding.

    That is 1e-8, as the secant is of potentials that are a thousand times larger than what they differ by.
    """

    def width(load: float, charged: float) -> float:
        found = solver.solve({**body, "load": load, charge: charged})
        return float(found["contact_trailing"] + found["contact_leading"])

    asked = width(load, 0.0)
    other = brentq(lambda load: width(load, size) / asked - 1, 0.9 * load, 1.1 * load, xtol=1e-9 * load, rtol=1e-13)
    one = solver.solve({**body, "load": load})
    two = solver.solve({**body, "load": other, charge: size})
    secant = size / float(two[potential] - one[potential])
    assert float(one[store]) == pytest.approx(secant, rel=1e-7, abs=0)
