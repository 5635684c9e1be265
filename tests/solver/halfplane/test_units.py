"""Identical results under any change of base units, for every output by its ``units`` attribute."""

import re
from fractions import Fraction
from math import prod
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

import solver
from solver.material.constants import ANY_SIZE
from tests.solver.cases import closed_form
from tests.solver.strategies import constants, decades, loads, property_based

#: Exponents of metre, kilogram, second and ampere.
SYMBOLS: dict[str, tuple[int, int, int, int]] = {
    "1": (0, 0, 0, 0),
    "m": (1, 0, 0, 0),
    "N": (1, 1, -2, 0),
    "Pa": (-1, 1, -2, 0),
    "C": (0, 0, 1, 1),
    "V": (2, 1, -3, -1),
    "A": (0, 0, 0, 1),
    "T": (0, 1, -2, -1),
    "Wb": (2, 1, -2, -1),
    "F": (-2, -1, 4, 2),
    "s": (0, 0, 1, 0),
}
CONSTANTS = {"c": "Pa", "e": "C m-2", "f": "N A-1 m-1", "eps": "F m-1", "g": "N s V-1 C-1", "mu": "N s2 C-2"}
FACTORS = {
    "radius": "m",
    "friction": "1",
    "load": "N m-1",
    "charge": "C m-1",
    "magnetic_charge": "Wb m-1",
    "datum": "m",
}
POSITIONS = (-4.0, -1.05, -0.9, 0.2, 0.97, 1.05)


def factor(units: str, base: tuple[float, ...]) -> float:
    """Number of new units in one of SI, when metre, kilogram, second and ampere are ``base`` new ones each."""
    total = [Fraction(0)] * 4
    for symbol, power in re.findall(r"([A-Za-z]+|1)(-?\d+(?:/\d+)?)?", units):
        total = [t + Fraction(power or 1) * e for t, e in zip(total, SYMBOLS[symbol], strict=True)]
    out: float = prod(b ** float(t) for b, t in zip(base, total, strict=True))
    return out


@property_based
@given(c=constants(), case=loads(), base=st.tuples(*[decades(-4, 4)] * 4))
def test_results_do_not_depend_on_base_units(
    c: dict[str, float], case: dict[str, Any], base: tuple[float, ...]
) -> None:
    case = case | {"datum": 1.0}
    plain = solver.solve({"material": solver.Material.from_mapping(c), **case}, POSITIONS, regular=True)
    changed = {name: value * factor(CONSTANTS[name.rstrip("0123456789")], base) for name, value in c.items()}
    arrays: dict[str, Any] = {name: np.array(value) for name, value in changed.items()}
    material = solver.Material(**arrays, any_size=ANY_SIZE)
    other_case = {name: value * factor(FACTORS[name], base) for name, value in case.items()}
    other = solver.solve({"material": material, **other_case}, POSITIONS, regular=True)
    for name in closed_form(plain):
        values = plain[name]
        expected = values * factor(values.attrs["units"], base)
        size = float(np.max(np.abs(expected)))
        np.testing.assert_allclose(other[name], expected, rtol=1e-10, atol=1e-11 * size, err_msg=name)
