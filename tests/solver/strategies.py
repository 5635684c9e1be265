"""Random admissible materials, loads and contacts for the property tests."""

from typing import Any

from hypothesis import strategies as st

import solver
from solver.material.constants import ANY_SIZE
from tests.layers import few_and_many

#: A test of a few examples, and of many in `make soak`.
property_based = few_and_many(8, 100)


def between(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers with nine decimals: zero, or nothing so small that its square is lost."""
    return st.floats(low, high).map(lambda x: round(x, 9))


def decades(low: float, high: float) -> st.SearchStrategy[float]:
    """10**x with x between the bounds."""
    return between(low, high).map(lambda x: float(10**x))


@st.composite
def constants(draw: st.DrawFn) -> dict[str, float]:
    """Constants of a material with positive definite energy, SI units: half a decade about those of ceramics.

    Couplings reach the size of sqrt(c eps), twice those of the strongest ceramics.
    """
    c = {"c11": 2e11, "c33": 2e11, "c44": 5e10, "eps11": 5e-9, "eps33": 5e-9, "mu11": 1e-4, "mu33": 1e-4}
    c = {name: size * draw(decades(-0.5, 0.5)) for name, size in c.items()}
    c["c13"] = round(draw(between(-0.5, 0.95)), 6) * (c["c11"] * c["c33"]) ** 0.5
    for axis in ("11", "33"):
        c["g" + axis] = draw(between(-0.9, 0.9)) * (c["eps" + axis] * c["mu" + axis]) ** 0.5
    for kind, inertia in (("e", "eps"), ("f", "mu")):
        c[kind + "31"] = draw(between(-1.0, 1.0)) * (c["c11"] * c[inertia + "33"]) ** 0.5
        c[kind + "33"] = draw(between(-1.0, 1.0)) * (c["c33"] * c[inertia + "33"]) ** 0.5
        c[kind + "15"] = draw(between(-1.0, 1.0)) * (c["c44"] * c[inertia + "11"]) ** 0.5
    return c


@st.composite
def phases(draw: st.DrawFn) -> solver.Material:
    """Admissible materials with c12, fit for composites."""
    c: dict[str, Any] = draw(constants())
    least = max(-c["c11"], 2 * c["c13"] ** 2 / c["c33"] - c["c11"])
    c["c12"] = least + draw(between(0.05, 0.95)) * (c["c11"] - least)
    return solver.Material(**c, any_size=ANY_SIZE)  # a number next to zero has lost no unit


def loads(friction: float = 2.0) -> st.SearchStrategy[dict[str, Any]]:
    """Radius, friction, load and both charges, each over its useful range."""
    return st.fixed_dictionaries({
        "radius": decades(-3, 0),
        "friction": between(0, friction),
        "load": decades(2, 6),
        "charge": between(-1, 1).map(lambda x: 1e-5 * x),
        "magnetic_charge": between(-1, 1).map(lambda x: 1e-2 * x),
    })  # fmt: skip
