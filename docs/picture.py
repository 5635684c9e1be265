"""The picture of the pipeline, drawn from its rules (`docs/pipeline.svg`).

Snakemake gives the graph (`--rulegraph dot`); rules stand in columns by the longest way to them, in each column by the
mean height of what they need.
"""

import re
import subprocess
import sys
from collections import defaultdict
from html import escape
from pathlib import Path

FOLDER = Path(__file__).parent
#: Together these studies use every rule but those of the verification.
TARGETS = ("results/quickstart/report.html", "results/point/report.html")
ASKED = ("snakemake", "--rulegraph", "dot", "--quiet", "all", "--", *TARGETS)
_WIDTH, _HEIGHT, _GAP_X, _GAP_Y, _EDGE = 132, 30, 44, 16, 12

Arrows = set[tuple[str, str]]


def rulegraph() -> str:
    """What Snakemake says of the rules, as dot."""
    command = [str(Path(sys.executable).with_name(ASKED[0])), *ASKED[1:]]
    return subprocess.run(command, cwd=FOLDER.parent, capture_output=True, text=True, check=True).stdout


def arrows(dot: str) -> Arrows:
    """Pairs (needed rule, rule)."""
    names = dict(re.findall(r'^\s*(\d+)\s*\[.*?label\s*=\s*"([^"]+)"', dot, re.MULTILINE))
    return {(names[a], names[b]) for a, b in re.findall(r"(\d+)\s*->\s*(\d+)", dot)}


def places(pairs: Arrows) -> dict[str, tuple[int, float]]:
    """Column and height of every rule."""
    needs: dict[str, set[str]] = defaultdict(set)
    for first, then in pairs:
        needs[then].add(first)
        needs.setdefault(first, set())
    column: dict[str, int] = {}
    while len(column) < len(needs):
        ready = sorted(rule for rule in needs if rule not in column and needs[rule] <= column.keys())
        column |= {rule: max((column[need] + 1 for need in needs[rule]), default=0) for rule in ready}
    height: dict[str, float] = {}
    for index in range(max(column.values()) + 1):
        here = [rule for rule in sorted(column) if column[rule] == index]
        mean = {rule: sum(height[need] for need in needs[rule]) / max(len(needs[rule]), 1) for rule in here}
        for rank, rule in enumerate(sorted(here, key=lambda rule: (mean[rule], rule))):
            height[rule] = rank - (len(here) - 1) / 2
    return {rule: (column[rule], height[rule]) for rule in sorted(needs)}


def shortened(pairs: Arrows) -> Arrows:
    """Arrows without those that a longer way implies."""
    after: dict[str, set[str]] = defaultdict(set)
    for first, then in pairs:
        after[first].add(then)

    def reached(rule: str) -> set[str]:
        return after[rule].union(*map(reached, after[rule]))

    return {(a, b) for a, b in pairs if not any(b in reached(other) for other in after[a] - {b})}


def opened(title: str, size: tuple[float, float], font: int) -> list[str]:
    """The first lines of a picture: its paper, and the tips of its arrows."""
    wide, high = size
    return [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide:g} {high:g}"',
        f'font-family="sans-serif" font-size="{font}">',
        f'<title>{title}</title><rect width="{wide:g}" height="{high:g}" fill="#fff"/>',
        '<marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto">'
        '<path d="M0 0 8 4 0 8z" fill="#777"/></marker>',
    ]


def draw(pairs: Arrows) -> str:
    """The picture as SVG."""
    at = places(pairs)
    top = min(height for _, height in at.values())

    def corner(rule: str) -> tuple[float, float]:
        column, height = at[rule]
        return _EDGE + column * (_WIDTH + _GAP_X), _EDGE + (height - top) * (_HEIGHT + _GAP_Y)

    wide = max(corner(rule)[0] for rule in at) + _WIDTH + _EDGE
    high = max(corner(rule)[1] for rule in at) + _HEIGHT + _EDGE
    lines = opened("Rules of the pipeline", (wide, high), 13)
    for first, then in sorted(shortened(pairs)):
        (x0, y0), (x1, y1) = corner(first), corner(then)
        x0, y0, y1 = x0 + _WIDTH, y0 + _HEIGHT / 2, y1 + _HEIGHT / 2
        bend = (x1 - x0) / 2
        curve = f"M{x0:g} {y0:g}C{x0 + bend:g} {y0:g} {x1 - bend:g} {y1:g} {x1:g} {y1:g}"
        lines.append(f'<path d="{curve}" fill="none" stroke="#999" marker-end="url(#tip)"/>')
    for rule in at:
        x, y = corner(rule)
        box = f'<rect x="{x:g}" y="{y:g}" width="{_WIDTH}" height="{_HEIGHT}" rx="6" fill="#eef4fb" stroke="#2166ac"/>'
        text = f'<text x="{x + _WIDTH / 2:g}" y="{y + 20:g}" text-anchor="middle">{escape(rule)}</text>'
        lines.append(box + text)
    return "\n".join([*lines, "</svg>"]) + "\n"
