"""Bad factors and phases of a half-plane: one line with the factor, its value and what is allowed; never a NaN."""

from contextlib import suppress
from typing import Any

import numpy as np
import pytest
import xarray as xr

import solver
from tests.solver.cases import assert_finite, refused

GOOD: dict[str, Any] = {"material": "BaTiO3", "radius": 0.05, "load": 1e5}
MIXED: dict[str, Any] = {"volume_fraction": 0.5, "radius": 0.05, "load": 1e5}
OPTIONAL = ("friction", "charge", "magnetic_charge", "datum")
POSITIVE = ("radius", "load", "datum")
POSITIONS = (-2.0, 0.3, 1.5)
CHOSEN = ("composite", "profile", "electric", "magnetic")
TWO, THREE = xr.DataArray([1e4, 1e5], dims="case"), xr.DataArray([0.1, 0.2, 0.3], dims="case")

#: Beginning of the message, further words of it, and the case.
SINGLE: list[tuple[str, str, dict[str, Any]]] = [
    # the value at fault among good ones
    ("friction: nan is not", "", GOOD | {"friction": np.array([0.1, np.nan])}),
    ("radius: 0 is not", "", GOOD | {"radius": xr.DataArray([[0.1, 0.2], [0.3, 0.0]], dims=("a", "b"))}),
    ("volume_fraction: 1.5 is not", "", MIXED | {"volume_fraction": [0.0, 1.0, 1.5]}),
    # names
    ("Load: unknown factor", "did you mean 'load'", GOOD | {"Load": 0.3}),
    ("materal: unknown factor", "did you mean 'material'", GOOD | {"materal": 0.3}),
    ("fraction: unknown factor", "did you mean 'friction'", GOOD | {"fraction": 0.3}),
    ("xyz: unknown factor", "known are", GOOD | {"xyz": 0.3}),
    ("material: 'BaTio3' is unknown", "did you mean 'BaTiO3'", GOOD | {"material": "BaTio3"}),
    ("material: 'stel' is unknown", "did you mean 'steel'", GOOD | {"material": ["BaTiO3", "stel"]}),
    *(("material: ", str(value), GOOD | {"material": value}) for value in (3, None, 2.5)),
    *((f"{name}: '{word}' is not one of", "", MIXED | {name: word}) for name in CHOSEN for word in ("fibros", "")),
    *((f"{name}: ", "3", MIXED | {name: 3}) for name in CHOSEN),
    ("profile: ", "3", GOOD | {"profile": np.array(["cylinder", 3], dtype=object)}),
    # what must be given, what may not be together
    ("material: missing", "volume_fraction", {"radius": 0.05, "load": 1e5}),
    ("volume_fraction", "", {"radius": 0.05, "load": 1e5, "composite": "laminate"}),
    ("material: ", "not both", GOOD | {"composite": "fibrous"}),
    ("factors: ", "case", GOOD | {"load": TWO, "radius": THREE}),
    ("factors: ", "case", GOOD | {"load": TWO.assign_coords(case=[0, 1]), "radius": TWO.assign_coords(case=[0, 2])}),
    ("", "position", GOOD | {"load": xr.DataArray([1e4, 1e5, 1e6], dims="position")}),
    ("", "load", GOOD | {"radius": xr.DataArray([0.1, 0.2], dims="load")}),
    *(
        ("volume_fraction: ", "0 and <= 1", MIXED | {"composite": name, "volume_fraction": value})
        for name in ("fibrous", "laminate")
        for value in (-0.01, 1.01)
    ),
    *(
        (f"{name}: {value:g} is not", "finite", GOOD | {name: value})
        for name in OPTIONAL
        for value in (np.nan, -np.inf)
    ),
    *((f"{name}: ", "is not", GOOD | {name: value}) for name in OPTIONAL for value in ("half", "", {"a": 1})),
    *(("speed: ", f"{value}", GOOD | {"speed": value}) for value in (np.nan, np.inf, "fast")),
    # the limits of floating point
    *(("", "", GOOD | {name: 1e-320}) for name in POSITIVE),
    *(("", "", GOOD | {name: 1e300}) for name in ("friction", "charge", "magnetic_charge")),
]


@pytest.mark.parametrize(("message", "words", "factors"), SINGLE)
def test_refused(message: str, words: str, factors: dict[str, Any]) -> None:
    refused(factors, message, words, positions=POSITIONS)


def test_bad_phases_and_unknown_names_of_the_caller_s_materials_are_refused() -> None:
    table = xr.Dataset({"radius": ("case", [0.1]), "lode": ("case", [1.0])}).assign(material="steel")
    refused(table, "lode: unknown factor; did you mean 'load'")
    refused(MIXED, "", "'stel' is unknown", phases=("steel", "stel"))
    refused(
        GOOD | {"material": "wod"}, "", "did you mean 'wood'", materials={"wood": solver.Material.isotropic(1e10, 0.3)}
    )
    for phases in (("BaTiO3",), ("BaTiO3", "steel", "PZT-4"), (), ("steel", 3)):
        refused(MIXED, "phases: ", phases=phases)


def test_a_wrong_value_is_quoted_by_its_beginning() -> None:
    """The mapping of all materials in place of one is 9 kB of text."""
    everything = solver.materials()
    for factors in ({"material": everything}, {"profile": everything}, {"load": everything}, {"width": [everything]}):
        with pytest.raises(solver.FactorError) as caught:
            solver.solve(GOOD | factors)
        assert str(caught.value).startswith(f'{next(iter(factors))}: "{str(everything)[:20]}')
        assert len(str(caught.value)) < 200
    refused(GOOD | {"material": everything}, "", "give the name of one, or a Material")


def test_values_far_beyond_every_useful_range_are_refused_or_give_finite_results() -> None:
    case = GOOD | {"friction": 0.3, "charge": 1e-6}
    for name in POSITIVE:
        for value in (1e-150, 1e150):
            with suppress(solver.FactorError):
                assert_finite(solver.solve(case | {name: value}, POSITIONS))
    with suppress(solver.FactorError):
        assert_finite(solver.solve(case, [-1e200, 1e160, 1e308]))
    refused(GOOD | {"datum": solver.solve(GOOD).contact_trailing.item() / 2}, "", "charge_per_force", "datum")
