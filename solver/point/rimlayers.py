"""What the layers of a stack add to sigma_xx at the trailing edge of a contact, by its densities in b (points, 8).

A surface wave of div u = Delta_xo t_o stretches the surface there by, lengths over a and q = k a,

    eps_xx + eps_zz = int Delta_xo [t_o J_0 + t_1o J_1] q dq,    eps_zz = int Delta_xo [t_o J_1 + t_1o J_2] dq,

t_o(q) the cosine transform of phi, t_1o(q) the sine transform of psi; friction along x by Delta_xx and by shear waves
with J_1 and J_3. All are sums over b of smooth functions of b, wherever charges lie.
"""

from functools import lru_cache

import numpy as np

from solver.arrays import Array
from solver.point.bessel import bessel_orders
from solver.point.rim import Rim
from solver.point.shear import ShearWaves
from solver.point.wavefields import ORDERS
from solver.stack.electroded import difference
from solver.stack.layers import Stack
from solver.stack.wavenumbers import strip, wavenumbers

_FAR = 20.0  # distance over the longer of contact radius and thickness beyond which functions of b fall as powers
_FALLING = 2, 3  # these powers, of cosines and of sines
_KEPT = 32


def added_tension(stack: Stack, rim: Rim, ratio: float, b: Array, plain: Array, turned: Array) -> float:
    """What they add [Pa]."""
    last = _FAR * max(1.0, stack.thickness / ratio)
    k, added, sheared = _waves(stack, int(np.ceil(np.log2(ratio * (2 + last)))))
    q, near = k * ratio, b < last
    phases = q[:, None] * np.append(b[near], last)
    cosines, sines = np.cos(phases), np.sin(phases)
    falling = (last / b[~near]) ** np.array(_FALLING)[:, None]

    def together(values: Array, share: Array) -> Array:
        """Those far away in one; (b, channel)."""
        return np.append(values[:, near], (values[:, ~near] @ share)[:, None], 1).T

    first, second = cosines @ together(plain, falling[0]), sines @ together(turned[1:], falling[1])
    J = bessel_orders(q, np.ones(1), ORDERS)[..., 0]
    dilation = q * J[0] * first.T + q * J[1] * second.T
    hoop = J[1] * first.T + J[2] * second.T
    own = np.einsum("ki,ik->", added[:, 0, 1:], rim.stiffness * dilation - rim.shear * hoop)
    rubbed = q * (cosines @ together(turned[:1], falling[0]))[:, 0]
    along, across = (3 * J[1] - J[3]) / 4, (J[1] + J[3]) / 4
    straight = added[:, 0, 0] * (rim.stiffness * along + (rim.stiffness - rim.shear) * across)
    return float(ratio * stack.scale[0] * (own - rubbed @ (straight + sheared * rim.shear * across)))


@lru_cache(_KEPT)
def _waves(stack: Stack, power: int) -> tuple[Array, Array, Array]:
    """Wavenumbers for distances up to a power of two; Delta, and the same of shear waves, times their weights."""
    k, weights = wavenumbers(stack, 2.0**power, strip(stack))
    shear = ShearWaves(stack, k).at(0, np.zeros(1), reflected=True)[0, :, 0] / stack.scale[0] ** 2
    return k, difference(stack, k) * weights[:, None, None], shear * weights
