"""The picture of the rooms and the list of what is in them: `make docs` writes both from the code.

`docs/rooms.svg` is drawn from the imports; `docs/architecture.md` has a line of every module, its docstring's first.
Rooms stand in rows by the longest way down from them, so that every arrow goes down; a column is a room at the top.
"""

import ast
import re
from collections import defaultdict
from functools import cache
from html import escape
from pathlib import Path

import grimp

from docs.picture import Arrows, opened, shortened

FOLDER = Path(__file__).parent
PAGE = FOLDER / "architecture.md"
_LIST = re.compile(r"(?<=<!-- written by docs/rooms.py -->\n).*?(?=<!-- end -->)", re.DOTALL)
_TABLE = re.compile(r"(?<=<!-- rooms by docs/rooms.py -->\n).*?(?=<!-- end of the rooms -->)", re.DOTALL)
_WIDTH, _HEIGHT, _GAP_X, _GAP_Y, _EDGE, _HEAD = 98, 30, 12, 32, 12, 26

Point = tuple[float, float]
Frame = tuple[float, float, float, float]

#: Rooms at the top, from left to right, and how many rooms stand side by side in each; a colour for each.
COLUMNS = {
    "surrogate": (3, "#f3eefb", "#6a51a3"),
    "storage": (1, "#f2f2f2", "#666"),
    "approximation": (1, "#f2f2f2", "#666"),
    "workflow": (2, "#eef4fb", "#2166ac"),
    "solver": (2, "#eaf6ee", "#1b7837"),
    "verification": (1, "#fdf1e8", "#b35806"),
}
#: The same from the top down, in which the list goes.
COLUMNS_DOWN = ("workflow", "solver", "surrogate", "approximation", "storage", "verification")
#: Rooms that are one in the picture, whatever is within.
_WHOLE = ("approximation", "storage", "verification")


def imports() -> Arrows:
    """Pairs (room, room that it imports); a module beside the sub-rooms of a room counts as one."""
    graph = grimp.build_graph(*COLUMNS, cache_dir=None)
    pairs = ((a, b) for a in graph.modules for b in graph.find_modules_directly_imported_by(a))
    return {(room(a), room(b)) for a, b in pairs if room(a) != room(b)}


def room(module: str) -> str:
    """The room of a module."""
    first, *others = module.split(".")
    return ".".join([first, *others[:1]]) if first not in _WHOLE else first


def places(pairs: Arrows) -> dict[str, tuple[float, int]]:
    """Left end and row of every room; row 0 is the lowest."""
    after: dict[str, set[str]] = defaultdict(set)
    for above, below in pairs:
        after[above].add(below)

    @cache
    def row(name: str) -> int:
        return max((row(room) + 1 for room in after[name]), default=0)

    at: dict[str, tuple[float, int]] = {}
    left = float(_EDGE)
    for column, (wide, *_) in COLUMNS.items():
        rows: dict[int, list[str]] = defaultdict(list)
        for name in sorted({room for pair in pairs for room in pair if room.split(".")[0] == column}):
            rows[row(name)].append(name)
        for height, names in rows.items():
            inset = (wide - len(names)) / 2
            ordered = sorted(names, key=lambda name: (name == column, name))
            at |= {name: (left + (inset + k) * (_WIDTH + _GAP_X), height) for k, name in enumerate(ordered)}
        left += wide * (_WIDTH + _GAP_X) + 2 * _GAP_X
    return at


def draw(pairs: Arrows) -> str:
    """The picture as SVG; an arrow that a longer way implies is left out."""
    at = places(pairs)
    top = max(row for _, row in at.values())

    def corner(name: str) -> tuple[float, float]:
        x, row = at[name]
        return x, _EDGE + _HEAD + (top - row) * (_HEIGHT + _GAP_Y)

    wide = max(x for x, _ in at.values()) + _WIDTH + _EDGE
    high = _EDGE * 2 + _HEAD + (top + 1) * (_HEIGHT + _GAP_Y) - _GAP_Y
    lines = opened("Rooms and what they import", (wide, high), 14)
    frames = _frames({name: corner(name) for name in at})
    for column, (x, y, x1, y1) in frames.items():
        paper = COLUMNS[column][1]
        lines.append(f'<rect x="{x:g}" y="{y:g}" width="{x1 - x:g}" height="{y1 - y:g}" rx="9" fill="{paper}"/>')
    for above, below in sorted(shortened(pairs)):
        (x0, y0), (x1, y1) = corner(above), corner(below)
        ends = (x0 + _WIDTH / 2, y0 + _HEIGHT), (x1 + _WIDTH / 2, y1)
        way = _way(*ends, frames[above.split(".")[0]], frames[below.split(".")[0]])
        lines.append(f'<path d="{way}" fill="none" stroke="#888" marker-end="url(#tip)"/>')
    for name in sorted(at):
        x, y = corner(name)
        column, *within = name.split(".")
        ink, words = COLUMNS[column][2], within[0] if within else name if name in _WHOLE else "entrance"
        lines.append(
            f'<rect x="{x:g}" y="{y:g}" width="{_WIDTH}" height="{_HEIGHT}" rx="6" fill="#fff" stroke="{ink}"/>'
            f'<text x="{x + _WIDTH / 2:g}" y="{y + 20:g}" text-anchor="middle">{escape(words)}</text>'
        )
    for column, (x, y, *_) in frames.items():
        _, paper, ink = COLUMNS[column]
        lines.append(
            f'<text x="{x + 10:g}" y="{y + 18:g}" fill="{ink}" font-weight="bold" stroke="{paper}" stroke-width="4" '
            f'paint-order="stroke">{column}/</text>'
        )
    return "\n".join([*lines, "</svg>"]) + "\n"


def _frames(corners: dict[str, Point]) -> dict[str, Frame]:
    """What lies around the rooms of each column: left, top, right, bottom."""
    frames = {}
    for column in COLUMNS:
        own = [corner for name, corner in corners.items() if name.split(".")[0] == column]
        (left, top), (right, bottom) = map(min, zip(*own, strict=True)), map(max, zip(*own, strict=True))
        frames[column] = (left - 8, top - _HEAD, right + _WIDTH + 8, bottom + _HEIGHT + 8)
    return frames


def _way(start: Point, end: Point, out: Frame, into: Frame) -> str:
    """A curve between two rooms that goes through the gaps between rows, behind no other room."""
    (x0, y0), (x1, y1) = start, end
    if out == into:
        turn = y0 + _GAP_Y - 7
        return f"M{x0:g} {y0:g}C{x0:g} {turn:g} {x1:g} {y0:g} {x1:g} {turn:g}V{y1:g}"
    leftwards = x1 < x0
    side = out[0 if leftwards else 2]
    gap = y0 + _GAP_Y * (0.3 + 0.45 * abs(x0 - side) / (out[2] - out[0]))  # those of one row side by side
    way = f"M{x0:g} {y0:g}Q{x0:g} {gap:g} {side:g} {gap:g}"
    if y1 - into[1] < _HEAD + 1:  # the highest room of its column: from above
        return f"{way}S{x1:g} {(gap + y1) / 2:g} {x1:g} {y1:g}"
    lift = max(0.0, min(_GAP_Y, y1 - _GAP_Y / 2 - gap))
    door, sill = into[2 if leftwards else 0], y1 - _GAP_Y / 2
    return f"{way}S{door:g} {sill - lift:g} {door:g} {sill:g}Q{x1:g} {sill:g} {x1:g} {y1:g}"


def listed(page: str) -> str:
    """The page of the architecture with its table of rooms and its list of all modules as they are now."""
    page = _TABLE.sub(lambda _: "".join(_rows()), page)
    return _LIST.sub(lambda _: "".join(_lines(FOLDER.parent / column) for column in COLUMNS_DOWN), page)


def _rows() -> list[str]:
    """The table of all rooms, each with the first line of its docstring."""
    inner = {
        room: sorted(path.parent for path in (FOLDER.parent / room).glob("*/__init__.py")) for room in COLUMNS_DOWN
    }
    rooms = [within for room, own in inner.items() if room not in _WHOLE for within in own]
    rooms += [FOLDER.parent / room for room in COLUMNS_DOWN if room in _WHOLE]
    rows = [f"| `{room.relative_to(FOLDER.parent)}` | {_said(room / '__init__.py')} |\n" for room in rooms]
    return ["| room | what it is: what to look for there |\n|---|---|\n", *rows]


def _lines(folder: Path, depth: int = 3) -> str:
    """A folder's modules, then its sub-rooms, each with the first line of its docstring."""
    modules = sorted(path for path in folder.glob("*.py") if path.name != "__init__.py")
    rooms = sorted(path.parent for path in folder.glob("*/__init__.py"))
    head = f"{'#' * depth} {folder.relative_to(FOLDER.parent)}/\n\n{_said(folder / '__init__.py')}\n\n"
    own = "".join(f"- `{path.name}`: {_said(path)}\n" for path in modules)
    return head + (own and own + "\n") + "".join(_lines(room, depth + 1) for room in rooms)


def _said(path: Path) -> str:
    """The first line of a module's docstring."""
    return (ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or "").splitlines()[0]
