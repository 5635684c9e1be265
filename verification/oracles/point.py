"""A punch of revolution on a half-space in many digits (mpmath): the classical formulas and differences of them.

Hertz's problem with the compliance lambda for every power of r (Sneddon 1965), charges from the response of the
conducted fields, tangents by differences at 1e-30.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from mpmath import beta, inverse, lu_solve, matrix, mp, mpf, pi, sqrt

from verification.oracles.half_plane import WORK_DIGITS, half_plane

_STEP = mpf(10) ** -30
_UNIT = {1: mpf("1e-9"), 2: mpf("1e-6")}  # C and Wb


@dataclass(frozen=True)
class Punch:
    """A profile C r^e, e > 0, or a disc of a radius, on a material."""

    compliance: matrix  # N over (y, phi, psi), including an elastic punch; 3 x 3
    conducted: tuple[int, ...]  # Which of 1 (electric) and 2 (magnetic) the punch conducts
    # C and e; of a disc its radius and 0
    coefficient: mpf
    exponent: mpf

    @property
    def conducting(self) -> matrix:
        """M: N over the conducted fields."""
        return matrix([[self.compliance[i, j] for j in self.conducted] for i in self.conducted])

    @property
    def screening(self) -> list[mpf]:
        """r = M^-1 n over the conducted fields."""
        if not self.conducted:
            return []
        return list(lu_solve(self.conducting, matrix([self.compliance[i, 0] for i in self.conducted])))

    @property
    def lam(self) -> mpf:
        """Normal compliance under the punch."""
        pairs = zip(self.conducted, self.screening, strict=True)
        return self.compliance[0, 0] - sum(self.compliance[i, 0] * r for i, r in pairs)

    def approach(self, a: mpf) -> mpf:
        """d = a int_0^a g'(s) / sqrt(a^2 - s^2) ds."""
        return self.coefficient * self.exponent * a**self.exponent * beta(self.exponent / 2, mpf(1) / 2) / 2

    def force(self, a: mpf) -> mpf:
        """P = (4/lambda) int_0^a s^2 g'(s) / sqrt(a^2 - s^2) ds."""
        share = beta(self.exponent / 2 + 1, mpf(1) / 2) / 2
        return 4 / self.lam * self.coefficient * self.exponent * a ** (self.exponent + 1) * share

    def radius(self, force: mpf) -> mpf:
        """The radius that carries a force."""
        if not self.exponent:
            return self.coefficient
        of_one = self.force(mpf(1))  # P goes with a^(e + 1)
        return (force / of_one) ** (1 / (self.exponent + 1))

    def central_pressure(self, a: mpf) -> mpf:
        """p = (2/(pi lambda)) int_0^a d'(t) / t dt, d' the derivative of the approach; e > 1."""
        return 2 * self.approach(a) * self.exponent / (pi * self.lam * a * (self.exponent - 1))


def _answer(punch: Punch, force: mpf, charges: Mapping[int, mpf]) -> dict[str, mpf]:
    """Return radius [m], depth [m] and potentials (u1, u2) [V, A] under the charges of the conducted fields."""
    a = punch.radius(force)
    approach = punch.approach(a) if punch.exponent else force * punch.lam / (4 * a)
    sums = matrix([charges[i] + r * force for i, r in zip(punch.conducted, punch.screening, strict=True)])
    potentials = list(-punch.conducting * sums / (4 * a)) if punch.conducted else []
    depth = approach - sum(r * u for r, u in zip(punch.screening, potentials, strict=True))
    return {"radius": a, "depth": depth} | {f"u{i}": u for i, u in zip(punch.conducted, potentials, strict=True)}


def quantities(
    material: Mapping[str, float],
    *,
    exponent: float,
    coefficient: float,
    force: float,
    charge: float = 0.0,
    magnetic_charge: float = 0.0,
    conducted: tuple[int, ...] = (1, 2),
    punch_compliance: float = 0.0,
) -> dict[str, float]:
    """Quantities as they are named in ``solver.names``, SI units; ``peak_pressure`` where it is at the centre."""
    with mp.workdps(WORK_DIGITS):
        N = half_plane(material).normal_compliance.copy()
        N[0, 0] += mpf(punch_compliance)
        punch = Punch(N, conducted, mpf(coefficient), mpf(exponent))
        charges = {1: mpf(charge), 2: mpf(magnetic_charge)}
        return {name: float(value) for name, value in _named(punch, mpf(force), charges)}


def _named(punch: Punch, P: mpf, charges: dict[int, mpf]) -> list[tuple[str, mpf]]:
    answer = _answer(punch, P, charges)
    a, nothing = answer["radius"], {1: mpf(0), 2: mpf(0)}
    named = [("contact_radius", a), ("depth", answer["depth"])]
    if punch.exponent > 1:
        named.append(("peak_pressure", punch.central_pressure(a)))
    held = _inverse_tangent(punch, P, charges)
    stiff = inverse(held)  # d(P, charges) / d(depth, potentials)
    named += [("contact_stiffness", stiff[0, 0]), ("contact_stiffness_open", 1 / held[0, 0])]
    names = {
        1: ("voltage", "voltage_per_force", "charge_per_force", "stroke_per_volt", "blocked_force_per_volt",
            "capacitance", "electric_edge_intensity"),
        2: ("magnetic_potential", "magnetic_potential_per_force", "flux_per_force", "stroke_per_ampere",
            "blocked_force_per_ampere", "permeance", "magnetic_edge_intensity"),
    }  # fmt: skip
    for place, i in enumerate(punch.conducted, 1):
        uncharged = _inverse_tangent(punch, P, nothing)
        grounded = -punch.screening[place - 1]
        # below a conductor D = -r sigma + M^-1 (2/pi) V / sqrt(a^2 - s^2): its edge strength
        potentials = matrix([answer[f"u{j}"] for j in punch.conducted])
        strength = 2 / pi * lu_solve(punch.conducting, potentials)[place - 1] / a
        if not punch.exponent:
            strength += punch.screening[place - 1] * P / (2 * pi * a * a)
        values = (
            answer[f"u{i}"], uncharged[place, 0], grounded, -stiff[0, place] / stiff[0, 0], stiff[0, place],
            -4 * a * inverse(punch.conducting)[place - 1, place - 1], sqrt(pi * a) * strength,
        )  # fmt: skip
        named += list(zip(names[i], values, strict=True))
    return named


def _inverse_tangent(punch: Punch, P: mpf, charges: dict[int, mpf]) -> matrix:
    """d(depth, potentials) / d(P, charges), by central differences."""
    keys = ["depth", *(f"u{i}" for i in punch.conducted)]

    def moved(cause: int, share: mpf) -> dict[str, mpf]:
        if cause == 0:
            return _answer(punch, P * (1 + share), charges)
        i = punch.conducted[cause - 1]
        return _answer(punch, P, charges | {i: charges[i] + share * _UNIT[i]})

    sizes = [P, *(_UNIT[i] for i in punch.conducted)]
    out = matrix(len(keys), len(keys))
    for cause, size in enumerate(sizes):
        ahead, behind = moved(cause, _STEP), moved(cause, -_STEP)
        for row, key in enumerate(keys):
            out[row, cause] = (ahead[key] - behind[key]) / (2 * _STEP * size)
    return out
