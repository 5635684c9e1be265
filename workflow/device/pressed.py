"""The signal of a press in time on a contact of a study: pressed, held and let go."""

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from solver import Material, Stack, solve
from solver.heat.charge import HeatError
from solver.names import BODY, FACTORS, OF_HEAT
from solver.stack.electrodes import Electrode
from workflow.device.circuit import Circuit
from workflow.device.contact import ContactCurves, film
from workflow.device.signal import DROP, Figures, History, Warmth, read
from workflow.language.constants import DEVICE
from workflow.study import layered
from workflow.study.model import Study
from workflow.study.sections import Pressing

_PARTS = 40  # into which each part of the history is divided


def history(pressing: Pressing, case: Mapping[str, Any]) -> History:
    """Return forces that rise, are held, fall and are zero for a fifth of the hold; and likewise temperatures."""
    times = np.cumsum([0.0, pressing.press, pressing.hold, pressing.press, pressing.hold / 5])
    shape, temperatures = np.array([0.0, 1.0, 1.0, 0.0, 0.0]), None
    if "touch_temperature" in case:
        body = case.get("body_temperature", FACTORS["body_temperature"].default)
        temperatures = body + (case["touch_temperature"] - body) * shape
    return History(times, pressing.force * shape, temperatures).divided(_PARTS)


def signal(study: Study, pressing: Pressing, case: Mapping[str, Any]) -> xr.Dataset:
    """Return the signal of a press on a case."""
    assert study.device is not None
    numbers = study.device.constants | {name: float(case[name]) for name in DEVICE if name in case}
    factors, body, material = _pressed(study, pressing, case)
    solved = partial(study.solved, solve)
    contact = ContactCurves.from_case(factors, pressing.force, length=length(study), solved=solved, body=body)
    circuit = Circuit.of(numbers, material)
    times, figures = history(pressing, case), Figures.of_contact(contact, circuit, numbers["temperature"])
    warm, lacking = _warmth(study, pressing, case, times, {**factors, **({BODY: body} if study.body else {})})
    heat = np.zeros(len(times.times)) if warm is None else warm.charge(times)
    reading = read(times, contact, circuit, heat)
    out = xr.Dataset(coords={"time": ("time", times.times, {"units": "s", "long_name": "time"})})
    for name, values, units, long_name in (
        ("force", times.forces, "N", "force on the punch"),
        ("charge", reading.charge, "C", "charge of the contact"),
        ("voltage", reading.voltage, "V", "voltage that the contact is read at"),
        ("output", reading.output, "V", "output of the amplifier"),
        ("contact_charge", figures.charge, "C", "charge at zero volts, at the force that is held"),
        ("contact_output", figures.output, "V", "output that this charge gives at once, without heat and bias current"),
        ("capacitance", figures.capacitance, "F", "capacitance of the contact at the force that is held"),
        ("time_constant", figures.time_constant, "s", "time constant of a constant force"),
        ("drop", figures.drop(DROP), "1", f"share that a constant force loses in {DROP:g} s"),
        ("noise_charge", figures.noise[0], "C", "noise as a charge, root mean square"),
        ("noise_output", figures.noise[1], "V", "noise at the output, root mean square"),
        ("noise_force", figures.noise[2], "N", "noise as a force, root mean square"),
    ):
        out[name] = ("time" if np.ndim(values) else (), values, {"units": units, "long_name": long_name})
    if warm is not None and times.temperatures is not None:
        out["temperature"] = ("time", times.temperatures, {"units": "K", "long_name": "temperature of what touches"})
        out["heat"] = ("time", heat, {"units": "C", "long_name": "charge that its heat has made"})
        held = float(np.interp(pressing.press + pressing.hold, times.times, heat))
        out["heat_at_end"] = ((), held, {"units": "C", "long_name": "charge of the heat at the end of the hold"})
    return out.assign_attrs({"heat": lacking} if lacking else {})


def _warmth(
    study: Study, pressing: Pressing, case: Mapping[str, Any], times: History, factors: Mapping[str, Any]
) -> tuple[Warmth | None, str]:
    """Return the heat of a press on a case; without heat None and the reason, empty where nothing is warm."""
    if "touch_temperature" not in case:
        return None, ""
    solved = study.solved(solve, {**_cold(case), study.kind.loads.force: pressing.force / length(study)})
    try:
        return Warmth.of_case(
            factors, solved, times, length=length(study), materials=study.own_materials, phases=study.phases
        ), ""
    except HeatError as error:
        return None, str(error).removeprefix("heat: ")


def _cold(case: Mapping[str, Any]) -> dict[str, Any]:
    """Return the factors of a case without those of heat."""
    return {name: value for name, value in case.items() if name not in OF_HEAT}


def length(study: Study) -> float:
    """Return the length of a line contact [m], whose load is per metre; 1 of a point."""
    return (study.device.constants if study.device else {}).get("electrode_length", 1.0)


def _pressed(
    study: Study, pressing: Pressing, case: Mapping[str, Any]
) -> tuple[dict[str, Any], Stack | None, Material]:
    """Return a case's factors without force and heat, its layers or None, and the material that leaks charge."""
    force = study.kind.loads.force
    factors = {name: value for name, value in _cold(case).items() if name != force}
    if study.body:
        body = layered.stack(study.body, factors, study.own_materials, study.phases)
        return factors, body, _leaking_layer(body, factors)
    pressed = {**factors, force: pressing.force / length(study)}
    return factors, *film(pressed, study.own_materials, study.phases)


def _leaking_layer(body: Stack, case: Mapping[str, Any]) -> Material:
    """Return the material of the layer at the electrode that is read, or of the top layer."""
    between = Electrode(body, int(case["collector"])).between if "collector" in case else []
    return body.layers[between[0][-1] if between else 0].material
