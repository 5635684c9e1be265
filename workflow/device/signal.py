"""The signal of a history of forces: charge, voltage and output in time."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Self

import numpy as np
import scipy  # scipy.integrate, slow to import, when a signal is asked for

from approximation.arrays import Array
from workflow.device.circuit import Circuit
from workflow.device.contact import Contact

#: Time over which the drop under a constant force is told [s].
DROP = 10.0
_RELATIVE, _ABSOLUTE = 1e-6, 1e-8  # tolerances of the voltage; the absolute one of the largest
_SAME = 1e-9  # of the fastest rate, by which rates of one straight line may differ


@dataclass(frozen=True, eq=False)
class History:
    """Forces on a punch, linear in time between the given ones."""

    times: Array  # Ascending [s]; (time,)
    forces: Array  # None negative [N]; (time,)

    def finer(self, parts: int) -> "History":
        """The same with each interval in equal parts."""
        places = np.linspace(0, len(self.times) - 1, (len(self.times) - 1) * parts + 1)
        rows = np.arange(len(self.times))
        return History(np.interp(places, rows, self.times), np.interp(places, rows, self.forces))

    @property
    def rates(self) -> Array:
        """Force a second of every interval [N/s]; (time - 1,)."""
        return np.asarray(np.diff(self.forces) / np.diff(self.times))


@dataclass(frozen=True, eq=False)
class Signal:
    """What a circuit reads, one entry a time."""

    charge: Array  # Of the contact [C]
    voltage: Array  # Of the punch [V]
    output: Array  # Of the amplifier [V]


def read(history: History, contact: Contact, circuit: Circuit) -> Signal:
    """The signal of a history, which begins without voltage, at its times.

    The balance of charge (``workflow.device.circuit``) is an equation for the voltage, stiff where the circuit is fast:

        (C(P) + C_e) dV/dt = -(Q'(P) + C'(P) V) dP/dt - (C(P)/tau + G_e) V.

    It is integrated by Radau's implicit method of order five (scipy), anew from every time at which dP/dt jumps.
    """
    voltage = np.zeros_like(history.times)
    rates = history.rates
    same = np.abs(np.diff(rates)) <= _SAME * np.abs(rates).max()
    ends = np.flatnonzero(np.concatenate([[True], ~same, [True]]))
    size = _size(history, contact, circuit)
    for first, last in pairwise(ends):
        times = history.times[first : last + 1]
        balance = _Balance(contact, circuit, float(times[0]), float(history.forces[first]), float(rates[first]))
        solution = scipy.integrate.solve_ivp(
            balance.slope,
            (float(times[0]), float(times[-1])),
            voltage[first : first + 1],
            "Radau",
            times,
            jac=balance.jacobian,
            rtol=_RELATIVE,
            atol=_ABSOLUTE * size,
        )
        if not solution.success:
            raise ArithmeticError(solution.message)
        voltage[first : last + 1] = solution.y[0]
    charge, capacitance = contact.at(history.forces)
    return Signal(charge + capacitance * voltage, voltage, circuit.gain * voltage)


@dataclass(frozen=True)
class Figures:
    """What is told of a contact that a circuit reads, at its largest force."""

    # At zero volts [C], and of the contact [F]
    charge: float
    capacitance: float
    lasting: float  # Time constant of a constant force [s]; infinite where nothing leaks
    noise: tuple[float, float, float]  # As charge [C], at the output [V] and as force [N], root mean square

    @classmethod
    def of(cls, contact: Contact, circuit: Circuit, temperature: float) -> Self:
        """Those of a contact and a circuit."""
        charge, capacitance = (float(values[0]) for values in contact.at(np.array([contact.most])))
        noise = circuit.noise(capacitance, temperature)
        amplified = abs(circuit.gain) / (capacitance + circuit.capacitance)
        by_force = noise * contact.most / abs(charge)
        return cls(charge, capacitance, circuit.time_constant(capacitance), (noise, noise * amplified, by_force))

    def drop(self, time: float) -> float:
        """Share that a constant force has lost after a time [s]."""
        return float(-np.expm1(-time / self.lasting))


def _size(history: History, contact: Contact, circuit: Circuit) -> float:
    """How large voltages are at most [V]: by all the charge, or by its current where that leaks at once."""
    charge, capacitance = (float(values[0]) for values in contact.at(np.array([contact.most])))
    by_charge = abs(charge) / (capacitance + circuit.capacitance)
    current = abs(charge) / contact.most * float(np.abs(history.rates).max())
    leaks = capacitance * circuit.leakage + circuit.conductance
    return min(by_charge, current / leaks) if leaks and current else by_charge


@dataclass(frozen=True)
class _Balance:
    """The balance of charge while the force grows at one rate."""

    contact: Contact
    circuit: Circuit
    time: float
    force: float
    rate: float

    def slope(self, time: float, voltage: Array) -> Array:
        """dV/dt; (1,)."""
        return np.asarray(self.terms(time) @ np.array([voltage[0], 1.0]))

    def jacobian(self, time: float, _: Array) -> Array:
        """Its derivative by V; (1, 1)."""
        return self.terms(time)[:, :1]

    def terms(self, time: float) -> Array:
        """dV/dt = a V + b at a time: (1, 2)."""
        force = np.array([max(self.force + self.rate * (time - self.time), 0.0)])
        _, capacitance = self.contact.at(force)
        charge_rate, capacitance_rate = (slope * self.rate for slope in self.contact.rates(force))
        leaks = capacitance * self.circuit.leakage + self.circuit.conductance
        return -np.stack([capacitance_rate + leaks, charge_rate], -1) / (capacitance + self.circuit.capacitance)
