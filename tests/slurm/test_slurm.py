"""The quickstart through a real Slurm: every data file has the bytes of a local run. `make slurm`.

A Slurm of one node on this machine, from Debian's packages, runs as root on loopback and needs no database: `munge` for
credentials, `slurmctld` and `slurmd`, processes tracked through /proc.
"""

import os
import platform
import shutil
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests import programs
from tests.faults.conftest import contents
from tests.programs import PATIENCE
from tests.workflow.conftest import Copy, Project, copy
from workflow.run.provenance import ROOT

__all__ = ["copy"]

pytestmark = pytest.mark.slurm

CONF = Path("/etc/slurm/slurm.conf")
MARK = "# written by the tests of meecontact"
PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "sinfo", "runuser")

TEXT = f"""\
{MARK}
ClusterName=onenode
SlurmctldHost={{host}}(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=batch_sched_delay=0,sched_interval=2,defer
MinJobAge=3600
ReturnToService=2
StateSaveLocation={{folder}}/state
SlurmdSpoolDir={{folder}}/spool
SlurmctldPidFile={{folder}}/slurmctld.pid
SlurmdPidFile={{folder}}/slurmd.pid
SlurmctldLogFile={{folder}}/slurmctld.log
SlurmdLogFile={{folder}}/slurmd.log
NodeName={{host}} NodeAddr=127.0.0.1 CPUs={{cores}} RealMemory={{memory}} State=UNKNOWN
PartitionName=main Nodes={{host}} Default=YES MaxTime=INFINITE State=UP
"""


def missing() -> str:
    """Why no Slurm can be started here; empty where one can."""
    if os.geteuid() != 0:
        return "no Slurm (root may start one)"
    if reason := programs.missing(PROGRAMS):
        return reason
    if CONF.exists() and MARK not in CONF.read_text(encoding="utf-8"):
        return f"Slurm: {CONF} is somebody else's"
    return ""


@contextmanager
def cluster(folder: Path) -> Iterator[None]:
    """Start the cluster with its state in a folder; wait until the node takes jobs; stop it afterwards."""
    for name in ("state", "spool"):
        (folder / name).mkdir(parents=True)
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2**20
    text = TEXT.format(host=platform.node(), folder=folder, cores=os.cpu_count(), memory=memory * 9 // 10)
    CONF.write_text(text, encoding="utf-8")
    run = Path("/run/munge")
    run.mkdir(exist_ok=True)
    for place in (run, Path("/var/log/munge"), Path("/var/lib/munge")):
        shutil.chown(place, "munge", "munge")
    started = []
    try:
        with (folder / "said.log").open("w", encoding="utf-8") as said:
            for command in (
                ["runuser", "-u", "munge", "--", "munged", "--foreground"],
                ["slurmctld", "-D"],
                ["slurmd", "-D"],
            ):
                started.append(subprocess.Popen(command, stdout=said, stderr=said))
                time.sleep(1)
        _wait_for_node(folder)
        yield
    finally:
        for process in reversed(started):
            process.terminate()
        for process in started:
            process.wait(timeout=PATIENCE)
        CONF.unlink()


def _wait_for_node(folder: Path) -> None:
    for _ in range(60):
        done = subprocess.run(["sinfo", "-h", "-o", "%T"], capture_output=True, text=True, check=False)
        if done.stdout.strip() == "idle":
            return
        time.sleep(1)
    logs = "\n".join(file.read_text(encoding="utf-8")[-2000:] for file in sorted(folder.glob("*.log")))
    raise RuntimeError(f"Slurm does not start: {done.stdout}{done.stderr}\n{logs}")


@pytest.mark.skipif(bool(missing()), reason=missing() or "Slurm can be started")
def test_slurm_and_a_local_run_give_the_same_bytes(copy: Copy, tmp_path: Path) -> None:
    local, remote = Project(ROOT), copy("remote")
    local.run("meecontact", "run", "quickstart")  # nothing where `make run` has done it
    expected = contents(local, "quickstart")
    for part in ("results/ball", ".snakemake/metadata"):  # the study that opens the page: jobs of the same kinds
        shutil.copytree(ROOT / part, remote.folder / part)
    with cluster(tmp_path / "slurm"):
        remote.run("meecontact", "run", "quickstart", "--profile", "slurm", cold=True)
        jobs = subprocess.run(["scontrol", "-o", "show", "jobs"], capture_output=True, text=True, check=True).stdout
    assert jobs.count("JobState=COMPLETED") > 8  # it did go there
    assert len(expected) > 12
    assert contents(remote, "quickstart") == expected
