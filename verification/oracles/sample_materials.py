"""Material constants of theory section 7, in SI units, for the tests of the oracles, and tensors of crystals."""

from collections.abc import Mapping

import numpy as np

from verification.oracles.surface import VACUUM, tensor
from verification.oracles.surface_response import Array

ELECTRIC = ("e31", "e33", "e15", "g11", "g33")
MAGNETIC = ("f31", "f33", "f15")
SIH_SONG = {"c11": 226e9, "c13": 124e9, "c33": 216e9, "c44": 44e9, "e31": -2.2, "e33": 9.3, "e15": 5.8, "f31": 290.2}
SIH_SONG |= {"f33": 350.0, "f15": 275.0, "eps11": 5.64e-9, "eps33": 6.35e-9, "g11": 5.367e-12, "g33": 2.7375e-9}
SIH_SONG |= {"mu11": 297e-6, "mu33": 83.5e-6, "rho": 5550.0}
BARIUM_TITANATE = {"c11": 166e9, "c13": 78e9, "c33": 162e9, "c44": 43e9, "e31": -4.4, "e33": 18.6, "e15": 11.6}
BARIUM_TITANATE |= {"eps11": 11.2e-9, "eps33": 12.6e-9, "mu11": 5e-6, "mu33": 10e-6, "g11": 0.0, "g33": 0.0}
BARIUM_TITANATE |= dict.fromkeys(MAGNETIC, 0.0)
COBALT_FERRITE = {"c11": 286e9, "c13": 170.5e9, "c33": 269.5e9, "c44": 45.3e9, "f31": 580.3, "f33": 699.7, "f15": 550.0}
COBALT_FERRITE |= {"eps11": 0.08e-9, "eps33": 0.093e-9, "mu11": 590e-6, "mu33": 157e-6}
COBALT_FERRITE |= dict.fromkeys(ELECTRIC, 0.0)


def isotropic(young: float, poisson: float) -> dict[str, float]:
    """Plane constants of an isotropic elastic material [Pa]."""
    shear = young / (2 * (1 + poisson))
    lame = 2 * shear * poisson / (1 - 2 * poisson)
    constants = {"c11": lame + 2 * shear, "c13": lame, "c33": lame + 2 * shear, "c44": shear}
    constants |= {"eps11": 1e-10, "eps33": 1e-10, "mu11": 1e-6, "mu33": 1e-6}
    return constants | dict.fromkeys((*ELECTRIC, *MAGNETIC), 0.0)


def hexagonal(m: Mapping[str, float]) -> Array:
    """Generalised stiffness of constants with c12, poled along the normal."""
    stiffness, piezo = np.diag([0.0, 0.0, 0.0, m["c44"], m["c44"], (m["c11"] - m["c12"]) / 2]), np.zeros((3, 6))
    stiffness[:3, :3] = [
        [m["c11"], m["c12"], m["c13"]], [m["c12"], m["c11"], m["c13"]], [m["c13"], m["c13"], m["c33"]]
    ]  # fmt: skip
    piezo[2, :3] = m["e31"], m["e31"], m["e33"]
    piezo[0, 4] = piezo[1, 3] = m["e15"]
    return tensor(stiffness, piezo, np.diag([m["eps11"], m["eps11"], m["eps33"]]))


def lithium_niobate(angle: float | None) -> Array:
    """Generalised stiffness of LiNbO3, a cut turned from Y about X towards Z by an angle in degrees, or Z's."""
    stiffness = 1e9 * np.array([
        [203, 53, 75, 9, 0, 0], [53, 203, 75, -9, 0, 0], [75, 75, 245, 0, 0, 0],
        [9, -9, 0, 60, 0, 0], [0, 0, 0, 0, 60, 9], [0, 0, 0, 0, 9, 75],
    ])  # fmt: skip
    piezo = np.array([[0, 0, 0, 0, 3.7, -2.5], [-2.5, 2.5, 0, 3.7, 0, 0], [0.2, 0.2, 1.3, 0, 0, 0]])
    axes = np.eye(3)
    if angle is not None:
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        axes = np.array([[1, 0, 0], [0, s, -c], [0, c, s]])
    return tensor(stiffness, piezo, VACUUM * np.diag([44, 44, 29]), axes)


def quartz() -> Array:
    """Generalised stiffness of X-cut quartz of R. Bechmann (1958)."""
    stiffness = 1e9 * np.array([
        [86.74, 6.99, 11.91, -17.91, 0, 0], [6.99, 86.74, 11.91, 17.91, 0, 0], [11.91, 11.91, 107.2, 0, 0, 0],
        [-17.91, 17.91, 0, 57.94, 0, 0], [0, 0, 0, 0, 57.94, -17.91], [0, 0, 0, 0, -17.91, 39.875],
    ])  # fmt: skip
    piezo = np.array([[0.171, -0.171, 0, -0.0406, 0, 0], [0, 0, 0, 0, 0.0406, -0.171], [0, 0, 0, 0, 0, 0]])
    return tensor(stiffness, piezo, 1e-12 * np.diag([39.21, 39.21, 41.03]), [[0, 1, 0], [0, 0, 1], [1, 0, 0]])
