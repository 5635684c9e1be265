"""Processes of a run, found and killed as a machine would."""

import os
import random
import signal
import time
from contextlib import suppress
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Literal

import psutil

from tests import warm
from tests.programs import PATIENCE
from tests.workflow.conftest import Project

Victim = Literal["job", "snakemake"]


def start(project: Project, study: str, *files: str) -> BaseProcess:
    """Start `meecontact run`, or Snakemake for some files of the study, in the project's folder; words in `run.log`."""
    command = ["meecontact", "run", study, "--cores", "2"]
    if files:
        command = ["snakemake", "--cores", "2", *(f"results/{study}/{file}" for file in files)]
    log = project.folder / "run.log"
    return warm.start(command, project.folder, project.modules, (os.devnull, log, log))


def working(project: Project) -> list[psutil.Process]:
    """Processes that work in the project's folder, orphans among them."""
    processes = []
    for process in psutil.process_iter():
        with suppress(psutil.Error):
            if process.status() != psutil.STATUS_ZOMBIE and Path(process.cwd()) == project.folder:
                processes.append(process)
    return processes


def jobs(run: BaseProcess) -> list[psutil.Process]:
    """Forks of a run that run a rule's script."""
    descendants = []
    with suppress(psutil.Error):
        for process in psutil.Process(run.pid).children(recursive=True):
            with suppress(psutil.Error):
                if any(warm.FORKED in word for word in process.cmdline()):
                    descendants.append(process)
    return descendants


def kill_within(run: BaseProcess, victim: Victim, dice: random.Random) -> bool:
    """SIGKILL at a random moment after the first job has started; whether there still was something to kill.

    Snakemake's jobs are left behind as orphans, as by a killed terminal or the kernel's out-of-memory killer.
    """
    while run.is_alive() and not jobs(run):
        time.sleep(0.1)
    time.sleep(dice.uniform(0, 2))
    if victim == "snakemake":
        killed = run.is_alive()
        run.kill()
    else:
        while not (running := jobs(run)) and run.is_alive():  # between two jobs
            time.sleep(0.05)
        killed = bool(running)
        if killed:
            with suppress(psutil.NoSuchProcess):
                dice.choice(running).send_signal(signal.SIGKILL)
    run.join()
    return killed


def wait_for_orphans(project: Project) -> None:
    """Wait until nothing works in the project's folder any more."""
    psutil.wait_procs(working(project), timeout=PATIENCE)
