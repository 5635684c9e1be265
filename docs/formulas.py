"""Formulas of the pages as MathML, which browsers show without a script or a network: a hook of MkDocs.

Pages hold LaTeX between dollars, as GitHub shows it too. A formula steps aside while the page is turned into HTML.
"""

import re
from typing import Any

from latex2mathml.converter import convert

_CODE = re.compile(r"(```.*?```|`[^`\n]+`)", re.DOTALL)
_TAG = re.compile(r"\\tag\{(\w+(?:\.\w+)?)\}")
_FORMULA = re.compile(r"\$\$(.+?)\$\$|(?<![\\$\w])\$([^$\n]+(?:\n[^$\n]+)?)\$(?!\w)", re.DOTALL)
_ASIDE = re.compile(r"(?:<p>)?FORMULA(\d+)D(?:</p>)?|FORMULA(\d+)I")

_found: list[str] = []  # of the page that is being made


def on_page_markdown(markdown: str, **_: Any) -> str:
    """The page with a word for every formula; MkDocs calls it by this name."""
    _found.clear()
    parts = _CODE.split(markdown)
    return "".join(part if part.startswith("`") else _FORMULA.sub(_aside, part) for part in parts)


def on_page_content(html: str, **_: Any) -> str:
    """The page with its formulas in their places; MkDocs calls it by this name."""
    return _ASIDE.sub(lambda word: _found[int(word[1] or word[2])], html)


def _aside(formula: re.Match[str]) -> str:
    display, inline = formula.groups()
    _found.append(_displayed(display) if display else _mathml(inline, "inline"))
    return f"FORMULA{len(_found) - 1}{'D' if display else 'I'}"


def _displayed(latex: str) -> str:
    tag = _TAG.search(latex)
    number = f'<span class="number" id="eq-{tag[1]}">({tag[1]})</span>' if tag else ""
    return f'<div class="formula">{_mathml(_TAG.sub("", latex), "block")}{number}</div>'


def _mathml(latex: str, display: str) -> str:
    # browsers know no other variant than "normal"
    return convert(" ".join(latex.split()), display=display).replace('mathvariant="bold"', 'style="font-weight: bold"')
