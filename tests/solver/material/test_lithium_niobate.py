"""LiNbO3 as a transversely isotropic solid, against the half-plane of the full trigonal crystal."""

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

import solver
from solver.halfplane.surface import HalfPlane
from verification.oracles.surface import half_space, tensor

#: GPa and pC/N of B.A. Auld (1973), the source of the entry; permittivities over the vacuum's.
C11, C12, C13, C33, C44, C14, D15, D22, D31, D33 = 203, 53, 75, 245, 60, 9, 68, 21, -1, 6
PERMITTIVITY = np.diag([44.0, 44.0, 29.0]) * 8.8541878188e-12
C66 = (C11 - C12) / 2
STIFFNESS = 1e9 * np.array([
    [C11, C12, C13, C14, 0, 0], [C12, C11, C13, -C14, 0, 0], [C13, C13, C33, 0, 0, 0],
    [C14, -C14, 0, C44, 0, 0], [0, 0, 0, 0, C44, C14], [0, 0, 0, 0, C14, C66],
])  # fmt: skip
STRAIN = 1e-12 * np.array([[0, 0, 0, 0, D15, -2 * D22], [-D22, D22, 0, D15, 0, 0], [D31, D31, D33, 0, 0, 0]])
PIEZO = STRAIN @ STIFFNESS
#: Azimuths of the planes about the crystal's Z.
PLANES = {"XZ": 0.0, "YZ": np.pi / 2}


def compliance(stiffness: ArrayLike, piezo: ArrayLike, azimuths: ArrayLike) -> NDArray[np.float64]:
    """N of (u_y, phi) by (sigma_yy, D_y) of half-planes, shape (azimuth, 2, 2)."""
    si = [[1e-11, 0.1], [0.1, 1e9]]
    return np.asarray(half_space(tensor(stiffness, piezo, PERMITTIVITY), azimuths)[:, 2:, 2:].real * si)


@pytest.mark.parametrize(("plane", "voltage", "charge"), [("XZ", 1.098, 1.031), ("YZ", 1.041, 1.006)])
def test_what_is_lost_without_c14_and_d22(plane: str, voltage: float, charge: float) -> None:
    entry = HalfPlane(solver.find("LiNbO3")).compliance[:2, :2]
    bare, piezo = STIFFNESS.copy(), PIEZO.copy()
    bare[[0, 1, 3, 3, 4, 5], [3, 3, 0, 1, 5, 4]] = 0
    piezo[0, 5] = piezo[1, 0] = piezo[1, 1] = 0
    np.testing.assert_allclose(compliance(bare, piezo, PLANES[plane])[0], entry, rtol=1e-8)
    full = compliance(STIFFNESS, PIEZO, PLANES[plane])[0]
    assert entry[0, 1] / full[0, 1] == pytest.approx(voltage, abs=1e-3)
    assert (entry[0, 1] / entry[1, 1]) / (full[0, 1] / full[1, 1]) == pytest.approx(charge, abs=1e-3)
    normal = [m[0, 0] - m[0, 1] ** 2 / m[1, 1] for m in (entry, full)]
    assert normal[0] / normal[1] == pytest.approx(1, abs=5e-3)


#: e of Warner, Onoe and Coquin: e15, e22, e31, e33 [C/m2].
E15, E22, E31, E33 = 3.7, 2.5, 0.2, 1.3
WARNER = np.array([[0, 0, 0, 0, E15, -E22], [-E22, E22, 0, E15, 0, 0], [E31, E31, E33, 0, 0, 0]])


def test_a_tip_at_zero_volts_has_13_06_to_13_37_picocoulombs_by_azimuth() -> None:
    N = compliance(STIFFNESS, WARNER, np.pi * np.arange(24) / 24)
    charge = 1e12 * np.abs(N[:, 0, 1] / N[:, 1, 1])
    assert [charge.min(), charge.max()] == pytest.approx([13.061, 13.369], abs=2e-3)
    mean = np.mean(N, axis=0)
    assert 1e12 * abs(mean[0, 1] / mean[1, 1]) == pytest.approx(13.213, abs=1e-3)
    (warner,) = solver.find("LiNbO3").variants()
    ball = {"material": warner, "profile": "sphere", "radius": 1e-6, "force": 1e-4}
    assert 1e12 * float(solver.solve(ball)["charge_per_force"]) == pytest.approx(13.444, abs=1e-3)
