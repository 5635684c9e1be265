"""The labelled face: names, dimensions, units, coordinates, and cases that do not see each other."""

import re
import warnings
from typing import Any

import numpy as np
import pytest
import xarray as xr

import solver
from solver.fields import FIELDS, INTERIOR, INTERIOR_ON_REQUEST
from solver.names import EVERY_QUANTITY
from tests.solver.cases import assert_same
from verification.cases import SIH_SONG

POSITIONS = (-2.0, -0.5, 0.9, 1.001)
#: Friction, both charges: nothing that depends on the datum does so by chance alone.
CASE_OF_DATUM: dict[str, Any] = {
    "volume_fraction": 0.67, "radius": 0.14, "load": 1e4, "friction": 0.4, "charge": 1e-7, "magnetic_charge": -1e-3
}  # fmt: skip
ONE = {"material": "BaTiO3", "radius": 0.05, "load": 1e5}


def test_scattered_cases_share_a_dimension() -> None:
    """A Dataset of cases, as read from a table: one dimension, factors paired."""
    table = xr.Dataset(
        {
            "material": ("case", ["BaTiO3", "steel", SIH_SONG]),
            "radius": ("case", [0.01, 0.05, 0.1]),
            "load": ("case", [1e3, 1e5, 1e4]),
            "friction": ("case", [0.0, 0.3, 0.6]),
            "charge": 1e-6,
        },
        coords={"case": [10, 20, 30]},
    )
    out = solver.solve(table, POSITIONS)
    assert out.depth.dims == ("case",)
    assert out.stress_xx.dims == ("case", "position")
    assert out.coords["material"].dims == ("case",)
    for i in range(3):
        row = table.isel(case=i)
        factors = {str(name): row[name].item() for name in row.data_vars}
        assert_same(out.isel(case=i), solver.solve(factors, POSITIONS))


def test_data_arrays_bring_their_own_dimensions_and_broadcast_with_sequences() -> None:
    loads = xr.DataArray([[1e3, 1e4, 1e5], [2e3, 2e4, 2e5]], dims=("machine", "step"))
    radius = xr.DataArray([0.01, 0.02], dims="machine")
    out = solver.solve({"material": "BaTiO3", "radius": radius, "load": loads, "friction": [0.1, 0.2]})
    assert set(out.depth.dims) == {"machine", "step", "friction"}
    single = solver.solve({"material": "BaTiO3", "radius": 0.02, "load": 2e4, "friction": 0.2})
    assert_same(out.isel(machine=1, step=1, friction=1), single)


@pytest.mark.parametrize("composite", ["fibrous", "laminate"])
def test_phases_by_name_and_by_material(composite: str) -> None:
    first, two = solver.find("PZT-4"), solver.find("steel")
    factors = {"composite": composite, "volume_fraction": [0.2, 0.6], "radius": 0.05, "load": 1e5, "friction": 0.2}
    mix = {"fibrous": solver.fibrous, "laminate": solver.laminate}[composite]
    by_name = solver.solve(factors, POSITIONS, phases=("PZT-4", "steel"))
    by_material = solver.solve(factors, POSITIONS, phases=(first, two))
    alone = solver.solve(factors, POSITIONS, phases=("mine", "steel"), materials={"mine": first})
    assert_same(by_name, by_material, rtol=0)
    assert_same(by_name, alone, rtol=0)
    for i, fraction in enumerate((0.2, 0.6)):
        case = {"material": mix(first, two, fraction), "radius": 0.05, "load": 1e5, "friction": 0.2}
        assert_same(by_name.isel(volume_fraction=i), solver.solve(case, POSITIONS))


def test_own_materials_by_object_and_by_name() -> None:
    mine = solver.Material.isotropic(70e9, 0.3, name="aluminium")
    by_object = solver.solve({**ONE, "material": mine}, POSITIONS)
    by_name = solver.solve({**ONE, "material": "light"}, POSITIONS, materials={"light": mine})
    pair = solver.solve({**ONE, "material": ["steel", mine]}, POSITIONS)
    assert by_object.coords["material"].item() == "aluminium"
    assert by_name.coords["material"].item() == "light"
    assert list(pair.coords["material"].values) == ["steel", "aluminium"]
    assert_same(by_object, by_name, rtol=0)
    assert_same(pair.isel(material=1), by_object)


def test_what_is_marked_as_hanging_on_the_datum_is_what_changes_with_it() -> None:
    case = {**CASE_OF_DATUM, "datum": [0.01, 1.0, 10.0]}
    of_surface = solver.solve(case, POSITIONS, peaks=True)
    of_body = solver.solve_interior(case, [0.0, 0.5], [-0.5], fields=[*INTERIOR, *INTERIOR_ON_REQUEST])
    for out, known in ((of_surface, EVERY_QUANTITY | FIELDS), (of_body, INTERIOR | INTERIOR_ON_REQUEST)):
        changed = set()
        for name, array in out.data_vars.items():
            values = array.transpose("datum", ...).values.reshape(3, -1)
            if np.any(np.ptp(values, axis=0) > 1e-9 * np.abs(values).max()):
                changed.add(name)
        assert changed == {name for name, quantity in known.items() if quantity.on_datum}
        assert set(out.data_vars) == set(known)


@pytest.mark.parametrize(
    ("datum", "expected"),
    [({}, "1 m, the default"), ({"datum": 0.25}, "0.25 m"), ({"datum": [0.1, 1.0]}, "that of the coordinate datum")],
)
def test_what_hangs_on_the_datum_says_which_one_it_has(datum: dict[str, Any], expected: str) -> None:
    case = CASE_OF_DATUM | datum
    voltage = solver.solve(case)["voltage"]
    assert voltage.attrs["comment"].endswith(f"datum: {expected}")
    inside = solver.solve_interior(case, [0.0], [-1.0], fields=["electric_potential", "stress_xx"])
    assert inside["electric_potential"].attrs["comment"] == voltage.attrs["comment"]
    assert "comment" not in inside["stress_xx"].attrs
    assert "just inside" in solver.solve(case)["trailing_tension"].attrs["comment"]


@pytest.mark.parametrize(
    ("case", "words"),
    [
        ({"profile": "sphere", "radius": 1e-3, "force": [1.0, 1e5]}, "in 1 of 2 cases, at worst a half-width of"),
        ({"radius": 1e-3, "load": 1e8}, "strain: a half-width of 0.00122 m is 1.2 of the punch radius 0.001 m"),
        (
            {"thickness": 1e-4, "base": "rigid", "profile": "flat", "width": 1e-4, "load": 4e6},
            "0.22 of the thickness",
        ),
        ({"thickness": 1e-4, "base": "steel", "profile": "sphere", "radius": 0.1, "force": 2e4}, ""),
        ({"radius": 0.05, "load": 1e5}, ""),
    ],
)
def test_contacts_beyond_small_strain_are_told_with_both_numbers(case: dict[str, Any], words: str) -> None:
    """The depth of a film on a base as soft as it is the base's, not a strain of the film."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        answer = solver.solve({"material": "PZT-4", "surroundings": "insulated"} | case)
    assert [warning.category for warning in caught] == [solver.SmallStrainWarning] * bool(words)
    assert all(re.search(words, str(warning.message)) for warning in caught)
    if case.get("base") == "steel":
        assert float(answer["depth"]) > 0.1 * float(answer["thickness"])
