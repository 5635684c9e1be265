"""A rounded surrogate as an FMU for system simulators: FMI 3.0, Co-Simulation, with sources and a binary."""

import platform
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Mapping, Sequence
from hashlib import sha256
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from surrogate.transforms.groups import middle
from surrogate.use.ccode import code, environment, literal
from surrogate.use.rounding import Rounded

_COMPILERS = ("cc", "gcc", "clang")
_FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-fvisibility=hidden", "-fPIC", "-shared")
_SYSTEMS = {"linux": ("linux", "so"), "darwin": ("darwin", "dylib")}
_MACHINES = {"x86_64": "x86_64", "amd64": "x86_64", "aarch64": "aarch64", "arm64": "aarch64"}
_PARTS = ("", "_lower", "_upper")  # ends of the names of an output's variables
_EPOCH = (1980, 1, 1, 0, 0, 0)  # date of every member, so that the same model gives the same bytes


def unit(
    name: str, outputs: Sequence[Rounded], arithmetic: type[np.floating[Any]], notes: Sequence[str], tool: str
) -> tuple[bytes, bool]:
    """Return the bytes of an FMU of outputs of one model, and whether it has a binary for this machine.

    name: an identifier of C; notes: lines of the sources' comment; tool: name and version of the program.
    """
    texts = code(name, outputs, arithmetic, notes)
    token = "{" + sha256("".join(texts.values()).encode()).hexdigest()[:32] + "}"
    model = outputs[0].model
    starts = [literal(middle(axis), arithmetic) for axis in model.inputs_]
    wrapper = environment().get_template("fmi3.c").render(name=name, NAME=name.upper(), token=token, starts=starts)
    sources = {**texts, "fmi3.c": wrapper}
    description, build = map(environment(escaped=True).get_template, ("modelDescription.xml", "buildDescription.xml"))
    members: dict[str, bytes] = {
        "modelDescription.xml": description.render(_variables(outputs), name=name, token=token, tool=tool).encode(),
        "sources/buildDescription.xml": build.render(name=name).encode(),
        **{f"sources/{file}": text.encode() for file, text in sources.items()},
    }
    binary = _compiled(name, sources)
    with BytesIO() as written:
        with zipfile.ZipFile(written, "w", zipfile.ZIP_DEFLATED) as archive:
            for file, content in (members | binary).items():
                archive.writestr(zipfile.ZipInfo(file, _EPOCH), content, zipfile.ZIP_DEFLATED)
        return written.getvalue(), bool(binary)


def _text(text: str) -> str:
    """Return a text without characters that XML forbids."""
    return re.sub(r"[\x00-\x1f\x7f\ud800-\udfff\ufffe\uffff]", "_", text)


def _distinct(name: str, taken: set[str]) -> str:
    """Return a name that no variable has yet, and add it to those taken."""
    free = _text(name)
    while free in taken:
        free += "_"
    taken.add(free)
    return free


def _variables(outputs: Sequence[Rounded]) -> dict[str, Any]:
    """Return the description's entries for inputs and outputs."""
    taken = {"time", "status"}
    model = outputs[0].model
    inputs = [
        {
            "name": _distinct(axis.name, taken), "meaning": _text(axis.long_name),
            "unit": _text(axis.units or "1"), "low": repr(float(axis.low)),
            "high": repr(float(axis.high)), "start": repr(middle(axis)),
        }
        for axis in model.inputs_
    ]  # fmt: skip
    first = 1 + len(inputs)
    described: list[dict[str, Any]] = []
    for k, part in enumerate(outputs):
        attrs = part.model.attrs_[part.name]
        meanings = (
            attrs.get("long_name", ""),
            *(f"{end} end of the 95 % interval of {part.name}" for end in ("lower", "upper")),
        )
        for place, (end, meaning) in enumerate(zip(_PARTS, meanings, strict=True)):
            described.append(
                {
                    "name": _distinct(part.name + end, taken), "meaning": _text(meaning),
                    "unit": _text(attrs.get("units", "") or "1"),
                    "reference": first + 3 * k + place,
                }
            )  # fmt: skip
    return {
        "inputs": inputs,
        "outputs": described,
        "units": sorted({entry["unit"] for entry in [*inputs, *described]}),
        "references": " ".join(map(str, range(1, first))),
        "status": first + 3 * len(outputs),
        "description": _text(f"surrogate of {', '.join(part.name for part in outputs)}")[:200],
    }


def _compiled(name: str, sources: Mapping[str, str]) -> dict[str, bytes]:
    """Return the binary for this machine by its name in the archive; none without a compiler."""
    compiler = next(filter(None, map(shutil.which, _COMPILERS)), None)
    system, machine = _SYSTEMS.get(sys.platform), _MACHINES.get(platform.machine().lower())
    if compiler is None or system is None or machine is None:
        return {}
    with tempfile.TemporaryDirectory() as folder:
        for file, text in sources.items():
            (Path(folder) / file).write_text(text, encoding="ascii")
        library = f"{name}.{system[1]}"
        command = [compiler, *_FLAGS, f"{name}.c", "fmi3.c", "-lm", "-o", library]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode:
            raise ValueError(f"{compiler} does not compile the sources: {done.stderr.strip().splitlines()[:1]}")
        return {f"binaries/{machine}-{system[0]}/{library}": (Path(folder) / library).read_bytes()}
