"""The contract of every kind of body: shapes, units, cases, refusals, tangents, reciprocity and similarity."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import xarray as xr

import solver
from solver.body import KINDS, Kind, airless, kind_of
from solver.curves import SIZES
from solver.fields import EVERY_FIELD, EVERY_INTERIOR
from solver.material.constants import ANY_SIZE, UNITS
from solver.names import ALL_QUANTITIES, HEAT_QUANTITIES
from solver.similarity import QUANTITY_WEIGHTS, scale_powers, weight_of
from tests.refusals import assert_refused
from tests.solver.cases import PZT, assert_alike, refused, without
from verification.cases import constants

Case = dict[str, Any]
X, Y = [-1.4, -0.5, 0.3, 2.0], [-0.2, -3.0]
LINE: Case = {"material": "PZT-4", "radius": 0.05, "load": 2e4, "magnetic": "insulating"}
BALL: Case = LINE | {"profile": "sphere", "radius": 5e-3, "force": 10.0}
del BALL["load"]
COAT: Case = {"thickness": 2e-4, "base": "steel"}
BARE, AIR = {"surroundings": "insulated"}, {"surroundings": "air"}
BODIES: dict[str, Case] = {
    "half-plane": LINE,
    "half-plane, air": LINE | AIR,
    "film": LINE | COAT | BARE,
    "film, air": LINE | COAT | AIR,
    "half-space": BALL,
    "half-space, air": BALL | AIR | {"gap_radius": 5e-3},
    "point film": BALL | COAT | BARE,
    "point film, air": BALL | COAT | AIR | {"gap_radius": 5e-3},
}
LAMINATE: Case = {"composite": "laminate", "volume_fraction": 0.4, "magnetic": "conducting"}
#: Bodies of further options, for what no option may change: a composite, friction, other punches, speed, a stack.
VARIANTS = BODIES | {
    "composite": without(LINE, "material") | LAMINATE | {"friction": 0.3},
    "wedge": without(LINE, "radius") | {"profile": "wedge", "slope": 2e-3},
    "elastic punch": LINE | COAT | BARE | {"punch": "steel", "friction": 0.2},
    "moving": LINE | {"speed": 900.0},
    "tilted by a moment": without(LINE, "radius") | {"profile": "flat", "width": 1e-3, "moment": 0.4, "friction": 0.2},
    "sliding ball": BALL | COAT | BARE | {"friction": 0.2},
}
each_body = pytest.mark.parametrize("case", BODIES.values(), ids=BODIES)
each_variant = pytest.mark.parametrize("case", VARIANTS.values(), ids=VARIANTS)


def kind(case: Case) -> Kind:
    return kind_of(case, case.get("profile", "cylinder"), case.get("surroundings", "insulated"))


def pressing(case: Case) -> tuple[str, str]:
    """Names of the factors that press and charge the punch."""
    return kind(case).loads.force, kind(case).loads.charges[0]


def test_every_kind_of_body_is_here() -> None:
    """Contacts in space, which have no fields inside, have their own tests."""
    assert {kind(case).name for case in BODIES.values()} == {k.name for k in KINDS.values() if not k.space}


@each_variant
def test_names_units_dimensions_and_numbers(case: Case) -> None:
    force, _ = pressing(case)
    out = solver.solve(case | {force: [case[force], 1.2 * case[force]]}, X, regular=True)
    assert all(np.isfinite(values).all() for values in out.data_vars.values())
    known = kind(case).every_quantity | dict(kind(case).fields)
    assert "peak_von_mises" not in out
    assert not set(kind(case).fields) & set(solver.solve(case))
    for name, values in out.data_vars.items():
        described = known[str(name).removesuffix("_regular")]
        assert values.attrs["long_name"]
        assert values.dtype == np.float64
        assert values.dims == (
            (force, "position") if str(name) in kind(case).fields or "_reg" in str(name) else (force,)
        )
        if name in known:
            assert values.attrs["units"] == described.units, name
        else:
            root = np.sqrt(np.abs(1 - np.square(X)))
            np.testing.assert_allclose(values, out[str(name).removesuffix("_regular")] * root, rtol=1e-11, atol=1e-300)
    assert out.attrs["source"].startswith("meecontact")
    assert out.coords[force].attrs["units"] == ("N m-1" if force == "load" else "N")


@each_body
def test_a_body_answers_the_quantities_of_its_kind(case: Case) -> None:
    """Heat's follow from a solved contact; films without air have an electrode, read by a patch."""
    options = {"magnetic": "conducting"} | ({} if "load" in case else {"friction": 0.0})
    if "thickness" in case and "air" not in case.values():
        options |= {"collector": 1, "patch_size": 1e-4, "patch_pitch": 2e-4}
    assert set(solver.solve(case | options)) == kind(case).quantities.keys() - HEAT_QUANTITIES.keys()
    assert (airless(case | options) == "") == ("collector" not in options)


@each_variant
def test_cases_together_are_the_cases_alone_in_any_order_and_leave_their_input(case: Case) -> None:
    force, charge = pressing(case)
    charges = np.array([0.0, 1e-11 * case[force]])
    forces = [1.1 * case[force]] if "air" in case.values() else [case[force], 1.1 * case[force]]  # air takes long
    table = case | {force: forces, charge: charges}
    whole, inside = solver.solve(table, X), solver.solve_interior(table, X, Y)
    assert whole["depth"].dims == (force, charge)
    if "air" not in case.values():
        turned = solver.solve(dict(reversed(table.items())), X)
        assert turned["depth"].dims == (charge, force)
        assert_alike(turned.transpose(*whole.dims), whole, 1e-12)
    assert charges.tolist() == [0.0, 1e-11 * case[force]]
    single = case | {force: forces[-1], charge: charges[1]}
    assert_alike(whole.isel({force: -1, charge: 1}), solver.solve(single, X), 1e-9)
    assert_alike(inside.isel({force: -1, charge: 1}), solver.solve_interior(single, X, Y), 1e-8)


@each_variant
def test_at_an_edge_only_what_a_smooth_punch_presses_with_has_a_value(case: Case) -> None:
    """Limit 0 from both sides, against places from which it goes with the root of the distance; else NaN."""
    solution, near = solver.solve(case, [-1.0, X[1], 1.0]), solver.solve(case, [-1 + 1e-4, X[1], 1 - 1e-4])
    for name in kind(case).fields:
        if name not in solution:
            continue
        values, nearby = solution[name].values.ravel(), near[name].values.ravel()
        assert values[1] == pytest.approx(nearby[1], rel=1e-9, abs=1e-300)
        if name == "contact_pressure":
            vanishing = np.where(np.abs(nearby[[0, 2]]) < 0.05 * nearby[1], 0.0, np.nan)
        expected = vanishing if name in ("contact_pressure", "shear_traction") else [np.nan, np.nan]
        np.testing.assert_array_equal(values[[0, 2]], expected, err_msg=name)
    grid = [1.0, X[2]], [0.0, Y[0]]
    inside, plain = solver.solve_interior(case, *grid), solver.solve_interior(case, grid[0], [Y[0]])
    for field, array in inside.data_vars.items():
        table = array.values.reshape(2, 2)
        assert np.isnan(table).tolist() == [[True, False], [False, False]]
        np.testing.assert_allclose(table[1], plain[field].values.ravel(), rtol=1e-9)


#: Wrong values of a radius or a force, and the words of their refusal.
NUMBERS: tuple[tuple[object, str], ...] = (
    (float("nan"), "nan is not"), (float("-inf"), "-inf is not"), (0.0, "0 is not"), (-1.0, "-1 is not"),
    ("half", "'half' is not"), ([1.0, "half"], "'half' is not"), ([1.0, -7.0], "-7 is not"), (1j, ""), (10**400, ""),
    ([1.0, [1.0, 2.0]], ""), ([[1.0, 2.0]], "2 dimensions"), ({"a": 1}, "is not"), (np.ma.masked, "nan"),
)  # fmt: skip


@each_body
def test_bad_factors_and_positions_are_refused_in_one_line(case: Case) -> None:
    force, charge = pressing(case)
    for name in ("radius", force):
        for value, words in NUMBERS:
            refused(case | {name: value}, f"{name}: ", words)
        refused(without(case, name), f"{name}: missing")
    for name, value, words in (
        (charge, np.inf, "inf is not"), ("friction", -0.1, "-0.1 is not"), ("speed", -1.0, "-1"),
        ("fricton", 0.3, "did you mean 'friction'"), ("material", "PZT4", "did you mean 'PZT-4'"),
        ("material", 3, "3"), ("profile", "sphera", "is not one of"), ("electric", "fibros", "is not one of"),
        ("volume_fraction", 0.5, "not both"), (charge, [0.0, 1e-9], f"^{charge}: 1e-09 .*electric insulating"),
    ):  # fmt: skip
        insulating = {"electric": "insulating", "magnetic": "conducting"} if name == charge else {}
        with pytest.raises((solver.FactorError, solver.MaterialError), match=words):
            solver.solve(case | insulating | {name: value})
    for positions in ([np.nan], [np.inf], [], [[0.1, 0.2]], 0.5, ["a"], "abc"):
        refused(case, "positions: ", positions=positions)
    for x, y, fields, words in (
        ([0.0], [0.1], None, "^y: 0.1 is above the surface"),
        ([np.nan], [-1.0], None, "^x: nan"), ([], [-1.0], None, "^x: not a list"),
        ([0.0], [-1.0], ["stress"], "^fields: 'stress' is not one of stress_xx"),
    ):  # fmt: skip
        assert_refused(solver.FactorError, words, solver.solve_interior, case, x, y, fields=fields)
    assert_refused(solver.FactorError, "peaks: 'shear' is not one of", solver.solve, case, peaks=["shear"])


def slope(answer: Callable[[float], xr.Dataset], step: float) -> xr.Dataset:
    """Derivative at 0 by central differences, to the fourth order of the step."""
    near, far = ((answer(k * step) - answer(-k * step)) / (2 * k * step) for k in (1, 2))
    return (4 * near - far) / 3


@each_variant
def test_tangents_are_differences_and_the_charge_per_force_leaves_no_voltage(case: Case) -> None:
    force, charge = pressing(case)
    per, size = force if force == "load" else "force", case[force]
    result = solver.solve(case)
    by_force = slope(lambda step: solver.solve(case | {force: size + step}), 1e-3 * size)
    unit = abs(float(result["charge_per_force"])) * size
    by_charge = slope(lambda step: solver.solve(case | {charge: step}), 1e-3 * unit)
    assert float(result[f"voltage_per_{per}"]) == pytest.approx(float(by_force["voltage"]), rel=1e-6)
    assert float(result["stroke_per_volt"]) == pytest.approx(float(by_charge["depth"] / by_charge["voltage"]), rel=1e-6)
    determinant = by_force["depth"] * by_charge["voltage"] - by_charge["depth"] * by_force["voltage"]
    blocked = float(-by_charge["depth"] / determinant)
    assert float(result[f"blocked_{per}_per_volt"]) == pytest.approx(blocked, rel=1e-5)
    held = solver.solve(case | {charge: float(result["charge_per_force"]) * size})
    assert abs(float(held["voltage"])) < 1e-6 * abs(float(result["voltage"]))


def scaled(case: Case, size: float, strength: float) -> Case:
    """The similar case: each number times its powers of size and strength; a gap's permittivity by the strength."""
    numbers = {name: value for name, value in case.items() if isinstance(value, float) and name != "volume_fraction"}
    weights = {name: weight_of(name) for name in numbers if name not in ("friction", "speed")}
    similar = {name: numbers[name] * size**power.size * strength**power.strength for name, power in weights.items()}
    return case | similar | ({"gap_permittivity": strength} if case.get("surroundings") == "air" else {})


@each_variant
def test_similar_cases_have_similar_answers(case: Case) -> None:
    """Random factors; the stiffness of an elastic punch does not scale, so that only its lengths do."""
    size, strength = 2.0 ** np.random.default_rng(len(case)).uniform(-1, 1, 2)
    if case.get("punch") == "steel":
        strength = 1.0
    case = case | ({"datum": 0.3} if "load" in case else {})
    first, other = (solver.solve(similar, X) for similar in (case, scaled(case, size, strength)))
    assert set(first) == set(other)
    for name, values in first.data_vars.items():
        power = QUANTITY_WEIGHTS[str(name)]
        expected = values.values * size**power.size * strength**power.strength
        np.testing.assert_allclose(other[name], expected, rtol=0, atol=1e-6 * np.abs(expected).max(), err_msg=str(name))


COUPLINGS = {"e31": "f31", "e33": "f33", "e15": "f15"}
EXCHANGED = COUPLINGS | {"eps11": "mu11", "eps33": "mu33"}
#: Parts of a name, and what they become when electric and magnetic fields change places.
PARTNERS = (
    ("voltage", "magnetic_potential"), ("electric_displacement", "magnetic_induction"), ("electric", "magnetic"),
    ("charge", "flux"), ("volt", "ampere"), ("capacitance", "permeance"),
)  # fmt: skip


def partner(name: str) -> str:
    """Name of the same quantity or constant of the other field."""
    for first, other in PARTNERS:
        for old, new in ((first, other), (other, first)):
            if old in name:
                return name.replace(old, new)
    return name


@pytest.mark.parametrize("name", ["half-plane", "film", "half-space", "point film"])
def test_reversed_poling_reverses_the_fields_and_electric_and_magnetic_ones_may_change_places(name: str) -> None:
    charges = kind(BODIES[name]).loads.charges
    case = BODIES[name] | {"magnetic": "conducting"} | ({"base": "rigid"} if "film" in name else {})
    case |= {"friction": 0.3} if "load" in case else {}
    mix = solver.find("BaTiO3-CoFe2O4 50:50")
    entries: Case = {constant: getattr(mix, constant) for constant in UNITS}

    def solved(change: Case, T: float, J: float) -> xr.Dataset:
        material = solver.Material(**entries | change, name="image", any_size=ANY_SIZE)
        return solver.solve(case | {"material": material, charges[0]: T, charges[1]: J}, X)

    T, J = (share * case[pressing(case)[0]] for share in (1e-11, -1e-8))
    plain = solved({}, T, J)
    swapped = {**EXCHANGED, **{other: first for first, other in EXCHANGED.items()}}
    poled = solved({constant: -entries[constant] for pair in COUPLINGS.items() for constant in pair}, -T, -J)
    exchanged = solved({constant: entries[other] for constant, other in swapped.items()}, J, T)
    for quantity, values in plain.data_vars.items():
        size = 1e-9 * float(np.abs(values).max())
        odd = {unit.rstrip("-0123456789/") for unit in values.attrs["units"].split()} & {"V", "A", "C", "T", "Wb"}
        sign = -1 if len(odd) % 2 and quantity != "nominal_field" else 1
        np.testing.assert_allclose(poled[quantity], sign * values, rtol=0, atol=size, err_msg=str(quantity))
        if (other := partner(str(quantity))) in exchanged and quantity != "nominal_field":
            np.testing.assert_allclose(exchanged[other], values, rtol=0, atol=size, err_msg=other)


def test_every_name_has_its_powers() -> None:
    assert set(QUANTITY_WEIGHTS) == {*ALL_QUANTITIES, *EVERY_FIELD, *EVERY_INTERIOR, *SIZES}
    assert_refused(ValueError, "'load' and 'charge' scale alike", scale_powers, "depth", "load", "charge")
    assert_refused(ValueError, "'temperature' has no known powers", scale_powers, "temperature", "load", "radius")


@each_body
def test_fields_inside_meet_those_on_the_surface(case: Case) -> None:
    names = ["stress_yy", "stress_xx", "stress_zz", "electric_potential"]
    inside = solver.solve_interior(case, X, [0.0], fields=names)
    surface = solver.solve(case, X)
    pairs = {"stress_xx": "stress_xx"} if "load" in case else {"radial_stress": "stress_xx", "hoop_stress": "stress_zz"}
    for name, other in pairs.items():
        along = surface[name].values
        np.testing.assert_allclose(inside[other][0], along, rtol=0, atol=1e-9 * np.abs(along).max())
    pressure = surface["contact_pressure"].values
    np.testing.assert_allclose(-inside["stress_yy"][0], pressure, rtol=0, atol=1e-9 * pressure.max())
    np.testing.assert_allclose(inside["electric_potential"][0, 1:3], surface["voltage"], rtol=1e-6)


@each_body
def test_only_what_needs_c12_is_left_out_or_refused_without_it(case: Case) -> None:
    mine = {"name": "mine", **without(constants(PZT), "c12")}
    lacking = case | {"material": solver.Material.from_mapping(mine)}
    assert not {"stress_zz", "von_mises"} & set(solver.solve_interior(lacking, X, Y))
    with pytest.raises(solver.MaterialError, match=r"^mine: c12: missing; von_mises needs it"):
        solver.solve_interior(lacking, X, Y, fields=["von_mises"])
    assert_refused(solver.MaterialError, r"c12: missing; .* need", solver.solve, lacking, peaks=True)
