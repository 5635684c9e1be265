"""Al(1-x)Sc(x)N against numbers written out by hand, and through the face like any other composite."""

from typing import Any

import numpy as np
import pytest

import solver
from solver.material.constants import VACUUM_PERMITTIVITY

CONTACT: dict[str, Any] = {"radius": 0.05, "load": 1e4}
#: Of x = 0.3, with 0.7, 0.3 and 0.21 put in by hand; GPa and C/m2.
AT_THREE_TENTHS = {
    "c11": 287.14 + 88.59 - 44.163, "c12": 99.68 + 59.58 - 12.999, "c13": 77.07 + 40.65 + 16.569,
    "c33": 269.5 - 7.14 - 21.294, "c44": 86.03 + 50.85 - 28.833,
    "e31": -0.441 - 0.1476 - 0.12915, "e33": 1.022 + 2.4579 - 1.24152, "e15": -0.273 - 0.1374 + 0.08757,
}  # fmt: skip


def test_constants_at_three_tenths() -> None:
    film = solver.aluminium_scandium_nitride(0.3)
    for name, value in AT_THREE_TENTHS.items():
        scale = 1e9 if name.startswith("c") else 1.0
        assert float(getattr(film, name)) == pytest.approx(value * scale, rel=1e-13), name
    for name in ("eps11", "eps33"):
        assert float(getattr(film, name)) / VACUUM_PERMITTIVITY == pytest.approx(9.37 + 1.11483 + 3.62637, rel=1e-13)


@pytest.mark.parametrize(("x", "expected", "measured"), [(0.0, 5.0, 5.5), (0.43, 33.9, 27.6)])
def test_strain_constant_and_how_far_films_are_from_it(x: float, expected: float, measured: float) -> None:
    """d = e s, by a matrix that is inverted here; measured ones spread by a fourth about the theory."""
    m = solver.aluminium_scandium_nitride(x)
    stiffness = np.array([[m.c11, m.c12, m.c13], [m.c12, m.c11, m.c13], [m.c13, m.c13, m.c33]], dtype=float)
    d = np.array([m.e31, m.e31, m.e33], dtype=float) @ np.linalg.inv(stiffness)
    assert d[2] * 1e12 == pytest.approx(expected, abs=0.05)
    assert d[2] * 1e12 == pytest.approx(measured, rel=0.25)


def test_volts_per_force_of_the_half_plane() -> None:
    """Figures computed by another program."""
    x = [0.0, 0.2, 0.3, 0.4]
    out = solver.solve({"composite": "AlScN", "scandium_fraction": x, **CONTACT})
    assert abs(out.voltage_per_load.values) == pytest.approx([0.073, 0.117, 0.146, 0.180], abs=5e-4)


@pytest.mark.parametrize(
    "body", [{}, {"thickness": 1e-3, "surroundings": "insulated", "base": "silicon"}], ids=["half-plane", "film"]
)
def test_beside_other_composites_it_is_what_its_constants_say(body: dict[str, Any]) -> None:
    """Every composite of a mixed call, one by one as a material."""
    contact = {**CONTACT, **body, "friction": 0.2}
    kinds = ["AlScN", "laminate", "fibrous"]
    out = solver.solve({"composite": kinds, "scandium_fraction": [0.0, 0.4], "volume_fraction": 0.6, **contact})
    phases = solver.find("BaTiO3"), solver.find("CoFe2O4")
    for k, kind in enumerate(kinds):
        for j, x in enumerate((0.0, 0.4)):
            material = solver.aluminium_scandium_nitride(x) if kind == "AlScN" else getattr(solver, kind)(*phases, 0.6)
            alone = solver.solve({"material": material, **contact})
            for name, value in alone.data_vars.items():
                values = out[name].isel(composite=k, scandium_fraction=j)
                np.testing.assert_allclose(values, value, rtol=1e-11, atol=0, err_msg=f"{kind} {x} {name}")
