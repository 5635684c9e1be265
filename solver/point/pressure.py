"""The pressure below a curved punch: the half-space's in closed form, what the layers add as a polynomial (points, 3).

    p(x) = (2/pi) (N^-1)_yy rise e F(x) - sum_n c_n (P_2n(x) - P_2n(0)) / (abs(P_2n(0)) x),   x = sqrt(1 - r^2/a^2),

over C a^(e-1), where F = int_0^x (1 - x^2 + v^2)^(e/2 - 1) dv = x 2F1(1 - e/2, 1; 3/2; x^2). Up to e = 1 it is
infinite at the centre, below e = 3 not smooth, and x does not tell places near it: there F is Pfaff's transformation
x (r/a)^(e-2) 2F1(1 - e/2, 1/2; 3/2; -(x a/r)^2), arsinh(x a/r) of a cone.
"""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from scipy.special import hyp2f1

from solver.arrays import Array
from solver.point.profile import Shape

#: Places x at which tables hold the pressure, from the edge to the centre.
SAMPLES = np.sin(np.pi / 2 * np.arange(1, 25) / 24)

_NEAR, _SMOOTH = 0.5, 3.0  # of the centre, in r/a; the exponent from which F is smooth there

_STEPS = 46  # of the golden section: to 1e-10 in x, where the pressure is flat
_RATIO = (np.sqrt(5) - 1) / 2


def finite(shape: Shape) -> bool:
    """Whether the pressure has a largest value: none at the edge of a disc and at the apex of a cone."""
    return shape.exponent > 1


def halfspace_form(shape: Shape, x: Array, r: Array | None = None) -> Array:
    """rise e F of the half-space; any shape, infinite at r = 0 where ``finite`` says so."""
    r = np.sqrt((1 - x) * (1 + x)) if r is None else r
    return np.asarray(shape.rise * shape.exponent * _form(shape.exponent, x, r))


def _form(e: float, x: Array, r: Array) -> Array:
    """F."""
    if e == 1:
        return np.arcsinh(x / r)
    near = (r > 0) & (r < _NEAR) & (e < _SMOOTH)
    at, apart = np.where(near, r, 1.0), np.where(near, 0.0, x)
    return np.where(
        near,
        x * at ** (e - 2) * hyp2f1(1 - e / 2, 0.5, 1.5, -((x / at) ** 2)),
        apart * hyp2f1(1 - e / 2, 1.0, 1.5, apart**2),
    )


@lru_cache
def halfspace_peak(shape: Shape) -> float:
    """The largest of it; at the centre up to the exponent 2, towards the edge above."""
    values = halfspace_form(shape, SAMPLES)
    best = int(np.argmax(values))
    if best == SAMPLES.size - 1:
        return float(values[best])
    around = np.array([SAMPLES[max(best - 1, 0)]]), np.array([SAMPLES[best + 1]])
    return float(climbed(lambda x: halfspace_form(shape, x), *around)[0])


def added_forms(x: Array, count: int) -> Array:
    """(P_2n(x) - P_2n(0)) / (abs(P_2n(0)) x) at x > 0; (..., n).

    x: (...), sqrt(1 - r^2/a^2) > 0.
    """
    values = np.polynomial.legendre.legvander(x, 2 * count - 2)[..., ::2]
    middle = np.polynomial.legendre.legvander(np.zeros(1), 2 * count - 2)[0, ::2]
    return np.asarray((values - middle) / (np.abs(middle) * x[..., None]))


def added_means(x: Array, count: int) -> Array:
    """int_0^r of ``added_forms`` times s ds over r^2 at r = sqrt(1 - x^2) <= 1; (..., n).

    As int_x^1 P_m(v) dv = (1 - x^2) P_m'(x) / (m (m + 1)).

    x: (...), sqrt(1 - r^2/a^2).
    """
    m = 2 * np.arange(count)
    whole = np.eye(2 * count - 1)[::2] / np.maximum(m * (m + 1), 1)[:, None]
    own = np.polynomial.legendre.legval(x, np.polynomial.legendre.legder(whole, axis=1).T) if count > 1 else 0 * x[None]
    middle = np.polynomial.legendre.legvander(np.zeros(1), 2 * count - 2)[0, ::2]
    found = np.moveaxis(own, 0, -1) - middle / (1 + x[..., None])
    return np.asarray(np.where(m > 0, found / np.abs(middle), 0.0))


def climbed(values: Callable[[Array], Array], low: Array, high: Array) -> Array:
    """The largest of values that rise and then fall between low and high, by the golden section; (case,).

    low, high: (case,), limits.
    """
    inner, outer = high - _RATIO * (high - low), low + _RATIO * (high - low)
    at_inner, at_outer = values(inner), values(outer)
    for _ in range(_STEPS):
        left = at_inner > at_outer
        high, low = np.where(left, outer, high), np.where(left, low, inner)
        kept, known = np.where(left, inner, outer), np.where(left, at_inner, at_outer)
        fresh = np.where(left, high - _RATIO * (high - low), low + _RATIO * (high - low))
        new = values(fresh)
        inner, outer = np.where(left, fresh, kept), np.where(left, kept, fresh)
        at_inner, at_outer = np.where(left, new, known), np.where(left, known, new)
    return np.maximum(at_inner, at_outer)
