"""Design questions from the command line: words to a target, and its answer."""

import argparse
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from approximation.arrays import Array
from solver.names import ALL_QUANTITIES, CHOICES
from storage.files import output as file_to_write
from storage.files import write_text
from surrogate import GaussianProcess, Input, load
from surrogate.use.inversion import LARGEST_ERROR, SMALLEST_ERROR, Inversion
from workflow.cli import query
from workflow.cli.progress import busy
from workflow.cli.words import named, printable, quantity, say, trained
from workflow.dataset import factorial
from workflow.design.search import targets
from workflow.design.verdict.answer import Answer
from workflow.design.wording import table
from workflow.design.wording.words import verdict
from workflow.language.factors import FACTORS
from workflow.language.given import size
from workflow.language.numbers import shown
from workflow.language.renamed import renamed
from workflow.language.spelling import nearest
from workflow.study import location
from workflow.study import model as studies
from workflow.study.categories import output
from workflow.study.consistency import check_target, check_values
from workflow.study.contents import Origin
from workflow.study.model import Study
from workflow.study.reading import InputError, first_problem, located
from workflow.study.target import Target

_BARE = re.compile(r"[-+]?[\d.]+(?:[eE][-+]?\d+)?")
_SHARED = re.compile(r"[\d.]++(?:[eE][-+]?\d+)?+\s*(?P<unit>[^\d\s%-].*)")  # an error's unit
_IMPOSSIBLE = 25.0  # five standard deviations
_REMEDIES = {
    -1.0: "the opposite sign",
    **{10.0**power: f"a factor of {10.0**power:g}" for power in (3, -3, 6, -6, 9, -9, 12, -12)},
    **{-(10.0**power): f"the opposite sign and a factor of {10.0**power:g}" for power in (3, -3, 6, -6)},
}
_UNDETERMINED = 0.8  # share of its range from which a factor's interval tells nothing; without measurement it is 0.95


def design(options: argparse.Namespace) -> None:
    """Answer a design question, as the options say."""
    path = None if options.output is None else file_to_write(options.output)
    with busy("searching"):
        answer = ask(options.results, vars(options))
    if path is not None:
        write_text(path, f"{table.as_json(answer)}\n" if path.suffix == ".json" else table.as_csv([answer]))
        say(f"wrote {options.output}: {verdict(answer)}")
    else:
        print(table.as_json(answer) if options.json else printable(table.as_text(answer, si=options.si)))


def infer(options: argparse.Namespace) -> None:
    """Infer factors from measured quantities, as the options say."""
    with busy("inferring"):
        answer = invert(options.results, vars(options), si=options.si)
    print(printable(answer))


def results(folder: Path, file: Path | None = None) -> tuple[Study, GaussianProcess]:
    """Return the study of a folder ``results/<study>`` and its surrogate, or another of its surrogates."""
    surrogate = trained(file or folder / "surrogate.nc")
    study = studies.load(location.of_results(folder))
    model = load(surrogate)
    same_inputs = model.made_from_ == study.physics and list(model.box.values()) == factorial.inputs(study)
    if not same_inputs or list(model.outputs_) != study.output_names:
        raise InputError(f"{surrogate}: was made from another state of the study; run `meecontact run {folder.name}`")
    return study, model


def target(study: Study, words: Mapping[str, Sequence[str] | None]) -> Target:
    """Return the target that the options of the command line describe."""
    words = renamed(dict(words), study.kind.every_quantity)
    content: dict[str, Any] = {
        "maximise": list(words.get("maximise") or []),
        "minimise": list(words.get("minimise") or []),
        "tolerance": named("--tolerance", words.get("tolerance")),
        "subject_to": list(words.get("limit") or []),
    }
    for key, read in (("over", _variable), ("at", _value), ("worst_case", _interval), ("uncertain", _distribution)):
        content[key] = _read(key, words, read)
    if robust := words.get("robust"):
        content["robust"] = robust[0]
    named_factors = {*content["over"], *content["at"], *content["worst_case"], *content["uncertain"]}
    for name, axis in study.factors.items():
        default = FACTORS[name].default
        if name not in named_factors and default is not None and axis.low <= default <= axis.high:
            content["at"][name] = default
    for name in study.categories:
        if name not in named_factors and (choice := _default(study, name)):
            content["at"][name] = choice
    try:
        return Target.model_validate(content, context=Origin(Path(), {}, in_si=True)).set_meeting(study.meeting)
    except ValidationError as error:
        raise InputError(f"design: {first_problem(error, Target, content)}") from None


def _read(key: str, words: Mapping[str, Sequence[str] | None], read: Callable[[str, str, str], Any]) -> dict[str, Any]:
    """Read an option's value for each name, by place, name and text."""
    option = f"--{key.replace('_', '-')}"
    return {name: read(f"{option}: {name}", name, text) for name, text in named(option, words.get(key)).items()}


def _default(study: Study, name: str) -> str:
    """Return a category's default if the study has it, else an empty text."""
    default = CHOICES.get(name, ("",))[0]
    return default if default in study.categories[name] else ""


def ask(folder: Path, words: Mapping[str, Sequence[str] | None]) -> Answer:
    """Answer a question from the results of a study."""
    study, model = results(folder)
    question = target(study, words)
    with located("design"):
        check_target(study, question)
    answer = targets.answer(study, "question", question, model)
    if not answer.feasible:
        point = [f"{name} = {kind}" for name, kind in answer.combination.items()]
        point += [f"{variable.name} = {variable.value:.6g}" for variable in answer.variables]
        raise InputError(f"design: {answer.status}, at {', '.join(point)}. {verdict(answer)}")
    return answer


def invert(folder: Path, words: Mapping[str, Sequence[str] | None], *, si: bool = False) -> str:
    """Return a line for each inferred factor, with its 95 % interval."""
    study, model = results(folder)
    words = renamed(dict(words), study.outputs)
    measured = named("--measured", words.get("measured"))
    readings = np.array([_measured(f"--measured: {name}", name, text) for name, text in measured.items()])
    values, errors = readings.reshape(-1, 2).T
    infer = list(named("--infer", words.get("infer")))
    point: dict[str, float | str] = {name: _default(study, name) for name in study.categories}
    point |= _read("at", words, _value)
    with located("invert"):
        for name, point_value in point.items():
            with located("--at"):
                check_values(study, name, [point_value])
        combination = {name: str(point.pop(name)) for name in study.categories}
        held = {name: float(value) for name, value in point.items()}
        outputs = [_learned(study, name, combination) for name in measured]
        inversion = Inversion(model.only(outputs) if study.kind.tabled else model, infer, outputs, held)
    estimate = inversion.estimate(values, errors)
    if estimate.misfit > _IMPOSSIBLE + len(measured):
        raise InputError(
            f"invert: no case within the study's ranges gives these measurements (misfit {estimate.misfit:.3g})"
            f"{_remedy(inversion, list(measured), values, errors)}"
        )
    rows = zip(infer, estimate.mean, estimate.low, estimate.high, strict=True)
    return "\n".join(_in_words(model.box[name], *numbers, si=si) for name, *numbers in rows)


def _remedy(inversion: Inversion, names: Sequence[str], values: Array, errors: Array) -> str:
    """Return the sign or the power of a thousand by which readings would fit, in words; empty where none does."""
    subsets = list(np.eye(len(names), dtype=bool))
    subsets += [np.ones(len(names), dtype=bool)] if len(names) > 1 else []
    for factor, words in _REMEDIES.items():
        for subset in subsets:
            scale = np.where(subset, factor, 1.0)
            with np.errstate(over="ignore"):
                scaled, widths = values * scale, errors * np.abs(scale)
            if not np.isfinite(scaled).all() or not ((widths >= SMALLEST_ERROR) & (widths <= LARGEST_ERROR)).all():
                continue
            if inversion.estimate(scaled, widths).misfit <= _IMPOSSIBLE + len(names):
                scaled_names = " and ".join(name for name, chosen in zip(names, subset, strict=True) if chosen)
                return f"; {scaled_names} would fit with {words}"
    return ""


def _learned(study: Study, name: str, combination: Mapping[str, str]) -> str:
    """Return the surrogate's output for a measured quantity."""
    if name not in study.outputs:
        raise InputError(f"--measured: {name}: is not learned by the study; {nearest(name, list(study.outputs))}")
    return output(name, combination)


def _in_words(axis: Input, mean: float, low: float, high: float, *, si: bool) -> str:
    """Return a factor with its interval, or that the interval is hardly narrower than the study's range."""
    units = FACTORS[axis.name].units
    if axis.to_unit(high) - axis.to_unit(low) > _UNDETERMINED * 2:  # the range is [-1, 1]
        within = f"the study's range is {shown(axis.low, units)} to {shown(axis.high, units)}"
        return f"{axis.name} cannot be told from this: {within}"
    return f"{axis.name:16s} {query.shown(mean, low, high, units, si=si)}"


def _measured(where: str, name: str, text: str) -> tuple[float, float]:
    """Return a measured value and its standard deviation in SI, which may be written as a share of the value."""
    value, sign, std = text.replace("±", "+-").replace("+/-", "+-").partition("+-")
    if not sign:
        raise InputError(f"{where}: {text!r} is not of the form VALUE+-STD")
    if name not in ALL_QUANTITIES:
        raise InputError(f"{where}: is no quantity; {nearest(name, list(ALL_QUANTITIES))}")
    shared = _SHARED.fullmatch(std.strip())
    if shared and _BARE.fullmatch(value.strip()):  # 380+-4 pC/N: one unit for both
        value = f"{value} {shared['unit']}"
    mean = quantity(where, value, _units(name))
    with located(where):
        absolute, share = size(name, std)
    if not np.isfinite(mean):
        raise InputError(f"{where}: {text!r} needs finite numbers")
    error = absolute + share * abs(mean)
    if not SMALLEST_ERROR <= error <= LARGEST_ERROR:
        raise InputError(f"{where}: {text!r}: an error must be within {SMALLEST_ERROR:g} to {LARGEST_ERROR:g}")
    return mean, error


def _units(name: str) -> str:
    """Return the units of a factor or quantity; 1 of an unknown name, which is refused later."""
    known = FACTORS.get(name) or ALL_QUANTITIES.get(name)
    return known.units if known else "1"


def _variable(where: str, name: str, text: str) -> dict[str, Any]:
    if not text:
        return {}
    if ":" in text:
        return dict(zip(("low", "high"), _interval(where, name, text), strict=True))
    return {"choices": [_value(where, name, choice) for choice in text.split("|")]}


def _value(where: str, name: str, text: str) -> float | str:
    """Return a number, or the name of a category."""
    return quantity(where, text, FACTORS[name].units, name) if name in FACTORS else text.strip()


def _interval(where: str, name: str, text: str) -> list[float]:
    ends = text.split(":")
    if len(ends) != 2:
        raise InputError(f"{where}: {text!r} is not of the form LOW:HIGH")
    return [quantity(where, end, _units(name)) for end in ends]


def _distribution(where: str, name: str, text: str) -> dict[str, list[float]]:
    family, bracket, arguments = text.partition("(")
    if not bracket or not arguments.endswith(")"):
        raise InputError(f"{where}: {text!r} is not of the form normal(MEAN,STD) or another distribution")
    return {family.strip(): [quantity(where, share, _units(name)) for share in arguments[:-1].split(",")]}
