"""The card of a contact beside the study's: what is pressed, what its amplifier shows, and what stops it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from workflow.design.verdict import linearity
from workflow.design.wording import asides
from workflow.language.numbers import number, shown
from workflow.language.titles import capital
from workflow.report import device, firstscreen
from workflow.report.svg import element
from workflow.study import signal_case
from workflow.study.model import Study


@dataclass(frozen=True)
class Card:
    """What its contact comes to, as `workflow.report.firstscreen.Screen` has it of a target."""

    title: str  # In words
    on: str  # What is pressed, within a sentence
    # The three lines, and what the library doubts
    build: str
    does: str
    stops: str
    doubt: str
    good: bool  # Whether nothing is beyond what its materials bear
    drawing: Markup  # To scale


def card(study: Study, signal: Mapping[str, float], held: Mapping[str, float]) -> Card:
    """The card of the contact that the study's press names."""
    own = signal_case.of(study)
    case = {**own.fixed, own.kind.loads.force: signal["force"]}
    built = firstscreen.in_words(own, case)
    numbers = {name: np.array([value]) for name, value in held.items()}
    beyond, nearest = linearity.beyond(own, numbers), linearity.nearest(own, numbers)
    share = f"{nearest.words} is {number(100 * nearest.share, 2)} % of the {nearest.at_most}" if nearest else ""
    stops = [*(words for words, _ in beyond)] or [share] * bool(share)
    stops.append(f"less than {shown(signal['noise_force'], 'N', 2)} is noise")
    title = own.title or f"{capital(firstscreen.punch_in_words(case))}, read by its amplifier"
    return Card(
        title=title,
        on=firstscreen.unbroken(f"the contact beside the designs ({built})"),
        build=firstscreen.unbroken(built),
        does=firstscreen.unbroken(
            f"{shown(signal['force'], 'N', 3)} gives {_banded(signal, 'contact_charge', 'charge_spread', 'C')} and "
            f"{_banded(signal, 'output', 'output_spread', 'V')} at the output{_fading(signal['time_constant'])}"
        ),
        stops=firstscreen.unbroken(f"{capital('; '.join(stops))}."),
        doubt=firstscreen.doubted(own),
        good=not beyond,
        drawing=element(
            device.draw(firstscreen.of_case(own, case, held), built),
            "device-beside",
            f"{title}, drawn to scale: {built}",
        ),
    )


def _banded(signal: Mapping[str, float], name: str, spread: str, units: str) -> str:
    """The size of a number with what the spread of the constants makes of it."""
    return f"{shown(abs(signal[name]), units, 3)}{asides.band(signal[spread])}"


def _fading(lasting: float) -> str:
    """What a constant force does."""
    if not math.isfinite(lasting):
        return ", as long as it is held"
    return f"; held, it fades with a time constant of {shown(lasting, 's', 2)}"
