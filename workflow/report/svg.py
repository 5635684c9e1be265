"""SVG figures as parts of a page: unique ids, colours that follow light and dark."""

import re
from pathlib import Path

from markupsafe import Markup

#: What the style of figures draws in, and the page's variables for it.
INK, PAPER = "#1c2430", "#fbfbf9"
_VARIABLES = {INK: "var(--ink)", PAPER: "var(--card)", "#2166ac": "var(--accent)"}
_IDS = re.compile(r'(\bid=")([^"]+)(")|(url\(#)([^)]+)(\))|(href="#)([^"]+)(")')
_STROKE = re.compile(r"stroke: (#[0-9a-f]{6})")


def inlined(path: Path, alt: str) -> Markup:
    """A figure's SVG as an element of the page.

    Parameters
    ----------
    path
        File of our own making.
    alt
        What it shows, for those who do not see it.
    """
    text = path.read_text(encoding="utf-8")
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, count=1, flags=re.DOTALL)  # of matplotlib
    prefix = path.stem

    def renamed(match: re.Match[str]) -> str:
        before, name, after = (part for part in match.groups() if part is not None)
        return f"{before}{prefix}-{name}{after}"

    text = _IDS.sub(renamed, text)
    for colour, variable in _VARIABLES.items():
        text = text.replace(colour, variable)
    # curves take some of the ink: dark ones are seen on dark paper, and light ones on light paper
    text = _STROKE.sub(r"stroke: color-mix(in srgb, \1 72%, var(--ink))", text)
    size = re.search(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', text)
    width = float(size[1]) if size else 0.0
    head = Markup('<svg role="img" aria-label="{}" class="figure" style="max-width: {:.0f}px"').format(alt, 1.9 * width)
    text = re.sub(r'<svg\b([^>]*?)\s(?:width|height)="[^"]*"', r"<svg\1", text, count=1)
    text = re.sub(r'<svg\b([^>]*?)\s(?:width|height)="[^"]*"', r"<svg\1", text, count=1)
    return head + Markup(text.removeprefix("<svg"))
