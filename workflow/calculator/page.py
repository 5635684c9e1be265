"""The calculator's page: one file that needs no server and nothing from elsewhere."""

import json
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from workflow.calculator.films import tables
from workflow.calculator.library import library

TEMPLATES = Path(__file__).parent / "templates"
NUMBERS = Path(__file__).parents[1] / "report/templates/numbers.js"
#: Scripts of what is calculated, which need no page, in their order.
CALCULATING = ("body.js", "line.js", "point.js", "entry.js")
_SHOWING = ("drawing.js", "app.js")

_EXAMPLE = """# a soft PZT; what is left out is zero, or vacuum's
name = "my PZT"
c11 = 126 GPa
c12 = 79.5 GPa
c13 = 84.1 GPa
c33 = 117 GPa
c44 = 23.0 GPa
e31 = -6.5 C/m2
e33 = 23.3 C/m2
e15 = 17.0 C/m2
eps11 = 15.05 nF/m
eps33 = 13.02 nF/m
depoling_stress = 10 MPa
"""


def page() -> str:
    """The page as HTML."""
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES), autoescape=True, undefined=StrictUndefined, keep_trailing_newline=True
    )
    environment.globals |= {"number": _number}
    return environment.get_template("calculator.html.j2").render(
        style=Markup((TEMPLATES / "calculator.css").read_text(encoding="utf-8")),
        script=Markup(script((*CALCULATING, *_SHOWING))),
        library=_embedded(library()),
        films=_embedded(tables()),
        example=_EXAMPLE,
    )


def script(names: tuple[str, ...] = CALCULATING) -> str:
    """Scripts one after the other, those of numbers for people first."""
    parts = [NUMBERS, *(TEMPLATES / name for name in names)]
    return "\n".join(part.read_text(encoding="utf-8") for part in parts)


def _embedded(content: Any) -> Markup:
    """Plain data that nothing within can end before its end."""
    text = json.dumps(content, separators=(",", ":"), allow_nan=False, ensure_ascii=False)
    return Markup(text.replace("<", "\\u003c"))


def _number(
    name: str, words: str, value: str, low: float = 0, high: float = 0, step: float = 0, scale: str = ""
) -> Any:
    """A labelled number with its unit, and a slider where it has a range."""
    slider = (
        Markup('<input type="range" data-of="{}" data-scale="{}" min="{}" max="{}" step="{}" aria-label="{}">').format(
            name, scale, low, high, step, words
        )
        if step
        else ""
    )
    return Markup(
        '<div class="entry"><label for="{0}">{1}</label><input id="{0}" name="{0}" value="{2}" inputmode="text" '
        'spellcheck="false" aria-describedby="{0}-note">{3}<span id="{0}-note" role="alert"></span></div>'
    ).format(name, words, value, slider)
