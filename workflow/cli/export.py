"""``meecontact export``: a trained surrogate as C, or as a unit for simulators (FMU)."""

import argparse
from collections.abc import Sequence
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

import surrogate
from storage.files import output, write_bytes
from surrogate import GaussianProcess
from workflow.cli.words import named, say, surrogate_file, trained
from workflow.language.spelling import nearest
from workflow.study.reading import InputError

_FORMS = {"c": ".c", "fmu": ".fmu"}
_PRECISIONS: dict[str, type[np.floating[Any]]] = {"single": np.float32, "double": np.float64}
_LEAST, _MOST = 1e-12, 0.1


def export(options: argparse.Namespace) -> None:
    """Write the files and say how far they are from the surrogate."""
    from surrogate.use import ccode, fmu, rounding

    path = trained(options.surrogate)
    target = output(_target(options, path), path)
    if not _LEAST <= (error := options.error) <= _MOST:
        raise InputError(f"--error: {error:g}: must be one number from {_LEAST:g} to {_MOST:g}, a share of the range")
    model = surrogate.load(path)
    outputs = _outputs(model, options.outputs)
    try:
        name = ccode.identifier(target.stem)
        arithmetic = _PRECISIONS[options.precision]
        parts = rounding.rounded(model, outputs, error, arithmetic)
        notes = _notes(path, model, error)
        if options.form == "fmu":
            content, compiled = fmu.unit(name, parts, arithmetic, notes, f"meecontact {version('meecontact')}")
            texts = {target.name: content}
        else:
            texts = {file: text.encode() for file, text in ccode.code(name, parts, arithmetic, notes).items()}
    except ValueError as reason:
        raise InputError(f"export: {reason}") from None
    files = {output(target.with_name(file), path): text for file, text in texts.items()}
    for file, text in files.items():
        write_bytes(file, text)
    if options.form == "fmu" and not compiled:
        say("no C compiler here: the FMU has its sources only")
    count = sum(part.numbers for part in parts)
    worst = max(parts, key=lambda part: part.error)
    say(
        f"wrote {' and '.join(map(str, files))}: {len(parts)} outputs in {count} numbers; "
        f"on fresh points off by {worst.error:.1e} of the range at most ({worst.name})"
    )


def _target(options: argparse.Namespace, path: Path) -> Path:
    ending = _FORMS[options.form]
    if options.output is None:
        stem = path.resolve().parent.name if path.name == surrogate_file(str(path.parent)).name else path.stem
        return Path(stem + ending)
    if options.output.suffix != ending:
        raise InputError(f"-o: {options.output}: must end in {ending}")
    return Path(options.output)


def _outputs(model: GaussianProcess, text: str | None) -> Sequence[str]:
    names = list(model.outputs_) if text is None else list(named("--outputs", text))
    for name in names:
        if name not in model.outputs_:
            raise InputError(
                f"--outputs: {name}: not an output of the surrogate; {nearest(name, list(model.outputs_))}"
            )
    return names


def _notes(path: Path, model: GaussianProcess, error: float) -> list[str]:
    """Return lines on the origin of the files."""
    return [
        f"Written by meecontact {version('meecontact')} from {path.name} of {path.resolve().parent.name}.",
        f"SHA-256 of that file: {sha256(path.read_bytes()).hexdigest()}",
        *([f"Hash of the study's physics: {model.made_from_}"] if model.made_from_ else []),
        f"Error asked for: {error:g} of an output's range. Trained on {model.cases_} cases; "
        + ("intervals calibrated on held-out cases." if model.calibrated else "intervals are not calibrated."),
    ]
