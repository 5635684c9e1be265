"""Films through the face: figures found by other methods, the closed form where film and base are one, refusals."""

from typing import Any

import numpy as np
import pytest
import xarray as xr

import solver
from solver.names import ALL_PEAKS, FILM_PEAKS

FILM: dict[str, Any] = {
    "material": "BaTiO3",
    "thickness": 0.5e-3,
    "surroundings": "insulated",
    "base": "rigid",
    "radius": 0.05,
    "load": 1e5,
}
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
