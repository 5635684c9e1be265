"""``meecontact signal``: the signal of a history of forces as a table, and its figures in words."""

import argparse
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from pydantic import ValidationError

from approximation.arrays import Array, Indices
from solver import solve
from solver.body import Kind, kind_of
from solver.heat.charge import HeatError
from storage.files import output, writing
from workflow.cli.casetable import one_case, read_cases
from workflow.cli.textfile import write_columns
from workflow.cli.words import named, say
from workflow.device.circuit import Circuit
from workflow.device.contact import ContactCurves, film
from workflow.device.signal import DROP, GONE, Figures, History, Signal, Warmth, read
from workflow.language.given import DESTRUCTIVE_PRESSURE, lost_unit
from workflow.language.numbers import shown
from workflow.language.spelling import nearest
from workflow.study.reading import InputError, first_problem, located, number, read_material
from workflow.study.sections import Amplifier, Device

_MOST_WRITTEN = 1_000_000  # rows of a table of the signal
_MOST_PARTS = 1000
_MOST_TIMES = 10_000_000
_ROUGH = 1e-6  # error of curves that is reported
_NOISE = 0.02  # of the largest force, down to which a force below 0 counts as noise
#: Columns of a history beside force or load, with their units.
_COLUMNS = {"time": "s", "temperature": "K"}
_NEEDS = "a history has the columns time and force, as 'time [s],force [N]'; a line may have load [N m-1]"


def signal(options: argparse.Namespace) -> None:
    """Write the signal of a history and print its figures, as the options say."""
    path = output(options.output, options.history, *options.materials)
    if not 1 <= options.parts <= _MOST_PARTS:
        raise InputError(f"--parts: {options.parts} is not a whole number from 1 to {_MOST_PARTS}")
    if not 0 < (temperature := options.temperature) < np.inf:
        raise InputError(f"--temperature: {temperature:g} is not a finite number > 0")
    materials = dict(read_material(path) for path in options.materials)
    case = _case(options.on)
    kind = kind_of([*case], case.get("profile", "cylinder"))
    numbers = _device(options.device, kind)
    length = numbers.get("electrode_length", 1.0)
    history, is_bare = read_history(options.history, length if kind.contact == "line" else None)
    if len(history.times) * options.parts > _MOST_TIMES:
        raise InputError(f"--parts: {options.parts} of {len(history.times)} rows are more than {_MOST_TIMES} times")
    most = float(history.forces.max())
    pressed = {**case, kind.loads.force: most / length}
    body, material = film(pressed, materials, ("BaTiO3", "CoFe2O4"))
    if is_bare:
        _check_unit(options.history, most, solve(pressed, materials=materials))
    contact = ContactCurves.from_case(case, most, length=length, solved=partial(solve, materials=materials), body=body)
    with located("--device"):
        circuit = Circuit.of(numbers, material)
    if contact.roughness > _ROUGH:
        say(f"the contact's curves are not smooth over these forces: they are met to {contact.roughness:.1g} only")
    history = history.divided(options.parts)
    figures = Figures.of_contact(contact, circuit, temperature)
    heat, heat_lines = None, list[str]()
    if history.temperatures is not None:
        if not kind.layered:
            raise InputError(f"{options.history}: temperature: heat is of films; the case has no thickness")
        with located(f"{options.history}: temperature", HeatError):
            solved = solve(pressed, materials=materials)
            warm = Warmth.of_case(case, solved, history, length=length, materials=materials)
        heat = warm.charge(history)
        heat_lines = _heat_figures(history, heat, warm, figures)
    reading = read(history, contact, circuit, heat)
    written = _write(path, history, reading, heat)
    print("\n".join([*_figures(history, reading, contact, circuit, figures), *heat_lines]))
    count = len(history.times)
    thinned = "" if written == count else f" of {count}: in groups, the first and the extremes of force and voltage"
    say(f"wrote {path}: {written} times{thinned}")


def read_history(path: Path, length: float | None) -> tuple[History, bool]:
    """Return a history, and whether its force has no unit; a line's load is multiplied by its length [m]."""
    table = read_cases(path, _COLUMNS)
    pressing = next((name for name in ("force", "load") if name in table.columns), "force")
    if length is None and pressing == "load":
        raise InputError(f"{path}: load: a point contact has none; {_NEEDS}")
    if unknown := next((name for name in table.columns if name not in (pressing, *_COLUMNS)), None):
        raise InputError(f"{path}: {unknown}: is no column of a history; {_NEEDS}")
    times, forces = (table.numbers(name, _NEEDS) for name in ("time", pressing))
    if table.count < 2:
        raise InputError(f"{path}: {table.count} row; a history has two or more")
    temperatures = table.numbers("temperature", _NEEDS) if "temperature" in table.columns else None
    if temperatures is not None and (cold := ~(temperatures > 0)).any():
        row = int(cold.argmax())
        raise InputError(f"{table.at(row)}: temperature: {temperatures[row]:g} K is not a finite number > 0 [K]")
    if (back := np.diff(times) <= 0).any():
        row = int(back.argmax()) + 1
        jump = ""
        if temperatures is not None and times[row] == times[row - 1] and temperatures[row] != temperatures[row - 1]:
            jump = f", from {temperatures[row - 1]:g} to {temperatures[row]:g} K: no temperature jumps without time"
        raise InputError(f"{table.at(row)}: time: {times[row]:g} is not after {times[row - 1]:g}{jump}")
    if not forces.any():
        raise InputError(f"{path}: {pressing}: is 0 all the time; nothing presses")
    if forces.min() < -_NOISE * forces.max():
        row = int(forces.argmin())
        raise InputError(
            f"{table.at(row)}: {pressing}: {forces[row]:g} is not a finite number >= 0; subtract the load cell's "
            "offset, or leave out what pulls"
        )
    scale = length or 1.0 if pressing == "load" else 1.0
    return History(times, np.maximum(forces, 0.0) * scale, temperatures), pressing == "force" and "force" in table.bare


def _heat_figures(history: History, heat: Array, warm: Warmth, figures: Figures) -> list[str]:
    """Return the printed lines about the heat of a signal."""
    place = int(np.abs(heat).argmax())
    touch = f"{shown(abs(float(heat[place]) / figures.charge), '1', 3)} times the charge of the largest force"
    lines = [f"heat: {shown(float(heat[place]), 'C', 3)} at {shown(float(history.times[place]), 's', 3)}, {touch}"]
    after = float(history.times[-1] - history.times[0])
    per_kelvin = abs(float(warm.sizes @ -np.expm1(-warm.rates * after)))
    if per_kelvin:
        equal = shown(figures.noise[0] / per_kelvin, "K", 3)
        lines.append(f"noise floor as a temperature: {equal} that last {shown(after, 's', 3)}")
    return lines


def _case(text: str) -> dict[str, Any]:
    """Read the factors of one case, from a table or from the option itself."""
    table = one_case("--on", text) if "=" in text else read_cases(Path(text))
    if table.count != 1:
        raise InputError(f"{text}: {table.count} cases; a signal is of one")
    return {name: column[0] for name, column in table.columns.items() if not table.empty(name)[0]}


def _device(text: str, kind: Kind) -> dict[str, float]:
    """Read numbers of a study's section ``device``, in SI."""
    values = {name: _plain(value) for name, value in named("--device", text, valued=True).items()}
    amplifier = {name: values.pop(name) for name in Amplifier.model_fields if name in values}
    content = {**values, "amplifier": amplifier}
    allowed = [name for name in (*Device.model_fields, *Amplifier.model_fields) if name != "amplifier"]
    if unknown := next((name for name in values if name not in allowed), None):
        raise InputError(f"--device: {unknown}: unknown key; {nearest(unknown, allowed)}")
    try:
        device = Device.model_validate(content)
        device.check(kind.contact)
    except ValidationError as error:
        raise InputError(f"--device: {first_problem(error, Device, content)}") from None
    except ValueError as error:
        raise InputError(f"--device: {error}") from None
    return device.constants


def _plain(text: str) -> float | str:
    try:
        return number(text)
    except ValueError:
        return text


def _check_unit(path: Path, most: float, solved: xr.Dataset) -> None:
    """Refuse a bare force whose contact would be destroyed: it has probably lost its unit."""
    peak = float(solved["peak_pressure"].values.max()) if "peak_pressure" in solved else 0.0
    if DESTRUCTIVE_PRESSURE < peak < np.inf:
        raise InputError(f"{path}: force: {lost_unit(most, 'N', peak)}")


def _write(path: Path, history: History, reading: Signal, heat: Array | None = None) -> int:
    """Write a signal as a table, a long one thinned to the extremes of groups of rows; return the number of rows."""
    columns = {"time [s]": history.times, "force [N]": history.forces, "charge [C]": reading.charge}
    columns |= {"voltage [V]": reading.voltage, "output [V]": reading.output}
    if heat is not None and history.temperatures is not None:
        columns |= {"temperature [K]": history.temperatures, "heat charge [C]": heat}
    rows = _written_rows(reading.voltage, history.forces)
    with writing(path) as file:
        write_columns(file, {heading: values[rows] for heading, values in columns.items()})
    return len(rows)


def _written_rows(voltage: Array, forces: Array) -> Indices:
    """Return all rows, or of groups of equal length the first one and those of extreme voltage and force."""
    count = len(voltage)
    if count <= _MOST_WRITTEN:
        return np.arange(count)
    length = -(-5 * count // _MOST_WRITTEN)
    begins = np.arange(0, count - count % length, length)
    rows = [begins, np.arange(count - count % length, count)]
    for values in (voltage, forces):
        groups = values[: len(begins) * length].reshape(-1, length)
        rows += [begins + groups.argmin(axis=1), begins + groups.argmax(axis=1)]
    return np.unique(np.concatenate(rows))


def _figures(
    history: History, reading: Signal, contact: ContactCurves, circuit: Circuit, figures: Figures
) -> list[str]:
    """Return the printed lines about a signal."""
    noise, at_output, as_force = figures.noise
    constant = "is held: nothing leaks"
    if np.isfinite(figures.time_constant):
        constant = f"decays with the time constant {shown(figures.time_constant, 's', 3)}"
        if figures.drop(DROP) < GONE:
            constant += f": {shown(figures.drop(DROP), '%', 3)} less after {DROP:g} s"
    offset = circuit.gain * circuit.bias_current / (figures.capacitance + circuit.capacitance)
    bias = f"changes the output by {shown(offset, 'V s-1', 3)}"
    if np.isfinite(figures.time_constant):
        bias = f"leaves {shown(offset * figures.time_constant, 'V', 3)} at the output in the end"
    return [
        f"{name}: {shown(float(values[place]), 'V', 3)} at {shown(float(history.times[place]), 's', 3)}"
        for name, values in (("peak voltage of the punch", reading.voltage), ("peak output", reading.output))
        for place in [int(np.abs(values).argmax())]
    ] + [
        f"contact at {shown(contact.largest_force, 'N', 3)}: {shown(figures.charge, 'C', 3)} at zero volts, "
        f"{shown(figures.capacitance, 'F', 3)}",
        f"a constant force {constant}",
        *([f"the bias current {bias}"] if circuit.bias_current else []),
        f"noise floor: {shown(noise, 'C', 3)}, {shown(at_output, 'V', 3)} at the output, {shown(as_force, 'N', 3)}",
    ]
