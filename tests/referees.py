"""Complaints of public referees about a run's files: `python tests/referees.py results/quickstart`; no code of ours.

CF 1.11 of every netCDF file by the IOOS compliance checker; all values by Debian's nccopy and nco, where they are
installed. `make referees` and
`tests/workflow/test_pipeline.py` run it, in an environment of its own (requirements/referees.in); it exits with 1 where
a referee finds a fault.
"""

import re
import shutil
import subprocess
import sys
import warnings
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

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


REFEREES = (conventions, foreign)


def main(folders: list[str]) -> int:
    """Ask every referee about every folder of results."""
    warnings.simplefilter("ignore")
    faults = 0
    for folder in map(Path, folders):
        for referee in REFEREES:
            complaints = list(referee(folder))
            print(f"{folder}: {referee.__name__}: {len(complaints) or 'no'} fault{'s' * (len(complaints) != 1)}")
            print("".join(f"  {text}\n" for text in complaints), end="")
            faults += len(complaints)
    return int(faults > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
