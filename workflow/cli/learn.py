"""``meecontact learn``: measured rows correct a study's surrogate, and what they tell is said in words."""

import argparse
import json

from solver.names import ALL_QUANTITIES
from storage.files import output
from surrogate import save
from surrogate.transforms.measured.corrected import CorrectedGP
from workflow.cli import questions
from workflow.cli.measuredtable import read_measured
from workflow.cli.words import named, say, trained
from workflow.language.given import size
from workflow.language.renamed import renamed
from workflow.learning import correction
from workflow.learning.instruments import Instrument
from workflow.study import uncertainty
from workflow.study.model import Study
from workflow.study.reading import InputError, number, one_line

#: Name of the corrected surrogate, beside the one that it was made from, where none is given.
CORRECTED = "corrected.nc"


def learn(options: argparse.Namespace) -> None:
    """Learn from measured rows, write the corrected surrogate and print what was learned, as the options say."""
    trained(options.on)
    path = output(options.output or options.on.with_name(CORRECTED), options.on, options.measured)
    study, model = questions.results(options.on.parent, options.on)
    if isinstance(model, CorrectedGP):
        raise InputError(f"{options.on}: is corrected already; learn from all rows at once, on the surrogate before")
    rows = read_measured(options.measured, study, model)
    constants = uncertainty.uncertain(study, _uncertain(options.uncertain))
    instruments = _instruments(renamed(options.instrument, study.outputs), study)
    try:
        corrected, summary = correction.learn(study, model, rows, constants, say, instruments)
    except InputError as error:
        raise InputError(f"{options.measured}: {error}") from None
    save(corrected, path)
    words = "\n".join(map(one_line, summary.lines))
    print(json.dumps(summary.plain, indent=2, allow_nan=False) if options.json else words)
    say(f"wrote {path}: `meecontact query {path}` answers with it")


def _uncertain(words: list[str] | None) -> dict[str, float | None] | None:
    """``NAME`` or ``NAME=5%`` between commas: prior standard deviations by name."""
    texts = named("--uncertain", words)
    return {name: _share("--uncertain", name, text) if text else None for name, text in texts.items()} or None


def _share(option: str, name: str, text: str) -> float:
    plain = text.removesuffix("%")
    try:
        share = number(plain) * (0.01 if plain != text else 1.0)
    except ValueError:
        share = -1.0
    if not 0 < share <= 0.5:
        raise InputError(f"{option}: {name}: {text!r} is not a number above 0 and up to 0.5 (50 %)")
    return share


def _instruments(words: list[str] | None, study: Study) -> list[Instrument]:
    """``QUANTITY_gain=3%`` and ``QUANTITY_offset=0.1um`` between commas: what readings may be off by."""
    instruments: list[Instrument] = []
    for name, text in named("--instrument", words).items():
        quantity, _, family = name.rpartition("_")
        if family not in ("gain", "offset") or quantity not in study.outputs:
            known = ", ".join(study.outputs)
            raise InputError(f"--instrument: {name!r} is not QUANTITY_gain or QUANTITY_offset of one of {known}")
        if family == "gain":
            instruments.append(Instrument(quantity, True, _share("--instrument", name, text)))
            continue
        try:
            absolute, _ = size(quantity, text)
        except ValueError as error:
            raise InputError(f"--instrument: {name}: {error}") from None
        if not 0 < absolute < float("inf"):
            raise InputError(f"--instrument: {name}: {text!r} is not a positive size with a unit, as '0.1 um'")
        instruments.append(Instrument(quantity, False, absolute, ALL_QUANTITIES[quantity].units))
    return instruments
