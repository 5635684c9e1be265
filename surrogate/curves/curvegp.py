"""Largest values of curves: the curves are learnt, which are smooth, and the maximum is taken after the query.

A maximum over a curve is kinked where its place jumps from one hill to another, and no number of levels learns a kink
well; the fields over the curve have none. They are learnt in the low-rank basis of the cases' singular vectors, every
coefficient as an output of a Gaussian process of any kind, and the maximum of what is predicted is that of piecewise
polynomials (module `panels`). Its derivatives follow from those of the coefficients: the place is stationary.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import replace
from typing import ClassVar, Self

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from approximation.measure import Measure
from storage.described import described
from surrogate.curves.curves import Basis, Curves, Largest
from surrogate.curves.following import Links, followed, following
from surrogate.curves.landscape import Landscape
from surrogate.data.arrays import Array
from surrogate.data.inputs import Input
from surrogate.data.meanings import MEANINGS
from surrogate.gp.engines import engine
from surrogate.gp.grouping import Grouping, Scaling
from surrogate.gp.model import GaussianProcess

# Curves whose largest values are looked for at a time: their fields stay in cache.
_BLOCK = 128
_PROBES = 64


class CurveGP(GaussianProcess):
    """Smooth outputs, and largest measures of curves, over the inputs of one Gaussian process.

    Parameters
    ----------
    smooth : callable
        Gives the process, not fitted, that learns what is smooth, by its outputs: plain ones, sizes, scores of curves.
    curves : sequence of Curves
        What is learnt of curves.
    largest : mapping of str to Largest
        Outputs that follow from them.
    outputs : sequence of str
        All outputs in order; those not in `largest` are plain variables of the data set.
    attrs : mapping, optional
        `units` and `long_name` of the outputs in `largest`.
    logarithms : bool
        Learn the logarithm of every size; else the size itself, by a process that knows better.
    error : float
        Root-mean-square error, relative to a field, that the low-rank basis and the compression of its scores may make.

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
    >>> from surrogate.data.inputs import gauss_points
    >>> a, points = Input("a", -1, 1), gauss_points(32)
    >>> grid = xr.Dataset(coords={"a": a.levels(12), "point": np.arange(32)})
    >>> x = xr.DataArray(points, dims="point")
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
        """Fit to a data set that holds the plain outputs, the sizes and the fields, as the process takes its own.

        Raises
        ------
        ValueError
            As that process; sizes that are not positive, fields that do not fit their panels.
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
        kept = [str(name) for name in X.variables if name in X.dims or name in X.coords]
        data = xr.Dataset(parts, {name: X[name] for name in kept if not set(X[name].dims) & self._dims()})
        smooth = self.smooth(list(parts)).fit(data)
        self.bases_, self.calibration_ = tuple(bases), None
        allowed = {f"log {size}": self.error for size in self._sizes()}  # of a size itself, none
        for number, basis in enumerate(bases):
            allowed |= {f"score {number} {k}": basis.error(self.error) for k in range(len(basis.vectors))}
        self._take(smooth.thinned(allowed), dict(self.attrs or {}))
        return self

    def _take(self, smooth: GaussianProcess, attrs: Mapping[str, dict[str, str]]) -> None:
        """Stand on a fitted process."""
        self.smooth_, self.inputs_, self.outputs_ = smooth, smooth.inputs_, self.outputs
        self.attrs_ = {
            name: attrs.get(name, {}) if name in self.largest else smooth.attrs_[name] for name in self.outputs
        }
        rows = {name: k for k, name in enumerate(smooth.outputs_)}
        self._plain = [(k, rows[name]) for k, name in enumerate(self.outputs) if name not in self.largest]
        # of a model of some outputs, only what these need is there
        self._size_rows = {size: rows[name] for size in self._sizes() if (name := self._learnt(size)) in rows}
        self._score_rows = [
            np.array([rows[name] for k in range(len(basis.vectors)) if (name := f"score {number} {k}") in rows])
            for number, basis in enumerate(self.bases_)
        ]
        self.grouping = self._grouped(smooth.grouping)
        self._landscapes = [
            Landscape(basis, curves.panels) for basis, curves in zip(self.bases_, self.curves, strict=True)
        ]
        self._witness = smooth.only([self._witnessed(name) for name in self.outputs])

    def _grouped(self, smooth: Grouping | None) -> Grouping | None:
        """The groups of the smooth process; what follows from curves scales as the size of these does."""
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
        return f"log {size}" if self.logarithms else size

    def _dims(self) -> set[str]:
        return {curves.dim for curves in self.curves}

    def _witnessed(self, name: str) -> str:
        """The smooth output whose variance tells how that of an output is spread over the box.

        Variances of the scores differ by the weights of their parts, which the calibration finds; that score is taken
        of which no part is small.
        """
        if name not in self.largest:
            return name
        smooth, rows = self.smooth_, self._score_rows[self.largest[name].curves]
        t = np.random.default_rng(0).uniform(-1, 1, (len(self.inputs_), _PROBES))
        parts = []
        for part in np.eye(smooth.parts):
            weights = np.repeat(part[:, None], len(smooth.outputs_), axis=1)
            parts.append(smooth._variance(t, weights)[rows].mean(axis=1))
        share = np.array([part / part.max() for part in parts if part.any()])
        best = int(np.log(np.maximum(share, 1e-30)).sum(axis=0).argmax()) if share.size else 0
        return smooth.outputs_[int(rows[best])]

    # -- answers -------------------------------------------------------------------------------------------------------
    @property
    def parts(self) -> int:
        """Number of parts of the variance: those of the process."""
        return self.smooth_.parts

    def _mean_variance(self, t: Array, weights: Array | None) -> tuple[Array, Array | None]:
        smooth, _ = self.smooth_._mean_variance(t, None)
        mean = self._followed(smooth)
        if weights is None:
            return mean, None
        return mean, self._witness._variance(t, weights) * self._spread(smooth) ** 2

    def _followed(self, smooth: Array) -> Array:
        """All outputs, (p, B), of the smooth ones, (q, B)."""
        out = np.empty((len(self.outputs), smooth.shape[1]))
        for k, row in self._plain:
            out[k] = smooth[row]
        for start in range(0, smooth.shape[1], _BLOCK):
            some = slice(start, start + _BLOCK)
            for number in range(len(self.curves)):
                for measure, names in self._searches(number):
                    scores, land = smooth[self._score_rows[number], some], self._landscapes[number]
                    summit = land.summit(scores, measure)
                    for name in names:
                        place = self.largest[name].place
                        value = summit.value if place < 0 else land.read(scores, summit, place)
                        out[self.outputs.index(name), some] = value * self._size(name, smooth[:, some])
        return out

    def _searches(self, number: int) -> Iterator[tuple[Measure, list[str]]]:
        """Measures of curves, and the outputs that each of them gives."""
        for measure in dict.fromkeys(one.measure for one in self.largest.values() if one.curves == number):
            yield (
                measure,
                [name for name, one in self.largest.items() if one.measure is measure and one.curves == number],
            )

    def links(self) -> Links:
        """Return which smooth outputs stand behind the outputs, for evaluation elsewhere."""
        rows = {name: k for k, name in enumerate(self.smooth_.outputs_)}
        sizes = {name: self._size_of(name) for name in self.largest}
        return Links(
            self._plain,
            [own.tolist() for own in self._score_rows],
            {name: self._size_rows[size] if size else -1 for name, size in sizes.items()},
            [rows[name] for name in self._witness.outputs_],
            [self._typical(name) for name in self.outputs],
        )

    def _size_of(self, name: str) -> str:
        one = self.largest[name]
        return self.curves[one.curves].sizes[max(one.place, 0)]

    def _size(self, name: str, smooth: Array) -> Array:
        """What an output scales by; (B,)."""
        size = self._size_of(name)
        if not size:
            return np.ones(smooth.shape[1])
        learnt = smooth[self._size_rows[size]]
        return np.asarray(np.exp(learnt) if self.logarithms else learnt)

    def _spread(self, smooth: Array) -> Array:
        """How large an output's standard deviation is over that of its witness; (p, B)."""
        out = np.ones((len(self.outputs), smooth.shape[1]))
        for k, name in enumerate(self.outputs):
            if name in self.largest:
                out[k] = self._typical(name) * self._size(name, smooth)
        return out

    def _typical(self, name: str) -> float:
        """The same where the output's size is one."""
        if name not in self.largest:
            return 1.0
        one = self.largest[name]
        basis = self.bases_[one.curves]
        typical = 1 / np.sqrt(basis.mean.size)  # of a score's vector, over the scale of its field
        return float(typical * (basis.scales[0] if one.place < 0 else np.ptp(basis.mean[one.place])))

    def _slopes(self, t: Array) -> Array:
        smooth, _ = self.smooth_._mean_variance(t, None)
        slopes = self.smooth_._slopes(t)
        out = np.empty((len(t), len(self.outputs), t.shape[1]))
        for k, row in self._plain:
            out[:, k] = slopes[:, row]
        mean = self._followed(smooth)
        for number, land in enumerate(self._landscapes):
            rows = self._score_rows[number]
            for start in range(0, t.shape[1], _BLOCK):
                some = slice(start, start + _BLOCK)
                for measure, names in self._searches(number):
                    summit = land.summit(smooth[rows, some], measure)
                    for name in names:
                        by_score = land.sensitivity(smooth[rows, some], measure, summit, self.largest[name].place)
                        slope = np.einsum("drb,rb->db", slopes[:, rows, some], by_score)
                        slope *= self._size(name, smooth[:, some])
                        k = self.outputs.index(name)
                        if size := self._size_of(name):
                            row = self._size_rows[size]
                            share = 1.0 if self.logarithms else 1 / smooth[row, some]
                            slope += mean[k, some] * share * slopes[:, row, some]
                        out[:, k, some] = slope
        return out

    def _slope_variances(self, t: Array, weights: Array) -> Array:
        smooth, _ = self.smooth_._mean_variance(t, None)
        return self._witness._slope_variances(t, weights) * self._spread(smooth) ** 2

    def only(self, outputs: Sequence[str]) -> Self:
        """Return the model of some outputs; means agree within `error`, and cost less to ask for."""
        part = copy(self)
        part.outputs = tuple(outputs)
        part.largest = {name: one for name, one in self.largest.items() if name in outputs}
        used = {one.curves for one in part.largest.values()}
        names = [name for name in outputs if name not in self.largest]
        sizes = {self._size_of(name) for name in part.largest} - {""}
        names += [self._learnt(size) for size in sorted(sizes)]
        names += [self.smooth_.outputs_[row] for number in sorted(used) for row in self._score_rows[number]]
        part._take(self.smooth_.only(names), self.attrs_)
        columns = [self.outputs.index(name) for name in outputs]
        part.calibration_ = None if self.calibration_ is None else self.calibration_.only(columns)
        return part

    # -- calibration ---------------------------------------------------------------------------------------------------
    def uncalibrated(self) -> Self:
        """Return the model without what `calibrate` has learnt."""
        plain = super().uncalibrated()
        plain.smooth_ = self.smooth_.uncalibrated()
        return plain

    def _corrected(self, dataset: xr.Dataset, errors: Array, t: Array, groups: NDArray[np.intp]) -> Array:
        """Correct what is smooth, the curves too where the cases have them; a process over groups stays as it is.

        Held-out cases hardly reach the ends of the groups' ranges, where what they tell of its error would be a guess.
        """
        plain = self.smooth_.uncalibrated()
        smooth = np.concatenate([plain._mean_variance(t[:, some], None)[0] for some in _blocks(t)], axis=1)
        known, left = np.zeros_like(smooth), errors.copy()
        for k, row in self._plain:
            known[row] = errors[k]
        asked = {name for curves in self.curves for name in (*curves.fields, *curves.sizes) if name}
        whole = asked <= dataset.keys()
        true = smooth + known
        if whole:
            for size, row in self._size_rows.items():
                true[row] = np.log(dataset[size].values) if self.logarithms else dataset[size].values
            for number, curves in enumerate(self.curves):
                true[self._score_rows[number]] = self.bases_[number].scores(curves.shapes(dataset))
            known = true - smooth
        found = self.smooth_._corrected(dataset, known, t, groups)
        for k, row in self._plain:
            left[k] = found[row]
        if whole:
            others = [k for k, name in enumerate(self.outputs) if name in self.largest]
            truth = errors[others] + self._followed(smooth)[others]
            left[others] = truth - self._followed(true - found)[others]
        return left

    # -- files ---------------------------------------------------------------------------------------------------------
    def state(self) -> xr.Dataset:
        """Return what a file must hold beside inputs, outputs and probes: the smooth process's under `smooth_`."""
        smooth = described(self.smooth_.stored(), "", "", MEANINGS)
        under = smooth.rename({name: f"smooth_{name}" for name in (*smooth.variables, *smooth.sizes)})
        under.attrs = {f"smooth_{name}": value for name, value in smooth.attrs.items()}
        inner = {
            "smooth_output": ("smooth_output", list(self.smooth_.outputs_)),
            "smooth_output_units": ("smooth_output", [self._attr(name, "units") for name in self.smooth_.outputs_]),
            "smooth_output_long_name": (
                "smooth_output",
                [self._attr(name, "long_name") for name in self.smooth_.outputs_],
            ),
        }
        return (
            under.assign(inner)
            .assign(following(self.curves, self.bases_, self.largest))
            .assign_attrs(smooth_engine=self.smooth_.engine, error=self.error, logarithms=int(self.logarithms))
        )

    def _attr(self, name: str, key: str) -> str:
        return self.smooth_.attrs_[name].get(key, "")

    @classmethod
    def restore(cls, stored: xr.Dataset, inputs: tuple[Input, ...], outputs: dict[str, dict[str, str]]) -> Self:
        """Return the model of a stored state; ValueError names what is inconsistent."""
        attrs = stored.attrs
        if attrs["smooth_engine"] == cls.engine:
            raise ValueError("largest values of largest values are none")
        curves, bases, largest = followed(stored, list(outputs))
        model = cls(
            _unfitted, curves, largest, list(outputs), outputs, bool(attrs["logarithms"]), float(attrs["error"])
        )
        own = stored[[name for name in stored.variables if str(name).startswith("smooth_")]]
        plain = own.rename({name: str(name).removeprefix("smooth_") for name in (*own.variables, *own.sizes)})
        plain.attrs = {key.removeprefix("smooth_"): value for key, value in attrs.items() if key.startswith("smooth_")}
        names = plain["output"].values.tolist()
        told = {
            name: {key: str(text) for key in ("units", "long_name") if (text := plain[f"output_{key}"].values[k])}
            for k, name in enumerate(names)
        }
        model.bases_, model.calibration_ = tuple(bases), None
        smooth = engine(attrs["smooth_engine"]).restored(plain, inputs, told)
        model._take(smooth, outputs)
        return model


def _unfitted(names: Sequence[str]) -> GaussianProcess:
    raise ValueError("a model from a file is not fitted again")


def _blocks(t: Array) -> Iterator[slice]:
    return (slice(start, start + 2048) for start in range(0, t.shape[1], 2048))
