"""A Slurm of one node on this machine, from Debian's packages: started, used and stopped by the test.

It runs as root on loopback and needs no database: `munge` for credentials, `slurmctld` and `slurmd`, processes tracked
through /proc. Elsewhere, or where a Slurm is configured already, :func:`missing` says why it is left out.
"""

import os
import platform
import shutil
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tests import programs
from tests.programs import PATIENCE

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
