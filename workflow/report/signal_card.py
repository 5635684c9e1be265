"""Card of a contact beside the designs: the contact, the amplifier's output, and the limits."""

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
    """Card of a contact that is solved as it is, not searched."""

    title: str
    on: str  # the contact within a sentence
    build: str
    does: str
    stops: str
    doubt: str  # constants that the library marks as doubtful
    good: bool  # no limit of materials and theory is exceeded
    drawing: Markup  # to scale


def card(study: Study, signal: Mapping[str, float], held: Mapping[str, float]) -> Card:
    """Return the card of the contact that the study's section ``signal`` names."""
    signal_study = signal_case.of(study)
    case = {**signal_study.fixed, signal_study.kind.loads.force: signal["force"]}
    built = firstscreen.in_words(signal_study, case)
    numbers = {name: np.array([value]) for name, value in held.items()}
    sizes = [np.array([float(case[name])]) if name in case else None for name in ("radius", "thickness")]
    beyond = [*linearity.beyond(signal_study, numbers), *linearity.beyond_small_strain(signal_study, numbers, *sizes)]
    nearest = linearity.nearest(signal_study, numbers)
    share = f"{nearest.words} is {number(100 * nearest.share, 2)} % of the {nearest.at_most}" if nearest else ""
    stops = [*(words for words, _ in beyond)] or [share] * bool(share)
    stops.append(f"forces below {shown(signal['noise_force'], 'N', 2)} are lost in the noise")
    title = signal_study.title or f"{capital(firstscreen.punch_in_words(case))}, read by its amplifier"
    return Card(
        title=title,
        on=firstscreen.unbroken(f"the contact beside the designs ({built})"),
        build=firstscreen.unbroken(built),
        does=firstscreen.unbroken(
            f"{shown(signal['force'], 'N', 3)} gives a charge of "
            f"{_banded(signal, 'contact_charge', 'charge_spread', 'C')} and "
            f"{_banded(signal, 'output', 'output_spread', 'V')} at the output{_fading(signal['time_constant'])}"
        ),
        stops=firstscreen.unbroken(f"{capital('; '.join(stops))}."),
        doubt=firstscreen.doubted(signal_study),
        good=not beyond,
        drawing=element(
            device.draw(firstscreen.of_case(signal_study, case, held), built),
            "device-beside",
            f"{title}, drawn to scale: {built}",
        ),
    )


def _banded(signal: Mapping[str, float], name: str, spread: str, units: str) -> str:
    """Size of a number with its spread by uncertain constants."""
    return f"{shown(abs(signal[name]), units, 3)}{asides.band(signal[spread])}"


def _fading(lasting: float) -> str:
    """Decay of the output under a constant force, in words."""
    if not math.isfinite(lasting):
        return ", which does not decay"
    return f"; under a constant force the output decays with a time constant of {shown(lasting, 's', 2)}"
