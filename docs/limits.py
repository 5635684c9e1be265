"""Numbers of docs/limits.md: ``python docs/limits.py`` prints them."""

import numpy as np

import solver

CASE = {"volume_fraction": 0.5, "radius": 0.05, "load": 1e5, "friction": 0.3}


def numbers() -> dict[str, float]:
    """What the page says, by name; SI."""
    data = np.array([0.01, 0.1, 1.0, 10.0])
    at = solver.solve({**CASE, "datum": data})
    free = ("charge_sensitivity", "stroke_per_volt", "contact_trailing", "peak_pressure", "trailing_tension")
    kinds = ["conducting", "insulating"]
    conducts = solver.solve({**CASE, "electric": kinds, "magnetic": kinds})
    width, pressure = conducts["contact_trailing"] + conducts["contact_leading"], conducts["peak_pressure"]
    elastic = solver.solve({**CASE, "punch": ["rigid", "steel"]})
    under_steel = (elastic["contact_trailing"] + elastic["contact_leading"]).values
    found = {
        f"volts per load, datum {d:g} m": abs(v) for d, v in zip(data, at["voltage_sensitivity"].values, strict=True)
    }
    return found | {
        "free of the datum within": max(
            float(np.ptp(at[name].values) / np.abs(at[name].values).mean()) for name in free
        ),
        "width between conductor and insulator": float(width.max() / width.min() - 1),
        "pressure between conductor and insulator": float(pressure.max() / pressure.min() - 1),
        "width under an elastic punch of steel": float(under_steel[1] / under_steel[0]) - 1,
        "(a/R)^2": float(at["contact_trailing"].max() / CASE["radius"]) ** 2,
        "largest pressure": float(at["peak_pressure"].max()),
        "tension behind the trailing edge": float(at["trailing_tension"].max()),
    }


if __name__ == "__main__":
    for name, value in numbers().items():
        print(f"{name:44s} {value:.3g}")
