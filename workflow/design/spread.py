"""What the uncertain constants of the materials make of a design: to first order, by the exact solver."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver.names import ALL_PEAKS
from workflow.design.designs import Designs
from workflow.design.risk import WorstCase
from workflow.design.sources import Exact
from workflow.design.terms import BINDS, Term
from workflow.language import statements, titles
from workflow.language.numbers import number
from workflow.study import uncertainty
from workflow.study.model import Study
from workflow.study.reading import InputError
from workflow.study.uncertainty import Constant

Array = NDArray[np.float64]

_STEP = 0.1  # of difference quotients, in prior standard deviations: what they leave out is 1e-5 of a derivative
_SMALL = 1e-3  # spread that is not told


def over(design: Designs, worst: Sequence[Mapping[str, float]]) -> xr.Dataset:
    """First-order spread of the terms of one design by the constants of its materials.

    Each constant, a family of them as :mod:`workflow.study.uncertainty` scales it, is moved by itself, up and down by
    a tenth of its prior standard deviation, in the case that decides a term; the design stays as it is. Constants are
    independent a priori, so that their effects add as squares. What a material bears is not moved.

    Parameters
    ----------
    design
        One design.
    worst
        The case that decides each term.

    Returns
    -------
    xarray.Dataset
        ``effect`` over (``term``, ``constant``), the relative change of a term by one prior standard deviation;
        ``spread`` over ``term``, the root of the sum of their squares; ``prior`` over ``constant``, in words. NaN for a
        term that counts over distributions, is next to zero, or is searched for in a film. Nothing where no
        constant is uncertain.
    """
    question = design.question
    try:
        constants = uncertainty.uncertain(question.study)
    except InputError:  # a material whose constants follow its composition
        return xr.Dataset()
    effects = np.full((len(question.terms), len(constants)), np.nan)
    told = [k for k, term in enumerate(question.terms) if _tells(question.study, term)]
    terms, cases = [question.terms[k] for k in told], [worst[k] for k in told]
    here = _values(design, question.study, terms, cases)
    for column, one in enumerate(constants):
        ends = [_values(design, _moved(question.study, one, z), terms, cases) for z in (_STEP, -_STEP)]
        with np.errstate(divide="ignore", invalid="ignore"):
            effects[told, column] = (ends[0] - ends[1]) / (2 * _STEP) / here
    effects[~np.isfinite(effects)] = np.nan
    return xr.Dataset(
        {
            "effect": (("term", "constant"), effects),
            "spread": ("term", np.sqrt((effects**2).sum(1))),
            "prior": ("constant", [one.prior for one in constants]),
        },
        coords={"constant": [one.name for one in constants]},
    )


def _tells(study: Study, term: Term) -> bool:
    """Whether one case tells what a term counts as, in less than seconds for every constant."""
    searched = study.kind.tabled and not ALL_PEAKS.keys().isdisjoint(term.expression.names())
    return isinstance(term.measure, WorstCase) and not searched


def _moved(study: Study, one: Constant, z: float) -> Study:
    return uncertainty.moved(study, [one], np.array([z]))


def _values(design: Designs, study: Study, terms: Sequence[Term], cases: Sequence[Mapping[str, float]]) -> Array:
    """Each term in its own case, with the constants of a study; (terms,)."""
    factors = {name: np.array([[case[name]] for case in cases]) for name in (cases[0] if cases else {})}
    known = design.question.known(Exact(study), factors, [term.expression for term in terms])
    values = [np.broadcast_to(term.expression.evaluate(known), (len(terms), 1)) for term in terms]
    return np.array([rows[place, 0] for place, rows in enumerate(values)])


def in_words(answer: xr.Dataset) -> str:
    """What the spread of the constants makes of a design, in a sentence; empty where nothing is known of it."""
    if "spread" not in answer:
        return ""
    goal = answer.isel(term=0)
    if not float(goal["spread"]) > _SMALL:
        return ""
    by = np.abs(goal["effect"].values)
    most = str(answer["constant"].values[int(np.nanargmax(by))])
    prior = str(answer["prior"].sel(constant=most).item()).replace("+-", "± ")
    parts = [f"the goal by {_percent(goal['spread'])} (most by {most}, {prior})"]
    for name in answer["term"].values:
        one = answer.sel(term=name)
        if float(one["limit"]) == float(one["limit"]) and float(one["spread"]) > _SMALL:
            binds = " (it binds: with other constants it may be broken)" if abs(float(one["margin"])) < BINDS else ""
            parts.append(f"{titles.limited(statements.limit(str(name)))} by {_percent(one['spread'])}{binds}")
    how = "one standard deviation: what published values differ by, 5 % at least; to first order"
    return f"The spread of the materials' constants ({how}) moves {titles.listed(parts)}."


def short(answer: xr.Dataset) -> str:
    """The same of the goal alone; empty where nothing is known of it."""
    if "spread" not in answer or not float(answer["spread"][0]) > _SMALL:
        return ""
    return f"The spread of the materials' constants moves it by {_percent(answer['spread'][0])}."


def _percent(share: xr.DataArray) -> str:
    return f"± {number(100 * float(share), 2)} %"
