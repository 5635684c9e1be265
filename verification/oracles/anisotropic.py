"""Surface compliance of a piezoelectric half-space of any anisotropy, by Stroh's eigenvalue problem in SI tensors."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

_VOIGT = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
_UNITS = np.diag([1e-5, 1e-5, 1e-5, 1e5])  # of displacements and potential, so that all entries are of one size


def compliance(stiffness: ArrayLike, piezo: ArrayLike, permittivity: ArrayLike, axes: ArrayLike) -> Array:
    """N of (u_y, phi) by (sigma_yy, D_y) of a half-plane; (2, 2)."""
    c, e, turn = np.zeros((3, 3, 3, 3)), np.zeros((3, 3, 3)), np.asarray(axes, dtype=np.float64)
    elastic, coupling = np.asarray(stiffness), np.asarray(piezo)
    for row, (i, j) in enumerate(_VOIGT):
        for column, (k, m) in enumerate(_VOIGT):
            c[i, j, k, m] = c[j, i, k, m] = c[i, j, m, k] = c[j, i, m, k] = elastic[row, column]
        e[:, i, j] = e[:, j, i] = coupling[:, row]
    coupled = np.zeros((3, 4, 4, 3))
    coupled[:, :3, :3] = np.einsum("ia,jb,kc,md,abcd->ijkm", turn, turn, turn, turn, c)
    turned = np.einsum("ia,jb,kc,abc->ijk", turn, turn, turn, e)
    coupled[:, :3, 3] = np.moveaxis(turned, 0, 2)
    coupled[:, 3, :3] = turned
    coupled[:, 3, 3] = -turn @ np.asarray(permittivity) @ turn.T
    Q, R, T = (_UNITS @ coupled[a, :, :, b] @ _UNITS for a, b in ((0, 0), (0, 1), (1, 1)))
    inverse = np.linalg.inv(T)
    roots, vectors = np.linalg.eig(np.block([[-inverse @ R.T, inverse], [R @ inverse @ R.T - Q, -R @ inverse]]))
    above = vectors[:, roots.imag > 0]
    whole = _UNITS @ (1j * above[:4] @ np.linalg.inv(above[4:])).real @ _UNITS
    return np.asarray(whole[np.ix_([1, 3], [1, 3])])


def around(stiffness: ArrayLike, piezo: ArrayLike, permittivity: ArrayLike, count: int = 24) -> Array:
    """N over azimuths of a surface across the crystal's Z, equally spaced over half a turn; (count, 2, 2).

    A point contact of revolution answers, to first order in what the azimuth changes, with the mean.
    """
    angles = np.pi * np.arange(count) / count
    planes = [[[np.cos(A), np.sin(A), 0], [0, 0, 1], [np.sin(A), -np.cos(A), 0]] for A in angles]
    return np.array([compliance(stiffness, piezo, permittivity, plane) for plane in planes])
