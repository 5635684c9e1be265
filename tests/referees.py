"""Complaints of public referees about a run's files: `python tests/referees.py results/quickstart`; no code of ours.

CF 1.11 of every netCDF file by the IOOS compliance checker; Croissant by mlcroissant; the Workflow Run RO-Crate by
roc-validator; all values by Debian's nccopy and nco, where they are installed. `make referees` and
`tests/workflow/test_referees.py` run it, in an environment of its own (requirements/referees.in); it exits with 1 where
a referee finds a fault.
"""

import re
import shutil
import subprocess
import sys
import warnings
from collections.abc import Iterator
from functools import cache
from importlib.resources import files
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

ROCRATE = "https://w3id.org/ro/crate/1.1/context"
# which its own check of monotonicity subtracts
LABELS = "unsupported operand type(s) for -: 'str' and 'str'"
# it asks these of the same file for every variable, some thousand times
ASKED_AGAIN = (
    "get_auxiliary_coordinate_variables",
    "get_axis_variables",
    "get_climatology_variable",
    "get_time_variables",
)


def in_order(text: str) -> bool:
    """Return True for a complaint about the order of a pressure only, which CF takes for a height."""
    return "recommended order T, Z, Y, X" in text and not re.search(r" \([TYX]\)", text)


def conventions(folder: Path) -> Iterator[str]:
    """Faults of the netCDF files by CF 1.11."""
    from compliance_checker.cf import util
    from compliance_checker.runner import CheckSuite

    for name in ASKED_AGAIN:
        setattr(util, name, cache(getattr(util, name)))
    CheckSuite.load_all_available_checkers()
    for path in sorted(folder.rglob("*.nc")):
        suite = CheckSuite()
        with suite.load_dataset(str(path)) as data:
            results, errors = suite.run_all(data, ["cf:1.11"], [])["cf:1.11"]
        said = [text for result in results if result.value[0] < result.value[1] for text in result.msgs]
        # the section on scope informs only
        said = [text for text in said if "same group" not in text and not in_order(text)]
        said += [str(error) for error, _ in errors.values() if str(error) != LABELS]
        yield from (f"{path}: {text}" for text in said)


def croissant(folder: Path) -> Iterator[str]:
    """Faults of the metadata for programs of machine learning."""
    import mlcroissant

    try:
        metadata = mlcroissant.Dataset(folder / "croissant.json").metadata
    except mlcroissant.ValidationError as error:
        yield str(error)
        return
    yield from (f"{issue}" for issue in metadata.ctx.issues.errors)
    if {record_set.name for record_set in metadata.record_sets} != {"cases"}:
        yield "croissant.json: the records are not the cases"


def crate(folder: Path) -> Iterator[str]:
    """Parts that the profile Workflow Run requires and the run's crate lacks."""
    import requests
    from rocrate_validator import services
    from rocrate_validator.utils.http import HttpRequester

    context = files("rocrate").joinpath("data/ro-crate.jsonld").read_bytes()

    def local(_: Any, url: str, **__: Any) -> requests.Response:
        answer = requests.Response()
        answer.status_code, answer.url = (200, url) if url == ROCRATE else (404, url)
        answer.headers["Content-Type"] = "application/ld+json"
        answer._content = context if url == ROCRATE else b""
        return answer

    HttpRequester.get = local
    settings = {
        "rocrate_uri": str(folder),
        "profile_identifier": "workflow-run-crate-0.5",
        "requirement_severity": "REQUIRED",
    }
    for issue in services.validate(services.ValidationSettings.parse(settings)).get_issues():
        yield f"ro-crate-metadata.json: {issue.check.identifier}: {issue.message}"


def foreign(folder: Path) -> Iterator[str]:
    """Files that Debian's own programs cannot read."""
    for program in ("nccopy", "ncks"):  # both read every value and write it again
        if shutil.which(program) is None:
            print(f"{program}: not installed, left out")
            continue
        for path in sorted(folder.rglob("*.nc")):
            with TemporaryDirectory() as folder_name:
                done = subprocess.run([program, str(path), f"{folder_name}/again.nc"], capture_output=True, text=True)
            if done.returncode:
                yield f"{path}: {program}: {done.stderr.strip()}"


#: What each looks at: not every study has a surrogate.
REFEREES = {conventions: "*.nc", croissant: "croissant.json", crate: "ro-crate-metadata.json", foreign: "*.nc"}


def main(folders: list[str]) -> int:
    """Ask every referee about every folder of results."""
    warnings.simplefilter("ignore")
    faults = 0
    for folder in map(Path, folders):
        for referee, needed in REFEREES.items():
            if not next(folder.rglob(needed), None):
                print(f"{folder}: {referee.__name__}: no {needed}")
                continue
            complaints = list(referee(folder))
            print(f"{folder}: {referee.__name__}: {len(complaints) or 'no'} fault{'s' * (len(complaints) != 1)}")
            print("".join(f"  {text}\n" for text in complaints), end="")
            faults += len(complaints)
    return int(faults > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
