"""Named inputs with a range and a scale, and the Chebyshev-Gauss levels of a range."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any, Literal, get_args

import numpy as np
import scipy  # scipy.special, slow to import, and few inputs have such a scale
import xarray as xr
from numpy.typing import ArrayLike

from approximation.arrays import Array, Indices, unmasked
from approximation.chebyshev import gauss_points

Scale = Literal["linear", "log", "logit"]
SCALES: tuple[str, ...] = get_args(Scale)
#: Variables of a file and the fields of `Input` that they hold, in the order of the fields.
COLUMNS = {
    "input": "name", "low": "low", "high": "high", "scale": "scale", "input_units": "units",
    "input_long_name": "long_name",
}  # fmt: skip


def _logit(share: Any) -> Any:
    return scipy.special.logit(share)


@dataclass(frozen=True)
class Input:
    """One input of a model: its name, its range and the scale on which it is mapped to [-1, 1].

    Parameters
    ----------
    name : str
    low, high : float
        Ends of the range, in `units`; finite, low < high, low > 0 on a log scale, and high < 1 too on a logit one.
    scale : {"linear", "log", "logit"}
        Scale on which the range is mapped to [-1, 1]: the value, its logarithm, or log(value/(1 - value)).
    units, long_name : str
        Attributes of the input in every labelled result.

    Raises
    ------
    ValueError
        For another range or scale; names the input and the value.

    Examples
    --------
    >>> radius = Input("radius", 0.01, 1.0, "log", units="m")
    >>> radius.from_unit([-1, 0, 1]).round(12).tolist(), float(radius.to_unit(0.1).round(12))
    ([0.01, 0.1, 1.0], 0.0)
    >>> radius.levels(3).round(4).tolist(), radius.range_text()
    ([0.0136, 0.1, 0.7346], '[0.01, 1] m')
    >>> radius.attrs
    {'units': 'm'}
    >>> float(radius.unit_slope(0.1).round(4))
    4.3429
    """

    name: str
    low: float
    high: float
    scale: Scale = "linear"
    units: str = ""
    long_name: str = ""

    def __post_init__(self) -> None:
        if not self.name:
            raise ValueError("an input needs a name")
        if self.scale not in SCALES:
            raise ValueError(f"input {self.name!r}: scale {self.scale!r} is none of {', '.join(SCALES)}")
        if not (np.isfinite(self.low) and np.isfinite(self.high)):
            raise ValueError(f"input {self.name!r}: the range [{self.low}, {self.high}] must be finite")
        if not self.low < self.high:
            raise ValueError(f"input {self.name!r}: low {self.low} must be less than high {self.high}")
        if self.scale == "log" and self.low <= 0:
            raise ValueError(f"input {self.name!r}: a log scale needs low > 0, got {self.low}")
        if self.scale == "logit" and not (self.low > 0 and self.high < 1):
            raise ValueError(f"input {self.name!r}: a logit scale needs 0 < low and high < 1, got {self.range_text()}")

    @cached_property
    def _width(self) -> float:
        """Width of the range on its scale."""
        if self.scale == "log":
            return float(np.log(self.high / self.low))
        return float(_logit(self.high) - _logit(self.low)) if self.scale == "logit" else self.high - self.low

    @property
    def attrs(self) -> dict[str, str]:
        """`units` and `long_name`, where it has them, for a labelled coordinate."""
        return {key: text for key, text in (("units", self.units), ("long_name", self.long_name)) if text}

    def to_unit(self, value: ArrayLike) -> Array:
        """Map physical values to the scaled coordinate, -1 at `low` and 1 at `high`; any shape."""
        value = np.asarray(unmasked(value), dtype=np.float64)
        return unit_coordinates((self,), value.reshape(-1, 1)).reshape(value.shape)

    def from_unit(self, unit: ArrayLike) -> Array:
        """Map scaled coordinates to physical values; any shape. The ends are met exactly."""
        unit = np.asarray(unmasked(unit), dtype=np.float64)
        along = (unit + 1) / 2 * self._width
        if self.scale == "log":
            value = self.low * np.exp(along)
        elif self.scale == "logit":
            value = scipy.special.expit(_logit(self.low) + along)
        else:
            value = self.low + along
        return np.asarray(np.where(unit == -1, self.low, np.where(unit == 1, self.high, value)))

    def unit_slope(self, value: ArrayLike) -> Array:
        """Return d(scaled coordinate)/d(value) at physical values, any shape, in 1/`units`."""
        value = np.asarray(unmasked(value), dtype=np.float64)
        if self.scale == "log":
            return np.asarray(2 / (self._width * value))
        if self.scale == "logit":
            return np.asarray(2 / (self._width * value * (1 - value)))
        return np.full_like(value, 2 / self._width)

    def levels(self, count: int) -> Array:
        """Return the `count` Chebyshev-Gauss levels of the range, ascending, shape (count,)."""
        return self.from_unit(gauss_points(count))

    def range_text(self) -> str:
        """Return the range as text for messages, e.g. ``[0.005, 0.2] m``."""
        return f"[{self.low:g}, {self.high:g}]" + (f" {self.units}" if self.units not in ("", "1") else "")


def chebyshev_levels(low: float, high: float, count: int, scale: Scale = "linear") -> Array:
    """Return the Chebyshev-Gauss levels of a range, ascending.

    The levels are the zeros of T_count mapped from [-1, 1] to [low, high] on the scale (L. N. Trefethen, Approximation
    Theory and Approximation Practice, 2013, chapter 2: "of the first kind").

    Parameters
    ----------
    low, high : float
        Ends of the range; they are not levels themselves.
    count : int
        Number of levels, >= 1.
    scale : {"linear", "log", "logit"}
        "log" needs low > 0, "logit" also high < 1.

    Returns
    -------
    ndarray, shape (count,)
        Levels in the units of `low` and `high`.

    Raises
    ------
    ValueError
        For a bad range, scale or count.

    Examples
    --------
    >>> chebyshev_levels(0.0, 1.0, 3).round(4).tolist()
    [0.067, 0.5, 0.933]
    """
    return Input("level", low, high, scale).levels(count)


def unit_coordinates(inputs: Sequence[Input], X: Array) -> Array:
    """Map physical points X, (n, d), to scaled coordinates, (d, n), as `Input.to_unit`; each row is contiguous."""
    low, width, logs, logits = _scales(tuple(inputs))
    t = np.subtract(X.T, low, order="C")
    if logs.size:
        t[logs] = np.log(X.T[logs] / low[logs])
    if logits.size:
        t[logits] = _logit(X.T[logits]) - _logit(low[logits])
    t *= 2
    t /= width
    t -= 1
    return t


def physical_points(inputs: Sequence[Input], t: Array) -> Array:
    """Map scaled coordinates t, (d, n), to physical points, (n, d): the inverse of `unit_coordinates`."""
    return np.stack([input_.from_unit(row) for input_, row in zip(inputs, t, strict=True)], axis=1)


@cache
def _scales(inputs: tuple[Input, ...]) -> tuple[Array, Array, Indices, Indices]:
    """Return low ends and widths on the inputs' scales, (d, 1) each, and the numbers of log and of logit inputs."""
    low = np.array([[input_.low] for input_ in inputs]).reshape(-1, 1)
    width = [input_._width for input_ in inputs]
    members = {scale: np.flatnonzero([input_.scale == scale for input_ in inputs]) for scale in SCALES}
    return low, np.reshape(width, (-1, 1)), members["log"], members["logit"]


def stored_inputs(stored: xr.Dataset, prefix: str = "") -> tuple[Input, ...]:
    """Return the inputs of a model in a file."""
    columns = [stored[f"{prefix}{name}"].values.tolist() for name in COLUMNS]
    if len(set(columns[0])) != len(columns[0]) or not columns[0]:
        raise ValueError("input names must be unique")
    return tuple(Input(*row) for row in zip(*columns, strict=True))
