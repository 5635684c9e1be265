"""A case that the solver refuses, found among many and named."""

from collections.abc import Callable, Mapping
from typing import Any

import xarray as xr

from solver import FactorError
from workflow.language.factors import FACTORS
from workflow.study.model import Study
from workflow.study.refusals import labelled


def named(
    study: Study, solved: Callable[[Mapping[str, Any]], object], factors: Mapping[str, Any], reason: FactorError
) -> FactorError:
    """Return the refusal of one case among many, with the factors and categories that tell it from others.

    It is looked for by halves, which takes twice as long as all cases together.

    Parameters
    ----------
    study
        The study.
    solved
        Solves cases by their factors; raises FactorError.
    factors
        Those of the cases, of which one is refused: numbers, names, sequences along themselves, labelled arrays.
    reason
        What the solver says to all of them.
    """
    cases = {name: labelled(name, value) for name, value in factors.items()}
    while (half := _half(solved, cases)) is not None:
        cases, reason = half
    if any(array.size > 1 for array in cases.values()):  # they are refused together only
        return reason
    given = [
        f"{name} = {cases[name].item():.6g} {FACTORS[name].units}".removesuffix(" 1") if name in study.factors
        else f"{name} = {cases[name].item()}"
        for name in (*study.factors, *study.categories)
        if name in cases
    ]  # fmt: skip
    return type(reason)(f"{reason}; the case is {', '.join(given)}") if given else reason


def _half(
    solved: Callable[[Mapping[str, Any]], object], cases: Mapping[str, xr.DataArray]
) -> tuple[dict[str, xr.DataArray], FactorError] | None:
    """The half of the cases along their longest dimension that is refused, and why; None where there is none."""
    sizes = {dim: size for array in cases.values() for dim, size in array.sizes.items() if size > 1}
    if not sizes:
        return None
    longest = max(sizes, key=lambda dim: sizes[dim])
    middle = sizes[longest] // 2
    for some in (slice(None, middle), slice(middle, None)):
        half = {name: array.isel({longest: some}, missing_dims="ignore") for name, array in cases.items()}
        try:
            solved(half)
        except FactorError as error:
            return half, error
    return None
