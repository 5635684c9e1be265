"""Predictions as `meecontact query` prints them: value, standard deviation and interval."""

from collections.abc import Mapping, Sequence
from math import floor, isfinite, log10

import xarray as xr

from surrogate import GaussianProcess
from surrogate.intervals.distribution import NOMINAL
from workflow.language.numbers import prefixed

#: Figures of a number whose interval says nothing of them, and the fewest and most that an interval asks for.
_DIGITS, _FEWEST, _MOST = 10, 4, 15


def predicted(
    model: GaussianProcess, points: Mapping[str, xr.DataArray], level: float, *, extrapolate: bool = False
) -> xr.Dataset:
    """``<output>``, ``<output>_std``, ``<output>_lower`` and ``<output>_upper`` of every output, in this order."""
    answer = model.predict(points, extrapolate=extrapolate)
    whole = answer.assign(model.interval(points, level, extrapolate=extrapolate).data_vars)
    names = [f"{name}{part}" for name in model.outputs_ for part in ("", "_std", "_lower", "_upper")]
    return whole[names + (["extrapolated"] if extrapolate else [])]


def table(answer: xr.Dataset, outputs: Sequence[str], level: float, *, si: bool = False) -> dict[str, str]:
    """A line for every output, ``name value [lower, upper] unit (95 %)`` at the first point, all of one length."""
    units = {name: str(answer[name].attrs.get("units", "")) for name in outputs}
    ends = {name: [float(answer[f"{name}{part}"].values[0]) for part in ("", "_lower", "_upper")] for name in outputs}
    lines = {
        name: f"{name:34s} {shown(value, lower, upper, units[name], level, si=si)}"
        for name, (value, lower, upper) in ends.items()
    }
    length = max(map(len, lines.values()))
    return {name: line.ljust(length) for name, line in lines.items()}


def shown(
    value: float, lower: float, upper: float, units: str = "", level: float = NOMINAL, *, si: bool = False
) -> str:
    """``value [lower, upper] unit (95 %)`` with two figures of the interval's half width."""
    scale, text = (1.0, units) if si else prefixed(max(abs(lower), abs(upper)), units)
    value, lower, upper = value / scale, lower / scale, upper / scale
    count = _digits(max(abs(lower), abs(upper)), (upper - lower) / 2)
    zeros = "#" if upper > lower else ""  # an exact value has no digits to keep
    middle, low, high = (f"{number:{zeros}.{count}g}".rstrip(".") for number in (value, lower, upper))
    return f"{f'{middle} [{low}, {high}] {text}'.rstrip()} ({100 * level:g} %)"


def _digits(size: float, half_width: float) -> int:
    if not (isfinite(size) and half_width > 0):
        return _DIGITS
    return min(max(floor(log10(size)) - floor(log10(half_width)) + 2, _FEWEST), _MOST)
