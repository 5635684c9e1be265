"""Double-exponential quadrature over the contact in mpmath, for any algebraic or logarithmic behaviour at its ends.

Takahasi and Mori (1974): with u = 1/(1 + exp(-pi sinh t)) the trapezoid rule in t doubles its digits when its step is
halved, whatever the exponents at u = 0 and u = 1. Integrands receive u and 1 - u, so that no digit is lost at an end.
"""

from collections.abc import Callable
from functools import lru_cache

from mpmath import cosh, exp, fsum, mp, mpf, pi, sinh

from verification.oracles.half_plane import WORK_DIGITS

_REACH = 7  # u^0.15 has fallen below 1e-110 there: enough for an integrand as steep as u^-0.85
_AGREEMENT = 40  # digits between two levels; the finer one then has about twice as many
_COARSEST, _FINEST = 4, 10


@lru_cache(maxsize=8)
def nodes(level: int) -> list[tuple[mpf, mpf, mpf]]:
    """Nodes (u, 1 - u, weight) on 0 < u < 1 with step 2^-level; only those that the coarser level does not have."""
    with mp.workdps(WORK_DIGITS):
        step, count = mpf(2) ** -level, _REACH * 2**level
        indices = range(-count, count + 1) if level == _COARSEST else range(1 - count, count, 2)
        return [_node(j * step, step) for j in indices]


def _node(t: mpf, step: mpf) -> tuple[mpf, mpf, mpf]:
    growth = exp(pi * sinh(t))
    u, v = growth / (1 + growth), 1 / (1 + growth)
    return u, v, step * pi * cosh(t) * u * v


def integrate(new_sums: Callable[[int], list[mpf]]) -> list[mpf]:
    """Integrals over 0 < u < 1 of several integrands at once, at the first level that agrees with the one before it."""
    with mp.workdps(WORK_DIGITS):
        value = new_sums(_COARSEST)
        for level in range(_COARSEST + 1, _FINEST + 1):
            old = value
            value = [v / 2 + new for v, new in zip(old, new_sums(level), strict=True)]
            noise = max(abs(v) for v in value) * mpf(10) ** -30  # an integral below it is a zero
            if all(abs(v - o) <= max(abs(v), noise) / mpf(10) ** _AGREEMENT for v, o in zip(value, old, strict=True)):
                return value
        raise ArithmeticError("double-exponential quadrature does not converge")


def integral(integrand: Callable[[mpf, mpf], mpf]) -> mpf:
    """Integral over 0 < u < 1 of one function of u and 1 - u."""
    return integrate(lambda level: [fsum(w * integrand(u, v) for u, v, w in nodes(level))])[0]
