"""Groups: training axes that are products of powers of the inputs, and outputs over products of powers.

Where a model of the world scales, its outputs depend on fewer numbers than it has inputs:

    output(x) = scale(x) (f(axes(x)) + coefficient log added(x)),   or   sign scale(x) exp(sign f(axes(x)))

with axes, scale and added products of powers of the inputs x, and f what is to be learnt. Nothing here knows why.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from surrogate.data.arrays import Array
from surrogate.data.inputs import Input

Powers = Mapping[str, float]


@dataclass(frozen=True)
class Group:
    """A training axis: a range with its scale, and the powers of the inputs whose product it is.

    Parameters
    ----------
    axis : Input
        Name, range, scale and units of the axis; the range must hold what the inputs' box gives, see `span`.
    powers : mapping of str to float
        Power of every input that it is made of; an input alone is ``{name: 1}``.
    constant : float
        What the product is multiplied by: that of what is no input.
    """

    axis: Input
    powers: Powers
    constant: float = 1.0


@dataclass(frozen=True)
class Scaling:
    """How one output follows from what is learnt.

    Parameters
    ----------
    powers : mapping of str to float
        The output is proportional to this product of powers of the inputs.
    coefficient : float
        What the logarithm of `Grouping.added` is multiplied by, before the product.
    logarithm : {-1, 0, 1}
        The sign of an output whose logarithm is learnt, 0 where it is learnt itself.
    """

    powers: Powers = field(default_factory=dict)
    coefficient: float = 0.0
    logarithm: int = 0


@dataclass(frozen=True)
class Grouping:
    """Axes, scales and added logarithms of a grouped model.

    Parameters
    ----------
    inputs : sequence of Input
        What the user asks by: the box.
    groups : sequence of Group
        The training axes.
    scalings : mapping of str to Scaling
        How every output follows.
    added : mapping of str to float
        Powers of the inputs in the product whose logarithm is added.
    reference : mapping of str to float
        Inputs at which every product of `scalings` and `added` is one, by default the middle of their ranges.

    Raises
    ------
    ValueError
        One line: an unknown input, one in no group and no scale, a broken power or a logarithm of an input that is not
        positive, an axis whose range does not hold the box.
    """

    inputs: tuple[Input, ...]
    groups: tuple[Group, ...]
    scalings: Mapping[str, Scaling]
    added: Powers = field(default_factory=dict)
    reference: Powers = field(default_factory=dict)

    def __post_init__(self) -> None:
        names = {one.name: one for one in self.inputs}
        used = {name for group in self.groups for name, power in group.powers.items() if power}
        for name in (*used, *self.added, *(name for one in self.scalings.values() for name in one.powers)):
            if name not in names:
                raise ValueError(f"groups: {name!r} is no input; the inputs are {', '.join(names)}")
        scaled = {*self.added, *(name for one in self.scalings.values() for name in one.powers)}
        for name in names:
            if name not in used | scaled:
                raise ValueError(f"groups: input {name!r} is in no group and no scale")
        for group in self.groups:
            self._check_positive(group.axis.name, {k: p for k, p in group.powers.items() if p < 0 or p != int(p)})
            low, high = sorted(group.constant * end for end in span(self.inputs, group.powers))
            room = 1e-9 * (group.axis.high - group.axis.low)
            if low < group.axis.low - room or high > group.axis.high + room:
                raise ValueError(f"groups: {group.axis.name!r} is {low:g} to {high:g} in the box, beyond its range "
                                 f"{group.axis.range_text()}")  # fmt: skip
        for name, one in self.scalings.items():
            self._check_positive(f"the scale of {name}", one.powers)
        self._check_positive("the added logarithm", self.added)

    def _check_positive(self, what: str, powers: Powers) -> None:
        for one in self.inputs:
            if powers.get(one.name, 0.0) and one.low <= 0:
                raise ValueError(f"groups: {what}: {one.name!r} from {one.low:g} on has no such power; it must be > 0")

    @property
    def axes(self) -> tuple[Input, ...]:
        """The training axes."""
        return tuple(group.axis for group in self.groups)

    def coordinates(self, X: Array) -> Array:
        """Return the axes' values at points (n, d): (n, axes), within their ranges where the points are in the box."""
        U = np.stack([group.constant * _product(X, self._row(group.powers)) for group in self.groups], axis=1)
        low, high = np.array([(one.low, one.high) for one in self.axes]).T
        near = 1e-9 * (high - low)
        inside = np.clip(U, low, high)
        return np.asarray(np.where(np.abs(U - inside) <= near, inside, U))  # the ends, met but for rounding

    def jacobian(self, X: Array) -> Array:
        """Return the derivatives of the axes' values by the inputs at points (n, d): (axes, d, n)."""
        return np.stack([group.constant * _slopes(X, self._row(group.powers)) for group in self.groups])

    def scales(self, X: Array, outputs: Sequence[str]) -> Array:
        """Return what the learnt outputs are multiplied by at points (n, d): (p, n)."""
        rows = np.stack([self._row(self.scalings[name].powers) for name in outputs])
        distinct, which = np.unique(rows, axis=0, return_inverse=True)
        return np.asarray(np.exp(self._logarithm(X, distinct))[which.reshape(-1)])

    def steepness(self, X: Array, outputs: Sequence[str]) -> Array:
        """Return the derivatives of the scales' logarithms by the inputs at points (n, d): (d, p, n)."""
        return np.stack([self._steep(X, self.scalings[name].powers) for name in outputs], axis=1)

    def additions(self, X: Array, outputs: Sequence[str]) -> Array:
        """Return what is added to the learnt outputs at points (n, d): (p, n)."""
        coefficients = np.array([self.scalings[name].coefficient for name in outputs])
        return np.asarray(coefficients[:, None] * self._logarithm(X, self._row(self.added)[None]))

    def added_slopes(self, X: Array, outputs: Sequence[str]) -> Array:
        """Return the derivatives of `additions` by the inputs at points (n, d): (d, p, n)."""
        coefficients = np.array([self.scalings[name].coefficient for name in outputs])
        return np.asarray(coefficients[:, None] * self._steep(X, self.added)[:, None])

    def logarithms(self, outputs: Sequence[str]) -> NDArray[np.intp]:
        """Return the sign of every output that is learnt as a logarithm, 0 for others: (p,)."""
        return np.array([self.scalings[name].logarithm for name in outputs])

    def learnt(self, values: Array, X: Array, outputs: Sequence[str]) -> Array:
        """Return what is to be learnt of outputs (p, n) at points (n, d): (p, n).

        Raises ValueError, naming the output, for the logarithm of what is not of one sign.
        """
        found = values / self.scales(X, outputs)
        for k, (name, sign) in enumerate(zip(outputs, self.logarithms(outputs), strict=True)):
            if not sign:
                continue
            if (found[k] * sign <= 0).any():
                low, high = values[k].min(), values[k].max()
                raise ValueError(f"output {name!r} is from {low:g} to {high:g}: no logarithm of what changes sign")
            found[k] = sign * np.log(found[k] * sign)  # grows with the output
        return np.asarray(found - self.additions(X, outputs))

    def told(self, learnt: Array, X: Array, outputs: Sequence[str]) -> Array:
        """Return the outputs of what is learnt, (p, n), at points (n, d): the inverse of `learnt`."""
        found, signs = learnt + self.additions(X, outputs), self.logarithms(outputs)
        for k in np.flatnonzero(signs):
            found[k] = signs[k] * np.exp(signs[k] * found[k])
        return np.asarray(found * self.scales(X, outputs))

    def reduced(self, dataset: xr.Dataset, outputs: Sequence[str]) -> xr.Dataset:
        """Return a data set of the axes: what is learnt of every output, over the dimensions that it has.

        Parameters
        ----------
        dataset : Dataset
            Outputs, and every input as a variable or coordinate, over any dimensions: the axes, or cases.
        outputs : sequence of str
            Which to take.
        """
        columns = xr.broadcast(*(dataset[one.name].reset_coords(drop=True) for one in self.inputs))
        found: dict[Any, Any] = {}
        for name in outputs:
            array, *given = xr.broadcast(dataset[name].reset_coords(drop=True), *columns)
            X = np.stack([one.transpose(*array.dims).values.ravel() for one in given], axis=1)
            learnt = self.learnt(np.asarray(array.values, dtype=np.float64).reshape(1, -1), X, [name])
            found[name] = array.dims, learnt.reshape(array.shape), dataset[name].attrs
        return xr.Dataset(found)

    def only(self, outputs: Sequence[str]) -> Self:
        """Return that of some outputs."""
        return replace(self, scalings={name: self.scalings[name] for name in outputs})

    def state(self, outputs: Sequence[str]) -> xr.Dataset:
        """Return the numbers for a file."""
        columns = [(one.name, one.low, one.high, one.scale, one.units, one.long_name) for one in self.axes]
        names = ("axis_name", "axis_low", "axis_high", "axis_scale", "axis_units", "axis_long_name")
        arrays = {name: ("axis", list(column)) for name, column in zip(names, zip(*columns, strict=True), strict=True)}
        scalings = [self.scalings[name] for name in outputs]
        return xr.Dataset(
            {
                **arrays,
                "axis_power": (("axis", "input"), np.stack([self._row(group.powers) for group in self.groups])),
                "axis_constant": ("axis", [group.constant for group in self.groups]),
                "scale_power": (("output", "input"), np.stack([self._row(one.powers) for one in scalings])),
                "added_coefficient": ("output", [one.coefficient for one in scalings]),
                "added_power": ("input", self._row(self.added)),
                "logarithm": ("output", np.array([one.logarithm for one in scalings])),
                "reference": ("input", self._references),
            }
        )

    @classmethod
    def restore(cls, stored: xr.Dataset, inputs: tuple[Input, ...], outputs: Sequence[str]) -> Self:
        """Return the grouping in a file; ValueError names what is inconsistent."""
        names = [one.name for one in inputs]
        columns = [
            stored[f"axis_{key}"].values.tolist() for key in ("name", "low", "high", "scale", "units", "long_name")
        ]

        def powers(row: Array) -> dict[str, float]:
            return {name: float(power) for name, power in zip(names, row, strict=True) if power}

        rows = stored["axis_power"].transpose("axis", "input").values
        groups = tuple(
            Group(Input(*one), powers(row), constant)
            for one, row, constant in zip(
                zip(*columns, strict=True), rows, stored["axis_constant"].values.tolist(), strict=True
            )
        )
        signs = stored["logarithm"].values.tolist()
        if not set(signs) <= {-1, 0, 1}:
            raise ValueError("the sign of a logarithm is -1, 0 or 1")
        scalings = {
            name: Scaling(powers(row), float(coefficient), int(sign))
            for name, row, coefficient, sign in zip(
                outputs,
                stored["scale_power"].transpose("output", "input").values,
                stored["added_coefficient"].values,
                signs,
                strict=True,
            )
        }
        reference = dict(zip(names, stored["reference"].values.tolist(), strict=True))
        return cls(inputs, groups, scalings, powers(stored["added_power"].values), reference)

    @property
    def _references(self) -> Array:
        return np.array([self.reference.get(one.name, middle(one)) for one in self.inputs])

    def _row(self, powers: Powers) -> Array:
        return np.array([powers.get(one.name, 0.0) for one in self.inputs])

    def _logarithm(self, X: Array, rows: Array) -> Array:
        """Logarithms of products of powers relative to the reference, (rows, n); only positive inputs occur in them."""
        used = rows.any(axis=0)
        return np.asarray(rows[:, used] @ np.log(X[:, used] / self._references[used]).T)

    def _steep(self, X: Array, powers: Powers) -> Array:
        """Derivatives of the logarithm of a product by the inputs, (d, n)."""
        row = self._row(powers)
        steep = np.zeros((len(row), len(X)))
        steep[row != 0] = row[row != 0, None] / X.T[row != 0]
        return steep


def middle(one: Input) -> float:
    """Return the middle of a range on its scale."""
    return float(one.from_unit(0.0))


def span(inputs: Sequence[Input], powers: Powers) -> tuple[float, float]:
    """Return the least and the largest value of a product of powers over a box.

    Examples
    --------
    >>> span([Input("charge", -2.0, 1.0), Input("load", 4.0, 8.0)], {"charge": 1, "load": -1})
    (-0.5, 0.25)
    """
    low = high = 1.0
    for one in inputs:
        power = powers.get(one.name, 0.0)
        if not power:
            continue
        ends = [one.low**power, one.high**power] + ([0.0] if one.low < 0 < one.high else [])
        products = [a * b for a in (low, high) for b in (min(ends), max(ends))]
        low, high = min(products), max(products)
    return low, high


def _product(X: Array, row: Array) -> Array:
    factors: list[Array] = [_power(X[:, k], row[k]) for k in np.flatnonzero(row)]
    return np.asarray(np.prod(factors, axis=0))


def _slopes(X: Array, row: Array) -> Array:
    """Derivatives of a product by every input, (d, n)."""
    slopes = np.zeros((len(row), len(X)))
    for k in np.flatnonzero(row):
        rest = row.copy()
        rest[k] = 0.0
        slopes[k] = row[k] * _power(X[:, k], row[k] - 1) * (_product(X, rest) if rest.any() else 1.0)
    return slopes


def _power(x: Array, power: float) -> Array:
    """Powers; whole small ones by products and quotients, which are exact at the ends of a range."""
    by_power: dict[float, Callable[[Array], Array]] = {
        0.0: np.ones_like, 1.0: np.asarray, 2.0: np.square, -1.0: np.reciprocal
    }  # fmt: skip
    return by_power[power](x) if power in by_power else np.asarray(x**power)
