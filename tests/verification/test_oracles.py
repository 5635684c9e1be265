"""The 50-digit oracle against the equations that it solves."""

from collections.abc import Callable

import pytest
from mpmath import log, matrix, mp, mpf, pi

from verification.oracles.contact import Contact, Sliding
from verification.oracles.half_plane import WORK_DIGITS, HalfPlane, half_plane
from verification.oracles.quadrature import integral
from verification.oracles.sample_materials import SIH_SONG


def principal_value(f: Callable[[mpf, mpf], mpf], u: mpf) -> mpf:
    """(1/pi) PV int f(s)/(s-x) ds with the singularity taken out; u = (a - x)/l."""
    value = f(u, 1 - u)
    return (integral(lambda s, t: (f(s, t) - value) / (u - s)) + value * log(u / (1 - u))) / pi


def without_kap(half: HalfPlane) -> HalfPlane:
    """The half-plane with k1 = n.d, where D_y and B_y of theory section 3 have the form 0/0."""
    local = half.local.copy()
    local[1, 0] -= Sliding(half, mpf(0), mpf("0.05"), (1, 2)).reduction[3]
    return HalfPlane(local, half.compliance, half.Q, half.R, half.T)


@pytest.mark.parametrize(("conducted", "friction", "digits"), [((1, 2), 1.5, 60), ((1,), 0.0, 60), ((1, 2), 0.7, 38)])
def test_tractions_satisfy_the_integral_equations_and_the_balances(
    conducted: tuple[int, ...], friction: float, digits: int
) -> None:
    """The last of a half-plane with a removable singularity."""
    with mp.workdps(WORK_DIGITS):
        half, tolerance = half_plane(SIH_SONG), mpf(10) ** -digits
        surface = Sliding(half if digits > 50 else without_kap(half), mpf(friction), mpf("0.05"), conducted)
        charges = [mpf(c) if i in surface.conducted else mpf(0) for i, c in ((1, "1e-6"), (2, "-2e-3"))]
        contact = Contact(surface, mpf(10) ** 5, *charges)
        N, k = surface.half.normal_compliance, surface.half.shear_coupling
        parts = [lambda s, t, i=i: contact.tractions(s, t)[i] for i in (1, 2, 3)]
        totals = [
            contact.width * integral(part) if i in (0, *surface.conducted) else mpf(0) for i, part in enumerate(parts)
        ]
        for total, applied in zip(totals, (contact.load, *charges), strict=True):
            assert abs(total + applied) <= tolerance * abs(applied)
        u, held = mpf("0.31"), (0, *surface.conducted)
        tractions, closed = contact.tractions(u, 1 - u)[1:], contact.transforms_inside(u, 1 - u)[1:]
        numeric = matrix([principal_value(p, u) if i in held else mpf(0) for i, p in enumerate(parts)])
        assert all(abs(c - n) <= tolerance * abs(n) for c, n in zip(closed, numeric, strict=True))
        answer = surface.friction * tractions[0] * matrix(k) + N * numeric
        x = contact.width * (1 - surface.alpha - u)
        for i in held:
            size = max(abs(N[i, j] * numeric[j]) for j in range(3)) + abs(x / surface.radius)
            assert abs(answer[i] - (x / surface.radius if i == 0 else 0)) < tolerance * size
