"""Names that have one value in a design question: what materials bear, and what is read or driven through the punch."""

from typing import Literal

from solver.described import Described
from solver.names import LIMITS

_BASE = "base_"

#: What the top material bears, and under ``base_...`` what the base does.
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
    "temperature": Described("K", "temperature of the circuit"),
    "thermal_energy": Described("J", "Boltzmann's constant times the temperature; 0 of a charge amplifier"),
    "feedback_heat": Described("C", "noise of a charge amplifier's feedback by its heat; 0 of other amplifiers"),
    "resistivity": Described("Ohm m", "electric resistivity of the film"),
    "loss_tangent": Described("1", "dielectric loss tangent of the film at loss_frequency"),
    "loss_frequency": Described("s-1", "frequency at which the loss tangent was measured"),
}

#: Every name of a constant.
CONSTANTS: dict[str, Described] = {**ALLOWABLES, **DEVICE}

#: How punch and body meet, as far as figures of a device differ by it: a line or a point, without or with air.
Meeting = Literal["line", "line in air", "point", "point in air"]


def _figures(pressing: str, capacitance: str, blocked: str, *, per_metre: bool) -> dict[str, Described]:
    """Figures of a device on a contact, from the names of what presses, of its capacitance and of its blocked force."""
    whole = " * electrode_length" if per_metre else ""
    circuit = f"({capacitance}{whole} + input_capacitance + cable_capacitance)"
    noise = f"sqrt(charge_noise^2 + (voltage_noise * {circuit})^2 + thermal_energy * {circuit} + feedback_heat^2)"
    force = [("force", "N", "load on the whole punch", f"{pressing}{whole}")] if per_metre else []
    told = (
        *force,
        ("signal_charge", "C", "charge at zero voltage", f"charge_per_force * {pressing}{whole}"),
        ("circuit_capacitance", "F", "capacitance of punch, cable and amplifier together", circuit),
        (
            "signal_voltage",
            "V",
            "open-circuit voltage into cable and amplifier",
            f"charge_per_force * {pressing}{whole} / {circuit}",
        ),
        ("time_constant", "s", "time in which the signal decays to 1/e", f"input_resistance * {circuit}"),
        ("smallest_force", "N", "force whose charge is the noise", f"{noise} / abs(charge_per_force)"),
        (
            "dynamic_range",
            "1",
            "load over the smallest detectable one",
            f"{pressing}{whole} * abs(charge_per_force) / {noise}",
        ),
        (
            "position_resolution",
            "m",
            "distance that the noise hides of a place between two patches, from the difference of their charges",
            f"sqrt(2) * charge_noise / (abs(patch_charge_gradient) * {pressing}{whole})",
        ),
        ("drive_field", "V m-1", "driving voltage over the thickness", "abs(drive_voltage) / thickness"),
        ("stroke", "m", "stroke of the driving voltage at fixed load", "stroke_per_volt * drive_voltage"),
        (
            "blocked_force",
            "N",
            "force of the driving voltage at fixed depth, on the whole punch",
            f"{blocked} * drive_voltage{whole}",
        ),
    )
    return {name: Described(units, long_name, formula=formula) for name, units, long_name, formula in told}


#: Figures of a device, each a formula of quantities, factors and constants in the language of designs, by meeting. The
#: force on a point is a factor.
FIGURES_BY: dict[Meeting, dict[str, Described]] = {
    "line": _figures("load", "capacitance_per_length", "blocked_load_per_volt", per_metre=True),
    "line in air": _figures("load", "capacitance_at_load", "blocked_load_per_volt", per_metre=True),
    "point": _figures("force", "capacitance", "blocked_force_per_volt", per_metre=False),
    "point in air": _figures("force", "capacitance_at_force", "blocked_force_per_volt", per_metre=False),
}

#: Every one by name; unit and meaning are those of any meeting.
FIGURES = FIGURES_BY["line"]


def of_the_base(name: str) -> bool:
    """Whether a name of ``ALLOWABLES`` says what the base bears."""
    return name.startswith(_BASE)


def plain(name: str) -> str:
    """The name of ``LIMITS`` behind one of ``ALLOWABLES``."""
    return name.removeprefix(_BASE)
