"""Numbers of docs/limits.md: ``python docs/limits.py`` prints them."""

import numpy as np

import solver
from solver.halfplane.sliding import Sliding
from solver.halfplane.surface import HalfPlane

CASE = {"volume_fraction": 0.5, "radius": 0.05, "load": 1e5, "friction": 0.3}


def numbers() -> dict[str, float]:
    """What the page says, by name; SI."""
    data = np.array([0.01, 0.1, 1.0, 10.0])
    at = solver.solve({**CASE, "datum": data})
    free = ("charge_sensitivity", "stroke_per_volt", "contact_trailing", "peak_pressure", "trailing_tension")
    kinds = ["conducting", "insulating"]
    conducts = solver.solve({**CASE, "electric": kinds, "magnetic": kinds})
    width, pressure = conducts["contact_trailing"] + conducts["contact_leading"], conducts["peak_pressure"]
    bodies = [solver.find("steel"), solver.fibrous(solver.find("BaTiO3"), solver.find("CoFe2O4"), 0.5)]
    steel, body = (Sliding(HalfPlane(one), np.zeros(()), np.array([True, True])).lam for one in bodies)
    found = {
        f"volts per load, datum {d:g} m": abs(v) for d, v in zip(data, at["voltage_sensitivity"].values, strict=True)
    }
    return found | {
        "free of the datum within": max(
            float(np.ptp(at[name].values) / np.abs(at[name].values).mean()) for name in free
        ),
        "width between conductor and insulator": float(width.max() / width.min() - 1),
        "pressure between conductor and insulator": float(pressure.max() / pressure.min() - 1),
        "width under an elastic punch of steel": float(np.sqrt(1 + steel / body)) - 1,
        "(a/R)^2": float(at["contact_trailing"].max() / CASE["radius"]) ** 2,
        "largest pressure": float(at["peak_pressure"].max()),
        "tension behind the trailing edge": float(at["trailing_tension"].max()),
    }


if __name__ == "__main__":
    for name, value in numbers().items():
        print(f"{name:44s} {value:.3g}")
