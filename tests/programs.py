"""The command line in the tests' process, and programs that tests start and that no Python package brings.

A test marked ``needs("node", "ncdump")`` is skipped, with the Debian packages to install, where one is missing
(`tests/conftest.py`). Nothing else in the tests looks for programs.
"""

import shutil
from collections.abc import Iterable
from pathlib import Path

import pytest

#: Debian package of each program.
PACKAGES = {
    "chromium": "chromium",
    "gcc": "gcc libc6-dev",
    "node": "nodejs",
    **dict.fromkeys(("ncdump", "nccopy"), "netcdf-bin"),
    "ncks": "nco",
    "munged": "munge",
    "slurmctld": "slurmctld",
    "slurmd": "slurmd",
    **dict.fromkeys(("sbatch", "squeue", "sinfo"), "slurm-client"),
    "runuser": "util-linux",
}
_OTHER_NAMES = {"chromium": ("chromium-browser", "google-chrome")}


def find(program: str) -> str | None:
    """Path of a program, under the first of its names that is installed; None where it is missing."""
    return next(filter(None, map(shutil.which, (program, *_OTHER_NAMES.get(program, ())))), None)


def path(program: str) -> str:
    """Path of a program that a mark of the test asks for."""
    location = find(program)
    assert location is not None, f"the test lacks the mark needs({program!r})"
    return location


def missing(programs: Iterable[str]) -> str:
    """Reason to skip a test that starts these programs; empty where all are installed."""
    absent = [program for program in programs if find(program) is None]
    packages = dict.fromkeys(PACKAGES[program] for program in absent)
    return f"no {' or '.join(absent)} (Debian: {' '.join(packages)})" if absent else ""


class Command:
    """``meecontact`` in this process, with files in a folder."""

    def __init__(self, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
        self.folder, self.capsys = folder, capsys

    def file(self, name: str, text: str) -> Path:
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return path

    def status(self, *words: str | Path) -> int:
        from workflow.cli import main

        try:
            return main.main([str(word) for word in words])
        except SystemExit as stopped:
            return int(stopped.code or 0)

    def __call__(self, *words: str | Path) -> tuple[str, str]:
        """Output and messages of a command that ends well."""
        self.capsys.readouterr()
        status, said = self.status(*words), self.capsys.readouterr()
        assert status == 0, said.err
        return said

    def refused(self, *words: str | Path) -> str:
        """The single line of a command that is refused."""
        self.capsys.readouterr()
        status, said = self.status(*words), self.capsys.readouterr()
        assert (status, said.out, said.err.count("\n")) == (2, "", 1), said
        return said.err


#: Seconds that a test waits for another process: long enough for a busy machine.
PATIENCE = 900
