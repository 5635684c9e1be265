"""The circuit that reads a contact: one balance of charge for amplifiers of voltage and of charge.

The punch is one node with the cable and the amplifier's input, at the voltage V against ground. The contact gives it
the charge Q(P) + Q_heat + C(P) V, the capacitances of the circuit C_e V. No charge enters the node but through
resistances and by the amplifier's bias current:

    d/dt [Q(P) + Q_heat + (C(P) + C_e) V] = -(C(P)/tau + G_e) V + I_bias,

tau the time in which charge leaks through the film (resistivity times permittivity). A voltage amplifier has
C_e = C_in + C_cable and G_e = 1/R_in, and its output is V. A charge amplifier of open-loop gain A has the output -A V,
and its feedback C_f and R_f see (1 + A) V: C_e = C_in + C_cable + (1 + A) C_f, G_e = 1/R_in + (1 + A)/R_f. Its output
is Q/C_f, in the sign of the charge at zero volts; the voltage of an open contact, -Q/C, has the other one.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np

from solver import Material
from solver.units import BOLTZMANN
from workflow.language import grammar


@dataclass(frozen=True)
class Circuit:
    """Amplifier and cable of a contact, and the leakage of its film."""

    numbers: Mapping[str, float]  # of a study's section ``device`` by their names, in SI
    leakage: float = 0.0  # rate 1/tau at which charge leaks through the film [1/s]

    @classmethod
    def of(cls, numbers: Mapping[str, float], film: Material | None = None) -> Self:
        """Return the circuit of a device."""
        if "resistivity" in numbers and "loss_tangent" in numbers:
            raise ValueError("resistivity: given with a loss_tangent; give one of them")
        if ("loss_tangent" in numbers) != ("loss_frequency" in numbers):
            raise ValueError("loss_frequency: a loss tangent and its frequency need each other")
        if "feedback_resistance" in numbers and "feedback_capacitance" not in numbers:
            raise ValueError("feedback_resistance: without a feedback_capacitance")
        if "resistivity" in numbers:
            if film is None:
                raise ValueError("resistivity: needs the material of the film")
            return cls(numbers, 1 / (numbers["resistivity"] * permittivity(film)))
        if "loss_tangent" in numbers:
            return cls(numbers, 2 * np.pi * numbers["loss_frequency"] * numbers["loss_tangent"])
        return cls(numbers)

    @property
    def reads_charge(self) -> bool:
        """Return whether the amplifier is a charge amplifier."""
        return "feedback_capacitance" in self.numbers

    @property
    def gain(self) -> float:
        """Output over the voltage of the punch."""
        return -self.numbers.get("open_loop_gain", 1e6) if self.reads_charge else 1.0

    @property
    def bias_current(self) -> float:
        """Current that the amplifier's input feeds into the node [A]."""
        return self.numbers.get("bias_current", 0.0)

    @cached_property
    def capacitance(self) -> float:
        """C_e [F]: cable, input and the feedback as seen from the input."""
        feedback = (1 - self.gain) * self.numbers.get("feedback_capacitance", 0.0)
        return self._figure("circuit_capacitance", 0.0) + feedback

    @property
    def conductance(self) -> float:
        """G_e [S]: input and the feedback as seen from the input."""
        feedback = (1 - self.gain) / self.numbers.get("feedback_resistance", np.inf)
        return 1 / self.numbers.get("input_resistance", np.inf) + feedback

    def time_constant(self, contact: float) -> float:
        """Return the time in which a constant force decays to 1/e [s], from the contact's capacitance [F]."""
        rate = contact * self.leakage + self.conductance
        return (contact + self.capacitance) / rate if rate else np.inf

    def noise(self, contact: float, temperature: float) -> float:
        """Return the noise as a charge at the input, root mean square [C], by the figure ``smallest_force``."""
        feedback, energy = self.numbers.get("feedback_capacitance", 0.0), BOLTZMANN * temperature
        # k T C of the capacitance that a resistance discharges: the feedback's, or the circuit's
        heat = {"thermal_energy": 0.0 if feedback else energy, "feedback_heat": (energy * feedback) ** 0.5}
        return self._figure("smallest_force", contact + feedback, charge_per_force=1.0, **heat)

    def _figure(self, name: str, contact: float, **known: float) -> float:
        """Return a figure of the device with a contact of a capacitance [F]."""
        numbers = {"charge_noise": 0.0, "voltage_noise": 0.0, "cable_capacitance": 0.0, **self.numbers, **known}
        numbers |= {"capacitance_per_length": contact, "electrode_length": 1.0}
        expression = grammar.parse(name)
        return float(expression.evaluate({symbol: np.array(numbers[symbol]) for symbol in expression.names()}))


def permittivity(film: Material) -> float:
    """Return eps33 + e33^2/c33 [F/m], of a film that cannot widen, as under a wide contact."""
    return float(film.eps33 + film.e33**2 / film.c33)
