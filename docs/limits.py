"""Numbers of docs/limits.md: ``python docs/limits.py`` prints them."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

import solver
from workflow.language import grammar
from workflow.language.constants import Meeting
from workflow.study.device import Device
from workflow.study.reading import read_yaml

CASE = {"volume_fraction": 0.5, "radius": 0.05, "load": 1e5, "friction": 0.3}


def numbers() -> dict[str, float]:
    """What the page says, by name; SI."""
    data = np.array([0.01, 0.1, 1.0, 10.0])
    at = solver.solve({**CASE, "datum": data})
    free = ("charge_per_force", "stroke_per_volt", "contact_trailing", "peak_pressure", "trailing_tension")
    conduction = ["conducting", "insulating"]
    conducts = solver.solve({**CASE, "electric": conduction, "magnetic": conduction})
    width, pressure = conducts["contact_trailing"] + conducts["contact_leading"], conducts["peak_pressure"]
    elastic = solver.solve({**CASE, "punch": ["rigid", "steel"]})
    under_steel = (elastic["contact_trailing"] + elastic["contact_leading"]).values
    errors = {"charge per load of PZT-4 on copper": _on_copper()} | {
        f"volts per load, datum {d:g} m": abs(v) for d, v in zip(data, at["voltage_per_load"].values, strict=True)
    }
    return errors | {
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


def _on_copper() -> float:
    """Charge per load of a film on 20 um of copper on silicon."""
    film, copper = solver.Layer(solver.find("PZT-4"), 2e-4), solver.Layer(solver.find("copper"), 2e-5)
    body = solver.Stack([film, copper], solver.find("silicon"))
    return abs(
        float(
            solver.solve({"body": body, "surroundings": "insulated", "radius": 0.05, "load": 2e4})["charge_per_force"]
        )
    )


#: Designs of ``config/film_sensor.yaml``, rounded, in the case that decides.
DESIGNS: dict[str, dict[str, float | str]] = {
    "charge": {"volume_fraction": 0.8345, "thickness": 2.16e-4, "radius": 0.0514, "load": 5e3, "base": "steel"},
    "voltage": {"volume_fraction": 0.8325, "thickness": 1.486e-3, "radius": 0.0432, "load": 5e3, "base": "steel"},
    "quiet": {"volume_fraction": 0.8325, "thickness": 3.3e-3, "radius": 0.102, "load": 1e4, "base": "steel"},
}
_GROUNDED = {"interface_electric": "grounded", "interface_magnetic": "grounded", "punch": "steel"}
_TOLD = {
    "charge_per_force": 1e12,
    "circuit_capacitance - input_capacitance - cable_capacitance": 1e12,
    "signal_voltage": 1.0,
    "smallest_force": 1e6,
    "contact_trailing + contact_leading": 1e6,
    "contact_trailing * contact_leading / (2 * radius)": 1e9,
}


def surroundings(name: str, case: Mapping[str, float | str]) -> str:
    """The row of a design: what it is insulated, and in air."""
    film = {"friction": 0.3, **_GROUNDED, **case}
    device = Device.model_validate(read_yaml(Path(__file__).parents[1] / "config/film_sensor.yaml")["device"])
    kinds: tuple[tuple[dict[str, str], Meeting], ...] = (
        ({"surroundings": "insulated"}, "line"),
        ({"surroundings": "air"}, "line in air"),
    )
    rows = []
    for own, meeting in kinds:
        found = solver.solve({**film, **own})
        known = {str(quantity): np.abs(values.values) for quantity, values in found.data_vars.items()}
        numbers = {factor: value for factor, value in case.items() if not isinstance(value, str)}
        known |= {factor: np.asarray(value) for factor, value in {**device.constants, **numbers}.items()}

        told = [float(grammar.parse(text, meeting).evaluate(known)) * scale for text, scale in _TOLD.items()]
        rows.append([f"{number:.3g}" for number in told])
    pairs = (", ".join(pair) for pair in zip(*rows, strict=True))
    return f"| {name} | {' | '.join(pairs)} |"


if __name__ == "__main__":
    for name, case in DESIGNS.items():
        print(surroundings(name, case))
    for name, value in numbers().items():
        print(f"{name:44s} {value:.3g}")
