"""The 50-digit oracle against the equations that it solves, the theory's figures and classical limits."""

from collections.abc import Callable

import numpy as np
import pytest
from mpmath import digamma, eig, inverse, log, matrix, mp, mpf, pi, sin, zeros

from verification.oracles import precise
from verification.oracles.contact import Contact, Sliding
from verification.oracles.half_plane import WORK_DIGITS, HalfPlane, half_plane
from verification.oracles.quadrature import integral
from verification.oracles.sample_materials import BARIUM_TITANATE, SIH_SONG
from verification.oracles.surface_response import surface_response


def sliding(half: HalfPlane, friction: float, conducted: tuple[int, ...] = (1, 2)) -> Sliding:
    return Sliding(half, mpf(friction), mpf("0.05"), conducted)


# --- material constants ---


@pytest.mark.parametrize(("material", "speed"), [(SIH_SONG, 900.0), (BARIUM_TITANATE, 0.0)])
def test_angular_integrals_give_the_stroh_eigenvectors_answer(material: dict[str, float], speed: float) -> None:
    half = half_plane(material, speed)
    with mp.workdps(60):
        inertia = matrix(4, 4)
        inertia[0, 0] = inertia[1, 1] = mpf(material.get("rho", 0)) * mpf(speed) ** 2
        units = mp.diag([mpf(1), mpf(1), mpf(10) ** 10, mpf(10) ** 8])
        Q, R, T = (units * block * units / 10**11 for block in (half.Q - inertia, half.R, half.T))
        stroh = zeros(8)
        stroh[0:4, 0:4], stroh[0:4, 4:8] = -inverse(T) * R.T, inverse(T)
        stroh[4:8, 0:4] = R * inverse(T) * R.T - Q
        stroh[4:8, 4:8] = -R * inverse(T)
        roots, vectors = eig(stroh)
        upper = [i for i in range(8) if roots[i].imag > 0]
        A, B = zeros(4), zeros(4)
        for j, i in enumerate(upper):
            A[:, j], B[:, j] = vectors[0:4, i], vectors[4:8, i]
        answer = A * inverse(B)
        expected = units**-1 * (half.local - 1j * half.compliance) * units**-1 * 10**11
        assert mp.norm(answer - expected, mp.inf) < mpf(10) ** -50
    single = surface_response(material, speed)
    scale = np.array([1, 1, 1e10, 1e8])
    for ours, theirs in ((single.local, half.local), (single.compliance, half.compliance)):
        reference = np.array(theirs.tolist(), dtype=float)
        assert np.max(np.abs((ours - reference) / np.outer(scale, scale))) < 1e-14 * 1e-11 * 10


# --- the 50-digit oracle: its equations ---


def principal_value(f: Callable[[mpf, mpf], mpf], u: mpf) -> mpf:
    """(1/pi) PV int f(s)/(s-x) ds with the singularity taken out; u = (a - x)/l."""
    value = f(u, 1 - u)
    return (integral(lambda s, t: (f(s, t) - value) / (u - s)) + value * log(u / (1 - u))) / pi


def without_kap(half: HalfPlane) -> HalfPlane:
    """The half-plane with k1 = n.d, where D_y and B_y of theory section 3 have the form 0/0."""
    local = half.local.copy()
    local[1, 0] -= sliding(half, 0.0).reduction[3]
    return HalfPlane(local, half.compliance, half.Q, half.R, half.T)


@pytest.mark.parametrize(("conducted", "friction"), [((1, 2), 1.5), ((1,), 0.0)])
def test_tractions_satisfy_the_integral_equations_and_the_balances(conducted: tuple[int, ...], friction: float) -> None:
    with mp.workdps(WORK_DIGITS):
        half = half_plane(SIH_SONG)
        check_equations(sliding(half, friction, conducted), mpf(10) ** -60)


def test_removable_singularity_satisfies_them_too() -> None:
    with mp.workdps(WORK_DIGITS):
        check_equations(sliding(without_kap(half_plane(SIH_SONG)), 0.7), mpf(10) ** -38)


def check_equations(surface: Sliding, tolerance: mpf) -> None:
    charges = [mpf(c) if i in surface.conducted else mpf(0) for i, c in ((1, "1e-6"), (2, "-2e-3"))]
    contact = Contact(surface, mpf(10) ** 5, *charges)
    N, k = surface.half.normal_compliance, surface.half.shear_coupling
    parts = [lambda s, t, i=i: contact.tractions(s, t)[i] for i in (1, 2, 3)]
    totals = [
        contact.width * integral(part) if i in (0, *surface.conducted) else mpf(0) for i, part in enumerate(parts)
    ]
    for total, applied in zip(totals, (contact.load, *charges), strict=True):
        assert abs(total + applied) <= tolerance * abs(applied)
    u = mpf("0.31")
    tractions, closed = contact.tractions(u, 1 - u)[1:], contact.transforms_inside(u, 1 - u)[1:]
    numeric = matrix([principal_value(p, u) if i in (0, *surface.conducted) else mpf(0) for i, p in enumerate(parts)])
    assert all(abs(c - n) <= tolerance * abs(n) for c, n in zip(closed, numeric, strict=True))
    answer = surface.friction * tractions[0] * matrix(k) + N * numeric
    x = contact.width * (1 - surface.alpha - u)
    for i in (0, *surface.conducted):
        size = max(abs(N[i, j] * numeric[j]) for j in range(3)) + abs(x / surface.radius)
        assert abs(answer[i] - (x / surface.radius if i == 0 else 0)) < tolerance * size


def test_response_is_the_same_at_both_edges_and_as_the_digamma_formula() -> None:
    datum = mpf("0.3")
    with mp.workdps(WORK_DIGITS):
        surface = sliding(half_plane(SIH_SONG), 0.6)
        contact = Contact(surface, mpf(10) ** 5, mpf("1e-6"), mpf("2e-3"))
        depth, voltage, magnetic_potential = contact.punch_response(datum)
        half, alpha, width = surface.half, surface.alpha, contact.width

        def logarithmic(i: int) -> mpf:
            return width * integral(lambda s, t: contact.tractions(s, t)[i] * log(width * t / datum))

        shear = -surface.friction * contact.load  # sign(x - s) is -1 at the leading edge
        leading = -half.normal_compliance * matrix([logarithmic(i) for i in (1, 2, 3)]) / pi
        leading -= matrix(half.shear_coupling) * shear / 2
        expected = [(alpha * width) ** 2 / (2 * surface.radius) - leading[0], leading[1], leading[2]]
        for ours, theirs in zip((depth, voltage, magnetic_potential), expected, strict=True):
            assert abs(ours - theirs) < mpf(10) ** -50 * abs(ours)
        ours = width**2 * integral(lambda s, t: s**alpha * t ** (1 - alpha) * log(width * s / datum))
        shape = pi * alpha * (1 - alpha) / (2 * sin(pi * alpha))
        theirs = width**2 * shape * (log(width / datum) + digamma(alpha + 1) - digamma(3))
        assert abs(ours - theirs) < mpf(10) ** -60 * abs(theirs)


# --- the 50-digit oracle: limits ---


def test_charges_need_a_conductor() -> None:
    with pytest.raises(ValueError, match="insulating punch carries no charge"):
        precise.solve(SIH_SONG, radius=0.05, load=1e5, charge=1e-6, electric="insulating")
