"""Tornado charts in plain SVG, and the data of their sentences, the largest effect first."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr
from markupsafe import escape

from workflow.design.verdict.answer import Answer
from workflow.language import titles
from workflow.language.numbers import number
from workflow.report.svg import ACCENT, INK, PAPER, SOFT
from workflow.study.categories import parted, titled
from workflow.study.target import Target

_LEAST = 0.1  # percent of a variance; smaller shares are shown as less than that
_LITTLE = 0.001  # percent of a change; smaller ones are shown as less than that
_BARS, _ROW, _HEAD, _LEFT, _RIGHT = 208, 22, 30, 168, 84  # pixels: of all bars, of one, of a title, beside the bars
_THICK, _LETTER = 14, 7


@dataclass(frozen=True)
class Bar:
    """Effect of one factor on a quantity."""

    name: str  # of the factor
    title: str  # the factor in words
    low: float  # ends of the bar, in the unit of its chart
    high: float
    words: str  # the effect in words
    inner: float | None = None  # end of the dark part, the share that a factor explains alone

    @property
    def effect(self) -> float:
        """Length of the bar, by which a chart is sorted."""
        return abs(self.high - self.low)


@dataclass(frozen=True)
class Chart:
    """The bars of one quantity, the longest first."""

    name: str  # of the quantity
    title: str  # the quantity in words
    bars: tuple[Bar, ...]  # the longest first

    @classmethod
    def of(cls, name: str, title: str, bars: Sequence[Bar]) -> "Chart":
        """Return the chart of some bars."""
        return cls(name, title, tuple(sorted(bars, key=lambda bar: -bar.effect)))


def draw(charts: Sequence[Chart]) -> str:
    """Return all charts below each other as SVG; a page sets these parts side by side (`workflow.report.svg`)."""
    heights = [_HEAD + _ROW * len(chart.bars) + 12 for chart in charts]
    words_width = max((_LETTER * len(bar.words) + 12 for chart in charts for bar in chart.bars), default=0)
    width = _LEFT + _BARS + max(words_width, _RIGHT)
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {sum(heights)}">']
    for k, (chart, height) in enumerate(zip(charts, heights, strict=True)):
        parts += [
            f'<svg class="part" y="{sum(heights[:k])}" width="{width}" height="{height}" '
            f'viewBox="0 0 {width} {height}" font-size="13" font-family="DejaVu Sans, sans-serif">',
            f'<rect width="{width}" height="{height}" fill="{PAPER}"/>',
            *_chart(chart),
            "</svg>",
        ]
    return "\n".join([*parts, "</svg>"]) + "\n"


def _chart(chart: Chart) -> list[str]:
    low, high = min(bar.low for bar in chart.bars), max(bar.high for bar in chart.bars)
    span, crossed = (high - low) or 1.0, low < 0 <= high

    def place(value: float) -> float:
        return _LEFT + _BARS * (value - low) / span

    parts = [f'<text x="12" y="19" fill="{INK}" font-weight="600">{escape(chart.title)}</text>']
    for k, bar in enumerate(chart.bars):
        y = _HEAD + _ROW * k
        start, end = place(bar.low), max(place(bar.high), place(bar.low) + 1)
        parts.append(f'<text x="{_LEFT - 8}" y="{y + 12}" fill="{INK}" text-anchor="end">{escape(bar.title)}</text>')
        light = f'<rect class="bar" data-factor="{escape(bar.name)}" x="{start:.1f}" y="{y}" width="{end - start:.1f}"'
        parts.append(f'{light} height="{_THICK}" fill="{ACCENT}" fill-opacity="0.45"/>')
        if bar.inner is not None:
            width = place(bar.inner) - start
            parts.append(f'<rect x="{start:.1f}" y="{y}" width="{width:.1f}" height="{_THICK}" fill="{ACCENT}"/>')
        clear = max(end, place(0)) if crossed else end  # of the line at zero
        parts.append(f'<text x="{clear + 5:.1f}" y="{y + 12}" fill="{SOFT}" font-size="11">{escape(bar.words)}</text>')
    if crossed:
        parts.append(
            f'<path d="M{place(0):.1f} {_HEAD - 4} V{_HEAD + _ROW * len(chart.bars)}" stroke="{INK}" fill="none"/>'
        )
    return parts


def sensitivities(sensitivity: xr.Dataset, outputs: Sequence[str]) -> list[Chart]:
    """Return charts of total Sobol' indices in percent of the variance; dark is the share of a factor alone."""
    charts: list[Chart] = []
    for output in outputs:
        output_indices, bars = sensitivity.sel(output=output), []
        for name in map(str, output_indices["input"].values):
            total, alone = (100 * float(output_indices[key].sel(input=name)) for key in ("total", "first_order"))
            words = f"{number(total, 2)} %" if total >= _LEAST else f"< {number(_LEAST, 1)} %"
            bars.append(Bar(name, titles.title(name), 0.0, total, words, min(max(alone, 0.0), total)))
        charts.append(Chart.of(output, titled(output), bars))
    by_quantity: dict[str, list[Chart]] = {}
    for chart in charts:
        by_quantity.setdefault(parted(chart.name)[0], []).append(chart)
    return [chart for quantity, equals in by_quantity.items() for chart in _once(quantity, equals)]


def _once(quantity: str, charts: list[Chart]) -> list[Chart]:
    """Return one chart of a quantity in the place of several with equal bars."""
    sentences = {tuple((bar.name, bar.words) for bar in chart.bars) for chart in charts}
    if len(sentences) > 1 or len(charts) == 1:
        return charts
    return [replace(charts[0], title=f"{titles.title(quantity)}, whatever the category")]


def elasticities(answer: Answer) -> list[Chart]:
    """Return charts of the exact change of every goal and limit for 1 % more of each variable, in percent."""
    charts, title_counts = [], Counter(term.title for term in answer.terms)
    for k, term in enumerate(answer.terms):
        bars = [
            Bar(variable.name, variable.title, min(value, 0.0), max(value, 0.0), _change(value))
            for variable in answer.variables
            for value in variable.sensitivity.elasticity[k : k + 1]
            if np.isfinite(value)
        ]
        title = term.words if title_counts[term.title] > 1 and term in answer.limits else term.title
        charts.append(Chart.of(term.name, title, bars))
    return [chart for chart in charts if chart.bars]


def _change(percent: float) -> str:
    """Return a change in percent; a very small one as less than `_LITTLE`."""
    little = 0 < abs(percent) < _LITTLE
    return f"< {number(_LITTLE, 1)} %" if little else f"{number(percent, 2)} %"


def spans(rows: Sequence[Mapping[str, Any]]) -> list[Chart]:
    """Return charts of the range of each quantity over the values of each factor of a parametric study."""
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
    """Return the range of a quantity in words, or that it does not change."""
    ends = dict.fromkeys(titles.value(quantity, end, 3) for end in (low, high))
    return " to ".join(ends) if len(ends) > 1 else f"{next(iter(ends))}: no change"


def names(target: Target) -> list[str]:
    """Return the figures of a target in the order of the page; that of its contact comes after them."""
    continuous = len(target.continuous)
    names = ["front"] if len(target.objectives) > 1 else []
    names += ["map"] if continuous > 1 else []
    return [*names, *(["slices", "bars"] if continuous else [])]
