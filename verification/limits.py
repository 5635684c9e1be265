"""Classical limits and symmetries of the closed form, by textbook formulas."""

from typing import Any

import numpy as np

import solver
from solver.material.constants import ANY_SIZE
from verification.cases import CHARGED, SIH_SONG, Array, constants
from verification.findings import Check, Findings, Sizes, check, off, off_each
from verification.oracles import precise
from verification.oracles.surface_response import angular_integrals, reduced, surface_response

X = np.array([-6.0, -1.5, -0.999, -0.4, 0.1, 0.6, 0.98, 1.2, 4.0])
INSIDE = np.abs(X) < 1
STEEL = (200e9, 0.3)
PUNCH = {"radius": 0.05, "load": 1e5}
POTENTIALS = ("voltage", "magnetic_potential")
#: By the remaining field (1 electric, 2 magnetic): constants that vanish, constants without influence, the charge.
_UNCOUPLED: dict[int, tuple[tuple[str, ...], tuple[str, ...], dict[str, float]]] = {
    1: (("f31", "f33", "f15", "g11", "g33"), ("mu11", "mu33"), {"charge": 1e-6}),
    2: (("e31", "e33", "e15", "g11", "g33"), ("eps11", "eps33"), {"magnetic_charge": -2e-3}),
}


def run(_: Sizes) -> Findings:
    """All limits."""
    smaller = "the problem of displacements and {} potential alone, the other field absent"
    return Findings(
        "Limits and symmetries",
        "What the closed form becomes where the answer is in a textbook, and what must not change it.",
        [
            check("Hertz", "ends, peak and pressure of a cylinder on steel", 1e-13, hertz),
            check("Hertz, inside", "stresses on the axis below the contact (Johnson 1985, 4.2)", 1e-12, _hertz_inside),
            check("Isotropic sliding", "exponent, ends, pressure of Guler and Erdogan (2007)", 1e-12, _sliding),
            check("Sadowsky", "pressure of a flat punch without friction", 1e-13, _flat, 0.0),
            check("Flat punch, sliding", "p = P sin(pi alpha)/pi (a-x)^(alpha-1) (x+b)^-alpha", 1e-12, _flat, 0.7),
            check("Piezoelectric", smaller.format("electric"), 1e-11, _uncoupled, 1),
            check("Piezomagnetic", smaller.format("magnetic"), 1e-11, _uncoupled, 2),
            *_reciprocity(),
            check("Mirror", "sliding the other way, by the 50-digit oracle at -eta", 1e-11, _mirror),
            check("Units", "everything in millimetres, tonnes and milliamperes", 1e-11, _units),
        ],
    )  # fmt: skip


def hertz() -> float:
    """Largest relative error of a, b, p_max and p."""
    out = solver.solve({"material": solver.Material.isotropic(*STEEL), **PUNCH}, X)
    half, peak = _hertz()
    numbers = off_each([out.contact_trailing, out.contact_leading, out.peak_pressure], [half, half, peak])
    return max(numbers, off(out.contact_pressure, peak * np.sqrt(np.maximum(1 - X**2, 0))))


def _hertz() -> tuple[float, float]:
    modulus = STEEL[0] / (1 - STEEL[1] ** 2)
    half = np.sqrt(4 * PUNCH["radius"] * PUNCH["load"] / (np.pi * modulus))
    return half, 2 * PUNCH["load"] / (np.pi * half)


def _hertz_inside() -> float:
    """Largest error of sigma_xx and sigma_yy on the axis over the peak pressure."""
    depth = np.array([0.01, 0.3, 0.786, 2.0, 10.0])
    out = solver.solve_interior({"material": solver.Material.isotropic(*STEEL), **PUNCH}, [0.0], -depth)
    peak, root = _hertz()[1], np.sqrt(1 + depth**2)
    xx, yy = -peak * ((1 + 2 * depth**2) / root - 2 * depth), -peak / root
    return max(off(out.stress_xx.values[:, 0], xx), off(out.stress_yy.values[:, 0], yy))


def _sliding() -> float:
    """Largest relative error of alpha, a, b and the pressure over frictions from 0.01 to 3."""
    young, poisson = STEEL
    worst = 0.0
    for friction in (0.01, 0.3, 1.0, 3.0):
        out = solver.solve({"material": solver.Material.isotropic(*STEEL), **PUNCH, "friction": friction}, X)
        lam = 2 * (1 - poisson**2) / young
        kap = -lam * (1 - 2 * poisson) / (2 * (1 - poisson))
        alpha, trailing, leading = _ends(lam, kap, friction)
        inside = X[INSIDE]
        pressure = np.sin(np.pi * alpha) / (lam * PUNCH["radius"]) * (trailing + leading) / 2
        pressure = pressure * (1 - inside) ** alpha * (1 + inside) ** (1 - alpha)
        ends = out.pressure_exponent, out.contact_trailing, out.contact_leading
        result = [*ends, *out.contact_pressure.values[INSIDE]]
        worst = max(worst, off_each(result, [alpha, trailing, leading, *pressure]))
    return worst


def _ends(lam: float, kap: float, friction: float) -> tuple[float, float, float]:
    """Exponent and ends of a sliding cylinder (theory section 3)."""
    alpha = float(np.arctan2(1, -friction * kap / lam)) / np.pi
    width = float(np.sqrt(2 * lam * PUNCH["radius"] * PUNCH["load"] / (np.pi * alpha * (1 - alpha))))
    return alpha, (1 - alpha) * width, alpha * width


def _flat(friction: float) -> float:
    """Largest relative error of the pressure under a flat punch."""
    case = {"material": SIH_SONG, "profile": "flat", "width": 4e-4, "load": 1e5, "friction": friction}
    out = solver.solve(case, X)
    _, alpha = reduced(surface_response(constants(solver.find(SIH_SONG))), friction)
    inside = X[INSIDE]
    pressure = 1e5 * np.sin(np.pi * alpha) / (np.pi * 2e-4) * (1 - inside) ** (alpha - 1) * (1 + inside) ** -alpha
    return off_each(out.contact_pressure.values[INSIDE], pressure)


def _uncoupled(field: int) -> float:
    """Return the error of a material coupled to one field only against the problem of that field.

    It includes the answer of the other field, which must vanish, and the influence of that field's constants.
    """
    zero, other, charge = _UNCOUPLED[field]
    m = constants(solver.find(SIH_SONG)) | dict.fromkeys(zero, 0.0)
    case = {**PUNCH, "friction": 0.4, **charge}
    alone, coupled = (
        solver.solve({"material": solver.Material.from_mapping(m | change), **case}, X)
        for change in ({}, {name: 7 * m[name] for name in other})
    )
    names = ["contact_trailing", "contact_leading", "peak_pressure", "depth", POTENTIALS[field - 1]]
    same = off_each([alone[name] for name in names], [coupled[name] for name in names])
    silent = ("magnetic_potential", "magnetic_induction_y") if field == 1 else ("voltage", "electric_displacement_y")
    answered = max(float(np.max(np.abs(alone[name]))) for name in silent)

    N, k = _smaller(m, field)
    lam = N[0, 0] - N[0, 1] ** 2 / N[1, 1]
    kap = k[0] - N[0, 1] * k[1] / N[1, 1]
    values = [alone.pressure_exponent, alone.contact_trailing, alone.contact_leading]
    return max(same, answered, off_each(values, _ends(lam, kap, case["friction"])))


def _smaller(m: dict[str, float], field: int) -> tuple[Array, Array]:
    """Return N and k over (y, one potential) by angular integrals of the problem of three unknowns."""
    keep = [0, 1, 1 + field]
    full = surface_response(m)
    units = np.array([1.0, 1.0, (1e10, 1e8)[field - 1]])
    Q, R, T = (units[:, None] * block[np.ix_(keep, keep)] * units / 1e11 for block in (full.Q, full.R, full.T))
    local, compliance = angular_integrals(Q, R, T)
    scale = units[:, None] * units / 1e11
    return (compliance * scale)[1:, 1:], (local * scale)[1:, 0]


def _reciprocity() -> list[Check]:
    """Return checks of Betti's law for both fields: without friction, depth per charge is minus voltage per load."""
    case = {"material": SIH_SONG, **PUNCH}
    still = solver.solve(case)

    def error(charge: str, size: float, potential: str) -> float:
        moved = solver.solve(case | {charge: size})
        return off_each((moved.depth - still.depth) / size, -still[potential] / PUNCH["load"])

    return [
        check("Betti, electric", "d depth/dT and -V/P", 1e-10, error, "charge", 1e-4, "voltage"),
        check("Betti, magnetic", "d depth/dJ and -Psi/P", 1e-10, error, "magnetic_charge", 1e-1,
              "magnetic_potential"),
    ]  # fmt: skip


def _mirror() -> float:
    """Largest relative error of the mirror image of every surface field."""
    solved = solver.solve({"material": SIH_SONG, **CHARGED}, X)
    other = precise.solve(
        constants(solver.find(SIH_SONG)), positions=(-X).tolist(), **CHARGED | {"friction": -CHARGED["friction"]}
    )
    odd = ("shear_traction", "electric_displacement_x", "magnetic_induction_x")
    return max(
        off(solved[name], (-1 if name in odd else 1) * np.array(values, dtype=float))
        for name, values in other.fields.items()
    )


def _units() -> float:
    """Largest relative change of quantities when constants, factors and answers are in other base units."""
    m, kg, A = 1e3, 1e-3, 1e3  # new units in a metre, a kilogram, an ampere
    scales = {"c": kg / m, "e": A / m**2, "f": kg / A, "eps": A**2 / (kg * m**3), "g": 1 / m, "mu": kg * m / A**2}
    factors = {"radius": m, "friction": 1, "load": kg, "charge": A / m, "magnetic_charge": kg * m / A, "datum": m}
    answers = {"contact_trailing": m, "contact_leading": m, "pressure_exponent": 1, "peak_pressure": kg / m}
    answers |= {"depth": m, "voltage": kg * m**2 / A, "magnetic_potential": A, "trailing_tension": kg / m}
    answers |= {"electric_edge_intensity_trailing": A / m**1.5, "magnetic_edge_intensity_trailing": kg / A * m**0.5}
    plain = constants(solver.find(SIH_SONG))
    plain.pop("rho", None)
    changed: dict[str, Any] = {name: value * scales[name.rstrip("0123456789")] for name, value in plain.items()}
    elastic = solver.solve({"material": solver.Material.from_mapping(plain), **CHARGED})
    two = solver.solve(
        {"material": solver.Material(**changed, any_size=ANY_SIZE), **{k: v * factors[k] for k, v in CHARGED.items()}}
    )  # fmt: skip
    return off_each([two[name] for name in answers], [float(elastic[name]) * unit for name, unit in answers.items()])
