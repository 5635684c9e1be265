"""A study whose ranges are wider than its surrogate's: made and learned anew for one question."""

from collections.abc import Mapping
from math import ceil, prod

import numpy as np

from solver.units import written
from surrogate import GaussianProcess, Input
from workflow.dataset import factorial
from workflow.language.factors import FACTORS
from workflow.learning import curves, training
from workflow.study import grouped
from workflow.study import model as studies
from workflow.study.model import Study
from workflow.study.reading import InputError, located
from workflow.study.sections import Axis, Group
from workflow.study.target import Target

_WIDEST = 400_000  # cases of a factorial made for one question
_FINEST = 200  # levels of an axis, at most
_CALIBRATION = 1000  # random cases that calibrate its intervals, at most


def beyond(study: Study, target: Target) -> dict[str, tuple[float, float]]:
    """Factors of which a target asks for values outside the study's ranges: the ranges that hold them too."""
    wider = {}
    for name, axis in study.factors.items():
        values = [value for value in target.values(name) if not isinstance(value, str)]
        low, high = min([axis.low, *values]), max([axis.high, *values])
        if (low, high) != (axis.low, axis.high):
            wider[name] = (low, high)
    return wider


def lines(study: Study, wider: Mapping[str, tuple[float, float]]) -> str:
    """Return the lines of the study to change, in words."""
    parts = []
    for name, (low, high) in wider.items():
        axis = study.factors[name]
        ends = {"low": (low, axis.low), "high": (high, axis.high)}
        parts += [
            f"factors: {name}: {end}: {value:g} (now {f'{present:g} {written(FACTORS[name].units)}'.strip()})"
            for end, (value, present) in ends.items()
            if value != present
        ]
    return f"{study.path}: {'; '.join(parts)}"


def made(study: Study, target: Target, wider: Mapping[str, tuple[float, float]]) -> Study:
    """Return the study with wider ranges, levels in proportion, and those of its outputs that a target needs."""
    if study.open:
        raise InputError(f"design: the ranges are wider than the study's, whose levels are open; {lines(study, wider)}")
    axes = {name: _widened(axis, *wider.get(name, (axis.low, axis.high))) for name, axis in study.factors.items()}
    groups = _groups(study, axes)
    levels = [axis.levels for axis in (groups or axes).values()]
    cases = prod(count or 1 for count in levels) * len(study.combinations)
    if cases > _WIDEST:
        raise InputError(f"design: ranges this wide take {cases} cases, more than {_WIDEST}; {lines(study, wider)}")
    names = [name for name in study.outputs if name in target.names()]
    return studies.remade(
        study,
        factors={name: axis.model_dump(mode="json") for name, axis in axes.items()},
        groups={text: group.model_dump(mode="json") for text, group in groups.items()},
        surrogate={"outputs": names},
        validation=study.validation.model_dump(mode="json")
        | {"calibration": min(study.validation.calibration, _CALIBRATION)},
        design={},
        readout={},
    )


def fitted(study: Study) -> GaussianProcess:
    """A surrogate of a study that was made here, from exact cases."""
    model = training.fit(study, factorial.exact(study, factorial.axes(study), curves=True))
    model.calibrate(curves.training_data(study, factorial.cases(study, "calibration")))
    return model


def _groups(study: Study, factors: Mapping[str, Axis]) -> dict[str, Group]:
    """The groups of a study, as they are written, with levels for wider factors; none of a study without any."""
    if not study.groups:
        return {}
    with located("design: the ranges are wider than the study's"):
        wider = grouped.axes(study.groups, factors, study.numbers)
    groups = {}
    for text, group in study.groups.items():
        name = grouped.product(text).name
        groups[text] = group.model_copy(update={"levels": _levels(study.axes[name], wider[name])})
    return groups


def _widened(axis: Axis, low: float, high: float) -> Axis:
    """An axis over a wider range, with as many levels to its length; in a study with groups these have them."""
    if (low, high) == (axis.low, axis.high):
        return axis
    if axis.scale == "log" and low <= 0:
        raise InputError(f"design: {low:g} must be positive on a log scale")
    wider = axis.model_copy(update={"low": low, "high": high})
    return wider.model_copy(update={"levels": axis.levels and _levels(axis, wider)})


def _levels(axis: Axis, wider: Axis) -> int:
    """Return the number of levels that keeps an axis' density on a wider range."""
    ends = Input("axis", axis.low, axis.high, wider.scale).to_unit(np.array([wider.low, wider.high]))
    return min(ceil((axis.levels or 2) * float(np.ptp(ends)) / 2 - 1e-9), _FINEST)
