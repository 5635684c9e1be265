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

from tests import warm
from tests.programs import PATIENCE
from tests.workflow.conftest import Project

Victim = Literal["job", "snakemake"]
Run = warm.Running | subprocess.Popen[bytes]


def start(project: Project, study: str, *files: str, cold: bool = False) -> Run:
    """Start `meecontact run`, or Snakemake for some files of the study, in the project's folder; words in `run.log`."""
    command = ["meecontact", "run", study, "--cores", "2"]
    if files:
        command = ["snakemake", "--cores", "2", *(f"results/{study}/{file}" for file in files)]
    log = project.folder / "run.log"
    if not cold:
        return warm.Running(command, project.folder, project.modules, (os.devnull, log, log))
    environment = {**os.environ, "PYTHONPATH": str(project.modules), "OMP_NUM_THREADS": "1"}
    program = Path(sys.executable).with_name(command[0])
    with log.open("ab") as output:
        return subprocess.Popen(
            [program, *command[1:]], cwd=project.folder, env=environment, stdout=output, stderr=output
        )


def working(project: Project) -> list[psutil.Process]:
    """Processes that work in the project's folder, orphans among them."""
    processes = []
    for process in psutil.process_iter():
        with suppress(psutil.Error):
            if process.status() != psutil.STATUS_ZOMBIE and Path(process.cwd()) == project.folder:
                processes.append(process)
    return processes


def jobs(run: Run) -> list[psutil.Process]:
    """Processes of a run that run a rule's script: forks, or Pythons of their own."""
    descendants = []
    with suppress(psutil.Error):
        for process in psutil.Process(run.pid).children(recursive=True):
            with suppress(psutil.Error):
                if any("/.snakemake/scripts/" in word or warm.FORKED in word for word in process.cmdline()):
                    descendants.append(process)
    return descendants


def kill_within(run: Run, victim: Victim, dice: random.Random) -> bool:
    """SIGKILL at a random moment after the first job has started; whether there still was something to kill.

    Snakemake's jobs are left behind as orphans, as by a killed terminal or the kernel's out-of-memory killer.
    """
    while run.poll() is None and not jobs(run):
        time.sleep(0.1)
    time.sleep(dice.uniform(0, 5 if isinstance(run, subprocess.Popen) else 2))
    if victim == "snakemake":
        killed = run.poll() is None
        run.kill()
    else:
        while not (running := jobs(run)) and run.poll() is None:  # between two jobs
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
