"""Capacitance and permeance are those between two solved states of one contact."""

import numpy as np
import pytest
from scipy.optimize import brentq

import solver
from solver.stack.layers import Layer, Stack

FILM = {"surroundings": "insulated", "thickness": 0.7e-3, "radius": 0.05}
#: A bonded active base, whose far field carries load and charge alike.
ACTIVE = FILM | {"material": "BaTiO3", "base": "PZT-5H", "interface_electric": "bonded"}
MAGNETIC = FILM | {"composite": "fibrous", "volume_fraction": 0.6, "base": "CoFe2O4", "interface_magnetic": "bonded"}


@pytest.mark.parametrize(
    ("body", "load", "charge", "potential", "store", "size"),
    [
        (ACTIVE | {"friction": 0.3}, 3e6, "charge", "voltage", "capacitance_per_length", 1e-6),
        (MAGNETIC, 1e5, "magnetic_charge", "magnetic_potential", "permeance_per_length", 1e-7),
    ],
    ids=["electric, friction", "magnetic"],
)
def test_stores_are_those_between_two_states_of_one_width(
    body: dict[str, float], load: float, charge: str, potential: str, store: str, size: float
) -> None:
    """The potential is affine in the charge at one width: a secant is the tangent but for rounding.

    That is 1e-8, as the secant is of potentials that are a thousand times larger than what they differ by.
    """

    def width(load: float, charged: float) -> float:
        computed = solver.solve({**body, "load": load, charge: charged})
        return float(computed["contact_trailing"] + computed["contact_leading"])

    required = width(load, 0.0)
    other = brentq(lambda load: width(load, size) / required - 1, 0.9 * load, 1.1 * load, xtol=1e-9 * load, rtol=1e-13)
    first = solver.solve({**body, "load": load})
    two = solver.solve({**body, "load": other, charge: size})
    secant = size / float(two[potential] - first[potential])
    assert float(first[store]) == pytest.approx(secant, rel=1e-7, abs=0)


def test_figures_that_others_found() -> None:
    """Four digits of an independent check: dT/dV between two states of one contact, and an insulated base's exact."""
    assert float(solver.solve(ACTIVE | {"load": 3e6})["capacitance_per_length"]) == pytest.approx(9.888e-9, rel=5e-5)
    layers = Layer(solver.find("PZT-5H"), 10e-6), Layer(solver.find("polyimide"), 0.2e-3, magnetic="insulated")
    computed = solver.solve({"surroundings": "insulated", "body": Stack(layers), "radius": 0.05, "load": 1e4})
    assert float(computed["permeance_per_length"]) == pytest.approx(-6.960e-6, rel=1e-4)


@pytest.mark.parametrize(("thin", "load"), [(10e-6, 1e4), (50e-6, 1e3)])
def test_permeance_above_an_insulated_base_is_that_of_a_strip(thin: float, load: float) -> None:
    """One permeability throughout: (J / pi mu) log|2 sinh(pi x / 2H)|, and Chebyshev's terms, are the potential.

    Far away it is a straight line that is 0 at |x| = 0, the solver's is 0 at 2H/pi. Layers a thousand times less
    dielectric lie below: what long waves lose was 9e-4.
    """
    body = Stack((Layer(solver.find("PZT-5H"), thin), Layer(solver.find("polyimide"), 0.2e-3, magnetic="insulated")))
    computed = solver.solve({"surroundings": "insulated", "body": body, "radius": 0.05, "load": load})
    thickness, mu = body.thickness, float(solver.find("PZT-5H").mu11)
    n, count, half = np.arange(60), 60, float(computed["contact_trailing"])
    angle = np.pi * (n + 0.5) / count
    phase = np.pi * half / (2 * thickness) * (np.cos(angle)[:, None] - np.cos(angle))
    np.fill_diagonal(phase, 1e-9)  # the smooth part is 0 there
    terms = np.cos(angle[:, None] * n)
    logs = -np.pi / np.maximum(n, 1) * terms
    logs[:, 0] = np.pi * np.log(np.pi * half / (2 * thickness))
    smooth = np.log(np.sinh(phase) / phase) @ terms * np.pi / count
    charge = np.pi * np.linalg.solve(logs + smooth, np.ones(count))[0]
    assert float(computed["permeance_per_length"]) == pytest.approx(-np.pi * mu * charge / (1 - charge), rel=1e-6)
