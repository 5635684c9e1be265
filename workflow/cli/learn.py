"""``meecontact learn``: measured rows correct a study's surrogate, and what they tell is said in words."""

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from storage.files import output
from workflow.cli.words import named, place, quantity, say, surrogate_file, trained, written_as
from workflow.study.reading import InputError, number, one_line

if TYPE_CHECKING:
    from workflow.learning.instruments import Instrument
    from workflow.study.model import Study

#: Name of the corrected surrogate, beside the one that it was made from, where none is given.
CORRECTED = "corrected.nc"


def add(commands: "argparse._SubParsersAction[Any]") -> None:
    """Add the command to those of the program."""
    command = commands.add_parser(
        "learn",
        help="correct a surrogate by measured rows: uncertain constants and discrepancies, with intervals",
        description="Columns of MEASURED.csv: every factor and category of the study, names of quantities, and "
        "NAME_std, one standard deviation of the error of measurement. Measured values may be missing; errors that "
        "are missing are estimated. A unit may stand behind a name, as 'thickness [um]'; without one it is SI.",
    )
    command.add_argument("measured", type=Path, metavar="MEASURED.csv")
    command.add_argument("--on", type=surrogate_file, required=True, metavar="results/STUDY/surrogate.nc")
    command.add_argument(
        "--uncertain",
        action="append",
        metavar="NAME[=5%],...",
        help="'BaTiO3 permittivity', 'BaTiO3 e33', 'steel modulus'",
    )
    command.add_argument(
        "--instrument",
        action="append",
        metavar="QUANTITY_gain=3%,...",
        help="'voltage_gain=3%%', 'depth_offset=0.1um': what readings may be off by, all alike; one standard deviation",
    )
    command.add_argument(
        "--plan", type=int, metavar="N", help="say which N further measurements tell most of constants or answers"
    )
    command.add_argument(
        "--for", dest="wanted", action="append", metavar="NAME,...", help="constants and quantities that --plan is for"
    )
    command.add_argument("--at", metavar="FACTOR=VALUE,...", help="where a quantity that --for names is wanted")
    command.add_argument(
        "--errors", action="append", metavar="QUANTITY=1%,...", help="what --plan may measure, and its error"
    )
    command.add_argument("--within", action="append", metavar="FACTOR=LOW:HIGH,...", help="where --plan may measure")
    command.add_argument(
        "-o",
        "--output",
        type=written_as(nc="netCDF"),
        metavar="OUT.nc",
        help=f"default: {CORRECTED} beside the surrogate",
    )
    command.add_argument("--json", action="store_true", help="print JSON instead of words")
    command.set_defaults(run=learn)


def learn(options: argparse.Namespace) -> None:
    """Learn from measured rows, write the corrected surrogate and print what was learned, as the options say."""
    from surrogate import save  # scikit-learn and the solver: not for every command
    from surrogate.transforms.measured.corrected import CorrectedGP
    from workflow.cli import questions
    from workflow.cli.measuredtable import read_measured
    from workflow.language.renamed import renamed
    from workflow.learning import correction, plan
    from workflow.study import uncertainty

    trained(options.on)
    path = output(options.output or options.on.with_name(CORRECTED), options.on, options.measured)
    study, model = questions.results(options.on.parent, options.on)
    if isinstance(model, CorrectedGP):
        raise InputError(f"{options.on}: is corrected already; learn from all rows at once, on the surrogate before")
    rows = read_measured(options.measured, study, model)
    asked = uncertainty.uncertain(study, _uncertain(options.uncertain))
    instruments = _instruments(renamed(options.instrument, study.outputs), study)
    if options.plan is None and any((options.wanted, options.at, options.errors, options.within)):
        raise InputError("--for, --at, --errors and --within say what --plan N is to do; --plan is not given")
    known = [constant.name for constant in asked] + [instrument.name for instrument in instruments]
    wanted, errors, box = (
        list(named("--for", options.wanted)),
        _errors(renamed(options.errors, study.outputs)),
        _box(options.within),
    )
    at = place(options.at, {name: axis.units for name, axis in model.box.items()}) if options.at else {}
    if options.plan is not None:
        plan.check(model, options.plan, wanted, known, errors, box, at)
    try:
        corrected, summary = correction.learn(study, model, rows, asked, say, instruments)
        further = (
            plan.plan(corrected, options.plan, wanted or known, errors, box, at, instruments)
            if options.plan is not None
            else None
        )
    except InputError as error:
        raise InputError(f"{options.measured}: {error}") from None
    save(corrected, path)
    plain = summary.plain | ({"plan": further.plain} if further else {})
    lines = summary.lines + (further.lines if further else [])
    print(json.dumps(plain, indent=2, allow_nan=False) if options.json else "\n".join(map(one_line, lines)))
    say(f"wrote {path}: `meecontact query {path}` answers with it")


def _uncertain(words: list[str] | None) -> dict[str, float | None] | None:
    """``NAME`` or ``NAME=5%`` between commas: prior standard deviations by name."""
    given = named("--uncertain", words)
    return {name: _share("--uncertain", name, text) if text else None for name, text in given.items()} or None


def _share(option: str, name: str, text: str) -> float:
    plain = text.removesuffix("%")
    try:
        share = number(plain) * (0.01 if plain != text else 1.0)
    except ValueError:
        share = -1.0
    if not 0 < share <= 0.5:
        raise InputError(f"{option}: {name}: {text!r} is not a number above 0 and up to 0.5 (50 %)")
    return share


def _instruments(words: list[str] | None, study: "Study") -> "list[Instrument]":
    """``QUANTITY_gain=3%`` and ``QUANTITY_offset=0.1um`` between commas: what readings may be off by."""
    from solver.names import ALL_QUANTITIES
    from workflow.language.sizes import size
    from workflow.learning.instruments import Instrument

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


def _errors(words: list[str] | None) -> dict[str, tuple[float, float]]:
    """``QUANTITY=1%`` or ``QUANTITY=0.1um`` between commas: absolute error in SI, and its share of the value."""
    from workflow.language.sizes import size

    errors = {}
    for name, text in named("--errors", words, valued=True).items():
        try:
            errors[name] = size(name, text)
        except (KeyError, ValueError) as error:
            raise InputError(f"--errors: {name}: {error}") from None
    return errors


def _box(words: list[str] | None) -> dict[str, tuple[float, float]]:
    """``FACTOR=LOW:HIGH`` between commas, with units."""
    from workflow.language.factors import FACTORS

    box = {}
    for name, text in named("--within", words, valued=True).items():
        low, colon, high = text.partition(":")
        if not colon or name not in FACTORS:
            raise InputError(f"--within: {name}={text}: is not of the form FACTOR=LOW:HIGH, as load=10kN/m:20kN/m")
        units = FACTORS[name].units
        box[name] = (quantity(f"--within: {name}", low, units), quantity(f"--within: {name}", high, units))
    return box
