"""The badges of the README (`docs/badges.svg`): what the project's own files say, so that they cannot be untrue."""

import tomllib
from html import escape
from pathlib import Path

import xarray as xr

from storage.described import standard

FOLDER = Path(__file__).parent
_LETTER, _HEIGHT, _GAP = 6.7, 20, 6


def facts() -> dict[str, str]:
    """What each badge says, by its title."""
    said = tomllib.loads((FOLDER.parent / "pyproject.toml").read_text(encoding="utf-8"))
    project, mypy = said["project"], said["tool"]["mypy"]
    return {
        "version": project["version"],
        "python": project["requires-python"].replace(">=", "≥ "),
        "licence": project["license"],
        "types": "mypy strict" if mypy["strict"] else "mypy",
        "files": standard(xr.Dataset())["Conventions"],
    }


def draw() -> str:
    """Titles and facts side by side."""
    parts, x = [], 0.0
    for title, fact in facts().items():
        left, right = (len(text) * _LETTER + 12 for text in (title, fact))
        for at, width, colour, text in ((x, left, "#555", title), (x + left, right, "#0072b2", fact)):
            parts.append(f'<rect x="{at:.1f}" width="{width:.1f}" height="{_HEIGHT}" fill="{colour}"/>')
            parts.append(f'<text x="{at + width / 2:.1f}" y="14">{escape(text)}</text>')
        x += left + right + _GAP
    size = f'viewBox="0 0 {x - _GAP:.1f} {_HEIGHT}" width="{x - _GAP:.0f}" height="{_HEIGHT}"'
    label = "; ".join(f"{title} {fact}" for title, fact in facts().items())
    style = 'font-family="sans-serif" font-size="11" text-anchor="middle" fill="#fff"'
    head = f'<svg xmlns="http://www.w3.org/2000/svg" {size} role="img" aria-label="{escape(label)}" {style}>'
    return "\n".join([head, *parts, "</svg>\n"])
