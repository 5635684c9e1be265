"""What layers and base add to the half-space of the top, between the functions of a contact's tractions (points, 4).

    K_mn(a) = int_0^inf Delta(s/a) j_2m(s) j_2n(s) ds,    Delta = Y_top - Y0 over (y, phi, psi).

Delta is the plane's: a surface wave has the same multiplier in space. On a base that insulates the magnetic field the
flux leaves sideways: psi is then a logarithm far away, and zero at the distance of all layers' thickness.
"""

import numpy as np

from solver.arrays import Array
from solver.film.electroded import difference
from solver.film.kernel import strip, wavenumbers
from solver.film.reflection import sideways
from solver.film.stack import Stack, StackError
from solver.point.bessel import even_orders

_BLOCK = 2_000_000  # values of the Bessel functions held at once


def interactions(stack: Stack, radii: Array, count: int, odd: int = 0) -> Array:
    """K of a stack at radii [m] in the units of the stack; (radius, 3, 3, count, count).

    Parameters
    ----------
    stack
        Homogeneous layers on a base.
    radii
        a [m]; (radius,).
    count
        Number of functions.
    odd
        1 for the functions of odd orders, those of a force along the surface.

    Raises
    ------
    StackError
        A graded layer.
    """
    if stack.top.graded:
        raise StackError("layers: interactions of Legendre functions need layers that are not graded")
    found: Array = np.zeros((radii.size, 3, 3, count, count))
    octave = np.floor(np.log2(radii / np.max(radii)))
    for height in np.unique(octave):  # a narrow contact needs fewer wavenumbers
        alike = np.flatnonzero(octave == height)
        k, weights = wavenumbers(stack, 2 * float(np.max(radii[alike])), strip(stack))
        added = weights * np.moveaxis(difference(stack, k)[:, 1:, 1:], 0, -1)
        step = max(_BLOCK // (count * k.size), 1)
        for start in range(0, alike.size, step):
            some = alike[start : start + step]
            orders = np.moveaxis(even_orders(radii[some, None] * k, count, odd), 0, 1)  # (radius, n, k)
            for i, j in _coupled(added):
                found[some, i, j] = (orders * added[i, j]) @ np.swapaxes(orders, -1, -2)
                found[some, j, i] = found[some, i, j]
        if not odd and (spread := sideways(stack)):
            found[alike, 2, 2, 0, 0] -= np.sum(weights * spread / k * np.exp(-k * stack.thickness / 2))
    return np.asarray(found * radii[:, None, None, None, None])


def _coupled(added: Array) -> list[tuple[int, int]]:
    """Pairs of channels that a stack couples."""
    return [(i, j) for i in range(3) for j in range(i, 3) if np.any(added[i, j])]
