"""A figure's SVG in a third of its bytes: what matplotlib repeats is said once, nothing is finer than eyes are."""

import hashlib
import re
from collections import Counter

_DROPPED = re.compile(
    r"<!--.*?-->|<metadata>.*?</metadata>|<\?xml[^>]*\?>|<!DOCTYPE[^>]*>|<defs>\s*<style.*?</defs>", re.S
)
_DROPPED_IDS = re.compile(r'<g id="[^"]*"')
_IMAGE_IDS = re.compile(r' id="image[0-9a-f]+"')  # which nothing refers to, and equal images share
_EMPTY = re.compile(r"<g>\s*</g>")
_UNTURNED = re.compile(r' transform="rotate\(-?0 [^)]*\)"')
_BETWEEN = re.compile(r">\s*\n\s*<")
_PATH = re.compile(r'\sd="([^"]*)"')
_PLACED = re.compile(r'\s(?:x|y|transform)="[^"]*"')
_FINE = re.compile(r"-?\d+\.\d+")
_STYLE = re.compile(r' style="([^"]*)"')
_GROUP = re.compile(r"<g>|<g [^>]*>|</g>")
_ID = re.compile(r'(\bid="|url\(#|href="#)([^")]+)')
_STEP = re.compile(r"([A-Za-z])([^A-Za-z]*)")


def compacted(text: str) -> str:
    """The same picture: outlines in hundredths of a point, each style once, short ids, nothing that draws nothing."""
    text = _UNTURNED.sub("", _DROPPED_IDS.sub("<g", _IMAGE_IDS.sub("", _DROPPED.sub("", text))))
    while (fewer := _EMPTY.sub("", text)) != text:
        text = fewer
    text = _shortened(_ungrouped(text))
    text = _PATH.sub(lambda match: f' d="{_outline(match[1])}"', _BETWEEN.sub("><", text))
    text = _PLACED.sub(lambda match: _FINE.sub(lambda decimal: _number(float(decimal[0])), match[0]), text)
    styles = Counter(_STYLE.findall(text))
    names = {style: _name(style) for style, times in styles.items() if times > 1}
    text = _STYLE.sub(lambda match: f' class="{names[match[1]]}"' if match[1] in names else match[0], text)
    rules = "".join(f".{name}{{{style}}}" for style, name in names.items())
    # what matplotlib says of every element
    head = f' stroke-linejoin="round" stroke-linecap="butt"><style>{rules}</style>'
    return text.strip().replace(">", head, 1) + "\n"


def _ungrouped(text: str) -> str:
    """Without the groups that say nothing of what is in them."""
    bare: list[bool] = []

    def kept(match: re.Match[str]) -> str:
        if match[0] != "</g>":
            bare.append(match[0] == "<g>")
            return "" if bare[-1] else match[0]
        return "" if bare.pop() else match[0]

    return _GROUP.sub(kept, text)


def _shortened(text: str) -> str:
    """With the ids numbered as they come."""
    known: dict[str, str] = {}
    return _ID.sub(lambda match: match[1] + known.setdefault(match[2], f"i{len(known)}"), text)


def _name(style: str) -> str:
    """The same for the same style in every figure, as many stand in one page."""
    return "s" + hashlib.blake2b(style.encode(), digest_size=4).hexdigest()


def _number(value: float) -> str:
    """Two decimals, as short as they can be written."""
    return re.sub(r"^(-?)0\.", r"\1.", f"{round(value, 2) + 0.0:g}" if abs(value) < 1e3 else f"{value:.2f}")


def _outline(path: str) -> str:
    """A path whose lines go by differences; no error adds up, as they are differences of rounded places."""
    parts: list[str] = []
    point = (0, 0)
    for letter, numbers in _STEP.findall(path):
        places = [round(100 * float(place)) for place in numbers.split()]
        if letter == "L" and parts:
            across, down = places[0] - point[0], places[1] - point[1]
            letter, numbers = ("h", [across]) if not down else ("v", [down]) if not across else ("l", [across, down])
        else:
            numbers = places
        parts.append(letter + _joined(numbers))
        point = (places[-2], places[-1]) if places else point
    return "".join(parts)


def _joined(hundredths: list[int]) -> str:
    """Numbers with a blank only where the next has no sign of its own."""
    return re.sub(" -", "-", " ".join(_number(hundredth / 100) for hundredth in hundredths))
