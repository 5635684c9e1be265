"""The drawing to scale of a design: the whole punch on its body, and its contact magnified."""

from dataclasses import dataclass

import numpy as np
from markupsafe import escape

from approximation.arrays import Array
from solver.names import CONTACTS, FACTORS, PROFILES
from workflow.language.numbers import number, shown
from workflow.report.svg import ACCENT, BAD, BODY, INK, PAPER, PUNCH, SOFT, TIP

_WIDTH, _HEIGHT = 560, 250
_SURFACE = 128.0  # height of the surface in the picture
_WHOLE, _NEAR = (14.0, 206.0), (236.0, 546.0)  # from x to x: the punch whole, and its contact
_BETWEEN = 221  # x between both
_TOP, _LOW = 26.0, 222.0  # of either part
_WORDS = 46  # letters that have room below the film
_DEVICE = 84.0  # height of a whole punch
_WIDER = 2.6  # times the contact that the magnified part shows, or more
_DEEP = 62.0  # of the magnified film, at most
_TIPS = 10.0  # half of the least length that has room for two arrows
_BAR = (4.0, 90.0)  # lengths of the bar that tells the scale
_LINE = 22.0  # height of a line of text
_POINTS = 97
_LETTER = 8.5  # width of a letter, and some room
_CORNERED = ("wedge", "half_cylinder")  # which lie on one side of their edge
_FLAT, _POWERS = ("flat", "disc"), ("cone", "power")
_ENDLESS = ("wedge", *_POWERS)  # of which a part is drawn
_SIZES = {"flat": "w = ", "disc": "w = ", "wedge": "slope ", "cone": "slope ", "power": "C = "}
_BOTH_ENDS = f'stroke="{INK}" stroke-width="1.6" marker-start="url(#tip)" marker-end="url(#tip)"'


@dataclass(frozen=True)
class Device:
    """A punch on its body, in SI units."""

    profile: str  # as the interface names it
    corner: str  # side of the sharp edge
    size: float  # radius, width of a flat punch or disc, slope of a wedge or cone, or coefficient of a power
    trailing: float  # extents of the contact; of a point both are its radius
    leading: float
    load: float  # per length, or the force on a point
    conducts: bool = True  # whether the punch is an electrode
    thickness: float | None = None  # of a film; None on a half-space or half-plane
    base: str = ""  # of a film, in words
    grounded: bool = False  # whether an electrode lies between film and base
    exponent: float = 1.0  # of the profile of a power
    slides: bool = False  # whether there is friction
    top: str = "film"  # name of the layer with the thickness

    @property
    def point(self) -> bool:
        """Return whether the drawing is a section through a point contact."""
        return PROFILES[self.profile].contact == "point"

    @property
    def pressed(self) -> str:
        """Load in words."""
        return shown(self.load, FACTORS[CONTACTS[PROFILES[self.profile].contact].force].units, 3)

    @property
    def contact(self) -> float:
        """Width of the contact [m]."""
        return self.trailing + self.leading

    @property
    def reach(self) -> float:
        """Half the width of the whole punch [m]."""
        if self.profile in _ENDLESS:
            return 2 * self.contact
        return self.size / 2 if self.profile in _FLAT else self.size

    def heights(self, x: Array) -> Array:
        """Return the height of the punch's face over its lowest point [m], (x,); NaN outside the punch."""
        if self.profile in _FLAT:
            return np.where(np.abs(x) <= self.size / 2, 0.0, np.nan)
        if self.profile in _POWERS:
            return np.asarray(abs(self.size) * np.abs(x) ** self.exponent)
        if self.profile == "wedge":
            ahead = self._ahead(x)
            return np.where(ahead >= 0, abs(self.size) * ahead, np.nan)
        whole = self.profile != "half_cylinder"
        ahead = x if whole else self._ahead(x)
        inside = (np.abs(ahead) <= self.size) & (whole | (ahead >= 0))
        return np.where(inside, self.size - np.sqrt(np.maximum(self.size**2 - ahead**2, 0.0)), np.nan)

    def _ahead(self, x: Array) -> Array:
        """Return the distance from the sharp edge towards the other edge [m], (x,)."""
        return x + self.leading if self.corner == "leading" else self.trailing - x

    @property
    def sunk(self) -> float:
        """Depth of the lowest point below the ends of the contact [m]."""
        ends = self.heights(np.array([-self.leading, self.trailing]) * (1 - 1e-9))
        return float(np.nanmax(ends)) if np.any(np.isfinite(ends)) else 0.0

    @property
    def magnified(self) -> float:
        """Scale of the magnified part over that of the whole."""
        return self._near_scale / self._whole_scale

    @property
    def _whole_scale(self) -> float:
        """Pixels a metre of the whole punch."""
        return (_WHOLE[1] - _WHOLE[0] - 24) / (2 * self.reach)

    @property
    def _near_scale(self) -> float:
        wide = (_NEAR[1] - _NEAR[0]) / (_WIDER * self.contact)
        return wide if self.thickness is None else min(wide, _DEEP / self.thickness)


def draw(device: Device, title: str) -> str:
    """Return the drawing as SVG with two parts, the whole punch and its contact."""
    whole, near = _dimensions(device)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {_HEIGHT}" font-size="14">',
        f"<title>{escape(title)}</title>",
        *_placed(0, _BETWEEN, [*_part(device, _WHOLE, device._whole_scale), *_loads(device), *whole]),
        *_placed(_BETWEEN, _WIDTH, [*_part(device, _NEAR, device._near_scale), *near]),
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


def _placed(left: int, right: int, parts: list[str]) -> list[str]:
    """Return one part of the drawing from `left` to `right`, which a page may set below the other."""
    size = f'width="{right - left}" height="{_HEIGHT}"'
    return [
        f'<svg class="part" x="{left}" {size} viewBox="0 0 {right - left} {_HEIGHT}" font-size="14">',
        f'<rect {size} fill="{PAPER}"/>',
        TIP,
        f'<g transform="translate({-left} 0)">',
        *parts,
        "</g>",
        "</svg>",
    ]


def _part(device: Device, ends: tuple[float, float], scale: float) -> list[str]:
    """Return body and punch to scale between two places of the picture, whose middle is the contact's."""
    left, right = ends
    middle = (device.trailing - device.leading) / 2
    parts = [f'<rect x="{left}" y="{_SURFACE}" width="{right - left}" height="{_LOW - _SURFACE}" fill="{BODY}"/>']
    if device.thickness is not None:
        interface = min(_SURFACE + max(device.thickness * scale, 1.2), _LOW)
        size = f'width="{right - left}" height="{_LOW - interface:.2f}"'
        parts.append(f'<rect x="{left}" y="{interface:.2f}" {size} fill="{PUNCH}"/>')
        if device.grounded:
            parts.append(_line(left, interface, right, interface, ACCENT, 2.2))
    x = middle + np.linspace(left - right, right - left, _POINTS) / 2 / scale
    x = np.unique(np.concatenate([x, _edges(device)]))
    x = x[np.abs(x - middle) * scale <= (right - left) / 2 * (1 + 1e-9)]
    heights = device.heights(x)
    x, heights = x[np.isfinite(heights)], heights[np.isfinite(heights)]
    places = (left + right) / 2 + (x - middle) * scale
    faces = np.maximum(_SURFACE - (heights - device.sunk) * scale, _TOP)
    top = max(_TOP, _SURFACE - _DEVICE) if scale == device._whole_scale else _TOP
    outline = " ".join(f"{place:.2f},{max(face, top):.2f}" for place, face in zip(places, faces, strict=True))
    parts.append(_line(left, _SURFACE, right, _SURFACE))
    parts.append(
        f'<polygon points="{places[0]:.2f},{top} {outline} {places[-1]:.2f},{top}" fill="{PUNCH}" stroke="{INK}"/>'
    )
    if device.conducts:
        parts.append(f'<polyline points="{outline}" fill="none" stroke="{ACCENT}" stroke-width="2.2"/>')
    a, b = ((left + right) / 2 + (end - middle) * scale for end in (-device.leading, device.trailing))
    parts.append(_line(a, _SURFACE, max(b, a + 1.2), _SURFACE, BAD, 4))
    return parts


def _edges(device: Device) -> Array:
    """Return the positions of the punch's sharp edges [m], just inside."""
    inside = 1 - 1e-9
    if device.profile in _FLAT:
        return np.array([-0.5, 0.5]) * device.size * inside
    return np.array([-device.leading, device.trailing, -device.reach, device.reach]) * inside


def _loads(device: Device) -> list[str]:
    """Return load and direction of sliding, beside the whole punch."""
    left, middle = _WHOLE[0] + 4, sum(_WHOLE) / 2
    parts = [_line(middle, 4, middle, 38, BAD, 1.6, tip=True), _text(middle + 8, 16, device.pressed, BAD, "start")]
    if device.slides:
        parts += [_line(left + 52, 28, left, 28, BAD, 1.6, tip=True), _text(left, 18, "slides", BAD, "start")]
    return parts


def _dimensions(device: Device) -> tuple[list[str], list[str]]:
    """Return the numbers of both parts: radius or width; contact, thickness and magnification."""
    middle, near = sum(_WHOLE) / 2, sum(_NEAR) / 2
    half = device.contact * device._near_scale / 2
    name = _SIZES.get(device.profile, "R = ")
    size = number(device.size, 3) if device.profile in _ENDLESS else shown(device.size, "m", 3)
    start = near if device.point else near - half  # of the contact's dimension line
    extent = f"a = {shown(device.trailing, 'm', 3)}" if device.point else shown(device.contact, "m", 3)
    whole = [
        _size_text(device, middle, name + size),
        _text(_WHOLE[0], _HEIGHT - 10, "to scale", SOFT, "start"),
        *_bar(device._whole_scale),
    ]
    parts = [
        _text(_NEAR[0], _HEIGHT - 10, f"the contact, at {number(device.magnified, 2)} times that scale", SOFT, "start"),
        *([f'<path d="M{start:.2f} {_SURFACE - 16} H{near + half:.2f}" {_BOTH_ENDS}/>'] if half > _TIPS else []),
        _extent(device, near, extent),
    ]
    if device.thickness is None:
        body = "half-space" if device.point else "half-plane"
        return whole, [*parts, _text(_NEAR[0] + 8, _LOW - 10, body, SOFT, "start")]
    interface = _SURFACE + device.thickness * device._near_scale
    place, below = _NEAR[1] - 14, ", grounded electrode between" if device.grounded else ""
    below = below if len(device.base + below) <= _WORDS else ", electrode"
    words = (_SURFACE + interface) / 2 + 5 if interface - _SURFACE > _LINE else interface + _LINE - 4
    return whole, [
        *parts,
        f'<path d="M{place} {_SURFACE} V{interface:.2f}" {_BOTH_ENDS}/>',
        _text(place - 8, words, f"{device.top} {shown(device.thickness, 'm', 3)}", INK, "end"),
        _text(_NEAR[0] + 8, _LOW - 10, escape(device.base) + below, SOFT, "start"),
    ]


def _size_text(device: Device, middle: float, words: str) -> str:
    """Return the punch's size as text: within it, or beside the sharp edge of a half cylinder, which has no room."""
    if device.profile not in _CORNERED:
        return _text(middle, _SURFACE - 50, words)
    side = -1 if device.corner == "leading" else 1  # of the edge
    edge = middle + side * device.contact / 2 * device._whole_scale
    if device.profile == "wedge":
        return _text((edge + (_WHOLE[1] if side < 0 else _WHOLE[0])) / 2, _SURFACE - 50, words)
    return _text(edge + 8 * side, _SURFACE - 50, words, INK, "end" if side < 0 else "start")


def _extent(device: Device, near: float, words: str) -> str:
    """Return the contact's size as text: above it, or beside a punch that is narrower than the words."""
    half = device.reach * device._near_scale
    if device.profile in _CORNERED or 2 * half > _LETTER * len(words):
        return _text(near, _SURFACE - 24, words)
    return _text(near + half + 8, _SURFACE - 24, words, INK, "start")


def _bar(scale: float) -> list[str]:
    """Return a scale bar of 10 mm, or of a visible power of ten times that."""
    length = 0.01
    while length * scale > _BAR[1]:
        length /= 10
    while length * scale < _BAR[0]:
        length *= 10
    start, end, y = _WHOLE[0] + 62, _WHOLE[0] + 62 + length * scale, _HEIGHT - 14
    return [_line(start, y, end, y, INK, 3), _text(end + 6, _HEIGHT - 10, shown(length, "m", 3), SOFT, "start")]


def _line(
    x0: float, y0: float, x1: float, y1: float, colour: str = INK, wide: float = 1.2, *, tip: bool = False
) -> str:
    end = ' marker-end="url(#tip)"' if tip else ""
    return (
        f'<line x1="{x0:.2f}" y1="{y0:.2f}" x2="{x1:.2f}" y2="{y1:.2f}" stroke="{colour}" stroke-width="{wide}"{end}/>'
    )


def _text(x: float, y: float, text: str, colour: str = INK, anchor: str = "middle") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" fill="{colour}" text-anchor="{anchor}">{text}</text>'
