"""The circuit at a punch, as a study gives it: the punch's length, its amplifier and its drive voltage."""

from typing import Annotated

from pydantic import AfterValidator, Field
from scipy.constants import Boltzmann

from solver.described import Contact
from workflow.language.constants import DEVICE
from workflow.language.given import number
from workflow.study.types import Number, Strict


def _above(name: str, *, zero: bool = False) -> AfterValidator:
    def check(written: float | str) -> float | str:
        value = number(name, written)
        if not (value >= 0 if zero else value > 0):
            raise ValueError(f"{value:g} is not a finite number {'>=' if zero else '>'} 0 [{DEVICE[name].units}]")
        return written

    return AfterValidator(check)


class Amplifier(Strict):
    """Amplifier that reads the charge of the punch; numbers in SI, or with a unit, as ``10 pF``."""

    input_capacitance: Annotated[Number | str, _above("input_capacitance")] = Field(description="of its input [F]")
    input_resistance: Annotated[Number | str, _above("input_resistance")] | None = Field(
        None, description="of its input [Ohm]; needed by time_constant"
    )
    cable_capacitance: Annotated[Number | str, _above("cable_capacitance", zero=True)] = Field(
        0.0, description="of the cable [F]"
    )
    charge_noise: Annotated[Number | str, _above("charge_noise", zero=True)] | None = Field(
        None, description="root mean square in its band, as a charge at its input [C]; needed by smallest_force"
    )
    voltage_noise: Annotated[Number | str, _above("voltage_noise", zero=True)] = Field(
        0.0, description="root mean square in its band, as a voltage at its input [V]"
    )
    feedback_capacitance: Annotated[Number | str, _above("feedback_capacitance")] | None = Field(
        None, description="of a charge amplifier, between its output and input [F]; without it, it reads the voltage"
    )
    feedback_resistance: Annotated[Number | str, _above("feedback_resistance")] | None = Field(
        None, description="beside the feedback capacitance [Ohm]; infinite by default"
    )
    open_loop_gain: Annotated[Number | str, _above("open_loop_gain")] = Field(
        1e6, description="of a charge amplifier without its feedback"
    )


class Device(Strict):
    """Circuit that turns quantities into figures of a device; numbers in SI, or with a unit, as ``10 mm``."""

    electrode_length: Annotated[Number | str, _above("electrode_length")] | None = Field(
        None,
        description="of the punch along its axis [m]: needed by a line, whose loads are per metre; a point has none",
    )
    drive_voltage: Annotated[Number | str, _above("drive_voltage")] | None = Field(
        None, description="voltage that drives an actuator [V]"
    )
    amplifier: Amplifier | None = Field(None, description="what reads a sensor")
    temperature: Annotated[Number | str, _above("temperature")] = Field(
        293.15,
        description="of the circuit [K], whose heat is noise: a charge whose square is k T times the capacitance",
    )
    resistivity: Annotated[Number | str, _above("resistivity")] | None = Field(
        None, description="of the film [Ohm m], through which charge leaks; infinite by default"
    )
    loss_tangent: Annotated[Number | str, _above("loss_tangent", zero=True)] | None = Field(
        None, description="of the film at loss_frequency, in place of its resistivity"
    )
    loss_frequency: Annotated[Number | str, _above("loss_frequency")] | None = Field(
        None, description="at which the loss tangent was measured [1/s]"
    )

    def check(self, contact: Contact) -> None:
        """Raise ValueError, in one line, unless lines have a length and points, whose forces are whole, have none."""
        if contact == "line" and self.electrode_length is None:
            raise ValueError("electrode_length: missing; must be a number with a unit [m]")
        if contact == "point" and self.electrode_length is not None:
            raise ValueError("electrode_length: a point contact has none: its forces and charges are whole")

    @property
    def constants(self) -> dict[str, float]:
        """Every number that is given, by its name in designs, in SI."""
        written = {**dict(self), **dict(self.amplifier or {})}
        numbers = {name: number(name, written[name]) for name in DEVICE if written.get(name) is not None}
        energy, feedback = Boltzmann * numbers["temperature"], numbers.get("feedback_capacitance", 0.0)
        # what a resistance discharges: all of a circuit, or a charge amplifier's feedback alone
        return numbers | {"thermal_energy": 0.0 if feedback else energy, "feedback_heat": (energy * feedback) ** 0.5}
