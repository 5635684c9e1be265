"""Names that have one value in a design question: what materials bear, and what is read or driven through the punch."""

from solver.names import LIMITS, Described

_BASE = "base_"

#: What the top material bears, and under ``base_...`` what the base does.
BORNE: dict[str, Described] = LIMITS | {
    f"{_BASE}{name}": Described(one.units, f"{one.long_name}, of the base") for name, one in LIMITS.items()
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
    "resistivity": Described("Ohm m", "electric resistivity of the film"),
    "loss_tangent": Described("1", "dielectric loss tangent of the film at loss_frequency"),
    "loss_frequency": Described("s-1", "frequency at which the loss tangent was measured"),
}

#: Every name of a constant.
CONSTANTS: dict[str, Described] = {**BORNE, **DEVICE}

_CIRCUIT = "(capacitance * electrode_length + input_capacitance + cable_capacitance)"
_NOISE = f"sqrt(charge_noise^2 + (voltage_noise * {_CIRCUIT})^2)"

#: Figures of a device, each a formula of quantities, factors and constants in the language of designs.
FIGURES: dict[str, Described] = {
    name: Described(units, long_name, formula=formula)
    for name, units, long_name, formula in (
        ("force", "N", "load on the whole punch", "load * electrode_length"),
        ("signal_charge", "C", "charge at zero voltage", "charge_sensitivity * load * electrode_length"),
        (
            "circuit_capacitance",
            "F",
            "capacitance of punch, cable and amplifier together",
            _CIRCUIT,
        ),
        (
            "signal_voltage",
            "V",
            "open-circuit voltage into cable and amplifier",
            f"charge_sensitivity * load * electrode_length / {_CIRCUIT}",
        ),
        ("time_constant", "s", "time in which the signal decays to 1/e", f"input_resistance * {_CIRCUIT}"),
        ("smallest_force", "N", "force whose charge is the noise", f"{_NOISE} / abs(charge_sensitivity)"),
        (
            "dynamic_range",
            "1",
            "load over the smallest detectable one",
            f"load * electrode_length * abs(charge_sensitivity) / {_NOISE}",
        ),
        ("drive_field", "V m-1", "driving voltage over the thickness", "abs(drive_voltage) / thickness"),
        ("stroke", "m", "stroke of the driving voltage at fixed load", "stroke_per_volt * drive_voltage"),
        (
            "blocked_force",
            "N",
            "force of the driving voltage at fixed depth, on the whole punch",
            "blocked_load_per_volt * drive_voltage * electrode_length",
        ),
    )
}


def borne_by_base(name: str) -> bool:
    """Whether a name of ``BORNE`` says what the base bears."""
    return name.startswith(_BASE)


def plain(name: str) -> str:
    """The name of ``LIMITS`` behind one of ``BORNE``."""
    return name.removeprefix(_BASE)
