"""Names of quantities, factors, expressions and limits in words, as pages and messages have them."""

import math
import re
from collections.abc import Sequence

from solver.names import ALL_QUANTITIES, NEVER_TEMPERATURE, NEVER_TIME
from workflow.language import statements
from workflow.language.constants import FIGURES
from workflow.language.expressions import Expression, Name, Operation
from workflow.language.factors import FACTORS
from workflow.language.numbers import shown
from workflow.language.wordings import TITLES

_NAME, _SIZE, _OTHERS = re.compile(r"[A-Za-z_]\w*"), re.compile(r"\babs\(([^()]*)\)"), re.compile(r"[-+*^]|/.*/")
_SUM = r"\bcontact_(?:trailing \+ contact_leading|leading \+ contact_trailing)\b"
_NEVER = {"heat_time": NEVER_TIME, "temperature_equal": NEVER_TEMPERATURE}
_WIDTH = re.compile(rf"(?<!\w)\({_SUM}\)|{_SUM}")  # with the sum's brackets, but not those of a function


def title(name: str) -> str:
    """Return a quantity or factor in words."""
    return TITLES.get(name, name.replace("_", " "))


def capital(text: str) -> str:
    """Return a text with a capital first letter, the others as they are."""
    return text[:1].upper() + text[1:]


def listed(words: Sequence[str]) -> str:
    """Return words with commas between them, and an "and" before the last."""
    return " and ".join(filter(None, (", ".join(words[:-1]), *words[-1:])))


def spoken(expression: Expression, text: str) -> str:
    """Return an expression in words: the title of a name, its magnitude or a ratio, else the text with titles."""
    figure = text.strip().removeprefix("abs(").removesuffix(")").strip()
    if figure in FIGURES:
        return title(figure)
    if isinstance(expression, Name):
        return title(expression.name)
    if isinstance(expression, Operation) and expression.symbol == "abs":
        return spoken(expression.parts[0], text)
    if isinstance(expression, Operation) and expression.symbol == "/":
        parts = [spoken(part, "") for part in expression.parts]
        return " over ".join(parts) if all(parts) else in_words(text)
    return in_words(text)


def in_words(text: str) -> str:
    """Return an expression's text with its names in words, without abs(), and a lone division as "over"."""
    words = _NAME.sub(lambda match: title(match[0]), _WIDTH.sub("width of the contact", _SIZE.sub(r"\1", text)))
    return words.replace(" / ", " over ") if not _OTHERS.search(text) else words


def stated(statement: statements.Statement) -> str:
    """Return a statement's expression in words, with the factors of a deviation."""
    words = spoken(statement.expression, statement.inner)
    over = f" over {listed([title(name) for name in statement.over])}" if statement.over else ""
    return f"deviation of {words}{over}" if statement.deviation else words


def wanted(goals: Sequence[statements.Objective]) -> str:
    """Return the goals of a design in words, as the title of its card."""
    parts = []
    for goal in goals:
        words, most = stated(goal), "largest" if goal.maximise else "smallest"
        parts.append(words if words.startswith(most) else f"{most} {words}")
    return capital(listed(parts))


def units(statement: statements.Statement, si: str) -> str:
    """Return the unit in which a statement's values are shown, from the one in SI: % for deviations."""
    return "%" if statement.deviation else si


def bound(limit: statements.Limit, value: float, units: str) -> str:
    """Return a limit in words."""
    chance = "" if limit.probability is None else f" with probability {limit.probability:g}"
    return f"{stated(limit)} at {'most' if limit.upper else 'least'} {shown(value, units, 3)}{chance}"


def value(name: str, number: float, digits: int = 3) -> str:
    """Return a factor's or quantity's value with its unit; "never" for what heat does not reach."""
    if number >= _NEVER.get(name, math.inf):
        return "never"
    return shown(number, (FACTORS[name] if name in FACTORS else ALL_QUANTITIES[name]).units, digits)


def span(name: str, low: float, high: float) -> str:
    """Return a factor in words with the ends of its range; zero needs no unit."""
    return f"{title(name)} {value(name, low) if low else 0} to {value(name, high)}"
