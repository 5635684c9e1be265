"""Two runs at once, one core or two, few slabs or many: no interference, and the same bytes."""

import os
import random
import re
import shutil
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from multiprocessing.process import BaseProcess
from pathlib import Path

import psutil
import pytest

from storage.netcdf import ANSWERS, read_whole
from tests import warm
from tests.faults.conftest import FILES, NOT_COMPARED, RESULTS, TINY, contents
from tests.programs import PATIENCE
from tests.workflow.conftest import Copy, Project

Maker = Callable[[str], Project]


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


def kill_within(run: BaseProcess, victim: str, dice: random.Random) -> bool:
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
    psutil.wait_procs(working(project), timeout=PATIENCE)


def test_neither_a_second_run_nor_an_edit_of_the_study_disturbs_the_first(tiny: Maker, undisturbed: Project) -> None:
    project, last = tiny("twice"), str(RESULTS / FILES[0])
    study = project.folder / "config/tiny.yaml"
    first = start(project, "tiny", FILES[0])
    while first.is_alive() and not jobs(first):
        time.sleep(0.1)
    study.write_text(TINY.replace("fibrous", "laminate"), encoding="utf-8")
    for command in (["meecontact", "run", "tiny"], ["snakemake", "--cores", "1", last]):
        second = project.run(*command, check=False)
        assert second.returncode == 1
        assert re.search(r"^study 'tiny' is already being run \(process \d+\): wait", second.stderr, re.MULTILINE)
    first.join()
    assert first.exitcode == 0
    files = contents(project)
    assert FILES[0] in files
    assert files.items() <= contents(undisturbed).items()
    assert {"slab", "cases", "surrogate"} <= project.planned(last)  # the edit is seen now
    study.write_text(TINY, encoding="utf-8")
    assert not project.planned(last)


def same(first: Path, second: Path) -> bool:
    """Return True for files with equal bytes, or equal data but for the state of the study, which counts slabs."""
    if first.suffix != ".nc":
        return first.read_bytes() == second.read_bytes()
    data, others = read_whole(first), read_whole(second)
    for attributes in (data.attrs, others.attrs):
        del attributes["checksum"]
        attributes.pop(ANSWERS, None)
    return data.identical(others)


def test_cores_and_slabs_do_not_change_a_digit(tiny: Maker, undisturbed: Project) -> None:
    project, files = tiny("slabs1"), ("validation.nc", "figures/fields.svg")
    study = project.folder / "config/tiny.yaml"
    study.write_text(TINY.replace("slabs: 2", "slabs: 1"), encoding="utf-8")
    results = project.folder / RESULTS
    (results / "fields").mkdir(parents=True)
    for orphan in ("fields/slab_7.nc", "levels.nc"):  # of earlier states of the study
        (results / orphan).write_bytes(b"old")
    project.run("snakemake", "--cores", "1", *(str(RESULTS / name) for name in files))
    result = contents(project)
    assert sum("slab_" in name for name in result) == 1
    others = {name for name in result if "slab_" not in name}
    assert others >= set(files)
    assert [name for name in others if not same(results / name, undisturbed.folder / RESULTS / name)] == []


def survives(
    project: Project, study: str, expected: dict[str, bytes], kills: int, dice: random.Random, *files: str
) -> dict[str, bytes]:
    """Kill runs of one study in one folder, jobs and Snakemake in turn; look at the files each time, give the last."""
    done = 0
    while done < kills:
        run = start(project, study, *files)
        if kill_within(run, "job" if done % 2 else "snakemake", dice):
            done += 1
        elif run.exitcode == 0:  # it was quicker: begin again
            shutil.rmtree(project.folder / "results")
        for name, content in contents(project, study).items():
            hidden = name.rpartition("/")[2].startswith(".")
            assert hidden or content == expected[name], f"{name} after {done} kills"
    finished = start(project, study, *files)
    finished.join()
    assert finished.exitcode == 0, (project.folder / "run.log").read_text(encoding="utf-8")[-4000:]
    wait_for_orphans(project)
    return contents(project, study)


def test_kills_lose_nothing(tiny: Callable[[str], Project], undisturbed: Project) -> None:
    project, expected = tiny("killed"), contents(undisturbed)
    left = survives(project, "tiny", expected, 2, random.Random(3), "validation.nc")  # Snakemake, then a job
    assert {"quantities.nc", "surrogate.nc", "validation.nc"} <= left.keys()
    assert left.items() <= expected.items()


@pytest.mark.soak
def test_a_hundred_kills_lose_nothing_of_the_quickstart(copy: Copy) -> None:
    undisturbed = copy("quickstart")
    undisturbed.run("meecontact", "run", "quickstart", "--cores", "2", cold=True)
    expected = contents(undisturbed, "quickstart")
    killed = copy("killed")
    assert survives(killed, "quickstart", expected, 100, random.Random(100)) == expected
    assert all((killed.folder / "results/quickstart" / name).is_file() for name in NOT_COMPARED)


def flip(content: bytes) -> bytes:
    """One bit, in the middle."""
    middle = len(content) // 2
    return content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]


def test_damage_is_named_and_not_passed_on(undisturbed: Project, tmp_path: Path) -> None:
    project = Project(tmp_path / "tampered")
    results, slab = project.folder / RESULTS, undisturbed.folder / RESULTS / "fields/slab_1.nc"
    shutil.copytree(undisturbed.folder, project.folder, symlinks=True)
    # by file: what is said of it, the file that would be made from it, and its content
    damage: dict[str, tuple[str, str, Callable[[bytes], bytes]]] = {
        "fields/effect_friction.nc": ("incomplete", "figures/effect_friction.svg", lambda content: content[:-1]),
        "fields/slab_0.nc": ("holds tiny/fields/slab_1.nc", "figures/fields.svg", lambda _: slab.read_bytes()),
        "quantities.nc": ("altered", "surrogate.nc", flip),
    }
    for name, (_, target, changed) in damage.items():
        written = (results / name).stat()
        (results / name).write_bytes(changed((results / name).read_bytes()))
        os.utime(results / name, ns=(written.st_atime_ns, written.st_mtime_ns))
        (results / target).unlink()
    targets = [str(RESULTS / target) for _, target, _ in damage.values()]
    done = project.snakemake("--keep-going", *targets, check=False)
    assert done.returncode == 1
    for name, (says, target, _) in damage.items():
        assert f"FormatError: {RESULTS / name}: {says}" in done.stderr
        assert not (results / target).exists(), target
        (results / name).unlink()  # as docs/runs.md says
    project.snakemake(*targets)
    assert contents(project) == contents(undisturbed)


@contextmanager
def small_disk(folder: Path, kilobytes: int) -> Iterator[Callable[[], None]]:
    """Mount a small file system at a folder; yields what makes it large."""
    folder.mkdir(exist_ok=True)
    command = ["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        pytest.skip(f"no small disk (root may mount one: {' '.join(done.stderr.split())})")

    def enlarge() -> None:
        subprocess.run(["mount", "-o", "remount,size=100m", str(folder)], check=True)

    try:
        yield enlarge
    finally:
        subprocess.run(["umount", "--lazy", str(folder)], check=True)


def as_plain_user(project: Project, *command: str) -> subprocess.CompletedProcess[str]:
    """Run a command that permissions bind."""
    return warm.run(command, project.folder, project.modules, bound=True)


def test_a_full_disk_stops_the_run_and_a_rerun_completes(tiny: Maker, undisturbed: Project) -> None:
    project, expected = tiny("disk"), contents(undisturbed)
    target = str(RESULTS / "validation.nc")
    with small_disk(project.folder / "results", 900) as enlarge:  # for random cases, not for slabs beside them
        full = project.run("snakemake", "--cores", "1", target, check=False)
        assert full.returncode == 1
        assert "[Errno 28] No space left on device: 'results/tiny/" in full.stderr
        wait_for_orphans(project)
        assert {}.items() < contents(project).items() < expected.items()  # whole files, though not all
        enlarge()
        project.snakemake(target)
        left = contents(project)
        assert "validation.nc" in left
        assert left.items() <= expected.items()


def test_an_unwritable_folder_is_named_and_nothing_is_written(tiny: Maker) -> None:
    project = tiny("unwritable")
    folder = project.folder / RESULTS
    folder.mkdir(parents=True)
    folder.chmod(0o555)
    done = as_plain_user(project, "meecontact", "run", "tiny", "--cores", "2")
    folder.chmod(0o755)
    assert done.returncode == 1
    assert f"Permission denied: '{RESULTS}/" in done.stderr
    assert not list(folder.iterdir())


def test_an_unwritable_output_of_a_command_is_one_line(undisturbed: Project, tmp_path: Path) -> None:
    table, output = tmp_path / "table.csv", tmp_path / "closed/out.nc"
    table.write_text("volume_fraction,friction,load,radius\n0.5,0.2,10000,0.05\n", encoding="utf-8")
    output.parent.mkdir(mode=0o555)
    done = as_plain_user(undisturbed, "meecontact", "solve", str(table), "-o", str(output))
    assert (done.returncode, done.stderr) == (2, f"meecontact: {output}: Permission denied\n")
    assert not list(output.parent.iterdir())
