"""Figures of a device at a design: signal, noise and drive over its scenarios, and the load at its first limit."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver.face.refusal import FactorError
from workflow.design.asking.designs import Designs
from workflow.language import grammar, titles
from workflow.language.constants import CONSTANTS, FIGURES
from workflow.language.expressions import Expression
from workflow.language.factors import FACTORS
from workflow.language.numbers import number, shown

Array = NDArray[np.float64]

_LOADS = 33  # of one search, which is refined
_REFINED = 3
_SAME = 1.005  # share of the load that is as good as none more
#: How far a load is raised in search of the first limit.
MOST_LOAD = 10.0


def over(design: Designs, corner: Mapping[str, Array]) -> xr.Dataset:
    """Least and largest value of every figure that the study's device has.

    Parameters
    ----------
    design
        One design.
    corner
        Its quantities, exactly, over the scenarios of the verdict or the search, (1, scenarios) each.

    Returns
    -------
    xarray.Dataset
        ``figure_low`` and ``figure_high`` over ``figure``; nothing for a study without a device.
    """
    study = design.question.study
    if study.device is None:
        return xr.Dataset()
    rows: dict[str, tuple[float, float]] = {}
    for name in FIGURES:
        values = _figure(design, corner, grammar.parse(name))
        if values is not None:
            rows[name] = (float(values.min()), float(values.max()))
    ends = {f"figure_{end}": ("figure", [row[k] for row in rows.values()]) for k, end in enumerate(("low", "high"))}
    return xr.Dataset(ends, coords={"figure": list(rows)})


def _figure(design: Designs, corner: Mapping[str, Array], expression: Expression) -> Array | None:
    """A figure's values over the scenarios; None where something of it is not known."""
    question = design.question
    known: dict[str, Array] = {}
    for name in expression.names():
        if name in corner:
            known[name] = corner[name]
        elif name in CONSTANTS:
            try:
                known[name] = np.full((1, 1), question.study.constant(name))
            except ValueError:
                return None
        elif name in FACTORS:
            factors, held = design.factors_of(corner["contact_trailing"]), question.study.held(name)
            if name not in factors and not isinstance(held, float | int):
                return None
            known[name] = factors[name] if name in factors else np.full((1, 1), float(held or 0.0))
        else:
            return None
    return expression.evaluate(known)


def first_limit(design: Designs, worst: Sequence[Mapping[str, float]]) -> xr.Dataset:
    """How far the load may rise before a limit stops it, all else as in the case that decides that limit.

    Parameters
    ----------
    design
        One design that keeps its limits.
    worst
        The case that decides each term.

    Returns
    -------
    xarray.Dataset
        ``overload``: the load at the first limit over the design's own, at most ``MOST_LOAD``; ``overload_term``: that
        limit, empty where none stops it. Nothing where the load is no factor, or where none is known to stop it and one
        might that no case alone tells.
    """
    limits = [
        (term, case)
        for term, case in zip(design.question.terms, worst, strict=True)
        if term.limited and term.sign > 0 and not term.drawn and not term.along
    ]
    if "load" not in design.question.study.factors or not limits:
        return xr.Dataset()
    least, which = MOST_LOAD, ""
    for term, case in limits:
        low, high = 1.0, least
        for _ in range(_REFINED):
            shares = np.geomspace(low, high, _LOADS)
            factors = {name: np.full((1, 1), value) for name, value in case.items()}
            factors["load"] = case["load"] * shares[:, None]
            try:
                known = design.question.known(design.exact, factors, [term.expression])
            except FactorError:  # a load that no case of this kind bears
                break
            values = np.broadcast_to(term.expression.evaluate(known), (_LOADS, 1))[:, 0]
            beyond = np.flatnonzero(values[1:] > term.bound)
            if not beyond.size:
                break
            low, high = shares[beyond[0]], shares[beyond[0] + 1]
            least, which = float(high), term.label
    if not which and len(limits) < sum(term.limited for term in design.question.terms):
        return xr.Dataset()  # a limit that no one case tells may stop it
    return xr.Dataset({"overload": least, "overload_term": which})


def in_words(answer: xr.Dataset) -> str:
    """Figures of a device in a sentence; empty where there are none."""
    parts = []
    for name in answer["figure"].values if "figure" in answer.dims else []:
        one = answer.sel(figure=name)
        low, high = sorted((float(one["figure_low"]), float(one["figure_high"])), key=abs)
        units = FIGURES[str(name)].units
        ends = dict.fromkeys(shown(end, units, 3) for end in (low, high))
        parts.append(f"{titles.title(str(name))} {' to '.join(ends)}")
    return f"{titles.capital(titles.listed(parts))}." if parts else ""


def range_in_words(answer: xr.Dataset, stops: str) -> str:
    """How far the load may rise, in a sentence, with the dynamic range where noise is known.

    Parameters
    ----------
    answer
        Of one design.
    stops
        The limit that stops it, in words.
    """
    if "overload" not in answer:
        return ""
    share = float(answer["overload"])
    if not stops:
        return f"No limit is met up to {number(MOST_LOAD, 2)} times the load."
    told = f"The load may rise to {number(share, 3)} times its own before {stops} stops it"
    if share < _SAME:
        told = f"The load may not rise: {stops} stops it"
    if "figure" in answer.dims and "dynamic_range" in answer["figure"].values:
        reach = share * float(answer["figure_low"].sel(figure="dynamic_range"))
        told += f": a dynamic range of {number(reach, 2)}"
    return f"{told}."
