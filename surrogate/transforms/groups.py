"""Groups: training axes and scales that are products of powers of the inputs.

    output(x) = scale(x) (f(x) + coefficient log added(x)),   or   sign scale(x) exp(sign f(x))

with learnt f, and products of powers of the inputs `scale` and `added`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
import xarray as xr

from approximation.arrays import Array
from surrogate.data.inputs import Input

Powers = Mapping[str, float]
NEAR = 1e-9  # distance beyond the end of an axis's range that counts as rounding, as a share of the range


@dataclass(frozen=True)
class Group:
    """A training axis: a constant times a product of powers of the inputs.

    Parameters
    ----------
    axis : Input
        Name, range, scale and units of the axis; the range must include the values in the inputs' box, see `span`.
    powers : mapping of str to float
        Power of every input in the product; an input alone is ``{name: 1}``.
    constant : float
        Factor of the product.
    """

    axis: Input
    powers: Powers
    constant: float = 1.0


@dataclass(frozen=True)
class Scaling:
    """Map from the learnt function to one output.

    Parameters
    ----------
    powers : mapping of str to float
        The output is proportional to this product of powers of the inputs.
    coefficient : float
        Factor of the logarithm of `Grouping.added`.
    logarithm : {-1, 0, 1}
        The sign of an output whose logarithm is learnt, otherwise 0.
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
        Inputs of queries, with the box.
    groups : sequence of Group
        The training axes.
    scalings : mapping of str to Scaling
        Map from the learnt function to every output.
    added : mapping of str to float
        Powers of the inputs in the product whose logarithm is added.
    reference : mapping of str to float
        Inputs at which every product of `scalings` and `added` is one, by default the middle of their ranges.

    Raises
    ------
    ValueError
        An unknown input, one in no group and no scale, a fractional power or a logarithm of an input that is not
        positive, an axis whose range does not include the box.
    """

    inputs: tuple[Input, ...]
    groups: tuple[Group, ...]
    scalings: Mapping[str, Scaling]
    added: Powers = field(default_factory=dict)
    reference: Powers = field(default_factory=dict)

    def __post_init__(self) -> None:
        names = {input_.name: input_ for input_ in self.inputs}
        used = {name for group in self.groups for name, power in group.powers.items() if power}
        for name in (*used, *self.added, *(name for scaling in self.scalings.values() for name in scaling.powers)):
            if name not in names:
                raise ValueError(f"groups: {name!r} is no input; the inputs are {', '.join(names)}")
        scaled = {*self.added, *(name for scaling in self.scalings.values() for name in scaling.powers)}
        for name in names:
            if name not in used | scaled:
                raise ValueError(f"groups: input {name!r} is in no group and no scale")
        for group in self.groups:
            self._check_positive(group.axis.name, {k: p for k, p in group.powers.items() if p < 0 or p != int(p)})
            low, high = sorted(group.constant * end for end in span(self.inputs, group.powers))
            room = NEAR * (group.axis.high - group.axis.low)
            if low < group.axis.low - room or high > group.axis.high + room:
                raise ValueError(f"groups: {group.axis.name!r} is {low:g} to {high:g} in the box, beyond its range "
                                 f"{group.axis.range_text()}")  # fmt: skip
        for name, scaling in self.scalings.items():
            self._check_positive(f"the scale of {name}", scaling.powers)
        self._check_positive("the added logarithm", self.added)

    def _check_positive(self, what: str, powers: Powers) -> None:
        for input_ in self.inputs:
            if powers.get(input_.name, 0.0) and input_.low <= 0:
                raise ValueError(
                    f"groups: {what}: {input_.name!r} from {input_.low:g} on has no such power; it must be > 0"
                )

    @property
    def axes(self) -> tuple[Input, ...]:
        """The training axes."""
        return tuple(group.axis for group in self.groups)

    @cached_property
    def powers(self) -> Array:
        """Power of every input in the product of every axis, (axes, d)."""
        return np.stack([row_of(group.powers, self.inputs) for group in self.groups])

    def axis_values(self, X: Array) -> Array:
        """Return the axes' values at points (n, d): (n, axes), within their ranges where the points are in the box."""
        products = zip(self.groups, self.powers, strict=True)
        U = np.stack([group.constant * _product(X, row) for group, row in products], axis=1)
        low, high = np.array([(axis.low, axis.high) for axis in self.axes]).T
        inside = np.clip(U, low, high)
        return np.asarray(np.where(np.abs(U - inside) <= NEAR * (high - low), inside, U))  # no rounding at the ends

    def jacobian(self, X: Array) -> Array:
        """Return the derivatives of the axes' values by the inputs at points (n, d): (axes, d, n)."""
        products = zip(self.groups, self.powers, strict=True)
        return np.stack([group.constant * _slopes(X, row) for group, row in products])

    def reduced(self, dataset: xr.Dataset, outputs: Sequence[str]) -> xr.Dataset:
        """Return the learnt functions of these outputs, from a data set of outputs and inputs over any dimensions."""
        columns = [dataset[input_.name].variable for input_ in self.inputs]
        input_dims = tuple(dict.fromkeys(dim for column in columns for dim in column.dims))
        arrays: dict[Any, Any] = {}
        for name in outputs:
            variable = dataset[name].variable
            dims = {dim: dataset.sizes[dim] for dim in dict.fromkeys((*variable.dims, *input_dims))}
            whole = [source.set_dims(dims) for source in (variable, *columns)]  # type: ignore[no-untyped-call]
            array, *factors = (part.values for part in whole)
            X = np.stack([column.ravel() for column in factors], axis=1)
            learnt = Scales(self, [name]).transform(np.asarray(array, dtype=np.float64).reshape(1, -1), X)
            arrays[name] = tuple(dims), learnt.reshape(array.shape), dataset[name].attrs
        return xr.Dataset(arrays)

    def only(self, outputs: Sequence[str]) -> Self:
        """Return the grouping of these outputs."""
        return replace(self, scalings={name: self.scalings[name] for name in outputs})

    def state(self, outputs: Sequence[str]) -> xr.Dataset:
        """Return the numbers for a file, without the axes themselves."""
        scales = Scales(self, outputs)
        return xr.Dataset(
            {
                "axis_power": (("axis", "input"), self.powers),
                "axis_constant": ("axis", [group.constant for group in self.groups]),
                "scale_power": (("output", "input"), scales.powers),
                "added_coefficient": ("output", scales.coefficients),
                "added_power": ("input", scales.added),
                "logarithm": ("output", scales.signs),
                "reference": ("input", scales.references),
            }
        )

    @classmethod
    def restore(
        cls, stored: xr.Dataset, axes: Sequence[Input], inputs: tuple[Input, ...], outputs: Sequence[str]
    ) -> Self:
        """Return the grouping of a `state`, with these training axes; ValueError names what is inconsistent."""
        names = [input_.name for input_ in inputs]

        def powers(row: Array) -> dict[str, float]:
            return {name: float(power) for name, power in zip(names, row, strict=True) if power}

        rows, constants = stored["axis_power"].transpose("axis", "input").values, stored["axis_constant"].values
        groups = tuple(
            Group(axis, powers(row), constant)
            for axis, row, constant in zip(axes, rows, constants.tolist(), strict=True)
        )
        signs = stored["logarithm"].values.tolist()
        if not set(signs) <= {-1, 0, 1}:
            raise ValueError("the sign of a logarithm is -1, 0 or 1")
        columns = stored["scale_power"].transpose("output", "input").values, stored["added_coefficient"].values
        scalings = {
            name: Scaling(powers(row), float(coefficient), int(sign))
            for name, row, coefficient, sign in zip(outputs, *columns, signs, strict=True)
        }
        reference = dict(zip(names, stored["reference"].values.tolist(), strict=True))
        return cls(inputs, groups, scalings, powers(stored["added_power"].values), reference)


class Scales:
    """The scales of p outputs as functions of points in the inputs."""

    def __init__(self, grouping: Grouping, names: Sequence[str]) -> None:
        inputs, scalings = grouping.inputs, [grouping.scalings[name] for name in names]
        self.names = tuple(names)
        self.powers = np.stack([row_of(scaling.powers, inputs) for scaling in scalings])
        self.coefficients = np.array([scaling.coefficient for scaling in scalings])
        self.signs = np.array([scaling.logarithm for scaling in scalings])
        self.added = row_of(grouping.added, inputs)
        self.references = np.array([grouping.reference.get(input_.name, middle(input_)) for input_ in inputs])
        self._distinct, which = np.unique(self.powers, axis=0, return_inverse=True)
        self._which = which.reshape(-1)
        self._logarithms = [(int(k), int(self.signs[k])) for k in np.flatnonzero(self.signs)]

    def values(self, X: Array) -> Array:
        """Return the factors of learnt outputs at points (n, d): (p, n)."""
        return np.asarray(np.exp(self._logarithm(X, self._distinct))[self._which])

    def steepness(self, X: Array) -> Array:
        """Return the derivatives of the logarithms of `values` by the inputs at points (n, d): (d, p, n)."""
        return np.stack([_steepness(X, row) for row in self.powers], axis=1)

    def additions(self, X: Array) -> Array:
        """Return the logarithms added to learnt outputs at points (n, d): (p, n)."""
        return np.asarray(self.coefficients[:, None] * self._logarithm(X, self.added[None]))

    def added_slopes(self, X: Array) -> Array:
        """Return the derivatives of `additions` by the inputs at points (n, d): (d, p, n)."""
        return np.asarray(self.coefficients[:, None] * _steepness(X, self.added)[:, None])

    def transform(self, values: Array, X: Array) -> Array:
        """Return the learnt functions, (p, n), of outputs (p, n), in their units, at physical points X, (n, d)."""
        learnt = values / self.values(X)
        for k, sign in self._logarithms:
            if (learnt[k] * sign <= 0).any():
                low, high = values[k].min(), values[k].max()
                raise ValueError(
                    f"output {self.names[k]!r} is from {low:g} to {high:g}: no logarithm of what changes sign"
                )
            learnt[k] = sign * np.log(learnt[k] * sign)  # rises with the output
        return np.asarray(learnt - self.additions(X))

    def untransform(self, learnt: Array, X: Array) -> Array:
        """Return the outputs, (p, n), of learnt functions at physical points X, (n, d): the inverse of `transform`."""
        outputs = learnt + self.additions(X)
        for k, sign in self._logarithms:
            outputs[k] = sign * np.exp(sign * outputs[k])
        return np.asarray(outputs * self.values(X))

    def sizes(self, X: Array, mean: Array) -> Array:
        """Return the factors of learnt errors at points X, (n, d), the scale or a logarithm's output: (p, n)."""
        return np.asarray(np.where(self.signs[:, None] == 0, self.values(X), np.abs(mean)))

    def _logarithm(self, X: Array, rows: Array) -> Array:
        """Return logarithms of products of powers relative to the reference, (rows, n); their inputs are positive."""
        used = rows.any(axis=0)
        return np.asarray(rows[:, used] @ np.log(X[:, used] / self.references[used]).T)


def row_of(powers: Powers, inputs: Sequence[Input]) -> Array:
    """Return the power of every input, (d,)."""
    return np.array([powers.get(input_.name, 0.0) for input_ in inputs])


def middle(factor: Input) -> float:
    """Return the middle of a range on its scale."""
    return float(factor.from_unit(0.0))


def span(inputs: Sequence[Input], powers: Powers) -> tuple[float, float]:
    """Return the least and the largest value of a product of powers over a box."""
    low = high = 1.0
    for input_ in inputs:
        power = powers.get(input_.name, 0.0)
        if not power:
            continue
        ends = [input_.low**power, input_.high**power] + ([0.0] if input_.low < 0 < input_.high else [])
        products = [a * b for a in (low, high) for b in (min(ends), max(ends))]
        low, high = min(products), max(products)
    return low, high


def _product(X: Array, row: Array) -> Array:
    return np.asarray(np.prod([X[:, k] ** row[k] for k in np.flatnonzero(row)], axis=0))


def _slopes(X: Array, row: Array) -> Array:
    """Return the derivatives of a product by every input, (d, n)."""
    slopes = np.zeros((len(row), len(X)))
    for k in np.flatnonzero(row):
        others = row.copy()
        others[k] = 0.0
        slopes[k] = row[k] * X[:, k] ** (row[k] - 1) * (_product(X, others) if others.any() else 1.0)
    return slopes


def _steepness(X: Array, row: Array) -> Array:
    """Return the derivatives of the logarithm of a product by the inputs, (d, n)."""
    steep = np.zeros((len(row), len(X)))
    steep[row != 0] = row[row != 0, None] / X.T[row != 0]
    return steep
