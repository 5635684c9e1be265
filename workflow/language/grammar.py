"""The grammar of expressions, read by recursive descent. Nothing is executed.

    sum     := product (("+" | "-") product)*
    product := signed (("*" | "/") signed)*
    signed  := ("-" | "+") signed | atom ["^" integer]          ("**" is "^")
    atom    := number [unit] | name | function "(" sum ("," sum)* ")" | "(" sum ")"
    unit    := symbol ((" " | "·" | "/") symbol)*    a symbol with its exponent; no blank beside "/"

Names are the quantities and numeric factors of the interface, limits of materials, and numbers and figures of a device.
A number with a unit is taken to SI. A name with a formula is read as its formula; that of a figure is the meeting's.
"""

import re
from functools import lru_cache
from math import isfinite

from solver import units
from solver.names import ALL_QUANTITIES
from workflow.language.constants import CONSTANTS, FIGURES_BY, Meeting
from workflow.language.expressions import Expression, Name, Number, Operation
from workflow.language.factors import FACTORS
from workflow.language.spelling import nearest

FUNCTIONS = {"abs": 1, "sqrt": 1, "log": 1, "exp": 1, "min": 2, "max": 2}  # number of arguments; min and max: or more
DEEPEST = 40  # levels of brackets; keeps hostile texts from exhausting the stack
LONGEST = 1000  # characters
_KNOWN = {meeting: {**ALL_QUANTITIES, **figures, **CONSTANTS} for meeting, figures in FIGURES_BY.items()}
_TOKEN = re.compile(r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)|(?P<name>[A-Za-z_]\w*)|(?P<sign>\*\*|\S))")
_RAISED = re.compile(r"\s*(?:\^|\*\*)\s*")
_SYMBOL = re.compile(
    r"(?P<joint>\s*·\s*|/|\s*)(?P<symbol>%|eps0|mu0|[^\W\d_]+)"
    r"(?:\s*(?:\^|\*\*)\s*-?\d+|-?\d+(?:/\d+)?|[⁻⁺]?[⁰¹²³⁴⁵⁶⁷⁸⁹]+)?(?![\w(.])"
)


@lru_cache(1024)
def parse(text: str, meeting: Meeting = "line") -> Expression:
    """Read an expression."""
    if len(text) > LONGEST:
        raise ValueError(f"an expression of {len(text)} characters is longer than {LONGEST}")
    try:
        tree = _Parser(text, meeting).whole()
        tree.unit()
    except ValueError as error:
        raise ValueError(f"{text!r}: {error}") from None
    if not tree.names():
        raise ValueError(f"{text!r}: names no quantity")
    return tree


class _Parser:
    """Recursive descent over the tokens."""

    def __init__(self, text: str, meeting: Meeting) -> None:
        self._meeting, self._known = meeting, _KNOWN[meeting]
        self._tokens: list[tuple[str, str]] = []
        self._index = position = 0
        while match := _TOKEN.match(text, position):
            group, position = str(match.lastgroup), match.end()
            self._tokens.append((group, match[group]))
            if group == "number" and (end := self._unit_end(text, position)) > position:
                self._tokens.append(("unit", _RAISED.sub("^", text[position:end].strip())))
                position = end

    def _unit_end(self, text: str, position: int) -> int:
        """Return the position behind the symbols of a unit; names of quantities and factors end the unit."""
        first = True
        while match := _SYMBOL.match(text, position):
            if match["symbol"] in self._known or match["symbol"] in FACTORS or (first and match["joint"].strip()):
                break
            position, first = match.end(), False
        return position

    def whole(self) -> Expression:
        tree = self._sum(0)
        if self._index < len(self._tokens):
            raise ValueError(f"{self._peek()!r} is not expected there")
        return tree

    def _peek(self) -> str:
        return self._tokens[self._index][1] if self._index < len(self._tokens) else ""

    def _take(self, *signs: str) -> str:
        token = self._peek()
        if token in signs and token:
            self._index += 1
            return token
        return ""

    def _sum(self, depth: int) -> Expression:
        if depth > DEEPEST:
            raise ValueError(f"nested more than {DEEPEST} deep")
        tree = self._product(depth)
        while sign := self._take("+", "-"):
            tree = Operation(sign, (tree, self._product(depth)))
        return tree

    def _product(self, depth: int) -> Expression:
        tree = self._signed(depth)
        while sign := self._take("*", "/"):
            tree = Operation(sign, (tree, self._signed(depth)))
        return tree

    def _signed(self, depth: int) -> Expression:
        if depth > DEEPEST:
            raise ValueError(f"nested more than {DEEPEST} deep")
        if sign := self._take("-", "+"):
            inner = self._signed(depth + 1)
            return Operation("*", (Number(-1.0), inner)) if sign == "-" else inner
        atom = self._atom(depth)
        if self._take("^", "**"):
            sign, exponent = self._take("-", "+"), self._peek()
            if not exponent.isdecimal() or int(exponent) > 9:
                raise ValueError("an exponent must be a whole number from -9 to 9")
            self._index += 1
            return Operation("^", (atom, Number(float(sign + exponent))))
        return atom

    def _atom(self, depth: int) -> Expression:
        if self._index >= len(self._tokens):
            raise ValueError("something is missing at its end")
        group, token = self._tokens[self._index]
        self._index += 1
        if group == "number":
            return self._number(token)
        if group == "name" and self._take("("):
            return self._call(token, depth)
        if group == "name":
            if token not in self._known and token not in FACTORS:
                if measures(token):
                    raise ValueError(f"{token!r} is a unit, and stands behind a number without brackets: 0.5 V m N-1")
                raise ValueError(f"{token!r} is not a quantity; {nearest(token, [*self._known, *FACTORS])}")
            formula = self._known[token].formula if token in self._known else ""
            return _Parser(formula, self._meeting).whole() if formula else Name(token)
        if token == "(":
            return self._closed(self._sum(depth + 1))
        raise ValueError(f"{token!r} is not expected there")

    def _number(self, digits: str) -> Number:
        text, unit = digits, None
        if self._index < len(self._tokens) and self._tokens[self._index][0] == "unit":
            text, unit = f"{digits} {self._peek()}", units.parse(self._peek())
            self._index += 1
        value = float(digits) if unit is None else units.scaled(digits, unit.scale)
        if not isfinite(value):
            raise ValueError(f"{text} is not a finite number")
        return Number(value, unit)

    def _call(self, function: str, depth: int) -> Expression:
        if function not in FUNCTIONS:
            raise ValueError(f"{function!r} is not a function; {nearest(function, list(FUNCTIONS))}")
        arguments = [self._sum(depth + 1)]
        while self._take(","):
            arguments.append(self._sum(depth + 1))
        count = FUNCTIONS[function]
        if len(arguments) < count or (count == 1 and len(arguments) > 1):
            raise ValueError(f"{function} takes {count}{' or more' if count > 1 else ''}, not {len(arguments)}")
        return self._closed(Operation(function, tuple(arguments)))

    def _closed(self, tree: Expression) -> Expression:
        if not self._take(")"):
            raise ValueError("a bracket is not closed")
        return tree


def measures(text: str) -> bool:
    """Return whether a text is a unit."""
    try:
        units.parse(text)
    except ValueError:
        return False
    return True
