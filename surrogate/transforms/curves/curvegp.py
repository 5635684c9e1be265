"""Largest values of curves: a Gaussian process learns the smooth curves, and a query takes the predicted maximum.

A maximum has a kink in the inputs where its place jumps, which no number of levels learns well; the fields along the
curve are smooth. They are learnt in the basis of the cases' singular vectors, every score as an output of a Gaussian
process of any kind. The predicted curves are piecewise polynomials (module `panels`).
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import replace
from typing import Any, ClassVar, Self

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from typing_extensions import override

from approximation.arrays import Array, Indices, blocks
from approximation.measure import Measure
from approximation.panels import Panels
from surrogate.data.inputs import Input
from surrogate.face.model import GaussianProcess
from surrogate.transforms.curves.basis import Basis, Curves, Largest
from surrogate.transforms.curves.landscape import Landscape
from surrogate.transforms.groups import Grouping, Scaling
from surrogate.transforms.transformed import Transformed, groups_of

_QUERIES_AT_ONCE = 128  # curves that are searched at a time: their fields stay in cache
_PROBES = 64
_LONGEST_PANEL = 1000  # most points of a panel in a file


class CurveGP(Transformed):
    """Smooth outputs, and largest measures of curves, over the inputs of one Gaussian process.

    Parameters
    ----------
    smooth : callable
        Returns the process, not fitted, from the names of the smooth outputs: plain ones, sizes and scores of curves.
    curves : sequence of Curves
        Fields that are learnt along curves.
    largest : mapping of str to Largest
        Outputs that are maxima of curves.
    outputs : sequence of str
        All outputs in order; those not in `largest` are plain variables of the data set.
    attrs : mapping, optional
        `units` and `long_name` of the outputs in `largest`.
    logarithms : bool
        Learn the logarithm of every size, otherwise the size itself, which the process may scale.
    error : float
        Root-mean-square error of the basis and of the compression of its scores, relative to a field.

    Attributes
    ----------
    smooth_ : GaussianProcess
        The fitted process.
    bases_ : tuple of Basis
        Basis of every element of `curves`.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> from surrogate import GridGP, Input
    >>> from approximation.chebyshev import gauss_points
    >>> a, points = Input("a", -1, 1), gauss_points(32)
    >>> grid = xr.Dataset(coords={"a": a.levels(12), "point": np.arange(32)})
    >>> x = xr.DataArray(points, dims="point")
    >>> from approximation.measure import Measure
    >>> from approximation.panels import Panels
    >>> hills = Curves(("height",), ("",), Panels((32,)), "point")
    >>> highest = Largest(0, Measure(np.ones((1, 1)), np.zeros((1, 1, 1))))
    >>> model = CurveGP(lambda names: GridGP(inputs=[a]), [hills], {"top": highest}, ["top"])
    >>> model = model.fit(grid.assign(height=np.cos(3 * x) ** 2 + grid.a * x))  # two hills, as high at a = 0
    >>> fine = np.linspace(-1, 1, 200_001)
    >>> error = model.predict_array([[0.1]]).item() - (np.cos(3 * fine) ** 2 + 0.1 * fine).max()
    >>> bool(abs(error) < 1e-9)
    True
    """

    engine: ClassVar[str] = "curves"
    MEMBERS = CALIBRATED = ("smooth",)
    smooth_: GaussianProcess
    bases_: tuple[Basis, ...]

    def __init__(
        self,
        smooth: Callable[[Sequence[str]], GaussianProcess],
        curves: Sequence[Curves],
        largest: Mapping[str, Largest],
        outputs: Sequence[str],
        attrs: Mapping[str, dict[str, str]] | None = None,
        logarithms: bool = True,
        error: float = 1e-7,
    ) -> None:
        self.smooth, self.curves, self.largest = smooth, tuple(curves), dict(largest)
        self.outputs, self.attrs, self.logarithms, self.error = tuple(outputs), attrs, logarithms, error

    def fit(self, X: xr.Dataset) -> Self:
        """Fit to a data set of the plain outputs, the sizes and the fields.

        Raises
        ------
        ValueError
            As for the process; sizes that are not positive, fields that do not fit their panels.
        """
        plain = [name for name in self.outputs if name not in self.largest]
        parts: dict[str, xr.DataArray] = {name: X[name] for name in plain}
        for size in self._sizes():
            if not (X[size] > 0).all():
                raise ValueError(f"size {size!r} is not positive in some case")
            parts[self._learnt(size)] = X[size].copy(data=np.log(X[size].values)) if self.logarithms else X[size]
        bases = []
        for number, curves in enumerate(self.curves):
            like: xr.DataArray = X[curves.fields[0]].isel({curves.dim: 0}, drop=True)
            values = curves.shapes(X)
            bases.append(Basis.of(values, self.error))
            parts |= {
                f"score {number} {k}": like.copy(data=row.reshape(like.shape)).drop_attrs()
                for k, row in enumerate(bases[-1].scores(values))
            }
        coordinates = [str(name) for name in X.variables if name in X.dims or name in X.coords]
        along = {curves.dim for curves in self.curves}
        data = xr.Dataset(parts, {name: X[name] for name in coordinates if along.isdisjoint(X[name].dims)})
        smooth = self.smooth(list(parts)).fit(data)
        self.bases_, self.calibration_ = tuple(bases), None
        self.smooth_, self.cases_ = smooth.thinned(self.allowed(self.error)), smooth.cases_
        self._lay_out()
        return self

    def allowed(self, error: float) -> dict[str, float]:
        """Return the errors of log-sizes and scores that cause a relative error of the fields."""
        allowed = {f"log {size}": error for size in self._sizes()}
        for number, basis in enumerate(self.bases_):
            allowed |= {f"score {number} {k}": basis.error(error) for k in range(len(basis.vectors))}
        return allowed

    @property
    def witnesses(self) -> tuple[str, ...]:
        """Smooth outputs from whose variances those of the outputs follow."""
        return self._witness.outputs_

    def _lay_out(self) -> None:
        smooth, attrs = self.smooth_, dict(self.attrs or {})
        self.inputs_, self.outputs_ = smooth.inputs_, self.outputs
        self.attrs_ = {
            name: attrs.get(name, {}) if name in self.largest else smooth.attrs_[name] for name in self.outputs
        }
        rows = {name: k for k, name in enumerate(smooth.outputs_)}
        # rows of the smooth outputs: plain outputs, sizes, and scores of every element of `curves`
        self._plain_rows = [(k, rows[name]) for k, name in enumerate(self.outputs) if name not in self.largest]
        self._size_rows = {size: rows[name] for size in self._sizes() if (name := self._learnt(size)) in rows}
        self._score_rows = [
            [rows[name] for k in range(len(basis.vectors)) if (name := f"score {number} {k}") in rows]
            for number, basis in enumerate(self.bases_)
        ]
        self.grouping = self._grouped(groups_of(smooth))
        self._landscapes = [
            Landscape(basis, curves.panels) for basis, curves in zip(self.bases_, self.curves, strict=True)
        ]
        self._stand_witness()

    def _stand_witness(self) -> None:
        self._witness = self.smooth_.only([self._witnessed(name) for name in self.outputs])

    def _grouped(self, smooth: Grouping | None) -> Grouping | None:
        """Return the groups of the smooth process, with maxima of curves scaled like the curves' sizes."""
        if smooth is None:
            return None
        known = {name: smooth.scalings[name] for name in self.outputs if name not in self.largest}
        for name in self.largest:
            size = smooth.scalings.get(self._learnt(self._size_of(name)), Scaling())
            known[name] = replace(size, logarithm=0)
        return replace(smooth, scalings={name: known[name] for name in self.outputs})

    def _sizes(self) -> list[str]:
        return sorted({size for curves in self.curves for size in curves.sizes if size})

    def _learnt(self, size: str) -> str:
        """Return the name of the smooth output of a size."""
        return f"log {size}" if self.logarithms else size

    def _size_of(self, name: str) -> str:
        """Return the name of the size by which an output scales, empty if there is none."""
        largest = self.largest.get(name)
        return self.curves[largest.curves].sizes[max(largest.place, 0)] if largest else ""

    def _size(self, name: str, smooth: Array) -> Array:
        """Return the size by which an output scales, (B,), from smooth outputs (q, B)."""
        if not (size := self._size_of(name)):
            return np.ones(smooth.shape[1])
        learnt = smooth[self._size_rows[size]]
        return np.asarray(np.exp(learnt) if self.logarithms else learnt)

    def _witnessed(self, name: str) -> str:
        """Return the smooth output whose variance describes an output's over the box: the score without small parts.

        Variances of the scores differ by the weights of their parts, which the calibration determines.
        """
        if name not in self.largest:
            return name
        smooth, rows = self.smooth_, self._score_rows[self.largest[name].curves]
        t = np.random.default_rng(0).uniform(-1, 1, (len(self.inputs_), _PROBES))
        parts = []
        for part in np.eye(smooth.parts):
            weights = np.repeat(part[:, None], len(smooth.outputs_), axis=1)
            parts.append(smooth.variance(t, weights)[rows].mean(axis=1))
        share = np.array([part / part.max() for part in parts if part.any()])
        best = int(np.log(np.maximum(share, 1e-30)).sum(axis=0).argmax()) if share.size else 0
        return smooth.outputs_[int(rows[best])]

    # -- answers -------------------------------------------------------------------------------------------------------
    @override
    def mean_variance(self, t: Array, weights: Array | None) -> tuple[Array, Array]:
        """Return means and, with weights, variances that are scaled from those of the witnesses: (p, B) each."""
        smooth, _ = self.smooth_.mean_variance(t, None)
        mean = self.followed(smooth)
        if weights is None:
            return mean, np.zeros_like(mean)
        return mean, self._witness.variance(t, weights) * self._spread(smooth) ** 2

    def _spread(self, smooth: Array) -> Array:
        """Return every output's standard deviation over that of its witness, (p, B), from smooth outputs (q, B)."""
        return np.stack([self._typical(name) * self._size(name, smooth) for name in self.outputs])

    def _typical(self, name: str) -> float:
        """Return an output's standard deviation over that of its witness, for size one."""
        if name not in self.largest:
            return 1.0
        largest = self.largest[name]
        basis = self.bases_[largest.curves]
        typical = 1 / np.sqrt(basis.mean.size)  # of a score's vector, over the scale of its field
        return float(typical * (basis.scales[0] if largest.place < 0 else np.ptp(basis.mean[largest.place])))

    def _searches(self) -> Iterator[tuple[int, Measure, list[str]]]:
        """Yield number of curves, measure and names of outputs for every search of a maximum."""
        searched: dict[tuple[int, Measure], list[str]] = {}
        for name, largest in self.largest.items():
            searched.setdefault((largest.curves, largest.measure), []).append(name)
        for (number, measure), names in sorted(searched.items(), key=lambda search: search[0][0]):
            yield number, measure, names

    def followed(self, smooth: Array) -> Array:
        """Return all outputs, (p, B), from the smooth ones, (q, B)."""
        out = np.empty((len(self.outputs), smooth.shape[1]))
        for k, row in self._plain_rows:
            out[k] = smooth[row]
        for block in blocks(smooth.shape[1], _QUERIES_AT_ONCE):
            for number, measure, names in self._searches():
                scores, land = smooth[self._score_rows[number], block], self._landscapes[number]
                summit = land.summit(scores, measure)
                for name in names:
                    place = self.largest[name].place
                    value = summit.value if place < 0 else land.read(scores, summit, place)
                    out[self.outputs.index(name), block] = value * self._size(name, smooth[:, block])
        return out

    @override
    def slopes(self, t: Array) -> Array:
        smooth, _ = self.smooth_.mean_variance(t, None)
        slopes = self.smooth_.slopes(t)
        out = np.empty((len(t), len(self.outputs), t.shape[1]))
        for k, row in self._plain_rows:
            out[:, k] = slopes[:, row]
        mean = self.followed(smooth)
        for number, measure, names in self._searches():
            rows, land = self._score_rows[number], self._landscapes[number]
            for block in blocks(t.shape[1], _QUERIES_AT_ONCE):
                summit = land.summit(smooth[rows, block], measure)
                for name in names:
                    by_score = land.sensitivity(smooth[rows, block], measure, summit, self.largest[name].place)
                    slope = np.einsum("drb,rb->db", slopes[:, rows, block], by_score)
                    slope *= self._size(name, smooth[:, block])
                    k = self.outputs.index(name)
                    if size := self._size_of(name):
                        row = self._size_rows[size]
                        share = 1.0 if self.logarithms else 1 / smooth[row, block]
                        slope += mean[k, block] * share * slopes[:, row, block]
                    out[:, k, block] = slope
        return out

    @override
    def slope_variances(self, t: Array, weights: Array) -> Array:
        """Return the weighted variances of the derivatives, (d, p, B), scaled from those of the witnesses."""
        smooth, _ = self.smooth_.mean_variance(t, None)
        return self._witness.slope_variances(t, weights) * self._spread(smooth) ** 2

    @override
    def _narrowed(self, outputs: Sequence[str]) -> tuple[Self, Sequence[str]]:
        part = copy(self)
        part.outputs = tuple(outputs)
        part.largest = {name: largest for name, largest in self.largest.items() if name in outputs}
        names = [name for name in outputs if name not in part.largest]
        names += [self._learnt(size) for size in sorted({self._size_of(name) for name in part.largest} - {""})]
        for number in sorted({largest.curves for largest in part.largest.values()}):
            names += [self.smooth_.outputs_[row] for row in self._score_rows[number]]
        return part, names

    # -- calibration ---------------------------------------------------------------------------------------------------
    @override
    def corrected(self, dataset: xr.Dataset, errors: Array, t: Array, groups: Indices) -> Array:
        """Correct the smooth outputs, and the curves if the cases include them; return the errors left, (p, n)."""
        smooth = self.smooth_.uncalibrated().means(t)
        known, left = np.zeros_like(smooth), errors.copy()
        for k, row in self._plain_rows:
            known[row] = errors[k]
        required = {name for curves in self.curves for name in (*curves.fields, *curves.sizes) if name}
        whole = required <= dataset.keys()
        true = smooth + known
        if whole:
            for size, row in self._size_rows.items():
                true[row] = np.log(dataset[size].values) if self.logarithms else dataset[size].values
            for number, curves in enumerate(self.curves):
                true[self._score_rows[number]] = self.bases_[number].scores(curves.shapes(dataset))
            known = true - smooth
        # a process over groups is not corrected: few held-out cases lie near the ends of the groups' ranges
        smooth_left = self.smooth_.corrected(dataset, known, t, groups)
        self._stand_witness()
        for k, row in self._plain_rows:
            left[k] = smooth_left[row]
        if whole:
            others = [k for k, name in enumerate(self.outputs) if name in self.largest]
            truth = errors[others] + self.followed(smooth)[others]
            left[others] = truth - self.followed(true - smooth_left)[others]
        return left

    # -- files ---------------------------------------------------------------------------------------------------------
    def state(self) -> xr.Dataset:
        """Return the curves and their maxima; the process is stored as the member `smooth`."""
        maxima = list(self.largest.values())
        measures = list(dict.fromkeys(maximum.measure for maximum in maxima))
        state: dict[str, tuple[tuple[str, ...], NDArray[np.generic]]] = {
            "largest_output": (("largest",), np.array(list(self.largest))),
            "largest_curves": (("largest",), np.array([maximum.curves for maximum in maxima])),
            "largest_measure": (("largest",), np.array([measures.index(maximum.measure) for maximum in maxima])),
            "largest_place": (("largest",), np.array([maximum.place for maximum in maxima])),
        }
        for k, measure in enumerate(measures):
            dims = f"branch_{k}", f"measured_{k}"
            state[f"measure_linear_{k}"] = dims, measure.linear
            state[f"measure_root_{k}"] = (dims[0], f"row_{k}", dims[1]), measure.root
        for k, (curve, basis) in enumerate(zip(self.curves, self.bases_, strict=True)):
            state[f"curve_field_{k}"] = (f"field_{k}",), np.array(curve.fields)
            state[f"curve_size_{k}"] = (f"field_{k}",), np.array(curve.sizes)
            state[f"curve_across_{k}"] = (f"panel_across_{k}",), np.array(curve.panels.across)
            state[f"curve_down_{k}"] = (f"panel_down_{k}",), np.array(curve.panels.down)
            state[f"curve_dim_{k}"] = (), np.array(curve.dim)
            state |= basis.state(k)
        return xr.Dataset(state, attrs={"error": self.error, "logarithms": int(self.logarithms)})

    @override
    @classmethod
    def restore(cls, stored: xr.Dataset, inputs: tuple[Input, ...], outputs: dict[str, dict[str, str]]) -> Self:
        curves, bases, largest = _stored_curves(stored, list(outputs))
        known = bool(stored.attrs["logarithms"]), float(stored.attrs["error"])
        model = cls(_unfitted, curves, largest, list(outputs), outputs, *known)
        model.bases_ = tuple(bases)
        return model

    def described(self) -> dict[str, Any]:
        """Return curves, measures and maxima as plain values, for an export."""
        measures = list(dict.fromkeys(largest.measure for largest in self.largest.values()))
        return {
            "plain": self._plain_rows,
            "largest": [
                {
                    "output": self.outputs.index(name),
                    "net": largest.curves,
                    "measure": measures.index(largest.measure),
                    "place": largest.place,
                    "size": self._size_rows.get(self._size_of(name), -1),
                }
                for name, largest in self.largest.items()
            ],
            "measures": [{"linear": measure.linear.tolist(), "root": measure.root.tolist()} for measure in measures],
            "logarithms": self.logarithms,
            "nets": [
                {"across": curve.panels.across, "down": curve.panels.down, "scores": rows}
                for curve, rows in zip(self.curves, self._score_rows, strict=True)
            ],
            "spread": [self._typical(name) for name in self.outputs],
        }


def _unfitted(names: Sequence[str]) -> GaussianProcess:
    raise ValueError("a model from a file is not fitted again")


def _stored_curves(stored: xr.Dataset, outputs: Sequence[str]) -> tuple[list[Curves], list[Basis], dict[str, Largest]]:
    """Return curves, their bases and maxima in a file; ValueError where they do not fit each other."""
    curves: list[Curves] = []
    bases: list[Basis] = []
    while f"curve_field_{len(curves)}" in stored:
        k = len(curves)
        across, down = (tuple(stored[f"curve_{way}_{k}"].values.tolist()) for way in ("across", "down"))
        if not all(isinstance(count, int) and 0 < count <= _LONGEST_PANEL for count in (*across, *down)):
            raise ValueError(f"curves {k} have panels of {across} by {down} points")
        fields, sizes = (tuple(map(str, stored[f"curve_{part}_{k}"].values.tolist())) for part in ("field", "size"))
        curves.append(Curves(fields, sizes, Panels(across, down), str(stored[f"curve_dim_{k}"].item())))
        bases.append(Basis.restore(stored, k, curves[k].panels))
        if len(bases[k].mean) != len(fields):
            raise ValueError(f"the basis of curves {k} does not have their fields")
    measures: list[Measure] = []
    while f"measure_linear_{len(measures)}" in stored:
        k = len(measures)
        measures.append(Measure(stored[f"measure_linear_{k}"].values, stored[f"measure_root_{k}"].values))
    columns = [stored[f"largest_{part}"].values.tolist() for part in ("output", "curves", "measure", "place")]
    largest: dict[str, Largest] = {}
    for name, curve, measure, place in zip(*columns, strict=True):
        if name not in outputs or not (0 <= curve < len(curves) and 0 <= measure < len(measures)):
            raise ValueError(f"what follows as {name!r} is not there")
        if measures[measure].fields > len(curves[curve].fields) or not -1 <= place < len(curves[curve].fields):
            raise ValueError(f"{name!r} follows from fields that its curves do not have")
        largest[str(name)] = Largest(curve, measures[measure], place)
    return curves, bases, largest
