"""The signal of a history of forces and temperatures: charge, voltage and output in time, and the charge of heat."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import xarray as xr

from approximation.arrays import Array
from solver import Material
from solver.face.heat import responses
from workflow.device.circuit import Circuit
from workflow.device.contact import ContactCurves

#: Time after which the drop of a constant force is reported [s].
DROP = 10.0
#: Decay by then beyond which the time constant alone is reported.
GONE = 0.99
_TOLERANCE = 1e-10  # error of an interval over the size of the stored charge
_INTERVALS_AT_ONCE = 2**15  # intervals that are integrated together: some 30 MB of temporaries
_DEEPEST = 40  # halvings of a step
_ROOT = 6**0.5
# nodes and coefficients of the method Radau IIA of order five (Hairer & Wanner, Solving ODEs II, table IV.5.6)
_RADAU = np.array([(4 - _ROOT) / 10, (4 + _ROOT) / 10, 1.0])
_COEFFICIENTS = np.array(
    [
        [(88 - 7 * _ROOT) / 360, (296 - 169 * _ROOT) / 1800, (-2 + 3 * _ROOT) / 225],
        [(296 + 169 * _ROOT) / 1800, (88 + 7 * _ROOT) / 360, (-2 - 3 * _ROOT) / 225],
        [(16 - _ROOT) / 36, (16 + _ROOT) / 36, 1 / 9],
    ]
)
_TERMS, _TIMES = 40, 120  # exponentials, and times at which they are fitted
_SHORT = 1e-3  # of the mean step of a history: heat within less is not resolved
_EARLIER = 20  # first fitted time over the shortest resolved one: a ramp integrates the steps from zero on
_SINGULAR = 1e-8  # relative, of what is fitted: below it exponentials cancel one another


@dataclass(frozen=True, eq=False)
class History:
    """Forces on a punch, and its temperatures if known, linear in time between the rows."""

    times: Array  # ascending [s]; (time,)
    forces: Array  # not negative [N]; (time,)
    temperatures: Array | None = None  # of the punch [K]; (time,)

    def divided(self, parts: int) -> "History":
        """Return the history with each interval in equal parts."""
        rows = np.arange(len(self.times))
        fractional_rows = np.linspace(0, len(self.times) - 1, (len(self.times) - 1) * parts + 1)
        times, forces = (np.interp(fractional_rows, rows, values) for values in (self.times, self.forces))
        temperatures = None if self.temperatures is None else np.interp(fractional_rows, rows, self.temperatures)
        return History(times, forces, temperatures)


@dataclass(frozen=True, eq=False)
class Signal:
    """Charge, voltage and output at every time of a history."""

    charge: Array  # of the contact [C]
    voltage: Array  # of the punch [V]
    output: Array  # of the amplifier [V]


def read(history: History, contact: ContactCurves, circuit: Circuit, heat: Array | None = None) -> Signal:
    """Return the signal of a history, which begins without voltage, at its times.

    ``heat`` is the charge of heat at these times [C], (time,), linear between them. The balance of charge
    (``workflow.device.circuit``) is an equation for the charge y = (C(P) + C_e) V that the voltage stores, stiff where
    the circuit is fast:

        dy/dt = -y (C(P)/tau + G_e)/(C(P) + C_e) - Q'(P) dP/dt - dQ_heat/dt + I_bias.

    It is linear in y: an interval takes y to a y + b, both from one step of Radau's implicit method of order five, for
    many intervals together. An interval whose two halves give other numbers is divided.
    """
    balance = _Balance(contact, circuit)
    steps = np.diff(history.times)
    heat = np.zeros(len(history.times)) if heat is None else heat
    other_charge = np.diff(heat) - circuit.bias_current * steps
    tolerance = _TOLERANCE * (balance.scale(history) + float(np.abs(other_charge).max()))
    stored = np.zeros(len(history.times))
    for first in range(0, len(steps), _INTERVALS_AT_ONCE):
        rows = slice(first, first + _INTERVALS_AT_ONCE)
        forces = history.forces[:-1][rows], history.forces[1:][rows]
        factors, changes = balance.advance(steps[rows], *forces, other_charge[rows], tolerance)
        value = stored[first]
        for row, (factor, change) in enumerate(zip(factors.tolist(), changes.tolist(), strict=True), first + 1):
            value = factor * value + change
            stored[row] = value
    capacitance = contact.capacitance(history.forces)
    voltage = stored / (capacitance + circuit.capacitance)
    return Signal(contact.charge(history.forces) + heat + capacitance * voltage, voltage, circuit.gain * voltage)


@dataclass(frozen=True)
class Figures:
    """Figures of a contact and its circuit at the contact's largest force."""

    charge: float  # at zero volts [C]
    output: float  # of a force that acts at once, before any charge leaks, without heat and bias current [V]
    capacitance: float  # of the contact [F]
    time_constant: float  # of a constant force [s]; infinite where nothing leaks
    noise: tuple[float, float, float]  # as charge [C], at the output [V] and as force [N], root mean square

    @classmethod
    def of_contact(cls, contact: ContactCurves, circuit: Circuit, temperature: float) -> Self:
        """Return the figures of a contact and a circuit."""
        largest = np.array([contact.largest_force])
        charge, capacitance = float(contact.charge(largest)[0]), float(contact.capacitance(largest)[0])
        noise = circuit.noise(capacitance, temperature)
        amplified = -circuit.gain / (capacitance + circuit.capacitance)
        by_force = noise * contact.largest_force / abs(charge)
        noises = (noise, noise * abs(amplified), by_force)
        return cls(charge, charge * amplified, capacitance, circuit.time_constant(capacitance), noises)

    def drop(self, time: float) -> float:
        """Return the share of a constant force's signal that is lost after a time [s]."""
        return float(-np.expm1(-time / self.time_constant))


@dataclass(frozen=True)
class _Balance:
    """The balance of charge on intervals with constant rates of force, heat and bias current."""

    contact: ContactCurves
    circuit: Circuit

    def scale(self, history: History) -> float:
        """Return the size of the stored charge [C]: the contact's charge, or less where it leaks."""
        largest = np.array([self.contact.largest_force])
        charge = abs(float(self.contact.charge(largest)[0]))
        rate = float(np.abs(np.diff(history.forces) / np.diff(history.times)).max()) / self.contact.largest_force
        leak = float(self._leak(largest)[0])
        return charge * min(1.0, rate / leak) if leak and rate else charge

    def step(self, steps: Array, forces: Array, ends: Array, other_charge: Array) -> tuple[Array, Array]:
        """Return factor and summand by which one step changes the stored charge; `other_charge` is of heat and bias."""
        node_forces = forces[:, None] + (ends - forces)[:, None] * _RADAU
        leaks = self._leak(node_forces) * steps[:, None]
        induced = self.contact.charge_slope(node_forces) * (ends - forces)[:, None] + other_charge[:, None]
        system = np.eye(3) + _COEFFICIENTS * leaks[:, None, :]
        # a step of Radau's method from near the balance of current and leak; charge beyond that decays by the exact
        # exponential, since the method's own decay is poor where a step is long
        initial = -induced[:, :1] / (leaks[:, :1] + 1 / (1 + leaks[:, :1]))
        final = np.linalg.solve(system, (initial - induced @ _COEFFICIENTS.T)[..., None])[:, -1, 0]
        decay = np.exp(-(leaks @ _COEFFICIENTS[-1]))
        return decay, final - decay * initial[:, 0]

    def advance(
        self, steps: Array, forces: Array, ends: Array, other_charge: Array, tolerance: float, depth: int = 0
    ) -> tuple[Array, Array]:
        """Return factor and summand by which intervals change the stored charge, to a tolerance [C]; (interval,)."""
        whole = self.step(steps, forces, ends, other_charge)
        middle = (forces + ends) / 2
        factor, change = _in_turn(
            self.step(steps / 2, forces, middle, other_charge / 2), self.step(steps / 2, middle, ends, other_charge / 2)
        )
        wrong = np.abs(factor - whole[0]) * tolerance / _TOLERANCE + np.abs(change - whole[1]) > tolerance
        if depth < _DEEPEST and wrong.any():
            steps, forces, middle, ends = steps[wrong] / 2, forces[wrong], middle[wrong], ends[wrong]
            other_charge = other_charge[wrong] / 2
            halves = [
                self.advance(steps, begin, end, other_charge, tolerance, depth + 1)
                for begin, end in ((forces, middle), (middle, ends))
            ]
            factor[wrong], change[wrong] = _in_turn(*halves)
        return factor, change

    def _leak(self, forces: Array) -> Array:
        """Return the rate at which the stored charge leaks [1/s], at forces of any shape."""
        capacitance = self.contact.capacitance(forces)
        leaking = capacitance * self.circuit.leakage + self.circuit.conductance
        return np.asarray(leaking / (capacitance + self.circuit.capacitance))


def _in_turn(first: tuple[Array, Array], second: tuple[Array, Array]) -> tuple[Array, Array]:
    """Return factor and summand of two steps, one after the other."""
    return second[0] * first[0], second[0] * first[1] + second[1]


@dataclass(frozen=True, eq=False)
class Warmth:
    """Charge after a step of 1 K at the surface, as a sum of exponentials, under the largest force of the history."""

    rates: Array  # [1/s]; (term,)
    sizes: Array  # charge of each term in the end [C/K]; (term,)
    error: float  # largest error of the sum over its largest value

    @classmethod
    def of_case(
        cls,
        case: Mapping[str, Any],
        solved: xr.Dataset,
        history: History,
        *,
        length: float = 1.0,
        materials: Mapping[str, Material],
        phases: Sequence[str] = ("BaTiO3", "CoFe2O4"),
    ) -> Self:
        """Fit the warmth of a solved film under a history's punch; ``length`` [m] is that of a line."""
        whole = float(history.times[-1] - history.times[0])
        first = max(float(np.diff(history.times).min()), _SHORT * whole / (len(history.times) - 1)) / 2
        times = np.geomspace(min(first, whole / 10) / _EARLIER, whole, _TIMES)
        charges = length * responses(case, solved, times, materials, phases)[0]
        rates = 1 / np.geomspace(times[0], 10 * times[-1], _TERMS)
        approach = -np.expm1(-times[:, None] * rates)
        scale = float(np.abs(charges).max()) or 1.0
        sizes = np.linalg.lstsq(approach, charges / scale, rcond=_SINGULAR)[0] * scale
        return cls(rates, np.asarray(sizes, dtype=np.float64), float(np.abs(approach @ sizes - charges).max()) / scale)

    def charge(self, history: History) -> Array:
        """Return the charge of heat at the times of a history [C], (time,); the body has the first temperature."""
        assert history.temperatures is not None
        steps, rises = np.diff(history.times), np.diff(history.temperatures)
        lags, out = np.zeros_like(self.rates), np.zeros(len(history.times))
        total = self.sizes.sum() * (history.temperatures - history.temperatures[0])
        for row, (step, rise) in enumerate(zip(steps.tolist(), rises.tolist(), strict=True), 1):
            decay = np.exp(-self.rates * step)
            lags = lags * decay - rise * np.expm1(-self.rates * step) / (self.rates * step)
            out[row] = total[row] - self.sizes @ lags
        return out
