"""Sources of a design question's quantities: the surrogate, the exact solver, and the edge of answered cases."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from typing_extensions import override

from approximation.arrays import Array
from solver import CaseError, solve_interior
from solver.names import ALL_PEAKS
from surrogate import CurveGP, GaussianProcess, Input
from surrogate.data.inputs import unit_coordinates
from surrogate.face.region import Region
from surrogate.intervals.distribution import ONE_STD
from workflow.dataset import factorial
from workflow.study.categories import Combination, output
from workflow.study.model import Study
from workflow.study.refusals import REFUSAL, AllRefusedError

_DIMS = ("point", "scenario")
_DEPTHS = np.linspace(-2.0, 0.0, 17)  # in half-widths, where the field below the contact is judged
#: Factors by name over (points, scenarios); an axis that does not change a factor has length one.
Factors = dict[str, Array]


def shape(factors: Factors) -> tuple[int, ...]:
    """(points, scenarios)."""
    return np.broadcast_shapes(*(values.shape for values in factors.values()))


class Edge:
    """The edge beyond which the solver refuses cases: a surrogate's region as rows of a program, one a scenario."""

    def __init__(self, region: Region, inputs: Sequence[Input]) -> None:
        self._region, self._inputs = region, tuple(inputs)
        self._scale = float(np.abs(region.coefficients[1:]).sum()) or 1.0

    def excess(self, factors: dict[str, Array]) -> Array:
        """Distance of cases beyond the margin, in units of the region's steepest rise; (points, scenarios)."""
        X, whole = self._points(factors)
        above = self._region.above(unit_coordinates(self._inputs, X))
        return np.asarray(-above.reshape(whole) / self._scale)

    def slopes(self, factors: dict[str, Array], over: Sequence[str]) -> Array:
        """Derivatives of `excess` at one point, (scenarios, variables), by physical factors."""
        X, _ = self._points(factors)
        rising = self._region.slopes(unit_coordinates(self._inputs, X))
        names = [input_.name for input_ in self._inputs]
        columns = [names.index(name) for name in over]
        return np.stack([-rising[k] * self._inputs[k].unit_slope(X[:, k]) / self._scale for k in columns], axis=-1)

    def reason(self, factors: dict[str, Array]) -> str:
        """Why a known case next to that one of some which lies farthest beyond the edge is refused."""
        X, _ = self._points(factors)
        t = unit_coordinates(self._inputs, X)
        return self._region.reason(t[:, int(self._region.above(t).argmin())])

    def _points(self, factors: dict[str, Array]) -> tuple[Array, tuple[int, ...]]:
        whole = np.zeros(np.broadcast_shapes(*(values.shape for values in factors.values())))
        return np.stack([(factors[input_.name] + whole).ravel() for input_ in self._inputs], -1), whole.shape


class Source(ABC):
    """Quantities of factors."""

    #: Step of difference quotients in scaled coordinates; None: `slopes` has the derivatives.
    step: float | None = None
    #: The edge beyond which the solver refuses cases; None where it refuses none.
    edge: Edge | None = None

    @abstractmethod
    def values(self, factors: Factors, names: Sequence[str]) -> dict[str, Array]:
        """Quantities by name, (points, scenarios) each."""

    def slopes(self, factors: Factors, names: Sequence[str], over: Sequence[str]) -> dict[str, Array]:
        """Derivatives at one point, (scenarios, variables) each, in physical units."""
        raise NotImplementedError("difference quotients take the place of derivatives")


class Exact(Source):
    """The exact solver of a study."""

    step = 1e-6

    def __init__(self, study: Study, beyond: "Predicted | None" = None) -> None:
        self._study = study
        self._beyond = beyond if beyond is not None and beyond.edge is not None else None
        self.edge = None if self._beyond is None else self._beyond.edge
        self._solved: dict[tuple[float, ...], dict[str, float]] = {}  # costly cases by their factors

    @property
    def quantities(self) -> list[str]:
        """Every quantity that the study's cases have."""
        return self._study.quantities

    @override
    def values(self, factors: Factors, names: Sequence[str]) -> dict[str, Array]:
        if self._study.costly.isdisjoint(names):
            return self._anew(factors, names)
        return self._remembered(factors, names)

    def _remembered(self, factors: Factors, names: Sequence[str]) -> dict[str, Array]:
        """Quantities of costly cases, each of which is solved once: the terms of a question share their scenarios."""
        whole, over = shape(factors), sorted(factors)
        columns = [np.broadcast_to(factors[name], whole).ravel().tolist() for name in over]
        rows = list(zip(*columns, strict=True))
        missing = list(dict.fromkeys(row for row in rows if not self._solved.get(row, {}).keys() >= {*names}))
        if missing:
            anew = dict(zip(over, np.array(missing).T[:, None], strict=True))
            together = [name for name in self.quantities if name not in ALL_PEAKS]  # a case has them all at one price
            solved = self._anew(anew, names if self._beyond or not {*together} >= {*names} else together)
            cases = np.stack([np.broadcast_to(values, (1, len(missing)))[0] for values in solved.values()], -1)
            for row, case in zip(missing, cases.tolist(), strict=True):
                self._solved[row] = self._solved.get(row, {}) | dict(zip(solved, case, strict=True))
        return {name: np.array([self._solved[row][name] for row in rows]).reshape(whole) for name in names}

    def _anew(self, factors: Factors, names: Sequence[str]) -> dict[str, Array]:
        """Quantities of cases from the solver; of cases that it refuses beyond a known edge, from the surrogate."""
        axes = _labelled(factors)
        peaks = [name for name in names if name in ALL_PEAKS]
        if self._beyond is None:
            return _values(factorial.exact(self._study, axes, peaks=peaks), names)
        try:
            solved = factorial.exact(self._study, axes, peaks=peaks, holes=np.inf)
        except AllRefusedError:
            return self._beyond.values(factors, names)
        quantities = _values(solved, names)
        if REFUSAL in solved:
            whole = self._beyond.values(factors, names)
            quantities = {name: np.where(np.isnan(values), whole[name], values) for name, values in quantities.items()}
        return quantities

    def refusal(self, factors: Factors) -> str:
        """Why the solver refuses some case; empty where it refuses none."""
        try:
            factorial.exact(self._study, _labelled(factors), peaks=[])
        except CaseError as error:
            return str(error)
        return ""

    def field_below(self, factors: Factors) -> float:
        """Largest electric field below the contact's middle, two half-widths deep, over all cases [V/m]."""
        parts = ("electric_field_x", "electric_field_y")
        solved = self._study.solved(
            solve_interior, {**self._study.fixed, **_labelled(factors)}, [0.0], _DEPTHS, fields=parts
        )
        return float(np.hypot(*(solved[part].values for part in parts)).max())


class Predicted(Source):
    """The surrogate, for one combination of the study's categories."""

    def __init__(self, model: GaussianProcess, combination: Combination | None = None) -> None:
        self.edge = None if model.region_ is None else Edge(model.region_, model.inputs_)
        self._model = model.everywhere()
        self._combination = combination or {}
        self._parts: dict[tuple[str, ...], GaussianProcess] = {}

    @override
    def values(self, factors: Factors, names: Sequence[str]) -> dict[str, Array]:
        X, whole = self._points(factors)
        model = self._of(names)
        mean = model.predict_array(X)
        return {name: mean[:, self._column(name, model)].reshape(whole) for name in names}

    def errors(self, factors: Factors, weights: Mapping[str, Array]) -> tuple[float, float]:
        """Standard deviation and reach of a weighted sum of quantities over scenarios, with correlated errors."""
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
        """The model of these quantities, of one if there are none: what follows from curves costs a search each."""
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
    """Quantities of solved cases, (points, scenarios) each, or of length one along what does not change them."""
    lacking = [dim for dim in _DIMS if dim not in solved.dims]
    return {name: solved[name].expand_dims(lacking).transpose(*_DIMS).values for name in names}


def _labelled(factors: Factors) -> dict[str, xr.DataArray]:
    """Factors with the dimensions that each changes along."""
    return {
        name: xr.DataArray(
            values.squeeze(), dims=[dim for dim, size in zip(_DIMS, values.shape, strict=True) if size > 1]
        )
        for name, values in factors.items()
    }
