"""A roller in place of a ball, for docs/limits.md: ``python docs/points.py`` prints the table."""

from typing import Any

import numpy as np
import xarray as xr

import solver
from solver.arrays import Array

RADIUS, THICKNESS = 5e-3, 1e-4
MATERIALS = ("PZT-4", "BaTiO3")
RATIOS = (0.2, 1.0, 5.0)
_PUNCHES = {"ball": ("sphere", "force", "contact_radius"), "roller": ("cylinder", "load", "contact_trailing")}
_STEPS = 6  # of the secant, whose slope in logarithms hardly varies


def numbers() -> dict[tuple[str, float, str], dict[str, float]]:
    """What a ball and a roller give on a film on a rigid grounded base, by material, a/h and what is given.

    Charge per force [pC/N] and stroke per volt [pm/V] of each, depth R/a^2, and largest pressure R/a [GPa].
    """
    a = np.array(RATIOS) * THICKNESS
    found: dict[tuple[str, float, str], dict[str, float]] = {}
    for name, punch in _PUNCHES.items():
        values = _pressed(*punch)
        scaled = {
            "charge per force": values["charge_sensitivity"] * 1e12,
            "stroke per volt": values["stroke_per_volt"] * 1e12,
            "depth": values["depth"] * RADIUS / a**2,
            "largest pressure": values["peak_pressure"] * RADIUS / a / 1e9,
        }
        for of, table in scaled.items():
            for place, value in np.ndenumerate(table.values):
                found.setdefault((MATERIALS[place[0]], RATIOS[place[1]], of), {})[name] = float(value)
    return found


def _pressed(profile: str, pressing: str, extent: str) -> xr.Dataset:
    """Punches pressed until their contacts have the half-widths a = ratio h, over material and ratio."""
    over = xr.DataArray(list(MATERIALS), dims="of")
    case: dict[str, Any] = {"material": over, "profile": profile, "radius": RADIUS, "thickness": THICKNESS}
    a = np.array(RATIOS) * THICKNESS

    def at(log_force: Array) -> xr.Dataset:
        force = xr.DataArray(np.exp(log_force), dims=("of", "ratio"))
        return solver.solve(case | {"base": "rigid", pressing: force}).transpose("of", "ratio", ...)

    def off(log_force: Array) -> Array:
        return np.asarray(np.log(at(log_force)[extent].values / a))

    strain, area = np.maximum(RATIOS, 1.0) * a / RADIUS, a**2 if pressing == "force" else a
    last = np.log([solver.find(material).c33 * strain * area for material in MATERIALS])
    missing = off(last)
    log_force = last - missing
    for _ in range(_STEPS):
        still = off(log_force)
        slope = np.where(still == missing, 1.0, (log_force - last) / np.where(still == missing, 1.0, still - missing))
        last, missing, log_force = log_force, still, log_force - still * slope
    return at(log_force)


if __name__ == "__main__":
    for key, values in numbers().items():
        print(*key, " ".join(f"{name} {value:.4g}" for name, value in values.items()))
