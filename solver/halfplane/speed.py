"""The limiting speed of steady sliding, above which no steady subsonic contact exists (theory, section 4)."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array, BoolArray, outer
from solver.halfplane.sliding import Sliding
from solver.halfplane.surface import HalfPlane
from solver.material.constants import Material, MaterialError, combined

_SLOPES = np.concatenate([[0.0], np.geomspace(1e-3, 1e3, 241)])
_BELOW = 1 - 1e-6  # share of the transonic speed, at which a Stroh root is real and the tensors are undefined


def limiting_speed(material: Material, conducts: BoolArray | tuple[bool, bool] = (True, True)) -> Array:
    """First critical speed [m/s]; cases as the material's and the conduction's broadcast.

    It is the speed of the surface wave under the punch's conduction, where 1/lam falls to zero (Stroh's tensor L, over
    the normal displacement and what the punch conducts, is singular), or the transonic one, whichever comes first.

    Parameters
    ----------
    material
        With a density.
    conducts
        Whether the punch conducts (electric, magnetic); (..., 2). The speed is lowest where it conducts both.

    Raises
    ------
    MaterialError
        A material without density.

    Examples
    --------
    >>> import solver
    >>> f"{float(limiting_speed(solver.find('PZT-4'))):.0f} m/s"
    '2191 m/s'
    """
    from scipy.optimize import elementwise  # slow to import, and most cases do not ask for a speed

    if np.any(np.isnan(material.rho)):
        raise MaterialError(f"{material.name}: rho: missing; a speed needs the density [kg m-3]")
    conducts = np.asarray(conducts)
    shape = np.broadcast_shapes(material.shape, conducts.shape[:-1])
    cases = _flat(material, shape)
    conducted = np.broadcast_to(conducts, (*shape, 2)).reshape(-1, 2)
    everywhere = np.arange(conducted.shape[0])

    def stiffness(speed: Array, case: NDArray[Any]) -> Array:
        index = case.astype(int)
        moving = HalfPlane(combined(lambda values: values[index], [cases], material.name), speed)
        return 1 / Sliding(moving, np.zeros(()), conducted[index]).lam

    transonic = transonic_speed(cases)
    top = transonic * _BELOW
    root = elementwise.find_root(stiffness, (np.zeros_like(top), top), args=(everywhere,))
    return np.where(stiffness(top, everywhere) > 0, transonic, root.x).reshape(shape)


def transonic_speed(material: Material) -> Array:
    """Speed [m/s] at which the first Stroh root becomes real, of the shape of the material's cases."""
    # It is the least sqrt(lambda / rho) over real p, with lambda an eigenvalue of the 2 x 2 acoustic matrix, which is
    # Q + p (R + R^T) + p^2 T after its fields are eliminated; even in p by the mirror symmetry.
    from scipy.optimize import elementwise

    cases = _flat(material, material.shape)
    scale = HalfPlane(cases).scale
    Q, R, T = (block * outer(scale) for block in cases.generalised_stiffness())
    unit = scale[..., 0] ** 2

    def slowest(p: Array, case: NDArray[Any]) -> Array:
        index, root = case.astype(int), p[..., None, None]
        matrix = Q[index] + root * (R[index] + R[index].mT) + root**2 * T[index]
        fields = np.linalg.solve(matrix[..., 2:, 2:], matrix[..., 2:, :2])
        acoustic = matrix[..., :2, :2] - matrix[..., :2, 2:] @ fields
        return np.asarray(np.linalg.eigvalsh((acoustic + acoustic.mT) / 2)[..., 0])

    everywhere = np.arange(unit.size)
    scan = slowest(_SLOPES + np.zeros((unit.size, 1)), everywhere[:, None] + np.zeros(_SLOPES.size, int))
    least = np.argmin(scan, -1)
    low = np.where(least > 0, _SLOPES[least - 1], -_SLOPES[1])
    bracket = (low, _SLOPES[least], _SLOPES[np.minimum(least + 1, _SLOPES.size - 1)])
    minimum = elementwise.find_minimum(slowest, bracket, args=(everywhere,))
    value = np.minimum(np.where(minimum.success, minimum.f_x, np.inf), scan[everywhere, least])
    return np.asarray(np.sqrt(value / unit / cases.rho).reshape(material.shape))


def _flat(material: Material, shape: tuple[int, ...]) -> Material:
    """Return the material with its cases along one axis."""
    return combined(lambda values: np.broadcast_to(values, shape).ravel(), [material], material.name)
