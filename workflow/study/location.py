"""Location of a study's file: ``config/<name>.yaml``, or any path.

Results, logs and rules know a study by its name alone. A path is kept in the environment, which jobs inherit from the
process that reads the Snakefile; to other machines Snakemake passes the path as the key ``study`` of its config.
"""

import json
import os
import re
from pathlib import Path
from urllib.request import url2pathname

from workflow.language.spelling import nearest
from workflow.run.provenance import ROOT
from workflow.study.reading import InputError

FOLDER = Path("config")
#: Studies that come with the program, for folders that have no study of the name.
BUNDLED = ROOT / "meecontact/studies"
_ADDRESS = "file://"
_GIVEN = "MEECONTACT_STUDIES"  # in the environment: JSON, absolute paths by name
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,99}")  # it names folders, and is a wildcard of the Snakefile


def given(text: str) -> str:
    """Return the name of a study by name, path or `address`; child processes find the path again under the name."""
    path = Path(url2pathname(text.removeprefix(_ADDRESS))) if text.startswith(_ADDRESS) else Path(text)
    if path.suffix not in (".yaml", ".yml"):
        bundled = BUNDLED / f"{text}.yaml"
        if not _NAME.fullmatch(text) or text in files(FOLDER) or text in _paths() or not bundled.is_file():
            return text
        path = bundled
    if not path.is_file():
        reason = "not a file" if path.exists() else "No such file"
        raise InputError(f"{path}: {reason}; a study is given by its name in {FOLDER}/, or by the path of its file")
    check_name(path.stem, str(path))
    known = _paths()
    absolute = str(path.absolute())
    if known.get(path.stem, absolute) != absolute:
        raise InputError(f"{path}: another study named {path.stem!r} was given before: {known[path.stem]}")
    os.environ[_GIVEN] = json.dumps({**known, path.stem: absolute})
    return path.stem


def beside(name: str, study: Path) -> str:
    """Return the name of a study that another's file names: of ``config/``, beside that file, or of the program."""
    check_name(name, repr(name))
    sibling = study.parent / f"{name}.yaml"
    return given(str(sibling) if name not in files(FOLDER) and sibling.is_file() else name)


def address(name: str) -> str:
    """Return the file of a study as an address, whose letters need no quotes in any shell or in YAML."""
    return location(name).absolute().as_uri()


def location(name: str) -> Path:
    """Return the file of a study."""
    if name in (paths := _paths()):
        return Path(paths[name])
    known = files(FOLDER)
    if name in known:
        check_name(name, f"study: {name!r}")
        return known[name]
    bundled = [other for other in files(BUNDLED) if other not in known]
    where = "" if known else f": {Path.cwd()} has no {FOLDER}/*.yaml; go to a folder that has one"
    raise InputError(
        f"study: {name!r} is unknown{where}; {nearest(name, [*known, *bundled])}; or the path of a study's file"
    )


def files(folder: Path) -> dict[str, Path]:
    """Return the files of the studies in a folder, by name."""
    return {file.stem: file for file in sorted(folder.glob("*.yaml"))}


def by_path(name: str) -> bool:
    """Return True if jobs need a study's path: it was given, or the study comes with the program."""
    return name in _paths()


def of_results(folder: Path) -> Path:
    """Return the file of the study that a folder ``results/<study>`` was made from."""
    folder = folder.absolute()
    return _recorded(folder) or folder.parent.parent / FOLDER / f"{folder.name}.yaml"


def check_owner(name: str, folder: Path) -> None:
    """Refuse, by InputError, a folder of results that were made from another study of the same name."""
    other = _recorded(folder.absolute())
    if other and not other.samefile(location(name)):
        raise InputError(f"{folder}: holds the results of {other}; rename {location(name)}, or remove that folder")


def _recorded(folder: Path) -> Path | None:
    """Return the study's file that results record; None where it is gone or not recorded."""
    try:
        record = json.loads((folder / "provenance.json").read_text(encoding="utf-8"))["study"]
        path = Path(os.path.normpath(folder / record))
    except (OSError, ValueError, LookupError, TypeError):
        return None
    return path if path.suffix in (".yaml", ".yml") and path.is_file() else None


def from_results(name: str, folder: Path) -> str:
    """Return the path of a study's file as its results record it, relative to their folder."""
    return os.path.relpath(location(name), folder)


def _paths() -> dict[str, str]:
    return dict(json.loads(os.environ.get(_GIVEN, "{}")))


def check_name(name: str, where: str) -> None:
    """Refuse, by InputError, a name that cannot name results."""
    if not _NAME.fullmatch(name):
        raise InputError(
            f"{where}: a study's file must be named with up to 100 of the letters a to z, digits, - and _, "
            "a letter or digit first"
        )
