"""Groups: training axes that are products of powers of the inputs, and outputs over products of powers.

Where a model of the world scales, its outputs depend on fewer numbers than it has inputs. Nothing here knows why.
"""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
import xarray as xr

from approximation.arrays import Array
from surrogate.data.inputs import Input
from surrogate.transforms.inputs import NEAR, Axes, Group, Powers, middle, span
from surrogate.transforms.outputs import Scales, Scaling


def _over(variable: xr.Variable, dims: Mapping[Hashable, int]) -> Array:
    """Values over dimensions of these sizes, those of the variable among them."""
    values = variable.transpose(*(dim for dim in dims if dim in variable.dims)).values
    axes = tuple(slice(None) if dim in variable.dims else None for dim in dims)
    return np.broadcast_to(values[axes], tuple(dims.values()))


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
    def products(self) -> Axes:
        """The axes as functions of points."""
        return Axes(self.inputs, self.groups)

    def scales(self, outputs: Sequence[str]) -> Scales:
        """Return the scales of some outputs as functions of points."""
        return Scales(self.inputs, outputs, self.scalings, self.added, self._references)

    def reduced(self, dataset: xr.Dataset, outputs: Sequence[str]) -> xr.Dataset:
        """Return a data set of the axes: what is learnt of every output, over the dimensions that it has.

        Parameters
        ----------
        dataset : Dataset
            Outputs, and every input as a variable or coordinate, over any dimensions: the axes, or cases.
        outputs : sequence of str
            Which to take.
        """
        columns = [dataset[input_.name].variable for input_ in self.inputs]
        own_dims = tuple(dict.fromkeys(dim for column in columns for dim in column.dims))
        arrays: dict[Any, Any] = {}
        for name in outputs:
            variable = dataset[name].variable
            dims = {dim: dataset.sizes[dim] for dim in dict.fromkeys((*variable.dims, *own_dims))}
            array, *factors = (_over(source, dims) for source in (variable, *columns))
            X = np.stack([column.ravel() for column in factors], axis=1)
            learnt = self.scales([name]).transform(np.asarray(array, dtype=np.float64).reshape(1, -1), X)
            arrays[name] = tuple(dims), learnt.reshape(array.shape), dataset[name].attrs
        return xr.Dataset(arrays)

    def only(self, outputs: Sequence[str]) -> Self:
        """Return that of some outputs."""
        return replace(self, scalings={name: self.scalings[name] for name in outputs})

    def state(self, outputs: Sequence[str]) -> xr.Dataset:
        """Return the numbers for a file, beside the axes themselves."""
        scales = self.scales(outputs)
        return xr.Dataset(
            {
                "axis_power": (("axis", "input"), self.products.powers),
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
        """Return the grouping in a file.

        Parameters
        ----------
        stored : Dataset
            As `state` gives it.
        axes : sequence of Input
            The training axes.
        inputs : tuple of Input
            What the user asks by.
        outputs : sequence of str
            Names of the outputs.

        Raises
        ------
        ValueError
            What is inconsistent.
        """
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

    @property
    def _references(self) -> Array:
        return np.array([self.reference.get(input_.name, middle(input_)) for input_ in self.inputs])
