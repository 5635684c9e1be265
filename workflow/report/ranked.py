"""Data of tornado charts and of the sentences above them, the largest effect first."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from workflow.design.verdict.answer import Answer
from workflow.language import titles
from workflow.language.numbers import number
from workflow.report.tornado import Bar, Chart
from workflow.study.categories import parted, titled

_LEAST = 0.1  # percent of a variance that are told
_LITTLE = 0.001  # percent of a change that are told


def sensitivities(sensitivity: xr.Dataset, outputs: Sequence[str]) -> list[Chart]:
    """Total Sobol' indices of some outputs, in percent of the variance, dark what a factor explains alone."""
    charts: list[Chart] = []
    for output in outputs:
        output_indices, bars = sensitivity.sel(output=output), []
        for name in map(str, output_indices["input"].values):
            total, alone = (100 * float(output_indices[key].sel(input=name)) for key in ("total", "first_order"))
            words = f"{number(total, 2)} %" if total >= _LEAST else f"< {number(_LEAST, 1)} %"
            bars.append(Bar(name, titles.title(name), 0.0, total, words, min(max(alone, 0.0), total)))
        charts.append(Chart.of(output, titled(output), bars))
    same: dict[str, list[Chart]] = {}
    for chart in charts:
        same.setdefault(parted(chart.name)[0], []).append(chart)
    return [chart for quantity, output_indices in same.items() for chart in _once(quantity, output_indices)]


def _once(quantity: str, charts: list[Chart]) -> list[Chart]:
    """One chart of a quantity in the place of several whose bars say the same."""
    sentences = {tuple((bar.name, bar.words) for bar in chart.bars) for chart in charts}
    if len(sentences) > 1 or len(charts) == 1:
        return charts
    return [replace(charts[0], title=f"{titles.title(quantity)}, whatever the category")]


def elasticities(answer: Answer) -> list[Chart]:
    """Exact change of every goal and limit for 1 % more of each variable, in percent."""
    charts, titled_so = [], Counter(term.title for term in answer.terms)
    for k, term in enumerate(answer.terms):
        known = [
            (variable, variable.sensitivity.elasticity[k])
            for variable in answer.variables
            if variable.sensitivity.elasticity
        ]
        bars = [
            Bar(variable.name, variable.title, min(value, 0.0), max(value, 0.0), _change(value))
            for variable, value in known
            if np.isfinite(value)
        ]
        title = term.words if titled_so[term.title] > 1 and term in answer.limits else term.title
        charts.append(Chart.of(term.name, title, bars))
    return [chart for chart in charts if chart.bars]


def _change(percent: float) -> str:
    """A change in percent; what is next to none is said to be less than that."""
    little = 0 < abs(percent) < _LITTLE
    return f"< {number(_LITTLE, 1)} %" if little else f"{number(percent, 2)} %"


def spans(rows: Sequence[Mapping[str, Any]]) -> list[Chart]:
    """Range of each quantity over the values of each factor of a parametric study."""
    charts = []
    for quantity in dict.fromkeys(name for row in rows for name in row["spans"]):
        bars = [
            Bar(row["name"], titles.title(row["name"]), low, high, _span(quantity, low, high))
            for row in rows
            if quantity in row["spans"]
            for low, high in [row["spans"][quantity]]
        ]
        charts.append(Chart.of(quantity, titles.title(quantity), bars))
    return charts


def _span(quantity: str, low: float, high: float) -> str:
    """Range of a quantity in words; one word where it does not change."""
    ends = dict.fromkeys(titles.value(quantity, end, 3) for end in (low, high))
    return " to ".join(ends) if len(ends) > 1 else f"{next(iter(ends))}: no change"
