"""Sources of a design question's quantities: the surrogate and the exact solver."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from typing_extensions import override

from approximation.arrays import Array
from solver import solve_interior
from solver.names import ALL_PEAKS
from surrogate import CurveGP, GaussianProcess
from surrogate.intervals.distribution import ONE_STD
from workflow.dataset import factorial
from workflow.study.categories import Combination, output
from workflow.study.model import Study

_DIMS = ("point", "scenario")
_DEPTHS = np.linspace(-2.0, 0.0, 17)  # in half-widths, at which the field below the contact is solved
#: Factors by name over (points, scenarios); an axis that does not change a factor has length one.
Factors = dict[str, Array]


def shape(factors: Factors) -> tuple[int, ...]:
    """Return the shape (points, scenarios) of factors."""
    return np.broadcast_shapes(*(values.shape for values in factors.values()))


class Source(ABC):
    """Quantities of factors."""

    #: Step of difference quotients in scaled coordinates; None: `slopes` has the derivatives.
    step: float | None = None

    @abstractmethod
    def values(self, factors: Factors, names: Sequence[str]) -> dict[str, Array]:
        """Return quantities by name, (points, scenarios) each."""

    def slopes(self, factors: Factors, names: Sequence[str], over: Sequence[str]) -> dict[str, Array]:
        """Return derivatives at one point, (scenarios, variables) each, in physical units."""
        raise NotImplementedError("difference quotients take the place of derivatives")


class Exact(Source):
    """The exact solver of a study."""

    step = 1e-6

    def __init__(self, study: Study) -> None:
        self._study = study
        self._solved: dict[tuple[float, ...], dict[str, float]] = {}  # costly cases by their factors

    @override
    def values(self, factors: Factors, names: Sequence[str]) -> dict[str, Array]:
        if self._study.costly.isdisjoint(names):
            return self._solve(factors, names)
        return self._solve_once(factors, names)

    def _solve_once(self, factors: Factors, names: Sequence[str]) -> dict[str, Array]:
        """Return quantities of costly cases, solved once each: the terms of a question share their scenarios."""
        whole, over = shape(factors), sorted(factors)
        columns = [np.broadcast_to(factors[name], whole).ravel().tolist() for name in over]
        rows = list(zip(*columns, strict=True))
        missing = list(dict.fromkeys(row for row in rows if not self._solved.get(row, {}).keys() >= {*names}))
        if missing:
            missing_factors = dict(zip(over, np.array(missing).T[:, None], strict=True))
            # one solution has all but the peaks
            together = [name for name in self._study.quantities if name not in ALL_PEAKS]
            solved = self._solve(missing_factors, together if {*together} >= {*names} else names)
            cases = np.stack([np.broadcast_to(values, (1, len(missing)))[0] for values in solved.values()], -1)
            for row, case in zip(missing, cases.tolist(), strict=True):
                self._solved[row] = self._solved.get(row, {}) | dict(zip(solved, case, strict=True))
        return {name: np.array([self._solved[row][name] for row in rows]).reshape(whole) for name in names}

    def _solve(self, factors: Factors, names: Sequence[str]) -> dict[str, Array]:
        """Return quantities of cases from the solver."""
        peaks = [name for name in names if name in ALL_PEAKS]
        return _values(factorial.exact(self._study, _labelled(factors), peaks=peaks), names)

    def field_below(self, factors: Factors) -> float:
        """Return the largest electric field below the contact's middle, to two half-widths, over all cases [V/m]."""
        parts = ("electric_field_x", "electric_field_y")
        solved = self._study.solved(
            solve_interior, {**self._study.fixed, **_labelled(factors)}, [0.0], _DEPTHS, fields=parts
        )
        return float(np.hypot(*(solved[part].values for part in parts)).max())


class Predicted(Source):
    """The surrogate, for one combination of the study's categories."""

    def __init__(self, model: GaussianProcess, combination: Combination | None = None) -> None:
        self._model = model
        self._combination = combination or {}
        self._parts: dict[tuple[str, ...], GaussianProcess] = {}

    @override
    def values(self, factors: Factors, names: Sequence[str]) -> dict[str, Array]:
        X, whole = self._points(factors)
        model = self._of(names)
        mean = model.predict_array(X)
        return {name: mean[:, self._column(name, model)].reshape(whole) for name in names}

    def errors(self, factors: Factors, weights: Mapping[str, Array]) -> tuple[float, float]:
        """Return standard deviation and reach of a weighted sum of quantities over scenarios, errors correlated."""
        X, _ = self._points(factors)
        model = self._of(list(weights))
        columns = np.zeros((len(X), len(model.outputs_)))
        for name, part in weights.items():
            columns[:, self._column(name, model)] = part
        counting = columns.any(axis=1)
        if not counting.any():
            return 0.0, 0.0
        deviation, ends = (model.ends_of_sum(X[counting], columns[counting], level) for level in (ONE_STD, None))
        return float(np.ptp(deviation)) / 2, float(np.abs(ends).max())

    @override
    def slopes(self, factors: Factors, names: Sequence[str], over: Sequence[str]) -> dict[str, Array]:
        X, _ = self._points(factors)
        inputs = list(self._model.box)
        model = self._of(names)
        slopes = model.gradient_array(X)[..., [inputs.index(name) for name in over]]
        return {name: slopes[:, self._column(name, model)] for name in names}

    def _of(self, names: Sequence[str]) -> GaussianProcess:
        """Return the model of some quantities, at least one: each that follows from curves costs a search."""
        if not isinstance(self._model, CurveGP):
            return self._model
        outputs = tuple(dict.fromkeys(output(name, self._combination) for name in names)) or self._model.outputs_[-1:]
        if outputs not in self._parts:
            self._parts[outputs] = self._model.only(outputs)
        return self._parts[outputs]

    def _column(self, name: str, model: GaussianProcess) -> int:
        return model.outputs_.index(output(name, self._combination))

    def _points(self, factors: Factors) -> tuple[Array, tuple[int, ...]]:
        whole = np.zeros(shape(factors))
        return np.stack([(factors[name] + whole).ravel() for name in self._model.box], -1), whole.shape


def _values(solved: xr.Dataset, names: Sequence[str]) -> dict[str, Array]:
    """Return quantities of solved cases, (points, scenarios) each, with length one where they do not change."""
    lacking = [dim for dim in _DIMS if dim not in solved.dims]
    return {name: solved[name].expand_dims(lacking).transpose(*_DIMS).values for name in names}


def _labelled(factors: Factors) -> dict[str, xr.DataArray]:
    """Return factors with the dimensions along which each changes."""
    return {
        name: xr.DataArray(
            values.squeeze(), dims=[dim for dim, size in zip(_DIMS, values.shape, strict=True) if size > 1]
        )
        for name, values in factors.items()
    }
