"""A study whose ranges are wider than its surrogate's: made and learned anew for one question."""

from collections.abc import Mapping
from math import ceil, log, prod

from surrogate import GaussianProcess
from workflow.dataset import factorial
from workflow.language.factors import FACTORS
from workflow.learning import training
from workflow.study import model as studies
from workflow.study.model import Study
from workflow.study.reading import InputError
from workflow.study.sections import Axis
from workflow.study.target import Target

_MOST = 400_000  # cases of a factorial made for one question
_CALIBRATION = 1000  # random cases that calibrate its intervals, at most


def beyond(study: Study, target: Target) -> dict[str, tuple[float, float]]:
    """Factors of which a target asks for values outside the study's ranges: the ranges that hold them too."""
    wider = {}
    for name, axis in study.factors.items():
        asked = [value for value in target.values(name) if not isinstance(value, str)]
        low, high = min([axis.low, *asked]), max([axis.high, *asked])
        if (low, high) != (axis.low, axis.high):
            wider[name] = (low, high)
    return wider


def lines(study: Study, wider: Mapping[str, tuple[float, float]]) -> str:
    """The lines of the study that would have to be changed, in words."""
    parts = []
    for name, (low, high) in wider.items():
        axis = study.factors[name]
        ends = {"low": (low, axis.low), "high": (high, axis.high)}
        parts += [
            f"factors: {name}: {end}: {value:g} (now {now:g} {FACTORS[name].units})"
            for end, (value, now) in ends.items()
            if value != now
        ]
    return f"{study.path}: {'; '.join(parts)}"


def made(study: Study, target: Target, wider: Mapping[str, tuple[float, float]]) -> Study:
    """The study with wider ranges, and of its outputs what a target asks for.

    The levels of a factor grow with its range, on its own scale.

    Raises
    ------
    InputError
        Ranges in which some case has no solution, or a factorial of too many cases.
    """
    if study.open:
        raise InputError(f"design: the ranges are wider than the study's, whose levels are open; {lines(study, wider)}")
    axes = {name: _widened(axis, *wider.get(name, (axis.low, axis.high))) for name, axis in study.factors.items()}
    cases = prod(axis.levels or 0 for axis in axes.values()) * len(study.combinations)
    if cases > _MOST:
        raise InputError(f"design: ranges this wide take {cases} cases, more than {_MOST}; {lines(study, wider)}")
    names = [name for name in study.outputs if name in target.names()]
    return studies.remade(
        study,
        factors={name: axis.model_dump(mode="json") for name, axis in axes.items()},
        surrogate={"kernel": study.surrogate.kernel, "outputs": names},
        validation=study.validation.model_dump(mode="json")
        | {"calibration": min(study.validation.calibration, _CALIBRATION)},
        design={},
        readout={},
    )


def learned(study: Study) -> GaussianProcess:
    """A surrogate of a study that was made here, from exact cases."""
    model = training.fit(study, factorial.exact(study, factorial.axes(study)))
    model.calibrate(factorial.learned(study, factorial.cases(study, "calibration")))
    return model


def _widened(axis: Axis, low: float, high: float) -> Axis:
    """An axis over a wider range, with as many levels to its length."""
    if (low, high) == (axis.low, axis.high):
        return axis
    if axis.scale == "log" and low <= 0:
        raise InputError(f"design: {low:g} must be positive on a log scale")
    ratio = (high - low) / (axis.high - axis.low)
    if axis.scale == "log":
        ratio = log(high / low) / log(axis.high / axis.low)
    levels = min(ceil((axis.levels or 2) * ratio - 1e-9), 200)
    return axis.model_copy(update={"low": low, "high": high, "levels": levels})
