"""Films through the face: figures found by other methods, stacks and gradings by two ways to one number."""

from typing import Any

import numpy as np
import pytest
import xarray as xr

import solver
from solver.names import ALL_PEAKS, FILM_PEAKS, FILM_QUANTITIES, QUANTITIES
from tests.solver.cases import assert_alike
from tests.solver.line.films import BTO, CFO, STEEL

FILM: dict[str, Any] = {
    "material": "BaTiO3", "thickness": 0.5e-3, "surroundings": "insulated", "base": "rigid", "radius": 0.05,
    "load": 1e5,
}  # fmt: skip
MIX: dict[str, Any] = {
    "volume_fraction": 0.5, "thickness": 0.2e-3, "radius": 0.05, "friction": 0.3, "load": 1e5,
    "surroundings": "insulated",
}  # fmt: skip
POSITIONS = (-1.2, -0.5, 0.0, 0.5, 1.2)
_VECTORS: dict[str, slice | list[int]] = {
    "contact_pressure": slice(1, 4),
    "electric_displacement_y": slice(1, 4),
    "magnetic_induction_y": slice(1, 4),
    "stress_xx": [4, 0],
}
_SCALARS = (
    "contact_trailing", "contact_leading", "depth", "voltage", "magnetic_potential",
    "electric_edge_intensity_trailing", "electric_edge_intensity_leading",
    "magnetic_edge_intensity_trailing", "magnetic_edge_intensity_leading",
)  # fmt: skip

#: Theory of films, section 9: factors; the scalars above; p, D_y, B_y at X = -0.5, 0, 0.5; sigma_xx at X = 1.2, -1.2.
FIGURES: dict[str, tuple[dict[str, Any], tuple[float, ...], tuple[float, ...]]] = {
    "BaTiO3 on rigid": (
        FILM,
        (2.103852975e-04, 2.103852975e-04, 6.959044108e-07, -5.393112137e02, 0.0,
         6.164540932e-04, 6.164540932e-04, 0.0, 0.0),
        (2.620449157e08, 3.033895065e08, 2.620449157e08, -1.384260933e-02, -2.405493644e-02, -1.384260933e-02,
         0.0, 0.0, 0.0, 6.549891077e07, 6.549891077e07),
    ),
    "fibrous on rigid": (
        MIX | {"base": "rigid", "charge": 2e-5, "magnetic_charge": 1e-2},
        (1.741186380e-04, 1.750310824e-04, 4.900432047e-07, 1.082552282e03, 3.756287613e01,
         -3.643389579e-04, -3.499955974e-04, -3.971580532e-01, -3.965508806e-01),
        (3.116981669e08, 3.767103051e08, 3.179218122e08, -5.408774763e-02, -5.833231139e-02, -5.521730464e-02,
         -2.177424521e01, -1.956580057e01, -2.181913629e01, 1.555208861e08, -2.764407038e07),
    ),
    "fibrous on steel": (
        MIX | {"base": "steel", "interface_magnetic": "grounded", "datum": 0.2e-3},
        (2.003603865e-04, 1.857207118e-04, 4.444201344e-07, -2.715383908e02, -5.303018923e-01,
         6.379179498e-05, 9.308101282e-05, 6.050401959e-03, 6.063045377e-03),
        (2.801686084e08, 3.312695878e08, 2.905574954e08, -6.404062368e-04, -4.426843698e-03, -3.044442030e-03,
         -1.272829867e-01, -2.468574397e-01, -1.563876997e-01, 1.134370442e08, -9.345979507e07),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", FIGURES)
def test_published_figures_are_hit(name: str) -> None:
    factors, scalars, fields = FIGURES[name]
    out = solver.solve(factors, POSITIONS)
    np.testing.assert_allclose([float(out[key]) for key in _SCALARS], scalars, rtol=1e-8)
    index = np.concatenate([out[key].values[index] for key, index in _VECTORS.items()])
    np.testing.assert_allclose(index, fields, rtol=1e-8)


#: Section 9: a/h at zero volts, then P R/a^2 [Pa] and charge/load [pC/N] of PZT-4 and of BaTiO3, depth R/a^2 of PZT-4.
SHORT_CIRCUIT = {
    0.05: ((6.765708e10, 217.0654), (1.016044e11, 154.2390), 1.836732),
    0.5: ((7.708279e10, 183.3418), (1.177911e11, 137.9928), 0.810513),
    2.0: ((1.655475e11, 148.7037), (2.550877e11, 121.8530), 0.545221),
    10.0: ((7.66574e11, 132.654), (1.112011e12, 115.329), 0.501589),
}


def test_table_of_short_circuited_films_is_hit_to_every_digit() -> None:
    thickness, radius = 2e-4, 0.05
    half = np.array(list(SHORT_CIRCUIT)) * thickness
    for number, material in enumerate(("PZT-4", "BaTiO3")):
        stiffness, expected = np.array([row[number] for row in SHORT_CIRCUIT.values()]).T
        load = stiffness * half**2 / radius
        film = FILM | {"material": material, "thickness": thickness, "load": xr.DataArray(load, dims="case")}
        computed = solver.solve(film)["charge_per_force"].values * 1e12
        assert np.all(np.abs(computed - expected) < [6e-5, 6e-5, 6e-5, 6e-4])
        held = solver.solve(film | {"charge": xr.DataArray(computed * 1e-12 * load, dims="case")})
        np.testing.assert_allclose(held["contact_trailing"], half, rtol=1e-6)
        if material == "PZT-4":
            depth = [row[2] for row in SHORT_CIRCUIT.values()]
            np.testing.assert_allclose(held["depth"] * radius / half**2, depth, atol=6e-7)


def test_peaks_of_film_and_interface() -> None:
    out = solver.solve(FILM, peaks=True)
    assert set(FILM_PEAKS) - set(out.data_vars) == {"base_peak_von_mises", "base_peak_principal_tension"}
    assert float(out["interface_shear"]) > 3.3e7  # section 9, at X = 1
    assert abs(float(out["interface_shear_position"])) > 0.6
    assert float(out["film_peak_von_mises"]) > 1.829406836e08  # section 9, at half the thickness
    part = solver.solve(FILM, peaks=["interface_tension", "peak_von_mises"])  # a half-plane's: no film has it
    assert set(part.data_vars) & set(ALL_PEAKS) == {"interface_tension"}
    assert float(part["interface_tension"]) == float(out["interface_tension"])
    half = solver.solve({"material": "BaTiO3", "radius": 0.05, "load": 1e4}, peaks=["peak_von_mises_depth"])
    assert set(half.data_vars) & set(ALL_PEAKS) == {"peak_von_mises_depth"}
    with pytest.raises(solver.FactorError, match="peaks: 'shear' is unknown; known are peak_von_mises"):
        solver.solve(FILM, peaks=["shear"])


#: Theory of films, section 9, half way down at X = 0: sigma_xx, sigma_yy, D_y, von Mises; on the base at X = 0 and 1:
#: sigma_xy, sigma_yy.
INSIDE = {
    "BaTiO3 on rigid": (
        (-6.545137408e05, -2.051132126e08, -1.330565069e-02, 1.829406836e08),
        (0.0, 3.299573303e07), (-1.446113727e08, -1.059483710e08),
    ),
    "fibrous on rigid": (
        (-9.114078814e07, -3.431055653e08, -5.824930730e-02, 2.364533602e08),
        (-2.839180515e07, 6.210199417e07), (-2.792505284e08, -9.112992695e07),
    ),
    "fibrous on steel": (
        (-1.053084797e08, -2.981709574e08, -4.356648744e-03, 1.904045604e08),
        (-1.539243427e07, 5.320606955e07), (-2.376930566e08, -9.673632142e07),
    ),
}  # fmt: skip
_HALF_WAY = ("stress_xx", "stress_yy", "electric_displacement_y", "von_mises")


@pytest.mark.parametrize("name", INSIDE)
def test_published_figures_inside_are_hit(name: str) -> None:
    factors, (half_way, shear, normal) = FIGURES[name][0], INSIDE[name]
    out = solver.solve(factors)
    depth = factors["thickness"] / float(out["contact_trailing"] + out["contact_leading"]) * 2
    computed = solver.solve_interior(factors, [0.0, 1.0], [-depth / 2, -depth], fields=[*_HALF_WAY, "stress_xy"])
    np.testing.assert_allclose([float(computed[key][0, 0]) for key in _HALF_WAY], half_way, rtol=1e-9)
    np.testing.assert_allclose(computed["stress_xy"][1], shear, rtol=1e-9, atol=1e-3)
    np.testing.assert_allclose(computed["stress_yy"][1], normal, rtol=1e-9)


BARE: dict[str, Any] = {"radius": 0.05, "friction": 0.3, "load": 1e5, "surroundings": "insulated"}
PLAIN = BARE | {"material": "BaTiO3", "thickness": 0.2e-3, "base": "steel"}
PEAKS = ["interface_shear", "base_peak_von_mises", "base_peak_principal_tension"]
LINEAR = BARE | {"thickness": 0.2e-3, "base": "steel", "volume_fraction": 0.2, "base_volume_fraction": 0.8}


def test_a_graded_film_by_factors_is_the_stack_of_its_sublayers() -> None:
    by_factors = solver.solve(LINEAR)
    fractions = 0.2 + 0.6 * (np.arange(12) + 0.5) / 12
    materials = [solver.fibrous(BTO, CFO, fraction) for fraction in fractions.tolist()]
    body = solver.Stack([solver.Layer(material, 0.2e-3 / 12) for material in materials], base=STEEL)
    assert_alike(solver.solve(BARE | {"body": body}), by_factors, 1e-12)
    assert set(by_factors.data_vars) == {*QUANTITIES, *FILM_QUANTITIES}


def test_a_stack_of_one_layer_is_a_film_and_a_layer_cut_in_two_is_one() -> None:
    whole = solver.Stack([solver.Layer(BTO, 0.2e-3)], base=STEEL)
    cut = solver.Stack([solver.Layer(BTO, 0.15e-3), solver.Layer(BTO, 0.05e-3)], base=STEEL)
    film = solver.solve(PLAIN, [0.5, 1.2], peaks=PEAKS)
    computed = solver.solve(BARE | {"body": [whole, cut]}, [0.5, 1.2])
    assert list(computed["body"].values) == [whole.name, cut.name]
    names = [name for name in map(str, film) if name in computed]
    assert {*QUANTITIES, *FILM_QUANTITIES, "stress_xx"} <= set(names)
    assert_alike(computed.isel(body=0), film, 1e-12, names)
    assert_alike(computed.isel(body=1), film, 3e-9, names)
    peaks = solver.solve(BARE | {"body": cut}, peaks=True)
    assert {name for name in FILM_PEAKS if not name.startswith("film")} <= set(peaks.data_vars)
    assert_alike(peaks, film, 1e-6, PEAKS)
    inside, alone = (solver.solve_interior(BARE | {"body": body}, [0.3], [-0.5, -0.95, -2.0]) for body in (cut, whole))
    assert_alike(inside, alone, 1e-8)


def test_an_electrode_between_layers_shields_and_counts_as_the_ground() -> None:
    """Below a grounded electrode a dielectric has no part in the voltage but by its stiffness."""
    upper = solver.Layer(BTO, 0.2e-3, electric="grounded")
    computed = solver.solve(BARE | {"body": solver.Stack([upper, solver.Layer(STEEL, 0.3e-3)], base=STEEL)})
    assert_alike(
        computed,
        solver.solve(PLAIN),
        1e-9,
        ["contact_trailing", "voltage", "capacitance_per_length", "nominal_field", "depth"],
    )
