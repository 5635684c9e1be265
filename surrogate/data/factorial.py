"""Complete factorial data sets, checked: sorted levels of every factor and one full array per output."""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from approximation.arrays import Array, Indices
from approximation.chebyshev import gauss_points
from surrogate.data.inputs import Input, Scale

MOST_OF_A_FACTOR = 1000  # levels of a factor, since its kernel matrix is decomposed
LEVEL_TOLERANCE = 1e-10  # distance of a level from its Chebyshev-Gauss position, as a share of the half-range
_ROUNDED = 1e-6  # relative rounding of a level: seven digits are off by half of it, single precision by less


@dataclass(frozen=True)
class Factorial:
    """Outputs over the full product of the factors' levels."""

    inputs: tuple[Input, ...]  # one per factor, in the order of the arrays' axes
    levels: tuple[Array, ...]  # ascending levels of every factor, physical units
    outputs: dict[str, Array]  # read-only views (n_1, ..., n_d), broadcast along factors that an output lacks
    attrs: dict[str, dict[str, str]]  # `units` and `long_name` of every output


def complete_factorial(dataset: xr.Dataset, inputs: Sequence[Input] | None, outputs: Sequence[str] | None) -> Factorial:
    """Return a data set as a factorial; ValueError names what makes it none."""
    names = output_names(dataset, outputs, exclude=())
    variables = {name: dataset.variables[name] for name in names}  # `dataset[name]` would visit all other variables
    factors = [input_.name for input_ in inputs] if inputs is not None else _factors(dataset, names)
    for name, variable in variables.items():
        unknown = [str(dim) for dim in variable.dims if dim not in factors]
        if unknown:
            raise ValueError(
                f"output {name!r} has dimension {unknown[0]!r}, which is no input; the inputs are {', '.join(factors)}"
            )
    order = {factor: np.argsort(_levels(dataset, factor), kind="stable") for factor in factors}
    levels = tuple(_levels(dataset, factor)[order[factor]] for factor in factors)
    for factor, values in zip(factors, levels, strict=True):
        repeated = values[1:][np.diff(values) == 0]
        if repeated.size:
            raise ValueError(f"input {factor!r} has the level {repeated[0]:g} more than once")
    if inputs is None:
        inputs = [_inferred(dataset, factor, values) for factor, values in zip(factors, levels, strict=True)]
    check_levels(inputs, levels)
    levels = tuple(_exact(input_, values) for input_, values in zip(inputs, levels, strict=True))
    shape = tuple(map(len, levels))
    arrays = {name: _full(name, variable, factors, shape, order) for name, variable in variables.items()}
    return Factorial(
        tuple(inputs), levels, arrays, {name: text_attrs(variable) for name, variable in variables.items()}
    )


def output_names(dataset: xr.Dataset, outputs: Sequence[str] | None, exclude: Sequence[str]) -> list[str]:
    """Return the names of the outputs to model; ValueError for one that is missing or holds no numbers."""
    names = [str(name) for name in dataset.data_vars if name not in exclude] if outputs is None else list(outputs)
    if not names:
        raise ValueError("the data set has no variable to model")
    for name in names:
        if name not in dataset.data_vars:
            raise ValueError(f"output {name!r} is not in the data set; it has {', '.join(map(str, dataset.data_vars))}")
        if (dtype := dataset.variables[name].dtype).kind not in "iuf":
            raise ValueError(f"output {name!r} must be numbers, got {dtype} values")
    return names


def text_attrs(array: xr.DataArray | xr.Variable) -> dict[str, str]:
    """Return an array's `units` and `long_name`, where it has them."""
    return {key: str(array.attrs[key]) for key in ("units", "long_name") if key in array.attrs}


def _factors(dataset: xr.Dataset, names: Sequence[str]) -> list[str]:
    used = {dim for name in names for dim in dataset.variables[name].dims}
    return [str(dim) for dim in dataset.dims if dim in used]


def _levels(dataset: xr.Dataset, factor: str) -> Array:
    if factor not in dataset.dims:
        raise ValueError(
            f"input {factor!r} is no dimension of the data set; it has {', '.join(map(str, dataset.dims))}"
        )
    if factor not in dataset.coords:
        raise ValueError(f"input {factor!r} has no coordinate, so its levels are unknown")
    values = dataset[factor].values
    if values.dtype.kind not in "iuf":
        raise ValueError(f"input {factor!r} must have numbers as levels, got {values.dtype} values")
    if not np.isfinite(values).all():
        raise ValueError(f"input {factor!r} has a level that is not finite")
    return np.asarray(values, dtype=np.float64)


def _inferred(dataset: xr.Dataset, factor: str, levels: Array) -> Input:
    attrs = text_attrs(dataset[factor])
    if len(levels) < 2:
        raise ValueError(f"input {factor!r} has {len(levels)} level; a factor needs at least 2")
    scales: tuple[Scale, ...] = ("linear", "log") if levels[0] > 0 else ("linear",)
    for scale in scales:
        ends = np.log(levels[[0, -1]]) if scale == "log" else levels[[0, -1]]
        middle, reach = ends.mean(), (ends[1] - ends[0]) / 2 / gauss_points(len(levels))[-1]
        low, high = np.exp([middle - reach, middle + reach]) if scale == "log" else (middle - reach, middle + reach)
        inferred = Input(factor, float(low), float(high), scale, **attrs)
        if _distance(inferred, levels).max() <= LEVEL_TOLERANCE:
            return inferred
        for digits in range(1, 18):  # a range of few digits, whose levels are rounded
            both = (inferred.low, inferred.high)
            largest = max(map(abs, both))  # counts the digits on a linear scale, as a low end of 0 has none
            low, high = (_short(end, end if scale == "log" else largest, digits) for end in both)
            if low < high and (scale == "linear" or low > 0):
                shorter = Input(factor, low, high, scale, **attrs)
                if _is_rounded(shorter, levels):
                    return shorter
    raise ValueError(
        f"input {factor!r}: its {len(levels)} levels are no Chebyshev-Gauss levels of a linear or log range"
    )


def _short(value: float, size: float, digits: int) -> float:
    """Return the value rounded to the place that the last of `digits` digits has in `size`."""
    return round(value, digits - 1 - int(np.floor(np.log10(size))))


def _distance(input_: Input, levels: Array) -> Array:
    """Return the distances of levels from an input's Chebyshev-Gauss levels, as shares of its half-range; (n,)."""
    return np.abs(input_.to_unit(levels) - gauss_points(len(levels)))


def _is_rounded(input_: Input, levels: Array) -> bool:
    """Return whether levels are the Chebyshev-Gauss levels of an input but for rounding to seven digits."""
    size = np.abs(levels) if input_.scale != "linear" else np.abs(levels).max()
    return bool(np.all(np.abs(levels - input_.levels(len(levels))) <= _ROUNDED * size))


def _exact(input_: Input, levels: Array) -> Array:
    """Return the levels or, with a warning, the Chebyshev-Gauss levels from which they were rounded."""
    if _distance(input_, levels).max() <= LEVEL_TOLERANCE:
        return levels
    warnings.warn(
        f"input {input_.name!r}: its levels are {len(levels)} Chebyshev-Gauss levels of {input_.range_text()} rounded "
        "to seven digits; the exact ones are taken",
        UserWarning,
        stacklevel=2,
    )
    return input_.levels(len(levels))


def follows_chebyshev(dataset: xr.Dataset, factors: Sequence[str], inputs: Sequence[Input] | None) -> bool:
    """Return True if the levels of all factors are Chebyshev-Gauss levels."""
    try:
        levels = [_levels(dataset, factor) for factor in factors]
        if inputs is None:
            inputs = [_inferred(dataset, name, values) for name, values in zip(factors, levels, strict=True)]
        check_levels(inputs, levels)
    except ValueError:
        return False
    return True


def check_levels(inputs: Sequence[Input], levels: Sequence[Array]) -> None:
    """Raise ValueError unless the ascending levels (n,) of every input, in its units, are Chebyshev-Gauss levels."""
    for input_, values in zip(inputs, levels, strict=True):
        if len(values) > MOST_OF_A_FACTOR:
            raise ValueError(f"input {input_.name!r} has {len(values)} levels; a factor has at most {MOST_OF_A_FACTOR}")
        if len(values) < 2:
            raise ValueError(f"input {input_.name!r} has {len(values)} level; a factor needs at least 2")
        if input_.scale == "log" and values[0] <= 0:
            raise ValueError(f"input {input_.name!r} has the level {values[0]:g} on a log scale")
        off = _distance(input_, values)
        if off.max() > LEVEL_TOLERANCE and not _is_rounded(input_, values):
            k = int(off.argmax())
            raise ValueError(
                f"input {input_.name!r}: level {values[k]:.10g} is none of the {len(values)} Chebyshev-Gauss levels of "
                f"{input_.range_text()} ({input_.scale}), expected {input_.levels(len(values))[k]:.10g}"
            )


def _full(
    name: str, array: xr.Variable, factors: Sequence[str], shape: tuple[int, ...], order: Mapping[str, Indices]
) -> Array:
    present = [factor for factor in factors if factor in array.dims]
    values = np.asarray(array.transpose(*present).values, dtype=np.float64)
    for axis, factor in enumerate(present):
        if (np.diff(order[factor]) < 0).any():
            values = values.take(order[factor], axis=axis)
    # one reduction is enough to find any NaN or infinity, at a third of the cost of isfinite
    with np.errstate(over="ignore", invalid="ignore"):
        clean = np.isfinite(values.sum())
    if not clean and not np.isfinite(values).all():
        bad = int(np.count_nonzero(~np.isfinite(values)))
        raise ValueError(
            f"output {name!r} is not finite in {bad} of {values.size} cases; the factorial must be complete"
        )
    axes = [size if factor in array.dims else 1 for factor, size in zip(factors, shape, strict=True)]
    return np.broadcast_to(values.reshape(axes), shape)
