"""The drawings of the problems, for the page and for the documentation (`docs/problem.svg`, `docs/film.svg`).

Not to scale: the contact is some hundredths of the radius wide in truth.
"""

from collections.abc import Sequence
from itertools import pairwise

from workflow.report.svg import ACCENT, BAD, BODY, GOOD, INK, PAPER, PUNCH, SECOND, SOFT, TIP

TITLE = "A conducting punch slides on a magneto-electro-elastic half-plane"
ON_FILM = "A conducting punch slides on a film on its base"
ON_LAYERS = "A conducting punch slides on layers on their base"
AT_POINT = "A conducting ball is pressed into a body"
_WIDTH, _HEIGHT, _SURFACE = 760, 430, 250  # the surface y = 0 lies at this height of the picture
_RADIUS, _LEADING, _TRAILING, _LOW = 150, 300, 440, 380  # contact from x to x; x of the punch's lowest point
_DATUM = 690
_LETTER = 24  # size of letters: 11 pixels on a phone of 390
#: Share of its width at which a page shows a drawing: letters as large as those of the text.
SHOWN = 0.72
_CONTACT = 62  # half of a point contact
_TOP, _MIDDLE, _BOTTOM = 150, 222, 294  # of a film: surface, interface inside, base


def _line(x0: float, y0: float, x1: float, y1: float, colour: str = INK, attributes: str = "") -> str:
    return f'<line x1="{x0}" y1="{y0}" x2="{x1}" y2="{y1}" stroke="{colour}" stroke-width="1.6" {attributes}/>'


def _arrow(x0: float, y0: float, x1: float, y1: float, colour: str = INK, two_headed: bool = False) -> str:
    start = 'marker-start="url(#tip)" ' if two_headed else ""
    return _line(x0, y0, x1, y1, colour, f'{start}marker-end="url(#tip)"')


def _text(x: float, y: float, text: str, colour: str = INK, anchor: str = "middle", style: str = "italic") -> str:
    return f'<text x="{x}" y="{y}" fill="{colour}" text-anchor="{anchor}" font-style="{style}">{text}</text>'


def _words(x: float, y: float, text: str, anchor: str = "middle") -> str:
    return _text(x, y, text, SOFT, anchor, "normal")


def _span(x0: float, x1: float, y: float, text: str) -> list[str]:
    """A dimension line with its letter."""
    return [_arrow(x0, y, x1, y, two_headed=True), _text((x0 + x1) / 2, y - 6, text)]


def _opened(title: str) -> list[str]:
    return [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {_HEIGHT}" '
        f'font-family="serif" font-size="{_LETTER}">',
        f"<title>{title}</title>",
        f'<rect width="{_WIDTH}" height="{_HEIGHT}" fill="{PAPER}"/>',
        TIP,
    ]


def _band(top: int, bottom: int, colour: str) -> str:
    return f'<rect x="20" y="{top}" width="{_WIDTH - 40}" height="{bottom - top}" fill="{colour}"/>'


def draw() -> str:
    """The drawing as SVG."""
    centre = (_LEADING + _TRAILING) / 2
    top = _SURFACE - _RADIUS * 2 + 30
    parts = [
        *_opened(TITLE),
        # body and punch
        f'<rect x="20" y="{_SURFACE}" width="{_WIDTH - 40}" height="{_HEIGHT - _SURFACE - 12}" fill="{BODY}"/>',
        f'<path d="M{_LOW - 138} {top + 90} A {_RADIUS} {_RADIUS} 0 0 0 {_LOW + 138} {top + 90} Z" fill="{PUNCH}" '
        f'stroke="{INK}" stroke-width="1.6" transform="translate(0 {_SURFACE - top - 182})"/>',
        _line(20, _SURFACE, _WIDTH - 20, _SURFACE),
        _thick(_LEADING, _TRAILING, _SURFACE, BAD),
        # loads
        _arrow(_LOW, 20, _LOW, 120, BAD),
        _text(_LOW + 18, 48, "P", BAD),
        _arrow(_LOW - 30, 128, _LOW - 115, 128, BAD),
        _text(_LOW - 124, 134, "Q = \u03b7P", BAD, "end"),
        _words(_LOW - 190, 96, "the punch slides to \u2212x", "middle"),
        _text(_LOW + 52, 128, "T, J", ACCENT),
        _words(_LOW + 80, 128, "charges; \u03c6, \u03c8 constant", "start"),
        _line(_LOW, _SURFACE - 4, _LOW - 84, _SURFACE - 88, SOFT),
        _text(_LOW - 60, _SURFACE - 40, "R"),
        # contact
        *_span(_LEADING, _LOW, _SURFACE + 34, "b"),
        *_span(_LOW, _TRAILING, _SURFACE + 34, "a"),
        *_span(centre, _TRAILING, _SURFACE + 76, "h"),
        _line(centre, _SURFACE, centre, _SURFACE + 80, SOFT, 'stroke-dasharray="3 3"'),
        _line(_LEADING, _SURFACE, _LEADING, _SURFACE + 42, SOFT),
        _line(_TRAILING, _SURFACE, _TRAILING, _SURFACE + 80, SOFT),
        _line(_LOW, _SURFACE, _LOW, _SURFACE + 42, SOFT, 'stroke-dasharray="3 3"'),
        _words(_LEADING - 8, _SURFACE + 24, "leading edge X = \u22121", "end"),
        _words(_TRAILING + 8, _SURFACE + 24, "trailing edge X = 1", "start"),
        _text(centre - 18, _SURFACE + 82, "X = (x \u2212 c)/h", INK, "end"),
        _text(centre - 18, _SURFACE + 112, "c = (a \u2212 b)/2", INK, "end"),
        # axes, poling, datum
        _arrow(60, _SURFACE, 112, _SURFACE, GOOD),
        _text(108, _SURFACE - 8, "x", GOOD),
        _arrow(60, _SURFACE, 60, _SURFACE - 52, GOOD),
        _text(46, _SURFACE - 40, "y", GOOD),
        _arrow(60, _HEIGHT - 40, 60, _HEIGHT - 104, ACCENT),
        _words(74, _HEIGHT - 36, "poling", "start"),
        _words(_WIDTH - 40, _HEIGHT - 30, "magneto-electro-elastic half-plane", "end"),
        f'<circle cx="{_DATUM}" cy="{_SURFACE}" r="5" fill="{GOOD}"/>',
        _words(_WIDTH - 24, _SURFACE - 14, "datum: u, \u03c6, \u03c8 = 0", "end"),
        *_span(_TRAILING, _DATUM, _SURFACE + 112, "L"),
        _line(_DATUM, _SURFACE, _DATUM, _SURFACE + 118, SOFT, 'stroke-dasharray="3 3"'),
        _line(_TRAILING, _SURFACE + 80, _TRAILING, _SURFACE + 118, SOFT, 'stroke-dasharray="3 3"'),
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


def _punch() -> str:
    """The lower part of a circular punch, whose lowest point is just below the surface of a film."""
    return (
        f'<path d="M{_LOW - 138} {_TOP - 92} A {_RADIUS} {_RADIUS} 0 0 0 {_LOW + 138} {_TOP - 92} Z" fill="{PUNCH}" '
        f'stroke="{INK}" stroke-width="1.6" transform="translate(0 1)"/>'
    )


def _punch_on_film() -> list[str]:
    """The punch, the surface and the contact."""
    return [_punch(), _line(20, _TOP, _WIDTH - 20, _TOP), _thick(_LEADING, _TRAILING, _TOP, BAD)]


def _thick(start: float, end: float, y: float, colour: str) -> str:
    return f'<line x1="{start}" y1="{y}" x2="{end}" y2="{y}" stroke="{colour}" stroke-width="4"/>'


def _loads_on_film() -> list[str]:
    """Load, friction and charges, and half the length of the contact."""
    centre = (_LEADING + _TRAILING) / 2
    return [
        _arrow(_LOW, 12, _LOW, 52, BAD),
        _text(_LOW + 16, 30, "P", BAD),
        _arrow(_LOW - 30, 80, _LOW - 100, 80, BAD),
        _text(_LOW + 60, 86, "T, J", ACCENT),
        _text(_LOW - 62, 106, "Q = \u03b7P", BAD),
        # contact: the centre, and half its length
        _line(centre, _TOP, centre, _TOP + 30, SOFT, 'stroke-dasharray="3 3"'),
        _line(_TRAILING, _TOP, _TRAILING, _TOP + 30, SOFT),
        *_span(centre, _TRAILING, _TOP + 26, "h"),
    ]


def _electrode() -> list[str]:
    """Interface of a film and its base, with the ground of the electrode."""
    return [
        _thick(20, _WIDTH - 20, _BOTTOM, ACCENT),
        _line(640, _BOTTOM, 640, _BOTTOM + 14, ACCENT),
        *(_line(640 - w, _BOTTOM + 14 + d, 640 + w, _BOTTOM + 14 + d, ACCENT) for w, d in ((13, 0), (8, 5), (3, 10))),
    ]


def _axes_on_film() -> list[str]:
    """Axes and poling."""
    return [
        _arrow(60, _TOP, 112, _TOP, GOOD),
        _text(108, _TOP - 8, "x", GOOD),
        _arrow(60, _TOP, 60, _TOP - 52, GOOD),
        _text(46, _TOP - 40, "y", GOOD),
        _arrow(60, _BOTTOM - 14, 60, _BOTTOM - 66, ACCENT),
        _words(70, _BOTTOM - 14, "poling", "start"),
    ]


def _layered(layers: Sequence[str], base: str) -> list[str]:
    """Layers from the top down, their interfaces and their base, with names."""
    edges = [round(_TOP + (_BOTTOM - _TOP) * number / len(layers)) for number in range(len(layers) + 1)]
    bands = list(zip(pairwise(edges), layers, strict=True))
    return [
        *(_band(*band, (BODY, SECOND)[number % 2]) for number, (band, _) in enumerate(bands)),
        _band(_BOTTOM, _HEIGHT - 12, PUNCH),
        *(_line(20, y, _WIDTH - 20, y) for y in edges[1:-1]),
        _arrow(600, _TOP, 600, edges[1], two_headed=True),
        _words(610, (_TOP + edges[1]) // 2 + 5, "thickness", "start"),
        *(_words(160, (top + low) // 2 + 6, name, "start") for (top, low), name in bands),
        _words(130, _BOTTOM + 98, f"base: rigid, or a {base}", "start"),
        *_electrode(),
        _words(624, _BOTTOM + 32, "interface: grounded (\u03c6 = 0, an electrode),", "end"),
        _words(624, _BOTTOM + 60, "or bonded (\u03c6 and D pass)", "end"),
    ]


def _closed(parts: Sequence[str]) -> str:
    return "\n".join([*parts, *_axes_on_film(), "</svg>"]) + "\n"


def one_film(layers: Sequence[str] = ("film",)) -> str:
    """A punch on a film, or layers from the top down, and their base, as SVG."""
    title = ON_FILM if len(layers) == 1 else ON_LAYERS
    return _closed([*_opened(title), *_layered(layers, "half-plane"), *_punch_on_film(), *_loads_on_film()])


def point(layers: Sequence[str] = ()) -> str:
    """A ball on a film, layers from the top down on their base, or a half-space where there are none, as SVG."""
    end = _LOW + _CONTACT
    half_space = [_band(_TOP, _HEIGHT - 12, BODY), _words(_WIDTH - 40, _HEIGHT - 30, "half-space", "end")]
    return _closed(
        [
            *_opened(AT_POINT),
            *(_layered(layers, "half-space") if layers else half_space),
            _punch(),
            _line(20, _TOP, _WIDTH - 20, _TOP),
            _thick(_LOW - _CONTACT, end, _TOP, BAD),
            _arrow(_LOW, 12, _LOW, 52, BAD),
            _text(_LOW + 16, 30, "P", BAD),
            _text(_LOW + 60, 86, "T, J", ACCENT),
            _line(_LOW, _TOP - 4, _LOW - 62, _TOP - 66, SOFT),
            _text(_LOW - 48, _TOP - 28, "R"),
            _line(_LOW, _TOP, _LOW, _TOP + 30, SOFT, 'stroke-dasharray="3 3"'),
            _line(end, _TOP, end, _TOP + 30, SOFT),
            *_span(_LOW, end, _TOP + 26, "a"),
        ]
    )


def film() -> str:
    """A punch on a film of two layers and its base, as SVG."""
    far, low = 560, _HEIGHT - 12
    parts = [
        *_opened("A conducting punch slides on a film of two layers on its base"),
        _band(_TOP, _MIDDLE, BODY),
        _band(_MIDDLE, _BOTTOM, SECOND),
        _band(_BOTTOM, low, PUNCH),
        *_punch_on_film(),
        _line(20, _MIDDLE, _WIDTH - 20, _MIDDLE),
        *_loads_on_film(),
        # thicknesses
        *(
            part
            for x, top, bottom, name in (
                (far, _TOP, _MIDDLE, "h\u2081"),
                (far, _MIDDLE, _BOTTOM, "h\u2082"),
                (far + 80, _TOP, _BOTTOM, "H"),
            )
            for part in (_arrow(x, top, x, bottom, two_headed=True), _text(x + 10, bottom - 26, name, anchor="start"))
        ),
        # what each body is
        _words(130, _TOP + 62, "top layer: the edges are its own", "start"),
        _words(160, _MIDDLE + 42, "layer 2", "start"),
        _words(130, _BOTTOM + 88, "base: rigid, or a half-plane", "start"),
        *_electrode(),
        _words(624, _BOTTOM + 32, "electrode: \u03c6 = 0, D jumps", "end"),
        _words(624, _BOTTOM + 60, "or bonded: \u03c6 and D pass", "end"),
        _words(700, _BOTTOM + 116, "a wave goes down like exp(\u2212Gk\u00b7depth), a part comes back", "end"),
        # a surface traction of wavenumber k, and what comes back
        _arrow(_TRAILING + 20, _TOP + 8, _TRAILING + 44, _BOTTOM - 6, BAD),
        _arrow(_TRAILING + 44, _BOTTOM - 6, _TRAILING + 68, _TOP + 8, GOOD),
    ]
    return _closed(parts)
