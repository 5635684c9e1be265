"""Similar cases: the rule by which all cases of a study with groups follow from its stored ones (`representatives`)."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import xarray as xr

from approximation.arrays import Array, Indices
from approximation.sobol import sobol_points
from solver import solve
from solver.similarity import QUANTITY_WEIGHTS, scale_powers
from surrogate import Group, Grouping, Input, Scaling
from surrogate.levels.counts import decays
from surrogate.transforms.groups import Scales
from workflow.study.categories import Combination, output
from workflow.study.datum import inner, length
from workflow.study.model import Study
from workflow.study.reading import InputError

_GAIN = 0.5  # share of the predicted error below which a logarithm is learned
_LEAST = 1e-8  # least error of a process over the range of its values, however fast coefficients fall
_PLACES = 512  # points of the box at which errors are compared
#: Lengths by which a case is scaled, the first that it has; a cone has its slope, which no length changes.
_LENGTHS = ("thickness", "radius", "width", "datum", "slope")


def grouping(
    study: Study, inputs: Sequence[Input], axes: Sequence[Input], weights: Mapping[str, str] | None = None
) -> Grouping:
    """Return the rule by which outputs follow from the quantities learned over groups."""
    names = [input_.name for input_ in inputs]
    groups = tuple(_group(study, axis, names) for axis in axes)
    scalings = (
        {name: Scaling(scale(study, weight)) for name, weight in weights.items()}
        if weights is not None
        else {
            output(name, combination): Scaling(scale(study, name), _coefficient(study, name, combination))
            for combination in study.combinations
            for name in study.outputs
        }
    )
    added = {name: -power for name, power in scale(study, study.kind.ends[0]).items()}
    used = any(scaling.coefficient for scaling in scalings.values())
    return Grouping(tuple(inputs), groups, scalings, added if used else {}, inner(study))


def _group(study: Study, axis: Input, names: Sequence[str]) -> Group:
    """Return an axis as a group of the surrogate: powers of its inputs, and the product of the fixed factors."""
    if axis.name not in study.products:
        return Group(axis, {axis.name: 1.0})
    powers = study.products[axis.name].powers
    fixed = [study.numbers[name] ** power for name, power in powers.items() if name not in names]
    return Group(axis, {name: float(power) for name, power in powers.items() if name in names}, float(np.prod(fixed)))


def with_logarithms(grouping: Grouping, study: Study, learned: xr.Dataset) -> Grouping:
    """Return the grouping with logarithms of the outputs that the study names, or whose coefficients decay faster."""
    names_in_study = study.surrogate.log
    names = [
        output(name, combination)
        for combination in study.combinations
        for name in study.outputs
        if names_in_study is None or name in names_in_study
    ]
    signs = {name: _sign(learned[name].values) for name in names}
    for name, sign in signs.items():
        if names_in_study is not None and not sign:
            low, high = float(learned[name].min()), float(learned[name].max())
            raise InputError(
                f"{study.path}: surrogate: log: {name!r} is from {low:g} to {high:g}: no logarithm of what changes sign"
            )
    possible = {name: sign for name, sign in signs.items() if sign and not grouping.scalings[name].coefficient}
    logs = _replaced(grouping, possible)
    if names_in_study is None:
        plain, log = (_errors(rule, learned, list(possible)) for rule in (grouping, logs))
        logs = _replaced(grouping, {name: sign for name, sign in possible.items() if log[name] < _GAIN * plain[name]})
    return logs


def _sign(values: Array) -> int:
    return int(np.sign(values.flat[0])) if (values > 0).all() or (values < 0).all() else 0


def _replaced(grouping: Grouping, signs: Mapping[str, int]) -> Grouping:
    scalings = {name: replace(scaling, logarithm=signs.get(name, 0)) for name, scaling in grouping.scalings.items()}
    return replace(grouping, scalings=scalings)


def _errors(grouping: Grouping, learned: xr.Dataset, names: Sequence[str]) -> dict[str, float]:
    """Return the predicted error of every output over its range in the box, where its scale may span decades."""
    if not names:
        return {}
    axes = {axis.name: learned[axis.name] for axis in grouping.axes}
    data = grouping.reduced(learned, names).assign_coords(axes)
    scales, nearest, errors = *_within(grouping, learned, names), dict[str, float]()
    for number, (name, along) in enumerate(decays(data, grouping.axes, names).items()):
        values, sign, scale_ = data[name].transpose(*axes).values, grouping.scalings[name].logarithm, scales[number]
        outputs = (sign * np.exp(sign * values) if sign else values)[nearest] * scale_
        # an error of the logarithm is one of the output, relative
        size = np.abs(outputs) if sign else scale_
        error = max(sum(line.error(len(line.coefficients)) for line in along.values()), _LEAST) * np.ptp(values)
        errors[name] = float(error * size.max() / (np.ptp(outputs) or 1.0))
    return errors


def _within(grouping: Grouping, learned: xr.Dataset, names: Sequence[str]) -> tuple[Array, tuple[Indices, ...]]:
    """Return scales of outputs at points of the box, (output, point), and the nearest level of every axis."""
    unit = 2 * sobol_points(_PLACES, len(grouping.inputs)).T - 1
    points = np.stack([input_.from_unit(t) for input_, t in zip(grouping.inputs, unit, strict=True)], -1)
    group_values = grouping.axis_values(points)
    levels = [learned[axis.name].values for axis in grouping.axes]
    nearest = tuple(np.abs(along[:, None] - x).argmin(0) for along, x in zip(levels, group_values.T, strict=True))
    return Scales(grouping, names).values(points), nearest


def scale(study: Study, quantity: str) -> dict[str, float]:
    """Return the powers of a load and a length that a quantity is proportional to at the same groups."""
    if QUANTITY_WEIGHTS[quantity] == QUANTITY_WEIGHTS["pressure_exponent"]:
        return {}
    known = {*study.factors, *study.fixed, *(["thickness"] if study.body else [])}
    known |= set() if study.kind.datum == "absolute" else {"datum"}
    length = next(name for name in _LENGTHS if name in known)
    powers = scale_powers(quantity, study.kind.loads.force, length)
    return {name: power for name, power in powers.items() if name in study.factors and power}


def _coefficient(study: Study, name: str, combination: Combination) -> float:
    """Return the factor of the datum's logarithm in a quantity that groups decide up to the datum."""
    datum = length(study)
    if name not in study.added or datum is None:
        return 0.0
    case = {**{key: value for key, value in study.fixed.items() if key != "datum"}, **inner(study), **combination}
    values = study.solved(solve, {**case, "datum": datum * np.array([1.0, np.e])})[name].values
    return float(values[1] - values[0])
