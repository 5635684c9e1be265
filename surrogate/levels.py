"""Level counts of a factorial, chosen from a small pilot by the decay of its Chebyshev coefficients.

Along one factor, an output that is analytic near the box has coefficients that fall geometrically, and interpolation
on n Chebyshev-Gauss levels errs by at most twice the sum of the coefficients from the n-th on (L. N. Trefethen,
Approximation Theory and Approximation Practice (2013), theorems 4.2 and 8.2). A kink makes them fall
algebraically instead: then no count is claimed to reach a tolerance.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from surrogate.decay import Decay, decay_of
from surrogate.factorial import complete_factorial
from surrogate.factors import cosine_basis
from surrogate.inputs import Input

Array = NDArray[np.float64]

MOST_LEVELS = 256


class UnreachableError(ValueError):
    """The tolerance cannot be reached within the budget; the message says what would reach it."""


@dataclass(frozen=True)
class LevelChoice:
    """Level counts and the evidence for them.

    Attributes
    ----------
    counts : dict of str to int
        Levels of every input, in order; an affine input has 2.
    cases : int
        Their product.
    tolerance : float
        What was asked for, over the range of every output.
    error : dict of str to float
        Predicted error over range of every output at these counts; NaN for a kinked one, for which nothing is claimed.
    affine : tuple of str
        Inputs in which every output is affine.
    extrapolated : tuple of str
        Inputs with more levels than the pilot had, so that a rate was trusted; a larger pilot there would be evidence.
    kinked : dict of str to tuple of str
        Outputs whose coefficients do not decay geometrically, and the inputs along which.
    decay : Dataset
        `coefficient` over (`output`, `input`, `mode`): largest Chebyshev coefficient along an input over all pilot
        lines, over the output's range (NaN beyond the pilot's levels); `rate` over (`output`, `input`): fitted factor
        from one coefficient to the next; `interpolation_error` over (`output`, `input`): the part of the predicted
        error.
    """

    counts: dict[str, int]
    cases: int
    tolerance: float
    error: dict[str, float]
    affine: tuple[str, ...]
    extrapolated: tuple[str, ...]
    kinked: dict[str, tuple[str, ...]]
    decay: xr.Dataset


def choose_levels(
    pilot: xr.Dataset,
    inputs: Sequence[Input],
    tolerance: float,
    budget: int,
    outputs: Sequence[str] | None = None,
) -> LevelChoice:
    """Choose the smallest factorial that is predicted to reach a tolerance.

    Parameters
    ----------
    pilot : Dataset
        Complete factorial on Chebyshev-Gauss levels of `inputs`. An input needs 3 levels to be found affine and at
        least 8 to be told from a kink; 9 or more for all others is a good pilot.
    inputs : sequence of Input
        The box.
    tolerance : float
        Largest error over the range of every output, > 0.
    budget : int
        Most cases.
    outputs : sequence of str, optional
        Outputs that must reach the tolerance, by default all.

    Raises
    ------
    UnreachableError
        The tolerance needs more cases than the budget, or is below the noise of the pilot; the message says which
        counts would reach it, or what the budget reaches.
    ValueError
        A bad pilot, tolerance or budget, or no output that decays.
    """
    if not tolerance > 0 or budget < 1:
        raise ValueError(f"tolerance {tolerance} and budget {budget} must be positive")
    data = complete_factorial(pilot, inputs, outputs, chebyshev=True)
    names = [one.name for one in data.inputs]
    lines = {name: _lines(values) for name, values in data.outputs.items()}
    found = {name: [decay_of(one) for one in each] for name, each in lines.items()}
    kinked = {
        name: tuple(i for i, decay in zip(names, each, strict=True) if decay.algebraic) for name, each in found.items()
    }
    kinked = {name: where for name, where in kinked.items() if where}
    claimed = {name: each for name, each in found.items() if name not in kinked}
    if not claimed:
        raise ValueError(f"no output decays geometrically, so no tolerance can be met: {', '.join(kinked)}")
    counts = _smallest(list(claimed.values()), tolerance)
    if counts is None or int(np.prod(counts)) > budget:
        raise UnreachableError(_unreachable(names, claimed, counts, tolerance, budget))
    error = {name: sum(d.error(n) for d, n in zip(each, counts, strict=True)) for name, each in claimed.items()}
    affine = tuple(i for k, i in enumerate(names) if all(each[k].affine for each in found.values()))
    return LevelChoice(
        counts=dict(zip(names, counts, strict=True)),
        cases=int(np.prod(counts)),
        tolerance=tolerance,
        error={name: error.get(name, float("nan")) for name in found},
        affine=affine,
        extrapolated=tuple(i for i, n, known in zip(names, counts, data.levels, strict=True) if n > len(known)),
        kinked=kinked,
        decay=_evidence(names, found, counts),
    )


def _lines(values: Array) -> list[Array]:
    """Largest Chebyshev coefficient along every axis over all lines of the factorial, over the range of the values."""
    spread = float(np.ptp(values))
    size = spread if spread > 0 else 1.0
    largest = []
    for axis, n in enumerate(values.shape):
        basis, weights = cosine_basis(n)
        along = np.moveaxis(values, axis, -1) @ (basis * weights)
        largest.append(np.abs(along).reshape(-1, n).max(axis=0) / size)
    return largest


def _smallest(decays: Sequence[Sequence[Decay]], tolerance: float) -> list[int] | None:
    """Level counts of few cases with every output's summed error within the tolerance, None where there are none."""
    factors = range(len(decays[0]))
    active = max(1, sum(any(not each[k].affine for each in decays) for k in factors))
    counts = []
    for k in factors:
        each = [one[k] for one in decays]
        enough = (n for n in range(2, MOST_LEVELS) if max(one.error(n) for one in each) <= tolerance / active)
        count = next(enough, None)
        if count is None:
            return None
        counts.append(count)
    # equal shares are wasteful: take levels away where that saves most, while the sum of the errors allows
    while True:
        for k in sorted(factors, key=lambda k: counts[k]):
            fewer = [n - (j == k) for j, n in enumerate(counts)]
            if fewer[k] >= 2 and _error(decays, fewer) <= tolerance:
                counts = fewer
                break
        else:
            return counts


def _error(decays: Sequence[Sequence[Decay]], counts: Sequence[int]) -> float:
    return max(sum(one.error(n) for one, n in zip(each, counts, strict=True)) for each in decays)


def _unreachable(
    names: Sequence[str],
    claimed: Mapping[str, Sequence[Decay]],
    counts: list[int] | None,
    tolerance: float,
    budget: int,
) -> str:
    decays = list(claimed.values())
    low, high = np.log(tolerance), 0.0
    for _ in range(40):
        middle = (low + high) / 2
        tried = _smallest(decays, float(np.exp(middle)))
        low, high = (low, middle) if tried is not None and np.prod(tried) <= budget else (middle, high)
    reached = _smallest(decays, float(np.exp(high)))
    if reached is not None and np.prod(reached) <= budget:
        offer = f"{budget:,} cases reach about {np.exp(high):.1e} with {_text(names, reached)}"
    else:
        offer = f"{budget:,} cases do not even reach 1"
    if counts is None:
        worst = max(claimed, key=lambda name: sum(one.error(MOST_LEVELS) for one in claimed[name]))
        return f"tolerance {tolerance:g} is out of reach for output {worst!r}, which is too noisy or rough; {offer}"
    needed = f"{int(np.prod(counts)):,} cases ({_text(names, counts)})"
    return f"tolerance {tolerance:g} needs {needed}, the budget is {budget:,}; {offer}"


def _text(names: Sequence[str], counts: Sequence[int]) -> str:
    return " x ".join(f"{count} {name}" for name, count in zip(names, counts, strict=True))


def _evidence(names: Sequence[str], found: Mapping[str, Sequence[Decay]], counts: Sequence[int]) -> xr.Dataset:
    modes = max(len(one.coefficients) for each in found.values() for one in each)
    coefficients = np.full((len(found), len(names), modes), np.nan)
    for p, each in enumerate(found.values()):
        for k, one in enumerate(each):
            coefficients[p, k, : len(one.coefficients)] = one.coefficients
    table = [[one.rate for one in each] for each in found.values()]
    errors = [[one.error(n) for one, n in zip(each, counts, strict=True)] for each in found.values()]
    return xr.Dataset(
        {
            "coefficient": (("output", "input", "mode"), coefficients, {"long_name": "largest coefficient over range"}),
            "rate": (("output", "input"), np.array(table), {"long_name": "factor from one coefficient to the next"}),
            "interpolation_error": (("output", "input"), np.array(errors), {"long_name": "predicted error over range"}),
        },
        coords={"output": list(found), "input": list(names), "mode": np.arange(modes)},
    )
