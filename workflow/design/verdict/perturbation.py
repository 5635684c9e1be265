"""What small errors in building a design cost: elasticities, and the loss and the margins after an error of 1 %."""

import numpy as np

from approximation.arrays import Array
from workflow.design.question import budget
from workflow.design.question.question import Question
from workflow.design.question.sources import Exact, Source
from workflow.design.verdict.variable import Sensitivity
from workflow.language.factors import FACTORS

_STEP = 1e-3  # relative step of elasticities
_ERROR = 0.01  # relative error in building a variable
_SHARES = 1 + np.array([-_STEP, _STEP, -_ERROR, _ERROR])
_NOTHING = 1e-9  # share of the goal that counts as no change


def sensitivities(design: Question, exact: Array) -> dict[str, Sensitivity]:
    """Elasticity of every term, and what a 1 % error costs, for every continuous variable that is not zero.

    By differences on what stands for the exact solver.
    """
    source = budget.affordable(design)
    varied = _varied(design, source)
    # of draws the few of the search: what they lack is added to all alike
    sets = {key: design.searched[key] if key is True else chosen for key, chosen in design.judged.items()}
    counts = design.at_variables(varied).count(source, sets)
    counts += exact - counts[0]
    around = counts[1:].reshape(len(varied), len(_SHARES), len(exact))
    largest = np.abs(around).max((0, 1), initial=0.0)
    return {
        name: _effects(design, values[0], values[1 + 4 * k : 5 + 4 * k], counts[0], around[k], largest)
        for k, (name, values) in enumerate(varied.items())
        if values[0] != 0  # which has no 1 % of it
    }


def _varied(design: Question, source: Source) -> dict[str, Array]:
    """Variables at the design, then one after another moved by the shares, (1 + 4 d,) each."""
    count = 1 + len(_SHARES) * len(design.variables)
    varied = {name: np.full(count, nominal) for name, (nominal,) in design.variables.items()}
    for k, (name, values) in enumerate(varied.items()):
        # the surrogate, where it stands in, knows no case beyond its box
        factor = FACTORS[name]
        low, high = (factor.low, factor.high) if isinstance(source, Exact) else design.room(name)
        values[1 + 4 * k : 5 + 4 * k] = np.clip(values[0] * _SHARES, low, high)
    return varied


def _effects(
    question: Question, nominal: float, moved: Array, here: Array, around: Array, largest: Array
) -> Sensitivity:
    """Of one variable about its own value: what the terms count as there, (terms,), and moved, (4, terms)."""
    # a share of what is next to zero says nothing
    whole = np.where(np.abs(here) > _NOTHING * largest, here, np.nan)
    change = (moved[1] - moved[0]) / nominal
    with np.errstate(divide="ignore", invalid="ignore"):
        elasticity = (around[1] - around[0]) / whole / change if change else np.full(len(here), np.nan)
    wanted, erred = question.objectives, around[2:]
    loss = max(float((question.terms[0].sign * (here[0] - erred[:, 0])).max()), 0.0)
    same = np.abs(erred - here) <= _NOTHING * np.maximum(np.abs(here), largest)
    margins = [-term.oriented(erred[:, k]) for k, term in enumerate(question.terms) if term.limited]
    return Sensitivity(
        elasticity=tuple(elasticity.tolist()),
        cost=float(loss / abs(whole[0])),
        loss=loss,
        matters=not np.all(same[:, :wanted]),
        margin_left=float(np.min(margins)) if margins else np.nan,
    )
