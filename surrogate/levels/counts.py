"""Level counts of a factorial, chosen by the decay of Chebyshev coefficients of a data set or of pilots.

If an output is analytic near the box, its coefficients along a factor fall geometrically. Then the error of
interpolation on n Chebyshev-Gauss levels is at most twice the sum of the coefficients from the n-th on (L. N.
Trefethen, Approximation Theory and Approximation Practice (2013), theorems 4.2 and 8.2). At a kink they fall
algebraically, and no tolerance is claimed.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import prod
from operator import itemgetter
from types import MappingProxyType

import numpy as np
import xarray as xr

from approximation.arrays import Array
from approximation.chebyshev import coefficients
from surrogate.data.factorial import complete_factorial
from surrogate.data.inputs import Input
from surrogate.levels.decay import Decay, decay_of

MOST_LEVELS = 256

Decays = Mapping[str, Mapping[str, Decay]]  # by output and input


class UnreachableError(ValueError):
    """The tolerance cannot be reached within the budget; the message says what the budget reaches."""


@dataclass(frozen=True)
class LevelChoice:
    """Level counts and the evidence for them."""

    counts: dict[str, int]  # levels of every input, in order; an affine input has 2
    error: dict[str, float]  # predicted error over range of every output, NaN for a kinked one
    affine: tuple[str, ...]  # inputs in which every output is affine
    extrapolated: tuple[str, ...]  # inputs with more levels than their pilot, by the fitted rate
    kinked: dict[str, tuple[str, ...]]  # outputs whose coefficients do not decay geometrically, and along which inputs
    # `coefficient` over (`output`, `input`, `mode`): largest Chebyshev coefficient of all lines along an input, over
    # the output's range (NaN beyond the pilot's levels); over (`output`, `input`): `rate`, the fitted factor from one
    # coefficient to the next, and `interpolation_error`, the input's part of the predicted error
    decay: xr.Dataset


def decays(data: xr.Dataset, inputs: Sequence[Input], outputs: Sequence[str] | None = None) -> Decays:
    """Return the decay of every output of a factorial along every input."""
    factorial = complete_factorial(data, inputs, outputs)
    names = [input_.name for input_ in factorial.inputs]
    judged = {}
    for output, values in factorial.outputs.items():
        size = float(np.ptp(values)) or 1.0
        along = [largest(values[..., None], axis)[:, 0] / size for axis in range(values.ndim)]
        judged[output] = dict(zip(names, map(decay_of, along), strict=True))
    return judged


def largest(values: Array, axis: int) -> Array:
    """Return the largest Chebyshev coefficients along an axis of values (..., p), over all other axes: (n, p)."""
    along = np.moveaxis(coefficients(values, axis), axis, 0)
    return np.asarray(np.abs(along).reshape(values.shape[axis], -1, values.shape[-1]).max(axis=1))


def choose(
    decays: Decays, tolerance: float, budget: int, fixed: Mapping[str, int] = MappingProxyType({})
) -> LevelChoice:
    """Return the smallest factorial with a predicted error within the tolerance; UnreachableError beyond the budget."""
    if not tolerance > 0 or budget < 1:
        raise ValueError(f"tolerance {tolerance} and budget {budget} must be positive")
    kinks = {output: tuple(name for name in along if along[name].algebraic) for output, along in decays.items()}
    kinked = {output: where for output, where in kinks.items() if where}
    claimed = {output: along for output, along in decays.items() if output not in kinked}
    if not claimed:
        raise ValueError(f"no output decays geometrically, so no tolerance can be met: {', '.join(kinked)}")
    names = list(next(iter(decays.values())))
    counts = _smallest(claimed, tolerance, fixed)
    if counts is None or prod(counts.values()) > budget:
        raise UnreachableError(_unreachable(claimed, counts, tolerance, budget, fixed))
    error = {output: _error(along, counts) for output, along in claimed.items()}
    return LevelChoice(
        counts=counts,
        error={output: error.get(output, float("nan")) for output in decays},
        affine=tuple(name for name in names if all(along[name].affine for along in decays.values())),
        extrapolated=tuple(
            name
            for name in names
            if name not in fixed and counts[name] > max(len(along[name].coefficients) for along in decays.values())
        ),
        kinked=kinked,
        decay=evidence(decays, counts),
    )


def evidence(decays: Decays, counts: Mapping[str, int]) -> xr.Dataset:
    """Return decays as the data set `LevelChoice.decay`, with `kinked` over (`output`, `input`), 1 at a kink."""
    names = list(next(iter(decays.values())))
    table = [[along[name] for name in names] for along in decays.values()]
    modes = max(len(decay.coefficients) for row in table for decay in row)
    coefficients = np.full((len(table), len(names), modes), np.nan)
    for p, row in enumerate(table):
        for k, decay in enumerate(row):
            coefficients[p, k, : len(decay.coefficients)] = decay.coefficients
    over = ("output", "input")
    errors = [[decay.error(counts[name]) for name, decay in zip(names, row, strict=True)] for row in table]
    return xr.Dataset(
        {
            "coefficient": ((*over, "mode"), coefficients, {"long_name": "largest coefficient over range"}),
            "rate": (
                over, np.array([[decay.rate for decay in row] for row in table]),
                {"long_name": "factor from one coefficient to the next"},
            ),
            "interpolation_error": (over, np.array(errors), {"long_name": "predicted error over range"}),
            "kinked": (
                over, np.array([[int(decay.algebraic) for decay in row] for row in table]),
                {"long_name": "1 where coefficients fall as at a kink"},
            ),
        },
        coords={"output": list(decays), "input": names, "mode": np.arange(modes)},
    )  # fmt: skip


def _smallest(judged: Decays, tolerance: float, fixed: Mapping[str, int]) -> dict[str, int] | None:
    """Return level counts of few cases that keep every output's error within the tolerance, None if there are none."""
    counts = _equally_shared(judged, tolerance, fixed)
    return None if counts is None else _trimmed(counts, judged, tolerance, fixed)


def _equally_shared(judged: Decays, tolerance: float, fixed: Mapping[str, int]) -> dict[str, int] | None:
    """Return level counts that share the tolerance, less the error of the fixed counts, equally among other inputs."""
    names = list(next(iter(judged.values())))
    spent = max(sum(along[name].error(fixed[name]) for name in names if name in fixed) for along in judged.values())
    if spent > tolerance:
        return None
    curved = sum(any(not along[name].affine for along in judged.values()) for name in names if name not in fixed)
    share, counts = (tolerance - spent) / max(1, curved), dict[str, int]()
    for name in names:
        fewest = fixed[name] if name in fixed else _fewest([along[name] for along in judged.values()], share)
        if fewest is None:
            return None
        counts[name] = fewest
    return counts


def _fewest(decays: Sequence[Decay], error: float) -> int | None:
    """Return the fewest levels along one input that keep all outputs within an error, None beyond `MOST_LEVELS`."""
    enough = (count for count in range(2, MOST_LEVELS) if max(decay.error(count) for decay in decays) <= error)
    return next(enough, None)


def _trimmed(counts: dict[str, int], judged: Decays, tolerance: float, fixed: Mapping[str, int]) -> dict[str, int]:
    """Remove levels, first where that saves most cases, as long as the summed errors stay within the tolerance."""
    while True:
        free = sorted((name for name in counts if name not in fixed and counts[name] > 2), key=counts.__getitem__)
        fewer = ({**counts, name: counts[name] - 1} for name in free)
        allowed = (tried for tried in fewer if max(_error(along, tried) for along in judged.values()) <= tolerance)
        best = next(allowed, None)
        if best is None:
            return counts
        counts = best


def _error(along: Mapping[str, Decay], counts: Mapping[str, int]) -> float:
    """Return the predicted error of one output, the sum of the errors along its inputs."""
    return sum(decay.error(counts[name]) for name, decay in along.items())


def _unreachable(
    claimed: Decays, counts: dict[str, int] | None, tolerance: float, budget: int, fixed: Mapping[str, int]
) -> str:
    low, high = np.log(tolerance), 0.0
    for _ in range(40):
        middle = (low + high) / 2
        tried = _smallest(claimed, float(np.exp(middle)), fixed)
        low, high = (low, middle) if tried and prod(tried.values()) <= budget else (middle, high)
    reached = _smallest(claimed, float(np.exp(high)), fixed)
    if reached and prod(reached.values()) <= budget:
        offer = f"{budget:,} cases reach about {np.exp(high):.1e} with {_text(reached)}"
    else:
        offer = f"{budget:,} cases do not even reach 1"
    if counts is not None:
        needed = f"{prod(counts.values()):,} cases ({_text(counts)})"
        return f"tolerance {tolerance:g} needs {needed}, the budget is {budget:,}; {offer}"
    for name, count in fixed.items():
        output, worst = max(((key, along[name].error(count)) for key, along in claimed.items()), key=itemgetter(1))
        if worst > tolerance:
            too_few = f"{count} levels of {name!r}: output {output!r} errs by {worst:.1e} there"
            return f"tolerance {tolerance:g} is out of reach with {too_few}"
    output = max(claimed, key=lambda key: sum(decay.error(MOST_LEVELS) for decay in claimed[key].values()))
    return f"tolerance {tolerance:g} is out of reach for output {output!r}, which is too noisy or rough; {offer}"


def _text(counts: Mapping[str, int]) -> str:
    return " x ".join(f"{count} {name}" for name, count in counts.items())


LEVELS = (9, 17, 33, 65)  # of a pilot along its input; every refinement halves the spacing
OTHERS = (5, 4, 3, 2)  # levels of the other inputs, of which the most are taken that the budget allows

Solve = Callable[[dict[str, Array]], xr.Dataset]


@dataclass(frozen=True)
class Pilot:
    """Result of the pilots."""

    choice: LevelChoice
    levels: dict[str, int]  # levels of the finest pilot along every input
    cases: int  # cases of all pilots together


def explore(
    solve: Solve,
    inputs: Sequence[Input],
    tolerance: float,
    budget: int,
    outputs: Sequence[str] | None = None,
    fixed: Mapping[str, int] = MappingProxyType({}),
) -> Pilot:
    """Choose level counts from pilots with many levels of one input and few of the others.

    A pilot is refined while more levels are needed than it has, or an output looks kinked along it, as long as all
    pilots together stay within the budget.
    """
    # all first pilots together take at most half of the budget
    most_lines = budget / (2 * len(inputs) * LEVELS[0])
    others = next((count for count in OTHERS if count ** (len(inputs) - 1) <= most_lines), OTHERS[-1])
    lines = others ** (len(inputs) - 1)
    judged: dict[str, dict[str, Decay]] = {}
    fineness = dict.fromkeys((input_.name for input_ in inputs), 0)
    waiting, spent = [input_.name for input_ in inputs], 0
    while waiting:
        for name in waiting:
            count = LEVELS[fineness[name]]
            axes = {input_.name: input_.levels(count if input_.name == name else others) for input_ in inputs}
            spent += count * lines
            for output, along in decays(solve(axes), inputs, outputs).items():
                judged.setdefault(output, {})[name] = along[name]
        waiting = []
        for name in _unsettled(judged, tolerance, fixed):
            finer = fineness[name] + 1
            if finer < len(LEVELS) and spent + LEVELS[finer] * lines <= budget:
                fineness[name] = finer
                waiting.append(name)
    ordered = {output: {input_.name: along[input_.name] for input_ in inputs} for output, along in judged.items()}
    choice = choose(ordered, tolerance, budget, fixed)
    return Pilot(choice, {name: LEVELS[fine] for name, fine in fineness.items()}, spent)


def _unsettled(judged: Mapping[str, Mapping[str, Decay]], tolerance: float, fixed: Mapping[str, int]) -> list[str]:
    """Return the inputs along which a kink is suspected or more levels are needed than the pilot has."""
    names = list(next(iter(judged.values())))
    unsettled = []
    for name in names:
        decays_along = [along[name] for along in judged.values()]
        seen = max(len(decay.coefficients) for decay in decays_along)
        unclear = name not in fixed and max(decay.error(seen) for decay in decays_along) > tolerance / len(names)
        if unclear or any(decay.algebraic for decay in decays_along):
            unsettled.append(name)
    return unsettled
