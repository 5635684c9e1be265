"""What LiNbO3 loses as a transversely isotropic solid, against the half-plane of the full trigonal crystal."""

import numpy as np
import pytest

import solver
from solver.halfplane.surface import HalfPlane

VOIGT = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
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
#: Rows: along the surface, up (the crystal's Z), out of the plane.
PLANES = {"XZ": [[1, 0, 0], [0, 0, 1], [0, -1, 0]], "YZ": [[0, 1, 0], [0, 0, 1], [1, 0, 0]]}

Matrix = np.ndarray[tuple[int, ...], np.dtype[np.float64]]


def compliance(stiffness: Matrix, piezo: Matrix, plane: str) -> Matrix:
    """(u_y, phi) to (sigma_yy, D_y) of a half-plane of any anisotropy: Stroh's sextic form with a potential."""
    c, e = np.zeros((3, 3, 3, 3)), np.zeros((3, 3, 3))
    for one, (i, j) in enumerate(VOIGT):
        for two, (k, m) in enumerate(VOIGT):
            c[i, j, k, m] = c[j, i, k, m] = c[i, j, m, k] = c[j, i, m, k] = stiffness[one, two]
        e[:, i, j] = e[:, j, i] = piezo[:, one]
    turn = np.array(PLANES[plane], dtype=float)
    coupled = np.zeros((3, 4, 4, 3))
    coupled[:, :3, :3] = np.einsum("ia,jb,kc,md,abcd->ijkm", turn, turn, turn, turn, c)
    turned = np.einsum("ia,jb,kc,abc->ijk", turn, turn, turn, e)
    coupled[:, :3, 3] = np.moveaxis(turned, 0, 2)
    coupled[:, 3, :3] = turned
    coupled[:, 3, 3] = -turn @ PERMITTIVITY @ turn.T
    scale = np.diag([1e-5, 1e-5, 1e-5, 1e5])
    Q, R, T = (scale @ coupled[a, :, :, b] @ scale for a, b in ((0, 0), (0, 1), (1, 1)))
    inverse = np.linalg.inv(T)
    roots, vectors = np.linalg.eig(np.block([[-inverse @ R.T, inverse], [R @ inverse @ R.T - Q, -R @ inverse]]))
    above = vectors[:, roots.imag > 0]
    return (scale @ (1j * above[:4] @ np.linalg.inv(above[4:])).real @ scale)[np.ix_([1, 3], [1, 3])]


@pytest.mark.parametrize(("plane", "voltage", "charge"), [("XZ", 1.098, 1.031), ("YZ", 1.041, 1.006)])
def test_what_is_lost_without_c14_and_d22(plane: str, voltage: float, charge: float) -> None:
    entry = HalfPlane(solver.find("LiNbO3")).compliance[:2, :2]
    bare, piezo = STIFFNESS.copy(), PIEZO.copy()
    bare[[0, 1, 3, 3, 4, 5], [3, 3, 0, 1, 5, 4]] = 0
    piezo[0, 5] = piezo[1, 0] = piezo[1, 1] = 0
    np.testing.assert_allclose(compliance(bare, piezo, plane), entry, rtol=1e-8)
    full = compliance(STIFFNESS, PIEZO, plane)
    assert entry[0, 1] / full[0, 1] == pytest.approx(voltage, abs=1e-3)
    assert (entry[0, 1] / entry[1, 1]) / (full[0, 1] / full[1, 1]) == pytest.approx(charge, abs=1e-3)
    normal = [m[0, 0] - m[0, 1] ** 2 / m[1, 1] for m in (entry, full)]
    assert normal[0] / normal[1] == pytest.approx(1, abs=5e-3)
