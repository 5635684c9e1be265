"""The answer as a data set, and back: every field of the values of `answer` has a variable of its own name."""

import itertools
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any, get_origin, get_type_hints

import numpy as np
import xarray as xr

from storage.described import described
from storage.netcdf import read_whole
from workflow.design.verdict.answer import (
    Answer,
    Category,
    Choice,
    Constant,
    End,
    Figure,
    Overload,
    Range,
    Role,
    Sensitivity,
    Term,
    Tolerated,
    Variable,
)
from workflow.design.verdict.leftout import LeftOut
from workflow.language import statements
from workflow.language.constants import FIGURES_BY, Meeting

_LOCAL = ("map_x", "map_y", "slice", "step", "front", "choice", "position", "x", "y")  # dimensions of pictures

SOURCE = "meecontact: search on a Gaussian process, polished and judged on the closed-form solution"
SOURCE_OF_FILMS = "meecontact: search on a Gaussian process, judged on the exact solver of films"
_DESCRIBED = (Category, Choice, Range, Figure, Constant, Overload, LeftOut, Term, Variable, Sensitivity)
_MEANINGS = {
    **{
        name: hint.__metadata__[0]
        for row in _DESCRIBED
        for name, hint in get_type_hints(row, include_extras=True).items()
        if get_origin(hint) is Annotated
    },
    "target": "name of a design target",
    "factor": "name of a factor",
    "term": "objective or limit",
    "goal": "what is asked for",
    "tolerance_cost": "share of the goal that is gained without this one tolerance",
    "tolerance_gain": "share of the goal that is gained by half of this one tolerance",
    "nominal_value": "factor of the optimum without tolerances, over its SI unit",
    "nominal_exact": "exact goal of the optimum without tolerances, over its unit in units",
    "nominal_choice": "categories of the optimum without tolerances",
    "beyond": "what is beyond what the materials bear: linear theory does not hold there",
    "feasible": "whether the design keeps every limit",
    "status": "what binds or is violated",
    "flags": "what else is to be known of the design",
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
    "front": "a design of the Pareto front",
    "objective": "an objective of the Pareto front",
    "front_exact": "exact objective of a design of the front, over its unit in units",
    "front_predicted": "predicted objective of a design of the front, over its unit in units",
    "front_value": "factor of a design of the front, over its SI unit",
}


_TERM = ("predicted", "predicted_std", "half", "exact", "inside", "limit", "margin", "units", "bound", "source")
_VARIABLE = ("value", "tolerance", "role")
_SENSITIVITY = ("cost", "loss", "matters", "margin_left")
_TOLERATED = {"tolerance_cost": "cost", "tolerance_gain": "gain", "nominal_value": "values"}
#: Fields of an answer with rows over a dimension of their own, which the first field of each row names.
_ROWS: dict[str, type[Any]] = {
    "ranges": Range, "figures": Figure, "constants": Constant, "categories": Category, "choices": Choice,
    "left_out": LeftOut,
}  # fmt: skip


#: The meeting of files that name none.
_USUAL: Meeting = "line"
_SCALARS = ("overload", "overload_term")
_PICTURED = ("map_", "slice_", "front_", "field_", "inside_")  # begin the names of variables of pictures


def dataset(answer: Answer) -> xr.Dataset:
    """Return the answer as a data set."""
    terms, variables = answer.terms, answer.variables
    names = [variable.name for variable in variables]
    data: dict[str, Any] = {key: ("term", [getattr(term, key) for term in terms]) for key in _TERM}
    data |= {key: ("factor", [getattr(variable, key) for variable in variables]) for key in _VARIABLE}
    data |= {key: ("factor", [getattr(variable.sensitivity, key) for variable in variables]) for key in _SENSITIVITY}
    data["edge"] = ("factor", [variable.edge or "" for variable in variables])
    data["elasticity"] = (("factor", "term"), [variable.sensitivity.elasticity for variable in variables])
    data["worst"] = (("term", "factor"), [[term.worst[name] for name in names] for term in terms])
    data |= {key: getattr(answer, key) for key in ("feasible", "status", "beyond", "flags")}
    coords: dict[str, Any] = {"factor": names, "term": [term.name for term in terms], "target": answer.target}
    if answer.constants:
        data["effect"] = (("term", "constant"), [term.effect for term in terms])
        data["spread"] = ("term", [term.spread for term in terms])
    if answer.overload:
        data |= vars(answer.overload)
    if tolerated := answer.tolerated:
        for key, name in _TOLERATED.items():
            data[key] = ("factor", [getattr(tolerated, name).get(factor, np.nan) for factor in names])
        data |= {"nominal_exact": tolerated.exact, "nominal_choice": tolerated.choice}
    for rows in filter(None, (getattr(answer, key) for key in _ROWS)):
        dimension, *keys = [field.name for field in fields(rows[0])]
        coords[dimension] = [getattr(row, dimension) for row in rows]
        data |= {key: (dimension, [getattr(row, key) for row in rows]) for key in keys}
    out = xr.merge([xr.Dataset(data, coords), answer.pictures], compat="no_conflicts", join="outer")
    out.attrs = {
        "title": f"design target {answer.target}",
        "goal": answer.goal,
        "objective": answer.terms[0].name,
        "statistic": answer.statistic,
        "polish": answer.polish,
        "source": answer.source,
        "signs": [term.statement.sign for term in answer.objectives],
    }
    meeting = answer.terms[0].statement.meeting
    return out if meeting == _USUAL else out.assign_attrs(meeting=meeting)


def answer_of(data: xr.Dataset) -> Answer:
    """Return the answer in a data set of `dataset`."""
    names, numbers = _list(data, "factor"), [_list(data, key) for key in _TERM]
    cases = [dict(zip(names, case, strict=True)) for case in _list(data, "worst", "term", "factor")]
    effects = [tuple(effect) for effect in _list(data, "effect", "term", "constant")] or [()] * len(cases)
    spreads = _list(data, "spread") or [np.nan] * len(cases)
    terms = itertools.starmap(Term, zip(_stated(data), *numbers, cases, effects, spreads, strict=True))
    slopes, errors = _list(data, "elasticity", "factor", "term"), _rows(data, _SENSITIVITY)
    sensitivities = [Sensitivity(tuple(slope), *error) for slope, error in zip(slopes, errors, strict=True)]
    variables = [
        Variable(name, value, Role(role), sensitivity, tolerance, End(edge) if edge else None)
        for name, sensitivity, (value, tolerance, role, edge) in zip(
            names, sensitivities, _rows(data, (*_VARIABLE, "edge")), strict=True
        )
    ]
    contents: dict[str, Any] = {
        key: tuple(itertools.starmap(row, _rows(data, [field.name for field in fields(row)])))
        for key, row in _ROWS.items()
    }
    contents |= {key: str(data[key].item()) for key in ("beyond", "flags", "target")}
    # files have no variable for it, but it is part of both others
    contents["exceeded"] = tuple(part for part in contents["flags"].split("; ") if f"{part} (" in contents["beyond"])
    contents |= {key: str(data.attrs[key]) for key in ("statistic", "polish", "source")}
    return Answer(
        tuple(terms),
        tuple(variables),
        overload=Overload(*(data[key].item() for key in _SCALARS)) if set(_SCALARS) <= set(data) else None,
        tolerated=_tolerated(data),
        pictures=data[[name for name in data.data_vars if str(name).startswith(_PICTURED)]].drop_attrs(deep=False),
        **contents,
    )


def _stated(data: xr.Dataset) -> Iterator[statements.Objective | statements.Limit]:
    """Yield the statements of the terms, read by the grammar of a study."""
    signs = iter(np.atleast_1d(data.attrs["signs"]))
    meeting = next(known for known in FIGURES_BY if known == data.attrs.get("meeting", _USUAL))
    for text, limit in zip(_list(data, "term"), _list(data, "limit"), strict=True):
        if np.isfinite(limit):
            yield statements.limit(text, meeting)
        else:
            yield statements.objective(text, maximise=next(signs) > 0, meeting=meeting)


def _tolerated(data: xr.Dataset) -> Tolerated | None:
    if "nominal_exact" not in data:
        return None
    names = _list(data, "factor")
    cost, gain, values = (
        {name: value for name, value in zip(names, _list(data, key), strict=True) if np.isfinite(value)}
        for key in _TOLERATED
    )
    return Tolerated(cost, gain, values, data["nominal_exact"].item(), str(data["nominal_choice"].item()))


def _rows(data: xr.Dataset, keys: Sequence[str]) -> list[tuple[Any, ...]]:
    """Return values of some variables over one dimension as rows; none where the variables are missing."""
    return list(zip(*(_list(data, key) for key in keys), strict=True))


def _list(data: xr.Dataset, key: str, *dims: str) -> list[Any]:
    """Return the values of a variable as lists, over dimensions in their order; none where it is missing."""
    return data[key].transpose(*dims).values.tolist() if key in data.variables else []


def read(path: Path) -> Answer:
    """Read the answer in a file ``design/<target>.nc``."""
    return answer_of(read_whole(path))


def tell_unreached(studies: Iterable[str], results: str | Path) -> None:
    """Print a line for each target that no design reaches, by the files ``design.nc`` in the studies' results."""
    for path in (Path(results) / study / "design.nc" for study in sorted(studies)):
        data = read_whole(path)
        for target in data["target"].values[~data["feasible"].values.astype(bool)]:
            print(f"target {target}: not reachable: {read(path.parent / 'design' / f'{target}.nc').miss}")


def together(answers: list[xr.Dataset]) -> xr.Dataset:
    """Return all designs over ``target``, with missing values for terms and factors of other targets."""
    parts = [
        answer.drop_dims(_LOCAL, errors="ignore").assign(goal=str(answer.attrs["goal"])).drop_attrs()
        for answer in answers
    ]
    whole = xr.concat(parts, dim="target", join="outer", data_vars="all", fill_value=_missing(parts))
    return described(whole, "designs", str(answers[0].attrs["source"]), _MEANINGS)


def entire(answer: Answer) -> xr.Dataset:
    """Return an answer as a data set in which every variable has its meaning."""
    data = dataset(answer)
    pictured = {
        str(name): f"{str(name).partition('_')[2].replace('_', ' ')} under the recommended design"
        for name in data.data_vars
        if str(name).startswith(("field_", "inside_"))
    }
    return described(data, str(data.attrs["title"]), str(data.attrs["source"]), _MEANINGS | _PICTURES | pictured)


def _missing(answers: list[xr.Dataset]) -> dict[str, object]:
    """Return the fill value of every variable for terms or factors that a target lacks."""
    types = {str(name): array.dtype.kind for answer in answers for name, array in answer.data_vars.items()}
    return {name: "" if code in "UOT" else False if code == "b" else np.nan for name, code in types.items()}
