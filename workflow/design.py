"""Design: the best punch and composite under limits, found on the surrogate and solved again exactly."""

import csv
import io
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver.names import EVERY_QUANTITY, FACTORS
from surrogate import GaussianProcess, Input
from surrogate.optimise import Optimum, Problem, maximise
from workflow import factorial, targets
from workflow.study import Study, Target

Array = NDArray[np.float64]

_SEARCHED = 9  # scenarios a worst-case factor while searching: Chebyshev-Lobatto nodes, both ends among them
_JUDGED = 201  # and while judging the outcome on the exact solver
_MAP = 81  # points a side of the map
_ROUNDS = 6  # searches, each with limits tightened by what the exact solver found beyond them


@dataclass(frozen=True)
class Question:
    """A target of a study in the terms of the optimiser: unit coordinates, scenarios, terms."""

    study: Study
    target: Target

    @property
    def inputs(self) -> dict[str, Input]:
        """The factorial's inputs by name."""
        return {one.name: one for one in factorial.inputs(self.study)}

    @property
    def terms(self) -> list[targets.Term]:
        """Objective first, then the limited terms."""
        return [targets.objective(self.target.maximise), *(limit.term for limit in self.limits)]

    @property
    def limits(self) -> list[targets.Limit]:
        """The limits in the study's order."""
        return [targets.limit(text) for text in self.target.limits]

    def scenarios(self, count: int) -> dict[str, Array]:
        """Values of the worst-case factors in every scenario, (s,) each."""
        nodes = (1 - np.cos(np.pi * np.arange(count) / (count - 1))) / 2
        ranges = {name: low + (high - low) * nodes for name, (low, high) in self.target.worst_case.items()}
        grid = np.array(list(product(*ranges.values())), dtype=np.float64).reshape(-1, len(ranges))
        return {name: grid[:, column] for column, name in enumerate(ranges)}

    def factors(self, x: Array, count: int) -> dict[str, xr.DataArray]:
        """Every factor of the factorial at design points (n, d) in all scenarios, over dims (point, scenario)."""
        given: dict[str, xr.DataArray] = {}
        for column, name in enumerate(self.target.over):
            given[name] = xr.DataArray(self.inputs[name].from_unit(x[:, column]), dims="point")
        for name, values in self.scenarios(count).items():
            given[name] = xr.DataArray(values, dims="scenario")
        for name, value in self.target.at.items():
            given[name] = xr.DataArray(value)
        first = xr.zeros_like(given[self.target.over[0]])
        scenario = next((given[name] for name in self.target.worst_case), xr.DataArray([0.0], dims="scenario"))
        whole = first + xr.zeros_like(scenario)
        return {name: (given[name] + whole).transpose("point", "scenario") for name in self.study.factors}

    def judged(self, values: xr.Dataset) -> Array:
        """Terms of solved or predicted factors: objective and limited terms, (n, s, 1 + k), in SI units."""
        columns = [abs(values[t.quantity]) if t.absolute else values[t.quantity] for t in self.terms]
        return np.stack([column.transpose("point", "scenario").values for column in columns], -1)


def solve_target(study: Study, name: str, model: GaussianProcess) -> xr.Dataset:
    """Answer one design target.

    Parameters
    ----------
    study, name
        The study and the name of its target.
    model
        Surrogate of the study's quantities.

    Returns
    -------
    xarray.Dataset
        The design (``value`` over ``factor``), its terms (``predicted``, ``predicted_std``, ``exact``, ``limit``,
        ``margin`` over ``term``, the objective first), the exact range of every quantity over the scenarios, and a map
        of worst-case objective and excess over the first two variables.
    """
    question = Question(study, study.design[name])
    best = _search(question, model)
    exact = factorial.exact(study, dict(question.factors(best.x[None], _JUDGED)))
    predicted = model.predict(question.factors(best.x[None], _JUDGED))
    out = xr.merge([_verdict(question, best, exact, predicted), _ranges(exact), _map(question, model)])
    out.attrs = {"title": f"design target {name}", "maximise": question.target.maximise}
    return out.assign_coords(target=name)


def _search(question: Question, model: GaussianProcess) -> Optimum:
    """Optimum on the surrogate, the limits tightened until the exact solver finds no excess."""
    limits = np.array([limit.value for limit in question.limits])
    slack = np.zeros(len(limits))
    for _ in range(_ROUNDS):
        best = maximise(_problem(question, model, slack))
        exact = question.judged(factorial.exact(question.study, dict(question.factors(best.x[None], _JUDGED))))
        excess = (exact[0, :, 1:].max(0) - limits) / np.abs(limits)
        if not best.feasible or np.all(excess <= 0):
            break
        slack += np.where(excess > 0, 1.02 * excess + 1e-12, 0.0)
    return best


def _problem(question: Question, model: GaussianProcess, slack: Array) -> Problem:
    """The target on the surrogate: objective as it is, limits as relative excess plus ``slack``."""
    names = list(model.box)
    outputs = list(model.outputs_)
    columns = [outputs.index(term.quantity) for term in question.terms]
    absolute = np.array([term.absolute for term in question.terms])
    limits = np.array([limit.value for limit in question.limits])
    scale = np.concatenate([[1.0], np.abs(limits)])
    over = question.target.over

    def points(x: Array) -> Array:
        factors = question.factors(x, _SEARCHED)
        return np.stack([factors[name].values for name in names], -1)

    def value(x: Array) -> Array:
        where = points(x)
        values = model.predict_array(where.reshape(-1, len(names)))[:, columns].reshape(*where.shape[:2], -1)
        values = np.where(absolute, np.abs(values), values)
        values[..., 1:] = (values[..., 1:] - limits) / np.abs(limits) + slack
        return np.asarray(values)

    def slope(x: Array) -> Array:
        where = points(x[None])[0]
        values = model.predict_array(where)[:, columns]
        named = {name: xr.DataArray(where[:, column], dims="scenario") for column, name in enumerate(names)}
        gradient = model.gradient(named).sel(input=over)
        slopes = np.stack([gradient[outputs[k]].transpose("scenario", "input").values for k in columns], 1)
        slopes = np.where((absolute & (values < 0))[..., None], -slopes, slopes)
        unit = [1 / question.inputs[name].unit_slope(where[0, names.index(name)]) for name in over]
        return np.asarray(slopes * np.array(unit) / scale[:, None])

    return Problem(len(over), value, slope)


def _verdict(question: Question, best: Optimum, exact: xr.Dataset, predicted: xr.Dataset) -> xr.Dataset:
    """The design and its terms, predicted against exact, each in its own worst scenario."""
    solved, guessed = question.judged(exact)[0], question.judged(predicted)[0]
    worst = np.concatenate([solved[:, :1].argmin(0), solved[:, 1:].argmax(0)])
    take = np.arange(worst.size)
    std = np.stack([predicted[f"{term.quantity}_std"].values[0] for term in question.terms], -1)
    limits = np.array([np.nan, *(limit.value for limit in question.limits)])
    margin = (limits - solved[worst, take]) / np.abs(limits)
    factors = {name: array.values[0] for name, array in question.factors(best.x[None], _JUDGED).items()}
    feasible = bool(np.all(margin[1:] >= 0))
    binding = [str(limit) for limit, m in zip(question.limits, margin[1:], strict=True) if m < 1e-3]
    binding += [f"{name} at its end" for name, u in zip(question.target.over, best.x, strict=True) if abs(u) > 1 - 1e-6]
    if feasible:
        status = f"feasible; binding: {', '.join(binding) or 'none'}"
    else:
        tightest = int(np.argmin(margin[1:]))
        share = -100 * margin[1:][tightest]
        status = f"infeasible: {question.limits[tightest]} binds; the least violated design exceeds it by {share:.3g} %"
    return xr.Dataset(
        {
            "value": ("factor", [values[worst[0]] for values in factors.values()]),
            "role": ("factor", [_role(question.target, name) for name in factors]),
            "predicted": ("term", guessed[worst, take]),
            "predicted_std": ("term", std[worst, take]),
            "exact": ("term", solved[worst, take]),
            "limit": ("term", limits),
            "margin": ("term", margin),
            "units": ("term", [EVERY_QUANTITY[term.quantity].units for term in question.terms]),
            "worst": (("term", "factor"), np.array([[values[w] for values in factors.values()] for w in worst])),
            "feasible": feasible,
            "status": status,
        },
        coords={"factor": list(factors), "term": ["objective", *(str(limit) for limit in question.limits)]},
    )


def _role(target: Target, name: str) -> str:
    return "variable" if name in target.over else "worst case" if name in target.worst_case else "given"


def _ranges(exact: xr.Dataset) -> xr.Dataset:
    """Exact range of every quantity over the scenarios."""
    whole = exact[[name for name in EVERY_QUANTITY if name in exact]].to_dataarray("quantity").isel(point=0, drop=True)
    whole = whole.drop_vars([name for name in whole.coords if name != "quantity"])
    return xr.Dataset({"exact_low": whole.min("scenario"), "exact_high": whole.max("scenario")})


def _map(question: Question, model: GaussianProcess) -> xr.Dataset:
    """Worst-case objective and excess on the surrogate over the first two variables, the others at their middle."""
    over = question.target.over
    if len(over) < 2:
        return xr.Dataset()
    side = np.linspace(-1.0, 1.0, _MAP)
    x = np.zeros((_MAP * _MAP, len(over)))
    x[:, 0], x[:, 1] = (grid.ravel() for grid in np.meshgrid(side, side, indexing="ij"))
    values = _problem(question, model, np.zeros(len(question.limits))).value(x)
    shape = (_MAP, _MAP)
    coords: dict[str, Any] = {
        f"map_{axis}": (f"map_{axis}", question.inputs[name].from_unit(side), {"factor": name})
        for axis, name in zip("xy", over[:2], strict=True)
    }
    return xr.Dataset(
        {
            "map_objective": (("map_x", "map_y"), values[..., 0].min(1).reshape(shape)),
            "map_excess": (("map_x", "map_y"), values[..., 1:].max((1, 2), initial=-np.inf).reshape(shape)),
        },
        coords=coords,
    )


def together(answers: list[xr.Dataset]) -> xr.Dataset:
    """All designs over ``target``; what a target has not is missing there."""
    kept = [answer.drop_dims(["map_x", "map_y"], errors="ignore") for answer in answers]
    whole = xr.concat(kept, dim="target", join="outer", data_vars="all", fill_value={"units": "", "role": ""})
    return whole.assign_attrs(title="designs")


def table(answers: list[xr.Dataset]) -> str:
    """The designs as CSV: one row a variable, then one a term."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(["target", "kind", "name", "units", "predicted", "predicted_std", "exact", "limit", "margin"])
    for answer in answers:
        target = str(answer["target"].values)
        for name in answer["factor"].values:
            one = answer.sel(factor=name)
            rows.writerow(
                [target, str(one["role"].values), name, FACTORS[name].units, "", "", float(one["value"]), "", ""]
            )
        for name in answer["term"].values:
            one = answer.sel(term=name)
            numbers = [float(one[key]) for key in ("predicted", "predicted_std", "exact", "limit", "margin")]
            cells = ["" if np.isnan(number) else number for number in numbers]
            kind = "objective" if name == "objective" else "limit"
            label = answer.attrs["maximise"] if name == "objective" else name
            rows.writerow([target, kind, label, str(one["units"].values), *cells])
        rows.writerow([target, "status", str(answer["status"].values), "", "", "", "", "", ""])
    return text.getvalue()
