"""All designs of a study together: one data set, one table."""

import csv
import io

import numpy as np
import xarray as xr

from solver.names import FACTORS

_LOCAL = ("map_x", "map_y", "slice", "step", "front", "choice", "position", "x", "y")  # what only pictures need


def together(answers: list[xr.Dataset]) -> xr.Dataset:
    """All designs over ``target``; what a target has not is missing there."""
    kept = [
        answer.drop_dims(_LOCAL, errors="ignore").assign(goal=str(answer.attrs["goal"])).drop_attrs()
        for answer in answers
    ]
    whole = xr.concat(kept, dim="target", join="outer", data_vars="all", fill_value=_missing(kept))
    return whole.assign_attrs(title="designs")


def kinds(answer: xr.Dataset) -> list[tuple[str, str, str]]:
    """Name, what was chosen, and role of every category of a design."""
    if "category" not in answer.dims:
        return []
    columns = (answer[key].values for key in ("category", "kind", "kind_role"))
    return [(str(name), str(kind), str(role)) for name, kind, role in zip(*columns, strict=True)]


def choices(answer: xr.Dataset) -> list[tuple[str, float, bool]]:
    """Every choice in words, its best objective on the surrogate, and whether that is feasible."""
    if "choice" not in answer.dims:
        return []
    columns = (answer[key].values for key in ("choice", "choice_objective", "choice_feasible"))
    return [(str(name), float(value), bool(feasible)) for name, value, feasible in zip(*columns, strict=True)]


def _missing(answers: list[xr.Dataset]) -> dict[str, object]:
    """What stands where a target has no such term or factor."""
    kinds = {str(name): one.dtype.kind for answer in answers for name, one in answer.data_vars.items()}
    return {name: "" if kind in "UOT" else False if kind == "b" else np.nan for name, kind in kinds.items()}


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
