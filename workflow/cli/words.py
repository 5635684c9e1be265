"""Readers of options, paths of surrogates and answers, and messages on standard error."""

import codecs
import io
import math
import os
import sys
import unicodedata
from argparse import ArgumentTypeError
from collections.abc import Callable, Sequence
from pathlib import Path

from solver.units import in_si
from storage.files import regular
from workflow.language.spelling import nearest
from workflow.study.reading import InputError, located, number, one_line

_SURROGATE = "surrogate.nc"
#: Other files beside a surrogate, by ending.
_NO_MODELS = {
    ".csv": "a table",
    ".html": "a page",
    ".json": "JSON",
    ".md": "a text",
    ".svg": "a figure",
    ".yaml": "a study or a material",
}


def printable_streams() -> None:
    """Let standard output and error replace characters that their encoding lacks by ASCII ones."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors=_REPLACING)


def _replaced(error: UnicodeError) -> tuple[str, int]:
    """Return ASCII text for characters that an encoding lacks: ``um`` for ``µm``, ``m-2`` for ``m⁻²``."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    text = error.object[error.start : error.end]
    before = error.object[: error.start]
    power = "^" if before.endswith("10") and text[0] in _RAISED else ""
    return power + "".join(_ASCII.get(letter) or _plain(letter) for letter in text), error.end


def _plain(letter: str) -> str:
    """Return a letter without its accents; ``?`` for one without equivalent."""
    decomposed = unicodedata.normalize("NFKD", letter)
    return "".join(part for part in decomposed if part.isascii()) or "?"


_REPLACING = "meecontact_ascii"
_RAISED = "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"
_ASCII = {
    **dict.fromkeys("⁻\u2212\u2013\u2014\u2010\u2011", "-"),
    **dict.fromkeys("µμ", "u"),
    **dict.fromkeys("ΩΩ", "Ohm"),
    **dict.fromkeys("·⋅", " "),
    **dict.fromkeys("\u2018\u2019", "'"),
    **dict.fromkeys("\u201c\u201d\u201e", '"'),
    "×": "x", "±": "+-", "ᐟ": "/", "→": "->", "≤": "<=", "≥": ">=", "≈": "~", "°": " deg", "σ": "sigma", "ε": "eps",
    "α": "alpha", "β": "beta", "π": "pi", "τ": "tau", "ν": "nu", "ø": "o", "Ø": "O", "ł": "l", "ß": "ss", "æ": "ae",
    "•": "*", "─": "-", "│": "|", "█": "#", "√": "sqrt", "∞": "inf", "‰": "o/oo",
}  # fmt: skip
codecs.register_error(_REPLACING, _replaced)


def say(message: str) -> None:
    """Print a message on standard error; answers go to standard output."""
    try:
        print(one_line(message), file=sys.stderr, flush=True)
    except BrokenPipeError:  # a message without a reader does not stop the work
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stderr.fileno())


def printable(text: str) -> str:
    """Return lines without characters that command a terminal, as names from a file may have."""
    return "\n".join(one_line(line) for line in text.split("\n"))


def numbers(where: str, text: str) -> list[float]:
    """Read numbers between commas."""
    values = []
    for part in text.split(","):
        try:
            values.append(number(part))
        except ValueError:
            raise InputError(f"{where}: {part.strip()!r} is not a number") from None
    return values


def quantity(where: str, text: str, units: str, factor: str = "") -> float:
    """Read a number in SI, with a unit or bare; a bare one is checked against the usual sizes of its factor."""
    with located(where):
        try:
            value = number(text)
        except ValueError:
            return in_si(text, units)
        if not math.isfinite(value):
            raise ValueError(f"{text.strip()!r} is not a finite number")
        if factor:
            from workflow.language.given import check_bare  # NumPy: not for the help

            check_bare(factor, value)
        return value


def named(option: str, words: str | Sequence[str] | None, *, valued: bool = False) -> dict[str, str]:
    """Read ``NAME=VALUE`` or ``NAME`` between commas outside brackets: texts of the values by name."""
    texts: dict[str, str] = {}
    for word in [words] if isinstance(words, str) else words or []:
        for part in _parts(word):
            name, _, text = part.partition("=")
            name = " ".join(name.split())
            if valued and not text.strip():
                raise InputError(f"{option}: {part.strip()!r} is not of the form NAME=VALUE")
            if valued and "=" in text:
                raise InputError(f"{option}: {part.strip()!r} has two equal signs; commas stand between NAME=VALUE")
            if not name:
                raise InputError(f"{option}: a name is missing in {word!r}")
            if name in texts:
                raise InputError(f"{option}: {name}: given twice")
            texts[name] = text.strip()
    return texts


def _parts(word: str) -> list[str]:
    """Return the parts between commas outside brackets."""
    parts, depth = [""], 0
    for character in word:
        depth += (character in "([") - (character in ")]")
        if character == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += character
    return parts


def surrogate_file(text: str) -> Path:
    """Return the file of a surrogate; of a study's folder of results, the one in it."""
    path = Path(text)
    return path / _SURROGATE if path.is_dir() else path


def trained(path: Path) -> Path:
    """Return the file of a surrogate; InputError if it is missing or another file."""
    if path.suffix in _NO_MODELS and path.is_file():
        sibling = path.with_name(_SURROGATE)
        hint = f"{sibling} is" if sibling.is_file() else "it is netCDF, as results/STUDY/surrogate.nc"
        raise InputError(f"{path}: is {_NO_MODELS[path.suffix]}, no surrogate; {hint}")
    if path.exists():
        return regular(path)
    folder = path.parent if path.name == _SURROGATE else path
    problem = f"{folder}: holds no {_SURROGATE}" if folder.is_dir() else f"{folder}: no such file or folder"
    studies = sorted(file.parent.name for file in Path("results").glob(f"*/{_SURROGATE}"))
    known = f"STUDY: {nearest(folder.name, studies)}" if studies else "results/ has none here"
    raise InputError(
        f"surrogate: {problem}; must be results/STUDY, or a surrogate's file; {known}; `meecontact run STUDY` makes one"
    )


def written_as(**endings: str) -> Callable[[str], Path]:
    """Return the reader of an answer's path, whose ending must be one of `endings`."""

    def path(text: str) -> Path:
        if Path(text).suffix.removeprefix(".") not in endings:
            allowed, forms = (" or ".join(words) for words in ([f".{ending}" for ending in endings], endings.values()))
            raise ArgumentTypeError(f"{text!r}: must end in {allowed}: the answer is written as {forms}")
        return Path(text)

    return path


def cores(text: str) -> str:
    """Return a number of cores, or ``all``, as Snakemake reads it."""
    if text != "all" and not (text.isascii() and text.isdecimal() and int(text[:9]) >= 1 and len(text) < 6):
        raise ArgumentTypeError(f"{text!r} is not a number of cores from 1 on, or 'all'")
    return text
