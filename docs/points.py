"""A roller in place of a ball, for docs/limits.md: ``python docs/points.py`` prints the table."""

from typing import Any

import numpy as np
import xarray as xr
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

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
            "charge per force": values["charge_per_force"] * 1e12,
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
        return solver.solve(case | {"base": "rigid", "surroundings": "insulated", pressing: force}).transpose(
            "of", "ratio", ...
        )

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


_WORK = 0.05  # of adhesion [J/m^2], metals in humid air


def left_out() -> dict[str, float]:
    """What limits.md says of points that the solver leaves out, by name."""
    disc: dict[str, Any] = {"profile": "disc", "width": 1e-4, "force": 1.0, "magnetic": "insulating"}
    fringe = {name: _FRINGE * 1e-4 / 2 / float(solver.solve(disc | {"material": name})["capacitance"])
              for name in ("BaTiO3", "PVDF")}  # fmt: skip
    ball: dict[str, Any] = {"material": "BaTiO3", "profile": "sphere", "radius": RADIUS}
    thick = numbers()["BaTiO3", 0.2, "charge per force"]["ball"], numbers()["BaTiO3", 0.2, "depth"]["ball"]
    alone = solver.solve(ball | {"force": 1.0})
    constant = abs(float(alone["charge_per_force"])) * 1e12
    depth = float(alone["depth"] * RADIUS / alone["contact_radius"] ** 2)
    return {
        "pull-off of a ball [mN]": 1.5e3 * np.pi * _WORK * RADIUS,
        **{f"adhesion, radius at {force:g} N": _sticking(RADIUS, force) for force in (1.0, 0.01)},
        "adhesion, radius of a probe": _sticking(1e-6, 1e-5),
        **{f"ellipse of 1 to {ratio:g}, {name}": off for ratio in (2.0, 10.0) for name, off in _ellipse(ratio).items()},
        **{f"fringe of a disc on {name}": share for name, share in fringe.items()},
        "finite body, charge per force": 1 - thick[0] / constant,
        "finite body, depth": 1 - thick[1] / depth,
    }


_FRINGE = 4 * 8.8541878188e-12  # F per radius of a disc that faces air


def _sticking(radius: float, force: float) -> float:
    """By how much adhesion widens the contact of a ball (Johnson, Kendall, Roberts 1971)."""
    pull = 3 * np.pi * _WORK * radius
    return float((1 + (pull + np.sqrt(2 * pull * force + pull**2)) / force) ** (1 / 3) - 1)


def _ellipse(ratio: float) -> dict[str, float]:
    """An ellipsoid's mean radius and largest pressure over those of the ball of the same mean curvature, less 1.

    Hertz, by Johnson (1985), eq. 4.28 to 4.32; the ball's radius is the root of the product of both.
    """

    def of(e: float) -> tuple[float, float, float]:
        K, E = float(ellipk(e * e)), float(ellipe(e * e))
        short = np.sqrt(1 - e * e)
        return (E / short**2 - K) / (K - E), K, E

    e = float(brentq(lambda e: of(e)[0] - ratio, 1e-3, 1 - 1e-12))
    _, K, E = of(e)
    short = np.sqrt(1 - e * e)
    cube = 4 / (np.pi * e * e) * short**1.5 * np.sqrt((E / short**2 - K) * (K - E))
    return {"radius": float(cube ** (1 / 3) - 1), "pressure": float(cube ** (-2 / 3) - 1)}


if __name__ == "__main__":
    for name, value in left_out().items():
        print(f"{name:40s} {value:.3g}")
    for key, values in numbers().items():
        print(*key, " ".join(f"{name} {value:.4g}" for name, value in values.items()))
