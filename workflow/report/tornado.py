"""Tornado charts: what moves a quantity, the strongest first; plain SVG, for figures and inside the page."""

from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import escape

from workflow.report.svg import ACCENT, INK, PAPER, SOFT

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
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide} {sum(heights)}">',
    ]
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
