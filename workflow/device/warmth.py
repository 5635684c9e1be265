"""Charge that a history of the temperature of what touches makes in a film, by superposing steps."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import xarray as xr

from approximation.arrays import Array
from solver import Material
from solver.face.heat import responses
from workflow.device.signal import History

_TERMS, _TIMES = 40, 120  # exponentials, and times at which they are fitted
_SHORT = 1e-3  # of the mean step of a history: heat within less is not resolved
_EARLIER = 20  # first fitted time over the shortest resolved one: a ramp integrates the steps from zero on
_SINGULAR = 1e-8  # relative, of what is fitted: below it exponentials cancel one another


@dataclass(frozen=True, eq=False)
class Warmth:
    """Charge after a step of 1 K at the surface, as a sum of exponentials that approach their ends.

    The contact is the one under the largest force for all of the history: a smaller one has less heat.
    """

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
        phases: tuple[str, str] = ("BaTiO3", "CoFe2O4"),
    ) -> Self:
        """Warmth of a solved film below what a history presses on it; ``length`` [m] is that of a line."""
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
        """Charge of the heat at the times of a history [C], (time,); the first temperature is that of the body."""
        assert history.temperatures is not None
        steps, rises = np.diff(history.times), np.diff(history.temperatures)
        lags, out = np.zeros_like(self.rates), np.zeros(len(history.times))
        total = self.sizes.sum() * (history.temperatures - history.temperatures[0])
        for row, (step, rise) in enumerate(zip(steps.tolist(), rises.tolist(), strict=True), 1):
            falls = np.exp(-self.rates * step)
            lags = lags * falls - rise * np.expm1(-self.rates * step) / (self.rates * step)
            out[row] = total[row] - self.sizes @ lags
        return out
