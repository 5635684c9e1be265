"""A roller in place of a ball, for docs/limits.md: ``python docs/points.py`` prints the table."""

from typing import Any

import numpy as np
from scipy.optimize import brentq

import solver

RADIUS, THICKNESS = 5e-3, 1e-4
MATERIALS = ("PZT-4", "BaTiO3")
RATIOS = (0.2, 1.0, 5.0)
_PUNCHES = {"ball": ("sphere", "force", "contact_radius"), "roller": ("cylinder", "load", "contact_trailing")}


def numbers() -> dict[tuple[str, float, str], dict[str, float]]:
    """What a ball and a roller give on a film on a rigid grounded base, by material, a/h and what is given.

    Charge per force [pC/N] and stroke per volt [pm/V] of each, depth R/a^2, and largest pressure R/a [GPa].
    """
    found = {}
    for material in MATERIALS:
        for ratio in RATIOS:
            each = {name: _solved(material, ratio, *punch) for name, punch in _PUNCHES.items()}
            for of in each["ball"]:
                found[material, ratio, of] = {name: values[of] for name, values in each.items()}
    return found


def _solved(material: str, ratio: float, profile: str, pressing: str, extent: str) -> dict[str, float]:
    """The figures of a punch that is pressed until its contact has the half-width a = ratio h."""
    a = ratio * THICKNESS
    case: dict[str, Any] = {"material": material, "profile": profile, "radius": RADIUS, "thickness": THICKNESS}

    def at(log_force: float) -> dict[str, float]:
        solved = solver.solve(case | {"base": "rigid", pressing: float(np.exp(log_force))})
        return {str(name): float(values) for name, values in solved.items()}

    def off(log_force: float) -> float:
        return float(np.log(at(log_force)[extent] / a))

    mean_strain, area = max(ratio, 1.0) * a / RADIUS, a**2 if pressing == "force" else a
    guess = float(np.log(solver.find(material).c33 * mean_strain * area))
    found = at(brentq(off, guess - 2, guess + 2, xtol=1e-7))
    return {
        "charge per force": found["charge_sensitivity"] * 1e12,
        "stroke per volt": found["stroke_per_volt"] * 1e12,
        "depth": found["depth"] * RADIUS / a**2,
        "largest pressure": found["peak_pressure"] * RADIUS / a / 1e9,
    }


if __name__ == "__main__":
    for key, values in numbers().items():
        print(*key, " ".join(f"{name} {value:.4g}" for name, value in values.items()))
