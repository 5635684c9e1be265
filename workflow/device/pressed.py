"""A press in time on a contact of a study: pressed, held and let go, as its amplifier reads it."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from solver import Material, Stack, solve
from solver.face.cases import Cases
from solver.face.factors import checked
from solver.face.materials import material_of
from solver.film.electrodes import Electrode
from workflow.device.circuit import Circuit
from workflow.device.contact import Contact, film
from workflow.device.signal import DROP, Figures, History, read
from workflow.study import layered
from workflow.study.model import Study
from workflow.study.pressing import Pressing

#: What stands before the names of quantities of a contact at the force that is held.
HELD = "held_"
_PARTS = 40  # into which each part of the history is divided


def history(pressing: Pressing) -> History:
    """The forces: even up, held, even down, and a fifth of the hold without."""
    times = np.cumsum([0.0, pressing.press, pressing.hold, pressing.press, pressing.hold / 5])
    return History(times, np.array([0.0, pressing.force, pressing.force, 0.0, 0.0])).finer(_PARTS)


def signal(study: Study, pressing: Pressing, case: Mapping[str, Any]) -> xr.Dataset:
    """The signal of a press on a case.

    Parameters
    ----------
    study
        Which has an amplifier.
    pressing
        How hard and how long.
    case
        Factors of the case, categories among them; of a study's body those that its layers name.

    Returns
    -------
    xarray.Dataset
        ``force``, ``charge``, ``voltage`` and ``output`` over ``time``, in SI; numbers: ``contact_charge`` and
        ``capacitance`` at the force that is held, ``time_constant``, ``drop`` (share lost in ten seconds),
        ``noise_charge``, ``noise_output`` and ``noise_force``.
    """
    assert study.device is not None
    numbers, force = study.device.constants, study.kind.loads.force
    given = {name: value for name, value in case.items() if name != force}
    length, most = numbers.get("electrode_length", 1.0), pressing.force
    body: Stack | None = None
    if study.body:
        body = layered.stack(study.body, given, study.own_materials, study.phases)
        material = _beside(body, given)
    else:
        pressed = checked({**given, force: most / length})
        material = material_of(Cases(pressed, study.own_materials, (study.phases[0], study.phases[1])))
        body = film(given, material) if "thickness" in given else None
    contact = Contact.of(
        given,
        most,
        length=length,
        materials=study.own_materials,
        solved=lambda one: study.solved(solve, one),
        body=body,
    )
    circuit = Circuit.of(numbers, material)
    times, told = history(pressing), Figures.of(contact, circuit, numbers["temperature"])
    reading = read(times, contact, circuit)
    out = xr.Dataset(coords={"time": ("time", times.times, {"units": "s", "long_name": "time"})})
    for name, values, units, said in (
        ("force", times.forces, "N", "force on the punch"),
        ("charge", reading.charge, "C", "charge of the contact"),
        ("voltage", reading.voltage, "V", "voltage that the contact is read at"),
        ("output", reading.output, "V", "output of the amplifier"),
    ):
        out[name] = ("time", values, {"units": units, "long_name": said})
    for name, value, units, said in (
        ("contact_charge", told.charge, "C", "charge at zero volts, at the force that is held"),
        ("capacitance", told.capacitance, "F", "capacitance of the contact at the force that is held"),
        ("time_constant", told.lasting, "s", "time constant of a constant force"),
        ("drop", told.drop(DROP), "1", f"share that a constant force loses in {DROP:g} s"),
        ("noise_charge", told.noise[0], "C", "noise as a charge, root mean square"),
        ("noise_output", told.noise[1], "V", "noise at the output, root mean square"),
        ("noise_force", told.noise[2], "N", "noise as a force, root mean square"),
    ):
        out[name] = ((), value, {"units": units, "long_name": said})
    return out


def held(study: Study, pressing: Pressing) -> xr.Dataset:
    """Quantities of the contact while the force is held, at zero charge, each with ``HELD`` before its name.

    Parameters
    ----------
    study
        Of one case, as `workflow.study.beside.pressed` makes it.
    pressing
        How hard.
    """
    force = {
        study.kind.loads.force: pressing.force
        / (study.device.constants if study.device else {}).get("electrode_length", 1.0)
    }
    solved = study.solved(solve, {**study.fixed, **force})
    return solved.drop_vars(list(solved.coords)).rename({name: f"{HELD}{name}" for name in solved.data_vars})


def _beside(body: Stack, case: Mapping[str, Any]) -> Material:
    """What charge leaks through: the layer beside the electrode that is read, or else the top one."""
    between = Electrode(body, int(case["collector"])).between if "collector" in case else []
    return body.layers[between[0][-1] if between else 0].material
