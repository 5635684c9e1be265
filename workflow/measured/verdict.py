"""The verdict on a row: how many standard deviations the model is off, and what that says."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot
from typing import Literal

from workflow.language.numbers import number
from workflow.measured.values import Spread
from workflow.study.measurement import UNITS, Measurement

#: Standard deviations up to which a row agrees.
AGREES_WITHIN = 2.0
_SLIGHT = 0.01
_SAME = 1e-6  # relative difference up to which a row without an error says the same as the model

Word = Literal["agrees", "disagrees", "cannot be told"]


@dataclass(frozen=True)
class Verdict:
    """Verdict on a row."""

    word: Word  # In a word
    because: str  # Why, in a sentence without a full stop
    # Model less measured over the standard deviation of both, of each value of the model; none where no error is
    # published
    deviations: tuple[float | None, ...]
    rivals: tuple[float | None, ...]  # The same of the other rules


def deviation(row: Measurement, value: Spread) -> float | None:
    """Model less measured over the standard deviation of both; None where no error is published."""
    if row.error is None:
        return None
    scale = UNITS[row.unit]
    return (value.value / scale - row.value) / hypot(row.error, value.deviation / scale)


def judged(row: Measurement, model: Sequence[Spread], rivals: Sequence[Spread] = ()) -> Verdict:
    """The verdict on a row."""
    deviations, others = (tuple(deviation(row, value) for value in values) for values in (model, rivals))
    word, because = _said(row, deviations, others, model)
    return Verdict(word, because, deviations, others)


def _said(
    row: Measurement, deviations: Sequence[float | None], others: Sequence[float | None], model: Sequence[Spread]
) -> tuple[Word, str]:
    if row.open:
        return "cannot be told", row.open
    (off,) = deviations
    if off is None:
        return _without_error(row, model[0])
    if abs(off) > AGREES_WITHIN:
        return "disagrees", _off(off) + _and(row.outside)
    return "agrees", _off(off) + _ruled_out(row, others)


def _off(deviations: float) -> str:
    size = abs(deviations)
    return f"the model is {number(size, 2) if size >= _SLIGHT else f'less than {_SLIGHT}'} standard deviations off"


def _without_error(row: Measurement, value: Spread) -> tuple[Word, str]:
    ratio = value.value / UNITS[row.unit] / row.value
    if abs(ratio - 1) <= _SAME:
        return "agrees", "the statement has no error, and the model says exactly the same"
    if row.outside:
        return "disagrees", row.outside
    return "cannot be told", f"no error is published; the model is {number(100 * (ratio - 1), 2)} % off"


def _and(outside: str) -> str:
    return f": {outside}" if outside else ""


def _ruled_out(row: Measurement, others: Sequence[float | None]) -> str:
    """Return the row's verdict on other rules."""
    pairs = zip(row.rivals, others, strict=True)
    fits = {rule.quantity: abs(off) <= AGREES_WITHIN for rule, off in pairs if off is not None}
    said = [f"{name.replace('_', ' ')} {'fits too' if fit else 'does not fit'}" for name, fit in fits.items()]
    return "".join(f"; {sentence}" for sentence in said)
