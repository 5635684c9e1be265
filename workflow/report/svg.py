"""SVG figures as parts of a page: unique ids, colours that follow light and dark."""

import re

from markupsafe import Markup

#: Colours of figures, which the page replaces by `_VARIABLES`.
INK, PAPER, ACCENT = "#1c2430", "#fbfbf9", "#2166ac"
SOFT, GOOD, BAD = "#5b6675", "#1b7f4d", "#b3261e"
BODY, PUNCH, SECOND = "#eaf1f9", "#e4e5e7", "#f6ecdf"
#: The tip of an arrow, as marker ``tip``, in the colour of its line.
TIP = (
    '<marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" '
    'orient="auto-start-reverse"><path d="M0 0 8 4 0 8z" fill="context-stroke"/></marker>'
)
_VARIABLES = {
    INK: "var(--ink)",
    PAPER: "var(--card)",
    ACCENT: "var(--accent)",
    SOFT: "var(--soft)",
    GOOD: "var(--good)",
    BAD: "var(--bad)",
    BODY: "color-mix(in srgb, var(--accent) 10%, var(--card))",
    PUNCH: "color-mix(in srgb, var(--ink) 12%, var(--card))",
    SECOND: "color-mix(in srgb, #c98a3c 16%, var(--card))",
}
_IDS = re.compile(r'(\bid=")([^"]+)(")|(url\(#)([^)]+)(\))|(href="#)([^"]+)(")')
_PART = re.compile(r'<svg class="part"[^>]*?(viewBox=.*?</svg>)', re.DOTALL)
_SIZE = re.compile(r'<svg\b([^>]*?)\s(?:width|height)="[^"]*"')
_LETTERS, _LETTER = re.compile(r"""font(?:-size)?[=:]["' ]*(\d+(?:\.\d+)?)(?:px|["'])"""), 14.0
_EXPONENT = 7.1  # letters up to this size are raised or lowered ones
_STROKE = re.compile(r"stroke: (#[0-9a-f]{6})")


def element(text: str, name: str, alt: str, enlarged: float = 1.0) -> Markup:
    """Return one of the program's SVGs as an element of the page; several parts side by side where there is room."""
    parts = _PART.findall(text)
    if len(parts) > 1:
        elements = (element(f"<svg {part}", f"{name}-{k}", alt, enlarged) for k, part in enumerate(parts))
        return Markup('<div class="parts">{}</div>').format(Markup("").join(elements))
    text = text[text.index("<svg") :]

    def renamed(match: re.Match[str]) -> str:
        before, middle, after = (part for part in match.groups() if part is not None)
        return f"{before}{name}-{middle}{after}"

    text = _IDS.sub(renamed, text)
    for colour, variable in _VARIABLES.items():
        text = text.replace(colour, variable)
    # curves take some of the ink: dark ones are seen on dark paper, and light ones on light paper
    text = _STROKE.sub(r"stroke: color-mix(in srgb, \1 72%, var(--ink))", text)
    size = re.search(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', text)
    width = enlarged * float(size[1]) if size else 0.0
    # width over that of its smallest label, but for exponents: the page's least width on phones and in print follows
    letters = [size for size in map(float, _LETTERS.findall(text)) if size > _EXPONENT]
    lettered = width / enlarged / min(letters, default=_LETTER)
    head = Markup(
        '<svg role="img" aria-label="{}" class="figure" style="max-width: {:.0f}px; --letter: {:.1f}px"'
    ).format(alt, width, lettered)
    text = _SIZE.sub(r"<svg\1", _SIZE.sub(r"<svg\1", text, count=1), count=1)
    return head + Markup(text.removeprefix("<svg"))
