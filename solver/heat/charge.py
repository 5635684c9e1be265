"""Charge that heat makes on the electrodes of a layered body (docs/heat.md, Film).

The sign is that of D_y along +y. The strain of a body that is warm in one place only is left out.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np
import scipy  # scipy.optimize, slow to import, and few jobs ask for heat

from approximation.arrays import Array
from solver.heat.conduction import Conduction
from solver.heat.touch import Patch, Spot, Warmed
from solver.material.constants import Material, MaterialError
from solver.material.evidence import Sourced
from solver.names import THERMAL
from solver.stack.electrodes import Electrode, electrodes
from solver.stack.layers import Stack
from solver.units import VACUUM_PERMITTIVITY

_CONDUCTS = ("conductivity", "heat_capacity")
_EARLIEST, _LATEST = 1e-6, 1e6  # s, range in which heat is searched to overtake a force
_PER_DECADE = 6
_LEAST = 1e-8  # of the force's charge: heat's charge that is lost in rounding


class HeatError(MaterialError):
    """A thermal constant that is not known."""


def constant(name: str, thermal: Mapping[str, Sourced], owner: str) -> float:
    """Return the value of a thermal constant."""
    if name not in thermal:
        raise HeatError(f"heat: not known for {owner}: {name}")
    value, positive = float(thermal[name].value), name in _CONDUCTS
    if not np.isfinite(value) or (positive and value <= 0):
        allowed = f"a finite number{' > 0' if positive else ''} [{THERMAL[name].units}]"
        raise MaterialError(f"{owner}: thermal: {name}: {value:g} is not {allowed}")
    return value


def film_coefficient(film: Material, base: Material | None = None) -> float:
    """Charge per area and kelvin of a film between short-circuited electrodes, free or on a thick base [C m-2 K-1]."""
    if film.conductor or not (film.e31 or film.e33 or film.e15):  # without piezoelectricity there is no polar axis
        return 0.0
    free = constant("pyroelectric", film.thermal, film.name)
    if base is None:
        return free
    clamped = float(film.e31 - film.e33 * film.c13 / film.c33)
    mismatch = constant("expansion", film.thermal, film.name) - constant("expansion", base.thermal, base.name)
    return free - 2 * clamped * mismatch


def conduction(stack: Stack) -> Conduction:
    """Return the thermal layers of a stack."""
    if isinstance(stack.base, str):
        raise HeatError("heat: not known for the base 'rigid': conductivity; name the material of the base")
    bodies = [*(layer.material for layer in stack.layers), stack.base]
    values = {name: np.array([constant(name, m.thermal, m.name) for m in bodies]) for name in _CONDUCTS}
    thickness = np.array([layer.thickness for layer in stack.layers])
    return Conduction(thickness, values["conductivity"], values["heat_capacity"])


def layer_weights(stack: Stack, collector: int | None = None) -> Array:
    """Charge per area and kelvin of each layer on an electrode, or (None) on the punch [C m-2 K-1]; (layer,)."""
    weights = np.zeros(len(stack.layers))
    if collector is None:
        interfaces = electrodes(stack)
        if not interfaces:
            raise HeatError("heat: the punch's charge is of a film above a grounded interface; this body has none")
        parts = [(-1.0, range(interfaces[0][0] + 1))]
    else:
        between = Electrode(stack, collector).between
        parts = [(1.0, between[0])] if between and collector > 1 else []
        parts += [(-1.0, layers) for layers in between[len(parts) :]]
    base = None if isinstance(stack.base, str) else stack.base
    if base is None and any(layer.material.e33 for layer in stack.layers):
        raise HeatError("heat: not known for the base 'rigid': expansion; name the material of the base")
    for sign, layers in parts:
        plates = [(stack.layers[number].thickness, stack.layers[number].material) for number in layers]
        shares = np.array([h / float(m.eps33 + m.e33**2 / m.c33) for h, m in plates])
        coefficients = np.array([film_coefficient(m, base) for _, m in plates])
        weights[list(layers)] += sign * coefficients * shares / shares.sum()
    return weights


def film_gap(stack: Stack) -> float:
    """Thickness of air whose capacitance equals that of the layers above the first electrode [m]; 0 without one."""
    interfaces = electrodes(stack)
    layers = [(layer.thickness, layer.material) for layer in stack.layers[: interfaces[0][0] + 1 if interfaces else 0]]
    return VACUUM_PERMITTIVITY * sum(h / float(m.eps33 + m.e33**2 / m.c33) for h, m in layers)


@dataclass(frozen=True, eq=False)
class HeatedStack:
    """A stack and the electrode that collects its charge."""

    conduction: Conduction
    weights: Array  # charge per area and kelvin of each layer [C m-2 K-1]; (layer,)
    film_gap: float | None  # film_gap(stack) if the punch collects [m]; None if an electrode below does

    @classmethod
    def of(cls, stack: Stack, collector: int | None = None) -> "HeatedStack":
        """Return a stack whose charge an electrode collects, or (None) the punch."""
        layers, weights = conduction(stack), layer_weights(stack, collector)
        return cls(layers, weights, film_gap(stack) if collector is None else None)

    @property
    def uniform(self) -> float:
        """Charge per area and kelvin of a uniform change of temperature [C m-2 K-1]."""
        return float(self.weights.sum())

    def warmed(self, spot: Spot, time: float, leak: float = np.inf) -> Warmed:
        """Return the layers at a time after a touch, seen by a circuit of time constant ``leak`` [s]."""
        return Warmed.after(self.conduction, self.weights, spot, time, leak)

    def collected(self, warmed: Warmed, patch: Patch | None) -> float:
        """Charge collected per kelvin of the punch [C/K], along a line [C m-1 K-1]."""
        return warmed.over(patch) if self.film_gap is None else warmed.on_punch(self.film_gap)

    def overtaken(self, spot: Spot, patch: Patch | None, charge: float, leak: float = np.inf) -> float:
        """Time at which heat's charge per kelvin reaches ``charge``, which leaks as well [s]; inf beyond 1e6 s."""
        if not self.weights.any():
            return np.inf
        if not charge:
            return _EARLIEST

        @cache
        def excess(log: float) -> float:
            heat_charge = abs(self.collected(self.warmed(spot, 10**log, leak), patch))
            return float(np.log(max(heat_charge, _LEAST * abs(charge)) / abs(charge)) + min(10**log / leak, 700.0))

        low, high = float(np.log10(_EARLIEST)), float(np.log10(_LATEST))
        if (self.weights >= 0).all() or (self.weights <= 0).all():  # the ratio to the force's charge only grows
            first = last = float(np.clip(np.log10(self._arrival), low, high))
            step = 0.5
            while first > low and excess(first) > 0:
                first, last, step = max(first - step, low), first, 2 * step
            while last < high and excess(last) <= 0:
                first, last, step = last, min(last + step, high), 2 * step
        else:
            logs = np.linspace(low, high, 1 + 12 * _PER_DECADE).tolist()
            first, last = next((ends for ends in pairwise(logs) if excess(ends[1]) > 0), (high, high))
        if excess(last) <= 0:
            return np.inf
        if excess(first) > 0:
            return float(10**low)
        return float(10 ** scipy.optimize.brentq(excess, first, last, xtol=1e-6))

    @property
    def _arrival(self) -> float:
        """Time in which heat spreads to the first layer that makes charge [s]."""
        body, first = self.conduction, int(np.flatnonzero(self.weights)[0]) if self.weights.any() else 0
        depths = np.append(body.thickness[:first], body.thickness[first] / 2)
        speeds = np.sqrt(body.capacity / body.conductivity)[: first + 1]
        return float((depths @ speeds) ** 2 / 8)
