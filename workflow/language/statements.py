"""The texts of a design question: objectives and limits, read by a fixed grammar. Nothing in them is evaluated.

objective := expression | deviation
deviation := "deviation(" expression ["over" factor ("," factor)*] ")"
limit     := (expression | deviation) ("<=" | ">=" | "<" | ">") bound ["with probability" number]
bound     := number [unit] | [number ["%"]] ["of"] name         the name of a material's limit, as coercive_field
"""

import re
from dataclasses import dataclass
from math import isfinite
from typing import Any

from solver import units
from workflow.language import grammar
from workflow.language.constants import ALLOWABLES, Meeting
from workflow.language.expressions import Expression

_LIMIT = re.compile(
    r"(?P<left>.+?)\s*(?P<sign><=|>=|<|>)\s*(?P<value>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w.]))?\s*"
    rf"(?P<unit>.*?)\s*(?:\b(?:of\s+)?(?P<allowable>{'|'.join(ALLOWABLES)}))?"
    r"(?:\s*\bwith\s+probability\s+(?P<probability>\d*\.?\d+))?\s*"
)
_DEVIATION = re.compile(
    r"\s*deviation\((?P<inner>.*?)(?:\s+over\s+(?P<over>[A-Za-z]\w*(?:\s*,\s*[A-Za-z]\w*)*))?\s*\)\s*"
)


@dataclass(frozen=True, kw_only=True)
class Statement:
    """Expression of a design question, with its text."""

    text: str  # of the statement, as the study has it
    inner: str  # text of the expression
    expression: Expression  # that is an objective or is bounded
    deviation: bool = False  # whether its largest relative deviation from its mean over the cases counts instead
    over: tuple[str, ...] = ()  # factors over which a deviation is taken; none: all that a design does not choose
    meeting: Meeting = "line"  # kind of contact and amplifier by which figures were read

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True, kw_only=True)
class Objective(Statement):
    """An expression that is maximised or minimised."""

    maximise: bool

    @property
    def sign(self) -> float:
        """1 for a maximum, -1 for a minimum."""
        return 1.0 if self.maximise else -1.0

    @property
    def key(self) -> str:
        """Key of a target under which the objective stands."""
        return "maximise" if self.maximise else "minimise"


@dataclass(frozen=True, kw_only=True)
class Limit(Statement):
    """A bound of an expression in SI units."""

    key = "subject_to"

    value: float  # bound in the expression's SI unit, or share of the allowable
    upper: bool  # whether it is an upper bound
    probability: float | None = None  # share of the uncertain cases that must keep it; None: every case
    unitless: bool = False  # whether a bound in SI was written without the unit that the expression has
    allowable: str = ""  # name of the material's limit that bounds the expression, if any

    @property
    def sign(self) -> float:
        """1 for an upper bound, -1 for a lower one."""
        return 1.0 if self.upper else -1.0


def objective(text: str, *, maximise: bool = True, meeting: Meeting = "line") -> Objective:
    """Read an objective."""
    fields = _statement_fields(text, text, meeting)
    if fields["deviation"] and maximise:
        raise ValueError(f"{text!r}: a deviation is minimised")
    return Objective(**fields, maximise=maximise)


def _statement_fields(text: str, left: str, meeting: Meeting) -> dict[str, Any]:
    """Return the fields of a statement whose expression, or deviation of one, is `left`."""
    match = _DEVIATION.fullmatch(left) if len(left) <= grammar.LONGEST else None
    inner, over = (match["inner"], match["over"] or "") if match else (left, "")
    return {
        "text": " ".join(text.split()),
        "inner": " ".join(inner.split()),
        "expression": grammar.parse(inner, meeting),
        "deviation": match is not None,
        "over": tuple(name.strip() for name in over.split(",") if name.strip()),
        "meeting": meeting,
    }


def limit(text: str, meeting: Meeting = "line") -> Limit:
    """Read a limit."""
    if len(text) > grammar.LONGEST:
        raise ValueError(f"a limit of {len(text)} characters is longer than {grammar.LONGEST}")
    match = _LIMIT.fullmatch(text)
    if match is None or (match["value"] is None and not match["allowable"]):
        raise ValueError(f"{text!r} is not of the form: expression <= number [unit] [with probability p]")
    fields = _statement_fields(text, match["left"], meeting)
    expression, is_deviation = fields["expression"], fields["deviation"]
    try:
        unit = units.parse(match["unit"])
    except ValueError as error:
        raise ValueError(f"{text!r}: {error}") from None
    expected = units.Unit.none() if is_deviation else expression.unit()
    allowable = match["allowable"] or ""
    if allowable:
        _check_allowable(text, allowable, unit, expected)
    elif match["unit"] and expected is not None and not unit.fits(expected):
        shown = str(expected) if is_deviation else expression.interface_unit() or str(expected)
        raise ValueError(f"{text!r}: unit mismatch: the limit is in {match['unit']}, the expression in {shown}")
    value = float(match["value"] or 1.0) * unit.scale
    if not isfinite(value):
        raise ValueError(f"{text!r}: {match['value']} is not a finite number")
    probability = float(match["probability"]) if match["probability"] else None
    if probability is not None and not 0.5 <= probability < 1:
        raise ValueError(f"{text!r}: probability {probability:g} is not from 0.5 to below 1")
    if is_deviation and (probability is not None or "<" not in match["sign"] or value <= 0):
        raise ValueError(f"{text!r}: a deviation takes a positive upper bound and no probability")
    if allowable and not value > 0:
        raise ValueError(f"{text!r}: {value:g} of {allowable} is no bound; must be a positive share")
    bare = not match["unit"] and not allowable and value != 0
    unitless = bare and expected is not None and not expected.fits(units.Unit.none())
    return Limit(
        **fields,
        value=value,
        upper="<" in match["sign"],
        probability=probability,
        unitless=unitless,
        allowable=allowable,
    )


def _check_allowable(text: str, allowable: str, unit: units.Unit, expected: units.Unit | None) -> None:
    """Refuse a share of a material limit that may not bound the expression."""
    if not unit.fits(units.Unit.none()):
        raise ValueError(f"{text!r}: {str(unit)!r} before {allowable}: must be a pure number or %")
    allowable_units = ALLOWABLES[allowable].units
    if expected is None or not expected.fits(units.parse(allowable_units)):
        raise ValueError(
            f"{text!r}: unit mismatch: {allowable} is in {allowable_units}, the expression in {expected or 1}"
        )
