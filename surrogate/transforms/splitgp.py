"""Kinks that are named: the box is split there, and every part has a process, whose outputs are smooth."""

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import replace
from itertools import pairwise
from typing import Any, ClassVar, Self

import numpy as np
import xarray as xr
from typing_extensions import override

from approximation.arrays import Array, Flags, Indices
from surrogate.data.inputs import Input
from surrogate.face.model import GaussianProcess
from surrogate.face.plain import plain_inputs, plain_outputs
from surrogate.gp.gridgp import GridGP
from surrogate.transforms.transformed import Transformed


class SplitGP(Transformed):
    """A Gaussian process on both sides of a kink: where an output bends or jumps at a known value of an input.

    Each side is a `GridGP` on Chebyshev-Gauss levels of its own range, or split itself where there are more kinks.
    Held-out cases correct the means of every side, and calibrate the intervals of the whole box. At a kink the side
    below answers.

    Parameters
    ----------
    inputs : sequence of Input
        Inputs with the whole box.
    kinks : mapping of str to sequence of float
        Where outputs have kinks, by input, in its units; inside of its range.
    outputs : sequence of str, optional
        Outputs to model, by default every variable.
    compression : float
        As of `GridGP`.

    Attributes
    ----------
    below_, above_ : GaussianProcess
        The models of both sides of the first kink.

    Raises
    ------
    ValueError
        A kink along no input, outside of its range, or given twice; no kink at all.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> from surrogate import Input, SplitGP
    >>> x, y = Input("x", 0, 1), Input("y", 1, 2)
    >>> model = SplitGP([x, y], {"x": [0.37]})
    >>> grid = xr.Dataset(coords=model.levels({"x": 4, "y": 5}))
    >>> grid.sizes["x"]
    8
    >>> model = model.fit(grid.assign(f=abs(grid.x - 0.37) * grid.y**2))
    >>> bool(abs(model.predict({"x": 0.4, "y": 1.5})["f"] - 0.03 * 1.5**2) < 1e-12)
    True
    """

    engine: ClassVar[str] = "split"
    MEMBERS = CALIBRATED = ("below", "above")
    below_: GaussianProcess
    above_: GaussianProcess
    _number: int
    _at: float

    def __init__(
        self,
        inputs: Sequence[Input],
        kinks: Mapping[str, Sequence[float]],
        outputs: Sequence[str] | None = None,
        compression: float = 1e-12,
    ) -> None:
        self.inputs, self.outputs, self.compression = tuple(inputs), outputs, compression
        self.kinks = {name: tuple(sorted(map(float, own))) for name, own in kinks.items() if len(own)}
        boxes = {own.name: own for own in self.inputs}
        for name, own in self.kinks.items():
            if name not in boxes:
                raise ValueError(f"kinks of {name!r}, which is no input; the inputs are {', '.join(boxes)}")
            for low, high in pairwise((boxes[name].low, *own, boxes[name].high)):
                if not low < high:
                    told = ", ".join(f"{value:g}" for value in own)
                    raise ValueError(
                        f"kinks of {name!r}: {told} must differ and lie inside of {boxes[name].range_text()}"
                    )
        if not self.kinks:
            raise ValueError("a split needs at least one kink")

    def levels(self, counts: Mapping[str, int]) -> dict[str, Array]:
        """Return the levels of every input, ascending: so many Chebyshev-Gauss levels between its kinks.

        Parameters
        ----------
        counts : mapping of str to int, levels between two kinks of every input
        """
        return {
            own.name: np.concatenate([part.levels(counts[own.name]) for part in _between(own, self.kinks)])
            for own in self.inputs
        }

    def fit(self, X: xr.Dataset) -> Self:
        """Fit to a complete factorial on the levels of `levels`; ValueError as of `GridGP.fit`, for each part."""
        name, at = self._first()
        for side, inputs in zip(self.MEMBERS, self._sides(), strict=True):
            own = X.isel({name: np.flatnonzero((X[name].values <= at) == (side == "below"))})
            setattr(self, f"{side}_", self._process(inputs).fit(own))
        self.calibration_ = None
        self._lay_out()
        return self

    def _first(self) -> tuple[str, float]:
        """The kink at which the box is split: the input and its value."""
        return next((name, own[0]) for name, own in self.kinks.items())

    def _sides(self) -> tuple[tuple[Input, ...], tuple[Input, ...]]:
        """The inputs on both sides of the first kink."""
        name, at = self._first()
        below = tuple(replace(own, high=at) if own.name == name else own for own in self.inputs)
        return below, tuple(replace(own, low=at) if own.name == name else own for own in self.inputs)

    def _process(self, inputs: Sequence[Input]) -> GaussianProcess:
        """The process of a side, not fitted: split where it has kinks itself."""
        boxes = {own.name: own for own in inputs}
        rest = {name: [at for at in own if boxes[name].low < at < boxes[name].high] for name, own in self.kinks.items()}
        if any(rest.values()):
            return SplitGP(inputs, rest, self.outputs, self.compression)
        return GridGP("chebyshev", inputs, self.outputs, compression=self.compression)

    def _lay_out(self) -> None:
        below, above = self.below_, self.above_
        if (below.inputs_, above.inputs_) != self._sides() or below.outputs_ != above.outputs_:
            raise ValueError("the sides of a kink do not fit")
        name, at = self._first()
        self._number = [own.name for own in self.inputs].index(name)
        self._at = float(self.inputs[self._number].to_unit(at))
        self.inputs_, self.outputs_, self.attrs_ = self.inputs, below.outputs_, below.attrs_
        self.cases_ = below.cases_ + above.cases_

    # -- answers -------------------------------------------------------------------------------------------------------
    def _split(self, t: Array) -> list[tuple[GaussianProcess, Flags, Array, float]]:
        """Both sides with the points that they answer, in their own coordinates, and half the width of their range."""
        low, sides = t[self._number] <= self._at, []
        for model, own, (begin, end) in (
            (self.below_, low, (-1.0, self._at)),
            (self.above_, ~low, (self._at, 1.0)),
        ):
            half, inside = (end - begin) / 2, t[:, own].copy()
            inside[self._number] = (inside[self._number] - (begin + end) / 2) / half
            sides.append((model, own, inside, half))
        return [side for side in sides if side[1].any()]

    @override
    def mean_variance(self, t: Array, weights: Array | None) -> tuple[Array, Array | None]:
        mean = np.empty((len(self.outputs_), t.shape[1]))
        variance = np.zeros_like(mean)
        for model, own, inside, _ in self._split(t):
            mean[:, own], spread = model.mean_variance(inside, weights)
            if spread is not None:
                variance[:, own] = spread
        return mean, None if weights is None else variance

    @override
    def slopes(self, t: Array) -> Array:
        slopes = np.empty((len(t), len(self.outputs_), t.shape[1]))
        for model, own, inside, half in self._split(t):
            slopes[..., own] = model.slopes(inside)
            slopes[self._number][:, own] /= half
        return slopes

    @override
    def slope_variances(self, t: Array, weights: Array) -> Array:
        variances = np.empty((len(t), len(self.outputs_), t.shape[1]))
        for model, own, inside, half in self._split(t):
            variances[..., own] = model.slope_variances(inside, weights)
            variances[self._number][:, own] /= half**2
        return variances

    @override
    def corrected(self, dataset: xr.Dataset, errors: Array, t: Array, groups: Indices) -> Array:
        left = errors.copy()
        for model, own, inside, _ in self._split(t):
            left[:, own] = model.corrected(dataset, errors[:, own], inside, groups[own])
        return left

    def _narrowed(self, outputs: Sequence[str]) -> Self:
        part = copy(self)
        part.outputs = tuple(outputs)
        return part

    def _behind(self, outputs: Sequence[str]) -> Mapping[str, Sequence[str]]:
        return dict.fromkeys(self.MEMBERS, outputs)

    def state(self) -> xr.Dataset:
        """Return all kinks; the sides of the first stand beside them, as `below` and `above`."""
        pairs = [(name, at) for name, own in self.kinks.items() for at in own]
        return xr.Dataset(
            {
                "kink": ("kink_number", [at for _, at in pairs]),
                "kink_input": ("kink_number", [name for name, _ in pairs]),
            }
        )

    def plain(self) -> dict[str, Any] | None:
        """Return both sides of the first kink and where it lies, with the inputs and the calibration of the whole."""
        split = {"input": self._number, "at": self._at}
        sides = [side.plain() for side in (self.below_, self.above_)]
        return {"inputs": plain_inputs(self.inputs_), "split": split, "sides": sides, **plain_outputs(self)}

    @override
    @classmethod
    def restore(cls, stored: xr.Dataset, inputs: tuple[Input, ...], outputs: dict[str, dict[str, str]]) -> Self:
        kinks: dict[str, list[float]] = {}
        for name, at in zip(stored["kink_input"].values.tolist(), stored["kink"].values.tolist(), strict=True):
            kinks.setdefault(str(name), []).append(float(at))
        return cls(inputs, kinks, tuple(outputs))


def _between(factor: Input, kinks: Mapping[str, Sequence[float]]) -> list[Input]:
    """The ranges of an input between its kinks."""
    ends = (factor.low, *kinks.get(factor.name, ()), factor.high)
    return [replace(factor, low=low, high=high) for low, high in pairwise(ends)]
