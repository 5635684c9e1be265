"""A punch of revolution on a half-space in many digits (mpmath): the classical formulas and differences of them.

Hertz's problem with the compliance lambda for every power of r (Sneddon 1965), charges from the response of the
conducted fields, tangents by differences at 1e-30.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from mpmath import beta, fdot, inverse, lu_solve, matrix, mp, mpf, pi, sqrt

from verification.oracles.half_plane import WORK_DIGITS, half_plane

_STEP = mpf(10) ** -30
_UNITS = (mpf("1e-9"), mpf("1e-6"))  # sizes of the charges' steps, C and Wb
#: Names of the quantities of the electric and of the magnetic field.
_NAMES = (
    ("voltage", "voltage_per_force", "charge_per_force", "stroke_per_volt", "blocked_force_per_volt", "capacitance",
     "electric_edge_intensity"),
    ("magnetic_potential", "magnetic_potential_per_force", "flux_per_force", "stroke_per_ampere",
     "blocked_force_per_ampere", "permeance", "magnetic_edge_intensity"),
)  # fmt: skip


@dataclass(frozen=True)
class Punch:
    """A conducting profile C r^e, e > 0, or a disc of a radius, on a material."""

    compliance: matrix  # N over (y, phi, psi), 3 x 3
    # C and e; of a disc its radius and 0
    coefficient: mpf
    exponent: mpf

    @property
    def conducting(self) -> matrix:
        """M: N over (phi, psi)."""
        return self.compliance[1:, 1:]

    @property
    def screening(self) -> list[mpf]:
        """r = M^-1 n over (phi, psi)."""
        return list(lu_solve(self.conducting, self.compliance[1:, 0]))

    @property
    def lam(self) -> mpf:
        """Normal compliance under the punch."""
        return self.compliance[0, 0] - fdot(self.compliance[1:, 0], self.screening)

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


def _answer(punch: Punch, loads: Sequence[mpf]) -> list[mpf]:
    """Return depth [m] and potentials [V, A] under force, charge and magnetic charge."""
    force, *charges = loads
    a = punch.radius(force)
    approach = punch.approach(a) if punch.exponent else force * punch.lam / (4 * a)
    sums = matrix([charge + r * force for charge, r in zip(charges, punch.screening, strict=True)])
    potentials = list(-punch.conducting * sums / (4 * a))
    return [approach - fdot(punch.screening, potentials), *potentials]


def quantities(
    material: Mapping[str, float],
    *,
    exponent: float,
    coefficient: float,
    force: float,
    charge: float,
    magnetic_charge: float,
) -> dict[str, float]:
    """Quantities as they are named in ``solver.names``, SI units; ``peak_pressure`` where it is at the centre."""
    with mp.workdps(WORK_DIGITS):
        punch = Punch(half_plane(material).normal_compliance, mpf(coefficient), mpf(exponent))
        named = _named(punch, [mpf(force), mpf(charge), mpf(magnetic_charge)])
        return {name: float(value) for name, value in named.items()}


def _named(punch: Punch, loads: Sequence[mpf]) -> dict[str, mpf]:
    P, (depth, *potentials), a = loads[0], _answer(punch, loads), punch.radius(loads[0])
    held, uncharged = _inverse_tangent(punch, loads), _inverse_tangent(punch, [P, mpf(0), mpf(0)])
    stiff = inverse(held)  # d(P, charges) / d(depth, potentials)
    named = {"contact_radius": a, "depth": depth}
    if punch.exponent > 1:
        named["peak_pressure"] = punch.central_pressure(a)
    named |= {"contact_stiffness": stiff[0, 0], "contact_stiffness_open": 1 / held[0, 0]}
    # below a conductor D = -r sigma + M^-1 (2/pi) V / sqrt(a^2 - s^2): its edge strength
    strengths = 2 / pi * lu_solve(punch.conducting, matrix(potentials)) / a
    capacities = -4 * a * inverse(punch.conducting)
    for i, names in enumerate(_NAMES):
        strength, r = strengths[i], punch.screening[i]
        if not punch.exponent:
            strength += r * P / (2 * pi * a * a)
        values = (
            potentials[i], uncharged[i + 1, 0], -r, -stiff[0, i + 1] / stiff[0, 0], stiff[0, i + 1], capacities[i, i],
            sqrt(pi * a) * strength,
        )  # fmt: skip
        named |= dict(zip(names, values, strict=True))
    return named


def _inverse_tangent(punch: Punch, loads: Sequence[mpf]) -> matrix:
    """d(depth, potentials) / d(P, charges), by central differences."""
    out = matrix(3, 3)
    for cause, size in enumerate((loads[0], *_UNITS)):
        ahead, behind = (
            _answer(punch, [load + sign * _STEP * size * (k == cause) for k, load in enumerate(loads)])
            for sign in (1, -1)
        )
        for row in range(3):
            out[row, cause] = (ahead[row] - behind[row]) / (2 * _STEP * size)
    return out
