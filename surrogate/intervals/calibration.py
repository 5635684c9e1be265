"""Calibration of a model on held-out cases: the map from variances to standard deviations, and its state in files."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from approximation import products
from approximation.arrays import Array, Indices
from surrogate.intervals.copula import Copula
from surrogate.intervals.distribution import PROBABILITIES, Tabulated
from surrogate.intervals.guard import SLABS, Guard, unguarded

MINIMUM = 40  # least number of held-out cases
MOST_TERMS, MOST_DEGREE = 1000, 64  # of a trend in a file

_DIMS = {
    "weights": ("part", "output"),
    "floor": ("output",),
    "trend": ("trend_term", "output"),
    "trend_degree": ("trend_term", "input"),
    "trend_range": ("end", "output"),
    "guard": ("input", "slab", "output"),
    "corner_guard": ("pair", "edge", "other_edge", "output"),
    "quantile": ("probability", "output"),
}
# The guard of a model over groups, over that model's inputs.
_OUTER_DIMS = {
    "outer_guard": ("outer_input", "slab", "output"),
    "outer_corner_guard": ("outer_pair", "edge", "other_edge", "output"),
    "outer_pooled_guard": ("output",),
}


@dataclass(frozen=True)
class Calibration:
    """Map from a raw variance to a calibrated standard deviation and distribution."""

    weights: Array  # shape (k, p); weight of every part of the variance, for every output
    floor: Array  # shape (p,); variance added everywhere, squared units of the output
    trend: Array  # shape (m, p); coefficients of the logarithm of the local scale
    trend_degree: Indices  # shape (m, d); Chebyshev degrees of its terms in the scaled inputs, all 0 in the first
    trend_range: Array  # shape (2, p); its least and largest values at the cases, beyond which it is clipped
    guard: Guard  # further scales in slabs and corners of the box
    distribution: Tabulated  # distribution of (truth - mean) / std
    outer: Guard | None = None  # further scales over the inputs of a model that wraps this one; that model applies them
    copula: Copula | None = None  # joint distribution of errors; None in older files

    def std(self, variance: Array, t: Array) -> Array:
        """Return calibrated standard deviations of weighted variances, (p, B) each, at scaled coordinates t, (d, B)."""
        return np.asarray(np.sqrt(variance + self.floor[:, None]) * self.stretch(t))

    def stretch(self, t: Array) -> Array:
        """Return the factors on raw standard deviations at scaled coordinates (d, B): (p, B)."""
        inside = np.clip(t, -1, 1)
        scale = self.trend.T @ products.values(self.trend_degree, inside)
        np.clip(scale, *self.trend_range[..., None], out=scale)
        scale += self.guard.at(inside).T
        return np.asarray(np.exp(scale, out=scale))

    def only(self, columns: Sequence[int]) -> Self:
        """Return the calibration of the outputs `columns`."""
        chosen = list(columns)
        return replace(
            self,
            weights=self.weights[:, chosen],
            floor=self.floor[chosen],
            trend=self.trend[:, chosen],
            trend_range=self.trend_range[:, chosen],
            guard=self.guard.only(chosen),
            distribution=self.distribution.only(chosen),
            outer=None if self.outer is None else self.outer.only(chosen),
            copula=None if self.copula is None else self.copula.only(chosen),
        )

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the arrays by name."""
        plain = {name: getattr(self, name) for name in ("weights", "floor", "trend", "trend_degree", "trend_range")}
        guard = {"guard": self.guard.slabs, "corner_guard": self.guard.corners}
        if self.outer is not None and self.outer.pooled is not None:
            outer_guard = self.outer.slabs, self.outer.corners, self.outer.pooled
            guard |= dict(zip(_OUTER_DIMS, outer_guard, strict=True))
        return {**plain, **guard, "quantile": self.distribution.quantiles}

    def state(self) -> dict[str, tuple[tuple[str, ...], NDArray[np.generic]]]:
        """Return the arrays that are not empty with their dimensions, for a file."""
        state: dict[str, tuple[tuple[str, ...], NDArray[np.generic]]] = {
            f"calibration_{name}": ((_DIMS | _OUTER_DIMS)[name], array)
            for name, array in self.arrays().items()
            if array.size
        }
        together = {} if self.copula is None else self.copula.state()
        return {**state, **together, "calibration_cases": ((), np.array(self.distribution.cases))}

    @classmethod
    def restore(cls, stored: xr.Dataset, parts: int, inputs: int, outputs: int) -> Self | None:
        """Return the calibration in a file, None where it has none."""
        if "calibration_weights" not in stored:
            return None
        cases, pairs = int(stored["calibration_cases"]), inputs * (inputs - 1) // 2
        arrays = {name: stored[f"calibration_{name}"].values for name in _DIMS if pairs or name != "corner_guard"}
        arrays.setdefault("corner_guard", unguarded(inputs, outputs).corners)
        terms = len(arrays["trend"])
        sizes = {
            "part": parts, "output": outputs, "input": inputs, "trend_term": terms, "end": 2, "slab": SLABS,
            "pair": pairs, "edge": 3, "other_edge": 3, "probability": len(PROBABILITIES),
        }  # fmt: skip
        shapes = {name: tuple(sizes[dim] for dim in dims) for name, dims in _DIMS.items()}
        stored_shapes = {name: array.shape for name, array in arrays.items()}
        degree = arrays["trend_degree"]
        if stored_shapes != shapes or not 0 < terms <= MOST_TERMS or degree.dtype.kind not in "iu" or cases < MINIMUM:
            raise ValueError("the calibration does not fit the model")
        if degree.min() < 0 or degree.max() > MOST_DEGREE or degree[0].any():
            raise ValueError("the calibration has degrees that none has")
        if (arrays["weights"] < 0).any() or (arrays["floor"] < 0).any():
            raise ValueError("the calibration has a negative variance")
        if (np.diff(arrays["quantile"], axis=0) < 0).any():
            raise ValueError("the calibration's quantiles do not ascend")
        guard = Guard(arrays["guard"], arrays["corner_guard"])
        distribution = Tabulated(arrays["quantile"], cases)
        weights, floor, trend, within = (arrays[name] for name in ("weights", "floor", "trend", "trend_range"))
        outer, copula = _outer(stored, outputs), Copula.restore(stored, inputs, outputs)
        return cls(weights, floor, trend, degree.astype(np.intp), within, guard, distribution, outer, copula)


def _outer(stored: xr.Dataset, outputs: int) -> Guard | None:
    """Return the outer guard in a file, None where it has none; ValueError where it does not fit."""
    outer = {name: stored[f"calibration_{name}"].values for name in _OUTER_DIMS if f"calibration_{name}" in stored}
    if not outer:
        return None
    guard, pooled = (outer.get(name, np.zeros(0)) for name in ("outer_guard", "outer_pooled_guard"))
    empty = unguarded(len(guard), outputs, pooled=True)
    corners = outer.get("outer_corner_guard", empty.corners)  # one input has no corners
    if (guard.shape, corners.shape, pooled.shape) != (empty.slabs.shape, empty.corners.shape, (outputs,)):
        raise ValueError("the calibration's outer guard does not fit the model")
    return Guard(guard, corners, pooled)
