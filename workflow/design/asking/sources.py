"""Where a design question takes its quantities from: the surrogate, or the exact solver."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver import solve_interior
from solver.names import ALL_PEAKS
from surrogate import CurveGP, GaussianProcess
from workflow.dataset import factorial
from workflow.study.categories import Kinds, output
from workflow.study.model import Study

Array = NDArray[np.float64]
_DEPTHS = np.linspace(-2.0, 0.0, 17)  # in half-widths, where the field below the contact is judged
#: Factors by name over (points, scenarios); an axis that does not change a factor has length one.
Factors = dict[str, Array]


def shape(factors: Factors) -> tuple[int, ...]:
    """(points, scenarios)."""
    return np.broadcast_shapes(*(values.shape for values in factors.values()))


class Source(Protocol):
    """Quantities of factors."""

    #: Step of difference quotients in scaled coordinates; None: the derivatives are analytic.
    step: float | None

    def values(self, factors: Factors, names: Sequence[str]) -> dict[str, Array]:
        """Quantities by name, (points, scenarios) each."""

    def slopes(self, factors: Factors, names: Sequence[str], over: Sequence[str]) -> dict[str, Array]:
        """Derivatives at one point by the factors ``over``, (scenarios, variables) each, in physical units."""


class Exact:
    """The exact solver of a study."""

    step: float | None = 1e-6

    def __init__(self, study: Study) -> None:
        self._study = study

    @property
    def quantities(self) -> list[str]:
        """Every quantity that the study's cases have."""
        return self._study.quantities

    def values(self, factors: Factors, names: Sequence[str]) -> dict[str, Array]:
        """Quantities by name; factors that share a dimension are evaluated together."""
        axes = {name: _labelled(values) for name, values in factors.items()}
        solved = factorial.exact(self._study, axes, peaks=[name for name in names if name in ALL_PEAKS])
        whole = {"point": 1, "scenario": 1} | dict(solved.sizes)
        arrays = {name: solved[name].expand_dims([dim for dim in whole if dim not in solved.dims]) for name in names}
        return {name: array.transpose("point", "scenario").values for name, array in arrays.items()}

    def field_below(self, factors: Factors) -> float:
        """Largest electric field below the middle of the contact, two half-widths deep, over all cases [V/m].

        Below its edges, where a conducting punch ends, the field has no bound.
        """
        axes = {name: _labelled(values) for name, values in factors.items()}
        parts = ("electric_field_x", "electric_field_y")
        found = self._study.solved(solve_interior, {**self._study.fixed, **axes}, [0.0], _DEPTHS, fields=parts)
        return float(np.hypot(*(found[part].values for part in parts)).max())

    def slopes(self, factors: Factors, names: Sequence[str], over: Sequence[str]) -> dict[str, Array]:
        """Not given: the question differentiates by difference quotients."""
        raise NotImplementedError("the exact solver gives no derivatives")


class Predicted:
    """The surrogate, for one combination of the study's categories."""

    step: float | None = None

    def __init__(self, model: GaussianProcess, kinds: Kinds | None = None) -> None:
        self._model = model
        self._kinds = kinds or {}
        self._parts: dict[tuple[str, ...], GaussianProcess] = {}

    def values(self, factors: Factors, names: Sequence[str]) -> dict[str, Array]:
        """Means by name."""
        X, whole = self._points(factors)
        model = self._of(names)
        mean = model.predict_array(X)
        return {name: mean[:, self._column(name, model)].reshape(whole) for name in names}

    def stds(self, factors: Factors, names: Sequence[str]) -> dict[str, Array]:
        """Standard deviations by name."""
        X, whole = self._points(factors)
        model = self._of(names)
        _, std = model.predict_array(X, return_std=True)
        return {name: std[:, self._column(name, model)].reshape(whole) for name in names}

    def reaches(self, factors: Factors, names: Sequence[str]) -> dict[str, Array]:
        """From the mean to the farther end of the interval of the study's level, by name."""
        X, whole = self._points(factors)
        model = self._of(names)
        mean, (lower, upper) = model.predict_array(X), model.interval_array(X)
        reach = np.maximum(upper - mean, mean - lower)
        return {name: reach[:, self._column(name, model)].reshape(whole) for name in names}

    def slopes(self, factors: Factors, names: Sequence[str], over: Sequence[str]) -> dict[str, Array]:
        """Derivatives of the means."""
        X, _ = self._points(factors)
        inputs = list(self._model.box)
        model = self._of(names)
        slopes = model.gradient_array(X)[..., [inputs.index(name) for name in over]]
        return {name: slopes[:, self._column(name, model)] for name in names}

    def _of(self, names: Sequence[str]) -> GaussianProcess:
        """The model of these quantities, of one if there are none: what follows from curves costs a search each."""
        if not isinstance(self._model, CurveGP):
            return self._model
        asked = tuple(dict.fromkeys(output(name, self._kinds) for name in names)) or self._model.outputs_[-1:]
        if asked not in self._parts:
            self._parts[asked] = self._model.only(asked)
        return self._parts[asked]

    def _column(self, name: str, model: GaussianProcess) -> int:
        return model.outputs_.index(output(name, self._kinds))

    def _points(self, factors: Factors) -> tuple[Array, tuple[int, ...]]:
        whole = np.zeros(shape(factors))
        return np.stack([(factors[name] + whole).ravel() for name in self._model.box], -1), whole.shape


def _labelled(factor: Array) -> xr.DataArray:
    """With the dimensions that it changes along."""
    kept = [dim for dim, size in zip(("point", "scenario"), factor.shape, strict=True) if size > 1]
    return xr.DataArray(factor.squeeze(), dims=kept)
