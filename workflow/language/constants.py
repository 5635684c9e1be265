"""Names that have one value in a design question: limits of materials, numbers of the device, figures of both."""

from typing import Literal, cast

from solver.described import Described
from solver.names import LIMITS

_BASE = "base_"

#: Limits of the top material, and under ``base_...`` those of the base.
ALLOWABLES: dict[str, Described] = LIMITS | {
    f"{_BASE}{name}": Described(limit.units, f"{limit.long_name}, of the base") for name, limit in LIMITS.items()
}

#: Numbers of a study's section ``device``.
DEVICE: dict[str, Described] = {
    "electrode_length": Described("m", "length of the punch along its axis: all loads and charges are per metre of it"),
    "drive_voltage": Described("V", "voltage that drives an actuator"),
    "input_capacitance": Described("F", "capacitance of the amplifier's input"),
    "input_resistance": Described("Ohm", "resistance of the amplifier's input"),
    "cable_capacitance": Described("F", "capacitance of the cable"),
    "charge_noise": Described("C", "noise of the amplifier as a charge at its input, root mean square in its band"),
    "voltage_noise": Described("V", "noise of the amplifier as a voltage at its input, root mean square in its band"),
    "feedback_capacitance": Described("F", "capacitance between output and input of a charge amplifier"),
    "feedback_resistance": Described("Ohm", "resistance beside the feedback capacitance"),
    "open_loop_gain": Described("1", "gain of a charge amplifier without its feedback"),
    "bias_current": Described("A", "current that the amplifier's input draws"),
    "temperature": Described("K", "temperature of the circuit"),
    "thermal_energy": Described("J", "Boltzmann's constant times the temperature; 0 of a charge amplifier"),
    "feedback_heat": Described("C", "noise of a charge amplifier's feedback by its heat; 0 of other amplifiers"),
    "resistivity": Described("Ohm m", "electric resistivity of the film"),
    "loss_tangent": Described("1", "dielectric loss tangent of the film at loss_frequency"),
    "loss_frequency": Described("s-1", "frequency at which the loss tangent was measured"),
}

#: Every name of a constant.
CONSTANTS: dict[str, Described] = {**ALLOWABLES, **DEVICE}

#: Kind of contact, and whether a charge amplifier reads it: figures of a device depend on both.
Meeting = Literal[
    "line", "line in air", "point", "point in air", "line, charge amplifier", "line in air, charge amplifier",
    "point, charge amplifier", "point in air, charge amplifier",
]  # fmt: skip
Read = Literal["line", "line in air", "point", "point in air"]


def _figures(
    pressing: str, capacitance: str, blocked: str, *, per_metre: bool, reads_charge: bool
) -> dict[str, Described]:
    """Return the figures of a device, from the names of load, capacitance and blocked load of its contact."""
    length = " * electrode_length" if per_metre else ""
    charge = f"charge_per_force * {pressing}{length}"
    circuit = f"({capacitance}{length} + input_capacitance + cable_capacitance)"
    at_input = f"({circuit} + feedback_capacitance)" if reads_charge else circuit  # which the voltage noise charges
    noise = f"sqrt(charge_noise^2 + (voltage_noise * {at_input})^2 + thermal_energy * {circuit} + feedback_heat^2)"
    if reads_charge:
        voltage = ("output voltage of the charge amplifier", f"{charge} / feedback_capacitance")
        decay = "feedback_resistance * feedback_capacitance"
        leak = "feedback_resistance"
    else:
        voltage = ("open-circuit voltage into cable and amplifier", f"{charge} / {circuit}")
        decay = f"input_resistance * {circuit}"
        leak = "input_resistance"
    heat = f"heat_charge_per_length{length}" if per_metre else "heat_charge"
    force = [("force", "N", "load on the whole punch", f"{pressing}{length}")] if per_metre else []
    rows = (
        *force,
        ("signal_charge", "C", "charge at zero voltage", charge),
        ("circuit_capacitance", "F", "capacitance of punch, cable and amplifier together", circuit),
        ("signal_voltage", "V", *voltage),
        ("time_constant", "s", "time in which the signal decays to 1/e", decay),
        ("smallest_force", "N", "force whose charge equals the noise", f"{noise} / abs(charge_per_force)"),
        (
            "dynamic_range",
            "1",
            "load over the smallest detectable force",
            f"{pressing}{length} * abs(charge_per_force) / {noise}",
        ),
        (
            "position_resolution",
            "m",
            "distance between two patches that the noise hides, from the difference of their charges",
            f"sqrt(2) * charge_noise / (abs(patch_charge_gradient) * {pressing}{length})",
        ),
        ("bias_output", "V", "output that the bias current leaves", f"bias_current * {leak}"),
        (
            "noise_temperature",
            "K",
            "rise of what touches over the body whose heat makes as much charge as the noise, after hold",
            f"{noise} * abs(touch_temperature - body_temperature) / abs({heat})",
        ),
        ("drive_field", "V m-1", "driving voltage over the thickness", "abs(drive_voltage) / thickness"),
        ("stroke", "m", "stroke of the driving voltage at fixed load", "stroke_per_volt * drive_voltage"),
        (
            "blocked_force",
            "N",
            "force of the driving voltage at fixed depth, on the whole punch",
            f"{blocked} * drive_voltage{length}",
        ),
    )
    return {name: Described(units, long_name, formula=formula) for name, units, long_name, formula in rows}


_CONTACTS: dict[Read, tuple[str, str, str]] = {
    "line": ("load", "capacitance_per_length", "blocked_load_per_volt"),
    "line in air": ("load", "capacitance_at_load", "blocked_load_per_volt"),
    "point": ("force", "capacitance", "blocked_force_per_volt"),
    "point in air": ("force", "capacitance_at_force", "blocked_force_per_volt"),
}


def meeting_of(contact: Read, *, reads_charge: bool) -> Meeting:
    """Return the key of `FIGURES_BY` for a contact and its amplifier."""
    return cast("Meeting", f"{contact}, charge amplifier") if reads_charge else contact


#: Figures of a device by meeting, each a formula of quantities, factors and constants in the language of designs.
FIGURES_BY: dict[Meeting, dict[str, Described]] = {
    meeting_of(contact, reads_charge=charge): _figures(*names, per_metre=names[0] == "load", reads_charge=charge)
    for charge in (False, True)
    for contact, names in _CONTACTS.items()
}

#: Every figure by name; unit and meaning are those of any meeting.
FIGURES = FIGURES_BY["line"]


def of_the_base(name: str) -> bool:
    """Return whether a name of ``ALLOWABLES`` is a limit of the base."""
    return name.startswith(_BASE)


def plain(name: str) -> str:
    """Return the name in ``LIMITS`` of one of ``ALLOWABLES``."""
    return name.removeprefix(_BASE)
