"""All designs of a study together: one data set, one table."""

import csv
import io

import numpy as np
import xarray as xr

from storage.described import described
from workflow.language.factors import FACTORS

_LOCAL = ("map_x", "map_y", "slice", "step", "front", "choice", "position", "x", "y")  # what only pictures need

SOURCE = "meecontact: search on a Gaussian process, polished and judged on the closed-form solution"
SOURCE_OF_FILMS = "meecontact: search on a Gaussian process, judged on the exact solver of films"
_MEANINGS = {
    "target": "name of a design target",
    "factor": "name of a factor",
    "term": "objective or limit",
    "quantity": "name of a quantity",
    "category": "name of a category",
    "goal": "what is asked for",
    "value": "factor of the design, over its SI unit",
    "tolerance": "how far the factor may be off as built",
    "tolerance_cost": "share of the goal that is gained without this one tolerance",
    "tolerance_gain": "share of the goal that is gained by half of this one tolerance",
    "nominal_value": "factor of the optimum without tolerances, over its SI unit",
    "nominal_exact": "exact goal of the optimum without tolerances, over its unit in units",
    "nominal_choice": "categories of the optimum without tolerances",
    "figure": "name of a figure of a device",
    "figure_low": "least exact value of the figure over the scenarios, over its SI unit",
    "figure_high": "largest exact value of the figure over the scenarios, over its SI unit",
    "overload": "load at the first limit over the design's own",
    "overload_term": "the limit that stops the load; empty where none does up to ten times the load",
    "constant": "an uncertain constant of a material, or a family of them",
    "prior": "standard deviation of the constant",
    "effect": "relative change of the term by one standard deviation of the constant",
    "spread": "standard deviation of the term by all uncertain constants, over the term; to first order",
    "role": "what the factor is in the design",
    "predicted": "predicted term, over its unit in units",
    "predicted_std": "predicted standard deviation of the term, over its unit in units",
    "half": "half of the interval of the predicted term, over its unit in units",
    "exact": "exact term, over its unit in units",
    "inside": "whether the exact term lies inside the predicted interval",
    "limit": "limit of the term, over its unit in units",
    "margin": "share of the limit that is left; negative beyond it",
    "units": "unit of the term",
    "bound": "what of a material the limit is, if it names that",
    "source": "where that comes from",
    "beyond": "what is beyond what the materials bear: linear theory does not hold there",
    "worst": "factor in the scenario that decides the term, over its SI unit",
    "exact_low": "least exact quantity over the scenarios, over its SI unit",
    "exact_high": "largest exact quantity over the scenarios, over its SI unit",
    "feasible": "whether the design keeps every limit",
    "status": "what binds or is violated",
    "flags": "what else is to be known of the design",
    "elasticity": "relative change of the term for a relative change of the factor",
    "cost": "share of the objective lost by an error of 1 % in the factor",
    "loss": "what an error of 1 % in the factor takes from the objective, over its unit in units",
    "edge": "which end of its range the factor stands at, if any",
    "matters": "whether an error of 1 % in the factor changes any objective",
    "margin_left": "least margin of all limits after an error of 1 % in the factor",
    "kind": "what was chosen of the category",
    "kind_role": "whether the category was chosen or given",
}
_PICTURES = {
    "map_x": "first variable of the design map, over its SI unit",
    "map_y": "second variable of the design map, over its SI unit",
    "map_objective": "predicted objective on the design map, over its unit in units",
    "map_excess": "largest predicted excess over any limit on the design map, over the limit",
    "slice": "variable of a slice through the design",
    "step": "step along a slice",
    "slice_value": "variable along a slice, over its SI unit",
    "slice_objective": "predicted objective along a slice, over its unit in units",
    "slice_excess": "largest predicted excess over any limit along a slice, over the limit",
    "slice_low": "lower end of the interval of the objective along a slice, over its unit in units",
    "slice_high": "upper end of the interval of the objective along a slice, over its unit in units",
    "position": "surface position X = (x - c)/h, in half-lengths from the middle of the contact",
    "x": "position (x - c)/h below the punch, in half-lengths from the middle of the contact",
    "y": "height above the surface, in half-lengths of the contact",
    "choice": "a choice of categories, in words",
    "choice_objective": "best objective of a choice, over its unit in units",
    "choice_feasible": "whether a choice keeps every limit",
    "front": "a design of the Pareto front",
    "objective": "an objective of the Pareto front",
    "front_exact": "exact objective of a design of the front, over its unit in units",
    "front_predicted": "predicted objective of a design of the front, over its unit in units",
    "front_value": "factor of a design of the front, over its SI unit",
}


def together(answers: list[xr.Dataset]) -> xr.Dataset:
    """All designs over ``target``; what a target has not is missing there."""
    kept = [
        answer.drop_dims(_LOCAL, errors="ignore").assign(goal=str(answer.attrs["goal"])).drop_attrs()
        for answer in answers
    ]
    whole = xr.concat(kept, dim="target", join="outer", data_vars="all", fill_value=_missing(kept))
    return described(whole, "designs", str(answers[0].attrs["source"]), _MEANINGS)


def entire(answer: xr.Dataset) -> xr.Dataset:
    """An answer in which every variable says what it is."""
    fields = {
        str(name): f"{str(name).partition('_')[2].replace('_', ' ')} under the recommended design"
        for name in answer.data_vars
        if str(name).startswith(("field_", "inside_"))
    }
    return described(answer, str(answer.attrs["title"]), str(answer.attrs["source"]), _MEANINGS | _PICTURES | fields)


def kinds(answer: xr.Dataset) -> list[tuple[str, str, str]]:
    """Name, what was chosen, and role of every category of a design."""
    if "category" not in answer.dims:
        return []
    columns = (answer[key].values for key in ("category", "kind", "kind_role"))
    return [(str(name), str(kind), str(role)) for name, kind, role in zip(*columns, strict=True)]


def case(answer: xr.Dataset) -> dict[str, float]:
    """Every factor in the case that decides the first objective, the variables without their tolerances."""
    worst, value = (answer[key].values for key in ("worst", "value"))
    rows = zip(answer["factor"].values, answer["role"].values, worst[0], value, strict=True)
    return {str(name): float(own if role == "variable" else deciding) for name, role, deciding, own in rows}


def choices(answer: xr.Dataset) -> list[tuple[str, float, bool]]:
    """Every choice in words, its best objective on the surrogate, and whether that is feasible."""
    if "choice" not in answer.dims:
        return []
    columns = (answer[key].values for key in ("choice", "choice_objective", "choice_feasible"))
    return [(str(name), float(value), bool(feasible)) for name, value, feasible in zip(*columns, strict=True)]


def _missing(answers: list[xr.Dataset]) -> dict[str, object]:
    """What stands where a target has no such term or factor."""
    types = {str(name): array.dtype.kind for answer in answers for name, array in answer.data_vars.items()}
    return {name: "" if code in "UOT" else False if code == "b" else np.nan for name, code in types.items()}


def table(answers: list[xr.Dataset]) -> str:
    """The designs as CSV: one row a category, then one a factor, one a term, and the status."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(
        ["target", "kind", "name", "units", "predicted", "predicted_std", "exact", "limit", "margin", "inside"]
    )
    for answer in answers:
        target = str(answer["target"].values)
        for name, kind, role in kinds(answer):
            rows.writerow([target, role, name, "", "", "", kind, "", "", ""])
        for name in answer["factor"].values:
            one = answer.sel(factor=name)
            cells = ["", "", float(one["value"]), "", "", ""]
            rows.writerow([target, str(one["role"].values), name, FACTORS[name].units, *cells])
        for name in answer["term"].values:
            one = answer.sel(term=name)
            numbers = [float(one[key]) for key in ("predicted", "predicted_std", "exact", "limit", "margin")]
            shown = ["" if np.isnan(number) else number for number in numbers]
            kind = "limit" if np.isfinite(float(one["limit"])) else "objective"
            rows.writerow([target, kind, name, str(one["units"].values), *shown, int(one["inside"])])
        for kind in ("status", "flags"):
            rows.writerow([target, kind, str(answer[kind].values), *[""] * 7])
    return text.getvalue()
