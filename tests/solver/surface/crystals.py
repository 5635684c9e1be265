"""Stiffness tensors of the crystals of the tests."""

import numpy as np

import solver
from solver.arrays import Array
from solver.material.constants import VACUUM_PERMITTIVITY
from solver.surface.response import SurfaceBody, SurfaceLayer

_VOIGT = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))


def tensor(stiffness: Array, piezo: Array, permittivity: Array, axes: Array | None = None) -> Array:
    """E of constants in crystal axes, the rows of ``axes`` the axes of the surface; (3, 4, 4, 3)."""
    turn = np.eye(3) if axes is None else np.asarray(axes, dtype=np.float64)
    c, e = np.zeros((3, 3, 3, 3)), np.zeros((3, 3, 3))
    for row, (i, j) in enumerate(_VOIGT):
        for column, (k, m) in enumerate(_VOIGT):
            c[i, j, k, m] = c[j, i, k, m] = c[i, j, m, k] = c[j, i, m, k] = stiffness[row, column]
        e[:, i, j] = e[:, j, i] = piezo[:, row]
    E = np.zeros((3, 4, 4, 3))
    E[:, :3, :3] = np.einsum("ia,jb,kc,md,abcd->ijkm", turn, turn, turn, turn, c)
    turned = np.einsum("ia,jb,kc,abc->ijk", turn, turn, turn, e)
    E[:, :3, 3], E[:, 3, :3], E[:, 3, 3] = turned.transpose(1, 2, 0), turned, -turn @ permittivity @ turn.T
    return E


def hexagonal(name: str, axes: Array | None = None) -> Array:
    """E of a built-in material."""
    m = {key: float(value) for key, value in vars(solver.find(name)).items() if isinstance(value, np.ndarray)}
    c = np.diag([m["c11"], m["c11"], m["c33"], m["c44"], m["c44"], (m["c11"] - m["c12"]) / 2])
    c[[0, 1], [1, 0]], c[[0, 1, 2, 2], [2, 2, 0, 1]] = m["c12"], m["c13"]
    e = np.zeros((3, 6))
    e[0, 4] = e[1, 3] = m["e15"]
    e[2, :3] = m["e31"], m["e31"], m["e33"]
    return tensor(c, e, np.diag([m["eps11"], m["eps11"], m["eps33"]]), axes)


def lithium_niobate(axes: Array | None = None) -> Array:
    """E of LiNbO3 with the constants of Warner, Onoe and Coquin."""
    c11, c12, c13, c33, c44, c66, c14 = 203e9, 53e9, 75e9, 245e9, 60e9, 75e9, 9e9
    e15, e22, e31, e33 = 3.7, 2.5, 0.2, 1.3
    c = np.array([
        [c11, c12, c13, c14, 0, 0], [c12, c11, c13, -c14, 0, 0], [c13, c13, c33, 0, 0, 0],
        [c14, -c14, 0, c44, 0, 0], [0, 0, 0, 0, c44, c14], [0, 0, 0, 0, c14, c66],
    ])  # fmt: skip
    e = np.array([[0, 0, 0, 0, e15, -e22], [-e22, e22, 0, e15, 0, 0], [e31, e31, e33, 0, 0, 0]])
    return tensor(c, e, np.diag([44.0, 44.0, 29.0]) * VACUUM_PERMITTIVITY, axes)


def y_cut(degrees: float) -> Array:
    """Axes of a surface whose normal is turned from Y about X towards Z."""
    t = np.deg2rad(degrees)
    normal, x = np.array([0.0, np.cos(t), np.sin(t)]), np.array([1.0, 0.0, 0.0])
    return np.array([x, np.cross(normal, x), normal])


def tilted(degrees: float, azimuth: float = 0.0) -> Array:
    """Axes of a surface whose poling is tilted from the normal, then turned about it by the azimuth [rad]."""
    t = np.deg2rad(degrees)
    c, s = np.cos(t), np.sin(t)
    turn = np.array([[np.cos(azimuth), -np.sin(azimuth), 0], [np.sin(azimuth), np.cos(azimuth), 0], [0, 0, 1.0]])
    return np.asarray(turn @ np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]]))


def film(stiffness: Array, thickness: float) -> SurfaceBody:
    """Layer on a rigid grounded base."""
    return SurfaceBody((SurfaceLayer(stiffness, thickness),))
