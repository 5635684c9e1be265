"""The factorial of a study: its axes, its exact cases, and random cases in the same box."""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from solver import FactorError, solve, solve_curves
from solver.names import ALL_QUANTITIES
from surrogate import Grouping, Input, chebyshev_levels
from surrogate.data.points import EVEN
from workflow.dataset import draws, similar
from workflow.dataset.casecache import CaseCache, labelled, selected, sizes
from workflow.language.factors import FACTORS
from workflow.study import categories, representatives
from workflow.study.model import Study

#: Samples of random exact cases by purpose: the number of their seed, and the key of their size.
SAMPLES = {"validation": (0, "cases"), "calibration": (2, "calibration")}


def inputs(study: Study) -> list[Input]:
    """Return the factors as inputs of a surrogate."""
    return [
        Input(name, axis.low, axis.high, axis.scale, FACTORS[name].units, FACTORS[name].long_name)
        for name, axis in study.factors.items()
    ]


def axis_inputs(study: Study) -> list[Input]:
    """Return the axes of the data set, factors or groups, as inputs of a surrogate."""
    if not study.groups:
        return inputs(study)
    products = study.products
    return [
        Input(name, axis.low, axis.high, axis.scale, products[name].units, products[name].long_name)
        for name, axis in study.axes.items()
    ]


def grouping(study: Study, learned: xr.Dataset | None = None) -> Grouping:
    """Return the relation of learned quantities to a study's groups; logarithms need the factorial."""
    plain = similar.grouping(study, inputs(study), axis_inputs(study))
    lacks_factorial = study.crossed and study.surrogate.log is None
    return plain if learned is None or lacks_factorial else similar.with_logarithms(plain, study, learned)


def scaled(study: Study, data: xr.Dataset, by: Grouping | None) -> xr.Dataset:
    """Return the learned data over the axes: the outputs, or with groups the outputs over their scales."""
    if by is None:
        return data
    coordinates = {name: data[name] for name in study.axes}
    return by.reduced(with_factors(study, data), [str(name) for name in data.data_vars]).assign_coords(coordinates)


def with_factors(study: Study, data: xr.Dataset) -> xr.Dataset:
    """Return cases over the axes of a study with the factors of each as coordinates."""
    axes = {name: xr.DataArray(data[name].variable) for name in study.axes}
    return data.assign_coords(representatives.factors(study, axes))


def axes(study: Study) -> dict[str, np.ndarray[Any, np.dtype[Any]]]:
    """Return the axes of the data set: the levels of every factor, then the names of every category."""
    return levels(study) | {name: np.array(names) for name, names in study.categories.items()}


def training_data(study: Study, data: xr.Dataset) -> xr.Dataset:
    """Return cases as the surrogate learns them: every output over the continuous factors or ``case`` alone."""
    return categories.apart(data, study.categories, study.outputs)


def levels(study: Study) -> dict[str, np.ndarray[Any, np.dtype[np.float64]]]:
    """Return the levels of every axis of a study without open ones."""
    return {
        name: chebyshev_levels(axis.low, axis.high, axis.levels or 0, axis.scale) for name, axis in study.axes.items()
    }


def cases(study: Study, name: str, cache: CaseCache | None = None) -> xr.Dataset:
    """Return random exact cases of one of `SAMPLES`, over dimension ``case`` and the categories."""
    number, key = SAMPLES[name]
    ends = name == "calibration" and bool(study.groups) and not study.regions
    drawn, even = draws.sample(study, getattr(study.validation, key), (study.validation.seed, number), ends)
    if not ends:  # the surrogate corrects its curves by those of calibration, but not over groups
        return exact(study, drawn, curves=name == "calibration" and not study.groups, cache=cache)
    attributes = {"long_name": "1 where a case is spread evenly over the box, 0 where it is drawn towards its ends"}
    return exact(study, drawn, cache=cache).assign_coords({EVEN: ("case", even, attributes)})


def sample(study: Study, count: int, seed: Sequence[int]) -> xr.Dataset:
    """Return exact quantities of random cases over dimension ``case`` and the categories, see `draws.points`."""
    return exact(study, draws.points(study, count, seed))


def exact(
    study: Study,
    axes: dict[str, Any],
    positions: Iterable[float] | None = None,  # of the surface fields, over the half-width; None: no fields
    *,
    peaks: Collection[str] | None = None,  # largest stresses; None: those that the data set has
    outputs: Collection[str] | None = None,  # quantities; None: those that the data set has, or all
    regular: bool = False,  # whether the regular parts of the surface fields are wanted
    curves: bool = False,  # whether the curves that the surrogate learns are wanted
    cache: CaseCache | None = None,  # of what was solved before
) -> xr.Dataset:
    """Solve cases at values of the axes (SI), for every category; FactorError names a case that is refused."""
    grouped = bool(study.groups) and axes.keys() >= study.products.keys() and not axes.keys() >= study.factors.keys()
    over = list(study.products) if grouped else []
    factors_of_groups = representatives.factors(study, {name: axes[name] for name in over}) if over else {}
    other_axes = {name: values for name, values in axes.items() if name not in over}
    other_axes |= {name: names for name, names in study.categories.items() if name not in axes}
    factors = {**study.fixed_of_cases, **factors_of_groups, **other_axes}

    searched = study.searched if peaks is None else peaks
    quantities = study.asked if outputs is None else outputs

    def whole(cases: Mapping[str, Any]) -> xr.Dataset:
        solved = study.solved(solve, cases, positions, peaks=searched, outputs=quantities, regular=regular)
        if not (curves and study.regions):
            return solved
        along = study.solved(solve_curves, cases, study.regions)
        return solved.merge(along, compat="override", join="exact", combine_attrs="override")

    options: dict[str, Any] = {"peaks": sorted(searched), "outputs": quantities, "regular": regular}
    options |= {"regions": study.regions if curves else []}
    options |= {"positions": None if positions is None else list(map(float, positions))}
    entrance = whole if cache is None else cache.around(study, whole, options)
    try:
        solved = entrance(factors)
    except FactorError as error:
        cases = {name: labelled(name, value) for name, value in factors.items()}
        region, reason = refused_region(entrance, cases, error)
        raise _named(study, {} if region is None else selected(cases, region), reason) from None
    if over:
        along = {name: _axis(study, name, axes[name]) for name in over}
        solved = solved.assign_coords(along).transpose(*dict.fromkeys(axis.dims[0] for axis in along.values()), ...)
    return solved.drop_vars([name for name, quantity in ALL_QUANTITIES.items() if quantity.sparse and name in solved])


def refused_region(
    solved: Callable[[Mapping[str, Any]], object],
    cases: Mapping[str, xr.DataArray],
    reason: Exception,
    refusals: tuple[type[Exception], ...] = (FactorError,),
) -> tuple[dict[str, slice] | None, Exception]:
    """Return region and reason of one refused case, searched by halves; None where only several are refused."""
    region = {dim: slice(0, size) for dim, size in sizes(cases).items()}
    while longest := max(region, key=lambda dim: _length(region[dim]), default=""):
        whole = region[longest]
        if _length(whole) == 1:
            break
        middle = (whole.start + whole.stop) // 2
        for half in (slice(whole.start, middle), slice(middle, whole.stop)):
            try:
                solved(selected(cases, {**region, longest: half}))
            except refusals as error:
                region, reason = {**region, longest: half}, error
                break
        else:
            return None, reason
    return region, reason


def _length(part: slice) -> int:
    return int(part.stop - part.start)


def _named(study: Study, case: Mapping[str, xr.DataArray], reason: Exception) -> Exception:
    """Return the refusal of one case, with its factors and categories."""
    words = [
        f"{name} = {case[name].item():.6g} {FACTORS[name].units}".removesuffix(" 1") if name in study.factors
        else f"{name} = {case[name].item()}"
        for name in (*study.factors, *study.categories)
        if name in case
    ]  # fmt: skip
    return type(reason)(f"{reason}; the case is {', '.join(words)}") if words else reason


def _axis(study: Study, name: str, values: Any) -> xr.Variable:
    """Return the values of a group over their dimension, or over the group itself."""
    product, dim = study.products[name], values.dims if isinstance(values, xr.DataArray) else name
    return xr.Variable(dim, np.asarray(values), {"units": product.units, "long_name": product.long_name})
