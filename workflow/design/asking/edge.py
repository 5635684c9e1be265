"""The edge beyond which the solver refuses cases, as limits of a design: no scenario may lie beyond its margin."""

from collections.abc import Sequence

import numpy as np

from approximation.arrays import Array
from surrogate import Input
from surrogate.data.inputs import unit_coordinates
from surrogate.face.region import Region


class Edge:
    """A surrogate's region as rows of a nonlinear program, one a scenario."""

    def __init__(self, region: Region, inputs: Sequence[Input]) -> None:
        self._region, self._inputs = region, tuple(inputs)
        self._scale = float(np.abs(region.coefficients[1:]).sum()) or 1.0

    def excess(self, factors: dict[str, Array]) -> Array:
        """How far cases lie beyond the margin, in units of the region's steepest rise; (points, scenarios)."""
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
