"""Stacks, gradings, tables and fields on films that are refused, each in one line that names what is wrong."""

from collections.abc import Callable

import pytest

import solver
from solver import MaterialError, find
from solver.halfplane.pressing import ContactError
from solver.stack.layers import Layer, Stack
from tests.solver.line.films import BTO, CFO, FIBROUS

INSULATED = {"body": Stack((Layer(BTO, 0.5e-3, magnetic="insulated"),)), "surroundings": "insulated"}
CYLINDER = INSULATED | {"radius": 0.05, "load": 1e5}
ON_STEEL = Stack((Layer(FIBROUS, 2e-4, magnetic="grounded"),), "steel")
METAL = {"name": "mine", "c11": 126e9, "c13": 84.1e9, "c33": 117e9, "c44": 23e9}


#: Words of the refusal, and what is refused with them.
REFUSED: dict[str, Callable[[], object]] = {
    "thickness: 0.0 is not allowed": lambda: Layer(BTO, 0.0),
    "interface_electric: 'floating' is unknown; allowed are grounded, bonded": lambda: Layer(BTO, 1.0, "floating"),
    "layers: none": lambda: Stack(()),
    "base: material: 'soft' is unknown": lambda: Stack((Layer(BTO, 1.0),), "soft"),
    "material: 'coper' is unknown; did you mean 'copper'": lambda: Layer("coper", 1e-6),
    "thickness: '20 V': unit mismatch": lambda: Layer(BTO, "20 V"),
    "thickness: -2e-05 is not allowed": lambda: Layer(BTO, "-20 um"),
    "interface_magnetic: 'bonded' is not allowed": lambda: Stack((Layer(BTO, 1.0, magnetic="bonded"),)),
    "has case axes": lambda: Layer(solver.fibrous(BTO, CFO, [0.1, 0.2]), 1.0),
    "mine: conductor: 'yes' is not true or false": lambda: solver.Material.from_mapping(METAL | {"conductor": "yes"}),
    "mine: e33 = 1 C m-2: must be 0 in a conductor": lambda: solver.Material.from_mapping(
        METAL | {"conductor": True, "e33": 1.0}
    ),
    "beyond the range": lambda: solver.solve(CYLINDER, [1e7]),
    "x: 1e+06 is farther from the contact than the fields inside this film": lambda: solver.solve_interior(
        CYLINDER, [1e6], [0.0], fields=["stress_xx"]
    ),
    "magnetic_potential: is not given inside a film on a base that insulates": lambda: solver.solve_interior(
        CYLINDER, [0.0], [0.0], fields=["magnetic_potential"]
    ),
    "contact: half-length over thickness 11.1 is too wide for peaks; must be < 10": lambda: solver.solve(
        {"body": ON_STEEL, "profile": "flat", "width": 22.2 * 2e-4, "load": 1e4, "surroundings": "insulated"},
        peaks=True,
    ),
}  # fmt: skip


@pytest.mark.parametrize("words", REFUSED)
def test_it_is_refused(words: str) -> None:
    with pytest.raises((MaterialError, ContactError, solver.FactorError)) as caught:
        REFUSED[words]()
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_layers_and_bases_may_be_named_and_thicknesses_bear_units() -> None:
    named, stated = Stack([Layer("copper", "20 um")], "silicon"), Stack([Layer(find("copper"), 20e-6)], find("silicon"))
    assert named.name == stated.name
