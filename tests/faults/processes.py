"""Processes of a run, found and killed as a machine would."""

import os
import random
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import Literal

import psutil

from tests.patience import PATIENCE
from tests.workflow.conftest import Project

Victim = Literal["job", "snakemake"]


def start(project: Project, study: str, *files: str) -> subprocess.Popen[bytes]:
    """Start `meecontact run`, or Snakemake for some files of the study, in the project's folder; words in `run.log`."""
    environment = {**os.environ, "PYTHONPATH": str(project.folder), "OMP_NUM_THREADS": "1"}
    command = ["meecontact", "run", study, "--cores", "2"]
    if files:
        command = ["snakemake", "--cores", "2", *(f"results/{study}/{file}" for file in files)]
    program = Path(sys.executable).with_name(command[0])
    with (project.folder / "run.log").open("ab") as log:
        return subprocess.Popen([program, *command[1:]], cwd=project.folder, env=environment, stdout=log, stderr=log)


def working(project: Project) -> list[psutil.Process]:
    """Processes that work in the project's folder, orphans among them."""
    found = []
    for process in psutil.process_iter():
        with suppress(psutil.Error):
            if process.status() != psutil.STATUS_ZOMBIE and Path(process.cwd()) == project.folder:
                found.append(process)
    return found


def jobs(project: Project) -> list[psutil.Process]:
    """Those of them that run a rule's script."""
    found = []
    for process in working(project):
        with suppress(psutil.Error):
            if any("/.snakemake/scripts/" in word for word in process.cmdline()):
                found.append(process)
    return found


def kill_within(project: Project, run: subprocess.Popen[bytes], victim: Victim, dice: random.Random) -> bool:
    """SIGKILL at a random moment after the first job has started; whether there still was something to kill.

    Snakemake's jobs are left behind as orphans, as by a killed terminal or the kernel's out-of-memory killer.
    """
    while run.poll() is None and not jobs(project):
        time.sleep(0.1)
    time.sleep(dice.uniform(0, 5))
    if victim == "snakemake":
        killed = run.poll() is None
        run.kill()
    else:
        while not (running := jobs(project)) and run.poll() is None:  # between two jobs
            time.sleep(0.05)
        killed = bool(running)
        if killed:
            with suppress(psutil.NoSuchProcess):
                dice.choice(running).send_signal(signal.SIGKILL)
    run.wait()
    return killed


def wait_for_orphans(project: Project) -> None:
    """Wait until nothing works in the project's folder any more."""
    psutil.wait_procs(working(project), timeout=PATIENCE)
