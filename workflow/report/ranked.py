"""Tornado charts, and the data of the sentences above them, the largest effect first; plain SVG."""

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

_LEAST = 0.1  # percent of a variance that are told
_LITTLE = 0.001  # percent of a change that are told
_BARS, _ROW, _HEAD, _LEFT, _RIGHT = 208, 22, 30, 168, 84  # pixels: of all bars, of one, of a title, beside the bars
_THICK, _LETTER = 14, 7


@dataclass(frozen=True)
class Bar:
    """Effect of one factor on a quantity."""

    # The factor, and the same in words
    name: str
    title: str
    # Ends of the bar, in the unit of its chart
    low: float
    high: float
    words: str  # The same in words
    inner: float | None = None  # Up to where the bar is dark, as the share that a factor explains alone

    @property
    def effect(self) -> float:
        """Length of the bar, by which a chart is sorted."""
        return abs(self.high - self.low)


@dataclass(frozen=True)
class Chart:
    """The bars of one quantity, the longest first."""

    # The quantity, and the same in words
    name: str
    title: str
    bars: tuple[Bar, ...]  # The longest first

    @classmethod
    def of(cls, name: str, title: str, bars: Sequence[Bar]) -> "Chart":
        """The chart of some bars."""
        return cls(name, title, tuple(sorted(bars, key=lambda bar: -bar.effect)))


def draw(charts: Sequence[Chart]) -> str:
    """All charts below each other, as SVG; each is a part, which a page sets side by side (`workflow.report.svg`)."""
    heights = [_HEAD + _ROW * len(chart.bars) + 12 for chart in charts]
    room = max((_LETTER * len(bar.words) + 12 for chart in charts for bar in chart.bars), default=0)
    wide = _LEFT + _BARS + max(room, _RIGHT)
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide} {sum(heights)}">']
    for k, (chart, height) in enumerate(zip(charts, heights, strict=True)):
        parts += [
            f'<svg class="part" y="{sum(heights[:k])}" width="{wide}" height="{height}" viewBox="0 0 {wide} {height}" '
            f'font-size="13" font-family="DejaVu Sans, sans-serif">',
            f'<rect width="{wide}" height="{height}" fill="{PAPER}"/>',
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
            wide = place(bar.inner) - start
            parts.append(f'<rect x="{start:.1f}" y="{y}" width="{wide:.1f}" height="{_THICK}" fill="{ACCENT}"/>')
        clear = max(end, place(0)) if crossed else end  # of the line at zero
        parts.append(f'<text x="{clear + 5:.1f}" y="{y + 12}" fill="{SOFT}" font-size="11">{escape(bar.words)}</text>')
    if crossed:
        parts.append(
            f'<path d="M{place(0):.1f} {_HEAD - 4} V{_HEAD + _ROW * len(chart.bars)}" stroke="{INK}" fill="none"/>'
        )
    return parts


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
        bars = [
            Bar(variable.name, variable.title, min(value, 0.0), max(value, 0.0), _change(value))
            for variable in answer.variables
            for value in variable.sensitivity.elasticity[k : k + 1]
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


def names(target: Target) -> list[str]:
    """The figures of a target, in the order of the page; its contact, of which not every design has fields, is last."""
    continuous = len(target.continuous)
    names = ["front"] if len(target.objectives) > 1 else []
    names += ["map"] if continuous > 1 else []
    return [*names, *(["slices", "bars"] if continuous else [])]
