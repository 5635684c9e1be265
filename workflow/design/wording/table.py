"""The answer to a design question as lines for the terminal, JSON and CSV."""

import csv
import io
import json
from collections.abc import Iterable, Sequence
from pathlib import Path
from textwrap import wrap
from typing import Any

import numpy as np

from workflow.design.verdict import netcdf
from workflow.design.verdict.answer import Answer
from workflow.design.wording.words import spread, verdict
from workflow.language.factors import FACTORS
from workflow.language.numbers import shown
from workflow.language.statements import Limit
from workflow.language.wordings import plain

_WIDE = 100  # columns
_EXACT = 1e-6  # of a limit: a margin that is none, but for rounding
_HEAD = ("target", "verdict", "goal", "design")
_COLUMNS = ("target", "kind", "name", "units", "predicted", "predicted_std", "exact", "limit", "margin", "inside")
_NUMBERS = ("predicted", "predicted_std", "exact", "limit", "margin")
_JSON = ("exact", *_NUMBERS[:2], *_NUMBERS[3:])


def as_text(answer: Answer, *, si: bool = False) -> str:
    """Return one design as lines for the terminal."""
    lines = [answer.goal, *_paragraph(str(verdict(answer)))]
    lines += [f"  {category.category:44s} {category.kind:25s} {category.kind_role}" for category in answer.categories]
    for variable in answer.variables:
        within = f", within {variable.tolerance}" if variable.tolerance else ""
        value = _value(variable.value, FACTORS[variable.name].units, si)
        lines.append(f"  {variable.name:44s} {value:25s} {variable.role}{within}")
    lines.append(f"  {'':44s} {'exact':25s} {'predicted':25s} margin")
    for term in answer.terms:
        margin = "" if np.isnan(term.margin) else f"{100 * term.margin if abs(term.margin) > _EXACT else 0:.3g} %"
        cells = (f"{_value(value, term.units, si):25s}" for value in (term.exact, term.predicted))
        lines.append(f"  {term.name:44s} {' '.join(cells)} {margin}".rstrip())
    lines += ["best of every choice, on the surrogate"] if answer.choices else []
    for choice in answer.choices:
        flag = "" if choice.choice_feasible else "infeasible"
        units = answer.terms[0].units if answer.terms else ""
        lines.append(f"  {choice.choice:44s} {_value(choice.choice_objective, units, si):25s} {flag}".rstrip())
    lines += [answer.status, f"polish: {answer.polish}"]
    for effect in answer.left_out:
        lines += _paragraph(f"left out: {effect.left_out_words}")
    for note in filter(None, (answer.flags, spread(answer))):
        lines += _paragraph(f"note: {note}")
    return "\n".join(lines)


def _paragraph(text: str) -> list[str]:
    """Return sentences as lines of a terminal."""
    return wrap(text, _WIDE, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)


def _value(value: float, units: str, si: bool) -> str:
    return f"{value:.8g} {units}".rstrip() if si else shown(value, units)


def as_json(answer: Answer) -> str:
    """Return the answer as JSON, with null for numbers that are not finite."""
    out: dict[str, Any] = {
        "goal": answer.goal,
        "polish": answer.polish,
        "verdict": str(verdict(answer)),
        "status": answer.status,
        "flags": answer.flags,
        "feasible": answer.feasible,
        "spread": spread(answer),
        "factors": {
            variable.name: {
                "value": variable.value,
                "role": variable.role,
                "units": FACTORS[variable.name].units,
                "tolerance": variable.tolerance,
            }
            for variable in answer.variables
        },
        "categories": {
            category.category: {"value": category.kind, "role": category.kind_role} for category in answer.categories
        },
        "choices": [
            {"choice": choice.choice, "objective": _finite(choice.choice_objective), "feasible": choice.choice_feasible}
            for choice in answer.choices
        ],
        "terms": {
            term.name: {key: _finite(getattr(term, key)) for key in _JSON}
            | {"inside": term.inside, "units": term.units}
            for term in answer.terms
        },
        "left_out": [
            {key: value if isinstance(value, str) else _finite(value) for key, value in vars(effect).items()}
            for effect in answer.left_out
        ],
    }
    if "front" in answer.pictures.dims:
        out["front"] = _front(answer)
    return json.dumps(out, indent=2, allow_nan=False)


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _front(answer: Answer) -> list[dict[str, Any]]:
    """Return the exact objectives of every design of the Pareto front, and its choice where there are several."""
    front = answer.pictures
    names = front["objective"].values.tolist()
    rows: list[dict[str, Any]] = [
        dict(zip(names, values, strict=True))
        for values in front["front_exact"].transpose("front", "objective").values.tolist()
    ]
    if answer.choices:
        rows = [row | {"choice": name} for row, name in zip(rows, front["front_choice"].values.tolist(), strict=True)]
    return rows


def as_csv(answers: Iterable[Answer]) -> str:
    """Return designs as CSV: one row a category, then one a factor, one a term, and the status."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(_COLUMNS)
    for answer in answers:
        rows.writerows(map(plain, (answer.target, *row)) for row in _rows(answer))
    return text.getvalue()


def _rows(answer: Answer) -> list[tuple[Any, ...]]:
    """Return the rows of one design, without its target."""
    rows: list[tuple[Any, ...]] = [
        (category.kind_role, category.category, "", "", "", category.kind, "", "", "") for category in answer.categories
    ]
    for variable in answer.variables:
        rows.append((variable.role, variable.name, FACTORS[variable.name].units, "", "", variable.value, "", "", ""))
    for term in answer.terms:
        numbers = [getattr(term, key) for key in _NUMBERS]
        cells = ["" if np.isnan(number) else number for number in numbers]
        kind = "limit" if isinstance(term.statement, Limit) else "objective"
        rows.append((kind, term.name, term.units, *cells, int(term.inside)))
    return [*rows, ("status", answer.status, *[""] * 7), ("flags", answer.flags, *[""] * 7)]


def outcome(answers: Sequence[Path]) -> list[str]:
    """Return the lines of a table with design and verdict of each answer's file; none without answers."""
    if not answers:
        return []
    rows, reasons = [_HEAD], [""]
    for file in answers:
        answer = netcdf.read(file)
        goal, judged = answer.terms[0], verdict(answer)
        parts = [category.kind for category in answer.categories if category.kind_role == "variable"]
        parts += [f"{variable.title} {variable.words}" for variable in answer.variables if variable.chosen]
        rows.append((file.stem, judged.kind, f"{goal.title} {shown(goal.exact, goal.units, 3)}", ", ".join(parts)))
        reasons.append(judged.why)
    widths, lines = [max(map(len, column)) for column in zip(*rows, strict=True)], []
    for row, why in zip(rows, reasons, strict=True):
        lines.append("  ".join(map(str.ljust, row, widths)).rstrip())
        lines += [f"{'':{widths[0]}}  {why}"] if why else []
    return lines
