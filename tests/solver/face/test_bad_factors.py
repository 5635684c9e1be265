"""Bad factors and positions: a named error that says which, what value, and what is allowed; never a NaN."""

from contextlib import suppress
from typing import Any

import numpy as np
import pytest
import xarray as xr

import solver
from tests.solver import cases
from tests.solver.cases import assert_finite

GOOD: dict[str, Any] = {"material": "BaTiO3", "radius": 0.05, "load": 1e5}
MIXED: dict[str, Any] = {"volume_fraction": 0.5, "radius": 0.05, "load": 1e5}
NUMBERS = ("radius", "load", "friction", "charge", "magnetic_charge", "datum", "volume_fraction")
POSITIVE = ("radius", "load", "datum")
POSITIONS = (-2.0, 0.3, 1.5)
CHOSEN = ("composite", "profile", "electric", "magnetic")
TWO, THREE = xr.DataArray([1e4, 1e5], dims="case"), xr.DataArray([0.1, 0.2, 0.3], dims="case")


def refused(factors: dict[str, Any], *words: str, positions: Any = POSITIONS, **options: Any) -> None:
    cases.refused(factors, "", *words, positions=positions, **options)


def case(name: str) -> dict[str, Any]:
    return MIXED if name == "volume_fraction" else GOOD


@pytest.mark.parametrize("value", [float("nan"), float("inf"), float("-inf")])
@pytest.mark.parametrize("name", NUMBERS)
def test_not_finite(name: str, value: float) -> None:
    refused(case(name) | {name: value}, f"{name}: {value:g} is not", "finite")


@pytest.mark.parametrize("value", [0.0, -0.0, -1e-300, -1.0])
@pytest.mark.parametrize("name", POSITIVE)
def test_not_positive(name: str, value: float) -> None:
    refused(GOOD | {name: value}, f"{name}: {value:g} is not", "> 0")


@pytest.mark.parametrize("value", [-0.01, 1.01])
@pytest.mark.parametrize("composite", ["fibrous", "laminate"])
def test_fraction_outside_zero_to_one(composite: str, value: float) -> None:
    refused(MIXED | {"composite": composite, "volume_fraction": value}, f"volume_fraction: {value} is not", "0", "1")


@pytest.mark.parametrize("value", ["half", "", [1.0, "half"], {"a": 1}])
@pytest.mark.parametrize("name", NUMBERS)
def test_not_a_number(name: str, value: Any) -> None:
    refused(case(name) | {name: value}, f"{name}: ", "is not")


#: Beginning of the message, more of it, and the case.
SINGLE: list[tuple[str, str, dict[str, Any]]] = [
    ("friction: -0.3 is not", ">= 0", GOOD | {"friction": -0.3}),
    # the value at fault among good ones
    ("load: -7 is not", "", GOOD | {"load": [1e3, 1e4, -7.0, 1e5]}),
    ("friction: nan is not", "", GOOD | {"friction": np.array([0.1, np.nan])}),
    ("radius: 0 is not", "", GOOD | {"radius": xr.DataArray([[0.1, 0.2], [0.3, 0.0]], dims=("a", "b"))}),
    ("volume_fraction: 1.5 is not", "", MIXED | {"volume_fraction": [0.0, 1.0, 1.5]}),
    ("load: 'heavy' is not", "", GOOD | {"load": [1e3, "heavy"]}),
    # no numbers
    ("load: ", "", GOOD | {"load": 1e5 + 1j}),
    ("load: ", "", GOOD | {"load": [1e3, [1e4, 1e5]]}),
    ("load: ", "", GOOD | {"load": 10**400}),
    ("load: ", "2 dimensions", GOOD | {"load": [[1e3, 1e4]]}),
    # names
    ("fricton: unknown factor", "did you mean 'friction'", GOOD | {"fricton": 0.3}),
    ("Load: unknown factor", "did you mean 'load'", GOOD | {"Load": 0.3}),
    ("materal: unknown factor", "did you mean 'material'", GOOD | {"materal": 0.3}),
    ("fraction: unknown factor", "did you mean 'friction'", GOOD | {"fraction": 0.3}),
    ("xyz: unknown factor", "known are", GOOD | {"xyz": 0.3}),
    ("material: 'BaTio3' is unknown", "did you mean 'BaTiO3'", GOOD | {"material": "BaTio3"}),
    ("material: 'PZT4' is unknown", "did you mean 'PZT-4'", GOOD | {"material": "PZT4"}),
    ("material: 'stel' is unknown", "did you mean 'steel'", GOOD | {"material": ["BaTiO3", "stel"]}),
    *(("material: ", str(value), GOOD | {"material": value}) for value in (3, None, 2.5)),
    *((f"{name}: 'fibros' is not one of", "", MIXED | {name: "fibros"}) for name in CHOSEN),
    *((f"{name}: ", "3", MIXED | {name: 3}) for name in CHOSEN),
    ("profile: ", "3", GOOD | {"profile": np.array(["cylinder", 3], dtype=object)}),
    # what must be given, what may not be together
    ("radius: missing", "", {"material": "BaTiO3", "load": 1e5}),
    ("load: missing", "", {"material": "BaTiO3", "radius": 0.05}),
    ("material: missing", "volume_fraction", {"radius": 0.05, "load": 1e5}),
    ("volume_fraction", "", {"radius": 0.05, "load": 1e5, "composite": "laminate"}),
    ("material: ", "not both", GOOD | {"volume_fraction": 0.5}),
    ("material: ", "not both", GOOD | {"composite": "fibrous"}),
    ("factors: ", "case", GOOD | {"load": TWO, "radius": THREE}),
    ("factors: ", "case", GOOD | {"load": TWO.assign_coords(case=[0, 1]), "radius": TWO.assign_coords(case=[0, 2])}),
    ("", "position", GOOD | {"load": xr.DataArray([1e4, 1e5, 1e6], dims="position")}),
    ("", "load", GOOD | {"radius": xr.DataArray([0.1, 0.2], dims="load")}),
    # the limits of floating point
    *(("", "", GOOD | {name: 1e-320}) for name in POSITIVE),
    *(("", "", GOOD | {name: 1e300}) for name in ("friction", "charge", "magnetic_charge")),
]


@pytest.mark.parametrize(("message", "more", "factors"), SINGLE)
def test_refused(message: str, more: str, factors: dict[str, Any]) -> None:
    cases.refused(factors, message, more, positions=POSITIONS)


def test_unknown_variable_of_a_dataset() -> None:
    table = xr.Dataset({"radius": ("case", [0.1]), "lode": ("case", [1.0])}).assign(material="steel")
    with pytest.raises(solver.FactorError, match="lode: unknown factor; did you mean 'load'"):
        solver.solve(table)


def test_names_of_phases_and_own_materials_are_told() -> None:
    refused(MIXED, "'stel' is unknown", phases=("steel", "stel"))
    mine = {"wood": solver.Material.isotropic(1e10, 0.3)}
    refused(GOOD | {"material": "wod"}, "did you mean 'wood'", materials=mine)


def test_what_is_no_value_is_quoted_by_its_beginning() -> None:
    """Above all the mapping of all materials in place of one, which is 9 kB of text."""
    everything = solver.materials()
    for factors in ({"material": everything}, {"profile": everything}, {"load": everything}, {"width": [everything]}):
        with pytest.raises(solver.FactorError) as caught:
            solver.solve(GOOD | factors)
        assert str(caught.value).startswith(f'{next(iter(factors))}: "{str(everything)[:20]}')
        assert len(str(caught.value)) < 200
    refused(GOOD | {"material": everything}, "give the name of one, or a Material")
    refused(MIXED, "phases: ", "give the name of one, or a Material", phases=("steel", 3))


@pytest.mark.parametrize("value", [-1.0, float("nan"), float("inf"), "fast"])
def test_impossible_speed(value: Any) -> None:
    refused(GOOD | {"speed": value}, "speed: ", value if isinstance(value, str) else f"{value:g}")


@pytest.mark.parametrize("phases", [("BaTiO3",), ("BaTiO3", "steel", "PZT-4"), ()])
def test_phases_are_two(phases: tuple[str, ...]) -> None:
    refused(MIXED, "phases: ", phases=phases)


@pytest.mark.parametrize("value", [1.0, -1.0, float("nan"), float("inf"), float("-inf")])
def test_positions_on_an_edge_or_nowhere(value: float) -> None:
    refused(GOOD, f"positions: {value:g} is not allowed", positions=[0.5, value])


@pytest.mark.parametrize("positions", [[], [[0.1, 0.2]], np.array(0.5)])
def test_positions_that_are_no_list(positions: Any) -> None:
    refused(GOOD, "positions: ", positions=positions)


@pytest.mark.parametrize("positions", [0.5, ["a"], "abc"])
def test_positions_that_are_no_numbers(positions: Any) -> None:
    refused(GOOD, "positions: ", positions=positions)


@pytest.mark.parametrize("value", [1e-150, 1e150])
@pytest.mark.parametrize("name", POSITIVE)
def test_far_beyond_every_useful_range(name: str, value: float) -> None:
    with suppress(solver.FactorError):
        assert_finite(solver.solve(GOOD | {"friction": 0.3, "charge": 1e-6} | {name: value}, POSITIONS))


def test_positions_beyond_every_scale() -> None:
    with suppress(solver.FactorError):
        assert_finite(solver.solve(GOOD | {"friction": 0.3, "charge": 1e-6}, [-1e200, 1e160, 1e308]))


def test_a_contact_as_wide_as_the_datum_has_no_sensitivity_per_charge() -> None:
    datum = solver.solve(GOOD).contact_trailing.item() / 2
    refused(GOOD | {"datum": datum}, "charge_per_force", "datum")
