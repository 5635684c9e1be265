"""Charge that heat makes on the electrodes of a layered body.

A film between electrodes on one potential, on a thick base that it follows in its plane, has per kelvin

    p_film = p_sigma - 2 (e31 - e33 c13 / c33)(alpha - alpha_base),

and p_sigma where it is free. Its sign is that of D_y along +y. Several layers between two electrodes are plates in
series: each counts by its share h/eps of the sum. A material without piezoelectric constants has no polar axis: 0.
The strain of a body that is warm in one place only is left out.
"""

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
_EARLIEST, _LATEST = 1e-6, 1e6  # s, between which heat overtakes a force, or never
_PER_DECADE = 6
_LEAST = 1e-8  # charge over another one that is lost in rounding


class HeatError(MaterialError):
    """A constant for heat that is not known."""


def constant(name: str, thermal: dict[str, Sourced] | object, owner: str) -> float:
    """Value of a constant for heat of a body."""
    if not isinstance(thermal, dict) or name not in thermal:
        raise HeatError(f"heat: not known for {owner}: {name}")
    value, positive = float(thermal[name].value), name in _CONDUCTS
    if not np.isfinite(value) or (positive and value <= 0):
        allowed = f"a finite number{' > 0' if positive else ''} [{THERMAL[name].units}]"
        raise MaterialError(f"{owner}: thermal: {name}: {value:g} is not {allowed}")
    return value


def film_coefficient(film: Material, base: Material | None = None) -> float:
    """Charge per area and kelvin of a film between electrodes on one potential [C m-2 K-1].

    base : material that the film is bonded to, thick against it; None: the film is free.
    """
    if film.conductor or not (film.e31 or film.e33 or film.e15):
        return 0.0
    free = constant("pyroelectric", film.thermal, film.name)
    if base is None:
        return free
    clamped = float(film.e31 - film.e33 * film.c13 / film.c33)
    mismatch = constant("expansion", film.thermal, film.name) - constant("expansion", base.thermal, base.name)
    return free - 2 * clamped * mismatch


def conduction(stack: Stack) -> Conduction:
    """Layers of a stack as they conduct heat."""
    if isinstance(stack.base, str):
        raise HeatError("heat: not known for the base 'rigid': conductivity; name the material of the base")
    bodies = [*(layer.material for layer in stack.layers), stack.base]
    values = {name: np.array([constant(name, m.thermal, m.name) for m in bodies]) for name in _CONDUCTS}
    thickness = np.array([layer.thickness for layer in stack.layers])
    return Conduction(thickness, values["conductivity"], values["heat_capacity"])


def layer_weights(stack: Stack, collector: int | None = None) -> Array:
    """Charge of an electrode per area and kelvin of each layer [C m-2 K-1]; (layer,).

    collector : number of the electrode, from the top; None: a punch that conducts, on the surface.
    """
    weights = np.zeros(len(stack.layers))
    if collector is None:
        places = electrodes(stack)
        if not places:
            raise HeatError("heat: the punch's charge is of a film above a grounded interface; this body has none")
        parts = [(-1.0, range(places[0][0] + 1))]
    else:
        electrode = Electrode(stack, collector)
        between = electrode.between
        above = bool(between) and collector > 1
        parts = [(1.0, between[0])] if above else []
        parts += [(-1.0, layers) for layers in between[len(parts) :]]
    base = None if isinstance(stack.base, str) else stack.base
    if base is None and any(layer.material.e33 for layer in stack.layers):
        raise HeatError("heat: not known for the base 'rigid': expansion; name the material of the base")
    for sign, layers in parts:
        bodies = [(stack.layers[place].thickness, stack.layers[place].material) for place in layers]
        shares = np.array([h / float(m.eps33 + m.e33**2 / m.c33) for h, m in bodies])
        coefficients = np.array([film_coefficient(m, base) for _, m in bodies])
        weights[list(layers)] += sign * coefficients * shares / shares.sum()
    return weights


def film_gap(stack: Stack) -> float:
    """Thickness of air whose capacitance is that of the layers above the first electrode [m]; 0 without one."""
    below = electrodes(stack)
    layers = [(layer.thickness, layer.material) for layer in stack.layers[: below[0][0] + 1 if below else 0]]
    return VACUUM_PERMITTIVITY * sum(h / float(m.eps33 + m.e33**2 / m.c33) for h, m in layers)


@dataclass(frozen=True, eq=False)
class HeatedStack:
    """A stack and the electrode that collects its charge."""

    conduction: Conduction
    weights: Array  # charge per area and kelvin of each layer [C m-2 K-1]; (layer,)
    film_gap: float | None  # as of film_gap() where the punch collects [m]; None: an electrode below does

    @classmethod
    def of(cls, stack: Stack, collector: int | None = None) -> "HeatedStack":
        """The stack as it conducts heat and makes charge."""
        conducting, weights = conduction(stack), layer_weights(stack, collector)
        return cls(conducting, weights, film_gap(stack) if collector is None else None)

    @property
    def uniform(self) -> float:
        """Charge per area and kelvin of one change of temperature everywhere [C m-2 K-1]."""
        return float(self.weights.sum())

    def warmed(self, spot: Spot, time: float, leak: float = np.inf) -> Warmed:
        """Layers at a time after a touch, as a circuit whose time constant is ``leak`` [s] still shows them."""
        return Warmed.after(self.conduction, self.weights, spot, time, leak)

    def collected(self, warmed: Warmed, patch: Patch | None) -> float:
        """Charge per kelvin of the punch [C/K], of lines [C m-1 K-1]."""
        return warmed.over(patch) if self.film_gap is None else warmed.on_punch(self.film_gap)

    def overtaken(self, spot: Spot, patch: Patch | None, charge: float, leak: float = np.inf) -> float:
        """Time at which the charge per kelvin reaches a size [s], infinite if later than 1e6 s.

        The charge decays with the circuit's time constant ``leak`` [s] as well.
        """
        if not self.weights.any():
            return np.inf
        if not charge:
            return _EARLIEST

        @cache
        def excess(log: float) -> float:
            heat_charge = abs(self.collected(self.warmed(spot, 10**log, leak), patch))
            return float(np.log(max(heat_charge, _LEAST * abs(charge)) / abs(charge)) + min(10**log / leak, 700.0))

        low, high = float(np.log10(_EARLIEST)), float(np.log10(_LATEST))
        if (self.weights >= 0).all() or (self.weights <= 0).all():  # the charge over that of the force only grows
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
