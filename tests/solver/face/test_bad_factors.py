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


def refused(factors: dict[str, Any], *words: str, positions: Any = POSITIONS, **options: Any) -> None:
    cases.refused(factors, "", *words, positions=positions, **options)


def case(name: str) -> dict[str, Any]:
    return MIXED if name == "volume_fraction" else GOOD


# --- numbers ---


@pytest.mark.parametrize("value", [float("nan"), float("inf"), float("-inf")])
@pytest.mark.parametrize("name", NUMBERS)
def test_not_finite(name: str, value: float) -> None:
    refused(case(name) | {name: value}, f"{name}: {value:g} is not", "finite")


@pytest.mark.parametrize("value", [0.0, -0.0, -1e-300, -1.0])
@pytest.mark.parametrize("name", POSITIVE)
def test_not_positive(name: str, value: float) -> None:
    refused(GOOD | {name: value}, f"{name}: {value:g} is not", "> 0")


def test_negative_friction() -> None:
    refused(GOOD | {"friction": -0.3}, "friction: -0.3 is not", ">= 0")


@pytest.mark.parametrize("value", [-0.01, 1.01])
@pytest.mark.parametrize("composite", ["fibrous", "laminate"])
def test_fraction_outside_zero_to_one(composite: str, value: float) -> None:
    refused(MIXED | {"composite": composite, "volume_fraction": value}, f"volume_fraction: {value} is not", "0", "1")


@pytest.mark.parametrize("value", ["half", "", [1.0, "half"], {"a": 1}])
@pytest.mark.parametrize("name", NUMBERS)
def test_not_a_number(name: str, value: Any) -> None:
    refused(case(name) | {name: value}, f"{name}: ", "is not")


def test_the_value_at_fault_is_named_among_good_ones() -> None:
    refused(GOOD | {"load": [1e3, 1e4, -7.0, 1e5]}, "load: -7 is not")
    refused(GOOD | {"friction": np.array([0.1, np.nan])}, "friction: nan is not")
    refused(GOOD | {"radius": xr.DataArray([[0.1, 0.2], [0.3, 0.0]], dims=("a", "b"))}, "radius: 0 is not")
    refused(MIXED | {"volume_fraction": [0.0, 1.0, 1.5]}, "volume_fraction: 1.5 is not")


def test_the_text_at_fault_is_named_among_good_ones() -> None:
    refused(GOOD | {"load": [1e3, "heavy"]}, "load: 'heavy' is not")


def test_complex_numbers() -> None:
    refused(GOOD | {"load": 1e5 + 1j}, "load: ")


def test_a_ragged_list() -> None:
    refused(GOOD | {"load": [1e3, [1e4, 1e5]]}, "load: ")


def test_a_number_beyond_floating_point() -> None:
    refused(GOOD | {"load": 10**400}, "load: ")


def test_a_plain_array_of_two_dimensions() -> None:
    refused(GOOD | {"load": [[1e3, 1e4]]}, "load: ", "2 dimensions")


# --- names ---


@pytest.mark.parametrize(
    ("given", "meant"), [("fricton", "friction"), ("Load", "load"), ("materal", "material"), ("fraction", "friction")]
)
def test_unknown_factor(given: str, meant: str) -> None:
    refused(GOOD | {given: 0.3}, f"{given}: unknown factor", f"did you mean '{meant}'")


def test_unknown_factor_far_from_any() -> None:
    refused(GOOD | {"xyz": 0.3}, "xyz: unknown factor", "known are", "radius", "volume_fraction")


def test_unknown_variable_of_a_dataset() -> None:
    table = xr.Dataset({"radius": ("case", [0.1]), "lode": ("case", [1.0])}).assign(material="steel")
    with pytest.raises(solver.FactorError, match="lode: unknown factor; did you mean 'load'"):
        solver.solve(table)


@pytest.mark.parametrize(("given", "meant"), [("BaTio3", "BaTiO3"), ("PZT4", "PZT-4"), ("stel", "steel")])
def test_unknown_material(given: str, meant: str) -> None:
    refused(GOOD | {"material": given}, f"material: '{given}' is unknown", f"did you mean '{meant}'")
    refused(GOOD | {"material": ["BaTiO3", given]}, f"material: '{given}' is unknown")
    refused(MIXED, f"'{given}' is unknown", phases=("steel", given))


def test_own_materials_are_among_those_suggested() -> None:
    mine = {"wood": solver.Material.isotropic(1e10, 0.3)}
    refused(GOOD | {"material": "wod"}, "did you mean 'wood'", materials=mine)


@pytest.mark.parametrize("value", [3, None, 2.5])
def test_material_that_is_no_name(value: Any) -> None:
    refused(GOOD | {"material": value}, "material: ", str(value))


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


@pytest.mark.parametrize("name", ["composite", "profile", "electric", "magnetic"])
def test_unknown_choice(name: str) -> None:
    refused(case("volume_fraction") | {name: "fibros"}, f"{name}: 'fibros' is not one of")
    refused(case("volume_fraction") | {name: 3}, f"{name}: ", "3")


def test_choices_of_mixed_types() -> None:
    refused(GOOD | {"profile": np.array(["cylinder", 3], dtype=object)}, "profile: ", "3")


@pytest.mark.parametrize("value", [-1.0, float("nan"), float("inf"), "fast"])
def test_impossible_speed(value: Any) -> None:
    refused(GOOD | {"speed": value}, "speed: ", value if isinstance(value, str) else f"{value:g}")


# --- what must be given, what may not be together ---


@pytest.mark.parametrize("name", ["radius", "load"])
def test_missing(name: str) -> None:
    refused({key: value for key, value in GOOD.items() if key != name}, f"{name}: missing")


def test_missing_material() -> None:
    refused({"radius": 0.05, "load": 1e5}, "material: missing", "volume_fraction")
    refused({"radius": 0.05, "load": 1e5, "composite": "laminate"}, "volume_fraction")


@pytest.mark.parametrize("extra", [{"volume_fraction": 0.5}, {"composite": "fibrous"}])
def test_both_material_and_composite(extra: dict[str, Any]) -> None:
    refused(GOOD | extra, "material: ", "not both")


@pytest.mark.parametrize("phases", [("BaTiO3",), ("BaTiO3", "steel", "PZT-4"), ()])
def test_phases_are_two(phases: tuple[str, ...]) -> None:
    refused(MIXED, "phases: ", phases=phases)


def test_dimensions_that_do_not_fit() -> None:
    two, three = xr.DataArray([1e4, 1e5], dims="case"), xr.DataArray([0.1, 0.2, 0.3], dims="case")
    refused(GOOD | {"load": two, "radius": three}, "factors: ", "case")
    labelled = [array.assign_coords(case=labels) for array, labels in ((two, [0, 1]), (0.1 * two, [0, 2]))]
    refused(GOOD | {"load": labelled[0], "radius": labelled[1]}, "factors: ", "case")


def test_a_dimension_named_position_beside_positions() -> None:
    refused(GOOD | {"load": xr.DataArray([1e4, 1e5, 1e6], dims="position")}, "position")


def test_a_dimension_named_as_another_factor() -> None:
    refused(GOOD | {"radius": xr.DataArray([0.1, 0.2], dims="load")}, "load")


# --- positions ---


@pytest.mark.parametrize("value", [1.0, -1.0, float("nan"), float("inf"), float("-inf")])
def test_positions_on_an_edge_or_nowhere(value: float) -> None:
    refused(GOOD, f"positions: {value:g} is not allowed", positions=[0.5, value])


@pytest.mark.parametrize("positions", [[], [[0.1, 0.2]], np.array(0.5)])
def test_positions_that_are_no_list(positions: Any) -> None:
    refused(GOOD, "positions: ", positions=positions)


@pytest.mark.parametrize("positions", [0.5, ["a"], "abc"])
def test_positions_that_are_no_numbers(positions: Any) -> None:
    refused(GOOD, "positions: ", positions=positions)


# --- the limits of floating point: an error or a number, never a NaN ---


@pytest.mark.parametrize(
    "extreme",
    [
        {"radius": 1e-320},
        {"load": 1e-320},
        {"friction": 1e300},
        {"charge": 1e300},
        {"datum": 1e-320},
        {"magnetic_charge": 1e300},
    ],
)
def test_overflow_is_refused(extreme: dict[str, float]) -> None:
    refused(GOOD | extreme)


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
    refused(GOOD | {"datum": datum}, "charge_sensitivity", "datum")
