"""The study: one strict model of all that a run reads, checked and read from its file."""

import re
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from threading import Timer
from typing import Any, Self

from pydantic import ValidationError, model_validator

from solver import Material
from workflow.language.renamed import renamed_study
from workflow.study import defaults, layered
from workflow.study.consistency import check_pressed, check_quantities
from workflow.study.contents import Contents, Origin
from workflow.study.location import beside, location
from workflow.study.reading import InputError, first_problem, read_material, read_yaml
from workflow.study.solvable import (
    check_contact,
    check_fields,
    check_groups,
    check_size,
    hanging_on_datum,
    lacked,
    solve_effects,
)

#: Seconds after which a check is announced.
SILENCE = 3.0

_checked: dict[str, tuple[str, "Study"]] = {}  # by path, with the checked text: command and Snakefile load one study
_LABEL = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,59}")


class Study(Contents):
    """Everything that a run can be asked for; at least factors, effects, verification or measurements."""

    def model_post_init(self, origin: Any, /) -> None:
        """Take the origin, and complete the study by its defaults."""
        super().model_post_init(origin)
        defaults.settle(self)

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if not (self.factors or self.effects or self.verification or self.measurements):
            raise ValueError("factors: a study needs factors, effects, verification or measurements")
        check_contact(self)
        check_fields(self)
        check_groups(self)
        check_size(self)
        for name in self.fixed:
            if name in self.factors or name in self.categories:
                part = "factors" if name in self.factors else "categories"
                raise ValueError(f"fixed: {name}: is one of the {part} already")
        if self.body and not self.factors:
            raise ValueError("body: a study without factors has none")
        layered.check(self.body, self.fixed, {name: (axis.low, axis.high) for name, axis in self.factors.items()})
        for name, names in self.categories.items():
            if len(set(names)) < len(names):
                raise ValueError(f"categories: {name}: {', '.join(names)}: a name is given twice")
        for label in (*self.design, *self.readout):
            if not _LABEL.fullmatch(label):  # names files
                part = "design" if label in self.design else "readout"
                raise ValueError(f"{part}: {label!r} must be letters, digits and underscores, at most 60 of ASCII")
        if self._origin.absent is None:
            self._absent = lacked(self)
            solve_effects(self)
            self._hanging = hanging_on_datum(self)
        else:
            self._absent, self._hanging = self._origin.absent, self._origin.hanging
        check_quantities(self)
        return self


def pressed(study: Study) -> Study | None:
    """Return the other study whose design the section ``signal`` presses; None where it presses its own, or none."""
    if study.signal is None or not study.signal.study:
        return None
    try:
        other = named(beside(study.signal.study, study.path))
        check_pressed(other, study.signal.design)
    except ValueError as error:
        raise InputError(f"{study.path}: signal: {str(error).removeprefix('signal: ')}") from None
    return other


def named(name: str) -> Study:
    """Return the checked study of a name, wherever its file is; a check that takes seconds is announced."""
    with _announced(f"checking {name}: solving the corners of its box and its effects"):
        return load(location(name))


@contextmanager
def _announced(message: str) -> Iterator[None]:
    """Print a message on standard error if the work within takes longer than people wait in silence."""
    timer = Timer(SILENCE, lambda: print(message, file=sys.stderr, flush=True))
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        timer.join()  # a line that has begun is printed whole


def load(path: str | Path) -> Study:
    """Read and check a study, down to solutions at the corners of its box.

    Raises
    ------
    InputError
        One line that names file, key, value and what is allowed.
    """
    path = Path(path)
    content = renamed_study(read_yaml(path))
    names = content.get("materials")
    known = names if isinstance(names, list) and all(isinstance(name, str) for name in names) else []
    materials = dict(read_material(path.parent / name) for name in known)
    text = repr((content, {name: material.plain() for name, material in materials.items()}))
    if _checked.get(str(path), ("",))[0] != text:
        _checked[str(path)] = text, _validated(content, Origin(path, materials))
    return _checked[str(path)][1]


def thawed(frozen: Mapping[str, Any]) -> Study:
    """Return a study from its `frozen` data, without reading a file."""
    materials = {name: Material.from_mapping(entries) for name, entries in frozen["materials"].items()}
    return _validated(
        frozen["study"],
        Origin(Path(frozen["path"]), materials, frozenset(frozen["absent"]), frozenset(frozen["hanging"]), in_si=True),
    )


def remade(study: Study, **sections: Any) -> Study:
    """Return a study with other sections, checked as one that is read from a file."""
    origin = Origin(study.path, study.own_materials, in_si=True)
    return _validated(study.model_dump(mode="json") | sections, origin)


def _validated(content: dict[str, Any], origin: Origin) -> Study:
    try:
        return Study.model_validate(content, context=origin)
    except ValidationError as error:
        raise InputError(f"{origin.path}: {first_problem(error, Study, content)}") from None
