"""Half-spaces against the 50-digit oracle: every profile and conduction, charges, an elastic punch."""

from math import comb

import numpy as np
import pytest

from solver.point.profile import Shape, halfspace_peak
from solver.point.quantities import quantities
from tests.solver.point.points import FIBROUS, Conducts, on_halfspace
from verification.cases import constants
from verification.oracles import point

#: Exponent and coefficient of a sphere of 5 mm, a cone, a disc of 50 um and two powers.
PROFILES = [(2.0, 100.0), (1.0, 0.1), (0.0, 5e-5), (1.5, 3.0), (4.0, 1e9)]
STEEL_PUNCH = 2 * (1 - 0.3**2) / 210e9


@pytest.mark.sampled(5)
@pytest.mark.parametrize(("exponent", "coefficient"), PROFILES)
@pytest.mark.parametrize("conducts", [(True, True), (True, False), (False, True), (False, False)])
def test_every_quantity_to_1e_13(exponent: float, coefficient: float, conducts: Conducts) -> None:
    charges = np.where(conducts, (3e-10, -2e-8), 0.0)
    values = quantities(on_halfspace(FIBROUS, exponent, coefficient, 10.0, charges, conducts, STEEL_PUNCH))
    exact = point.quantities(
        constants(FIBROUS), exponent=exponent, coefficient=coefficient, force=10.0, charge=float(charges[0]),
        magnetic_charge=float(charges[1]), conducted=tuple(i for i in (1, 2) if conducts[i - 1]),
        punch_compliance=STEEL_PUNCH,
    )  # fmt: skip
    if exponent > 2:
        exact.pop("peak_pressure")  # not at the centre
    assert set(exact) <= set(values)
    for name, value in exact.items():
        assert values[name][0] == pytest.approx(value, rel=1e-13), name


@pytest.mark.parametrize("exponent", [4, 6, 10])
def test_pressure_is_largest_beside_the_centre_above_the_exponent_2(exponent: int) -> None:
    # int_r^1 t^(e-1) / sqrt(t^2 - r^2) dt of an even exponent is a polynomial in x = sqrt(1 - r^2)
    half = exponent // 2 - 1
    x = np.linspace(0, 1, 200001)
    values = sum(comb(half, k) * (1 - x**2) ** (half - k) * x ** (2 * k + 1) / (2 * k + 1) for k in range(half + 1))
    exact = exponent * Shape(exponent).rise * np.max(values)
    assert halfspace_peak(Shape(exponent)) == pytest.approx(exact, rel=1e-9)
