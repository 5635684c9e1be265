"""Disks that fill and folders that cannot be written: one clear error, nothing half-written, and a rerun completes."""

import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests import warm
from tests.faults.conftest import RESULTS, contents
from tests.faults.processes import wait_for_orphans
from tests.workflow.conftest import Project

Maker = Callable[[str], Project]


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


def leaves_whole_files(full: subprocess.CompletedProcess[str], project: Project, expected: dict[str, bytes]) -> int:
    """The run failed for want of room and left only whole files, though not all; how many."""
    assert full.returncode == 1
    assert "[Errno 28] No space left on device: 'results/tiny/" in full.stderr
    wait_for_orphans(project)
    left = contents(project)
    assert left.items() < expected.items()
    return len(left)


def test_a_full_disk_stops_the_run_and_a_rerun_completes(tiny: Maker, undisturbed: Project) -> None:
    project, expected = tiny("disk"), contents(undisturbed)
    target = str(RESULTS / "validation.nc")
    with small_disk(project.folder / "results", 900) as enlarge:  # for random cases, not for slabs beside them
        full = project.run("snakemake", "--cores", "1", target, check=False)
        assert leaves_whole_files(full, project, expected) > 0
        enlarge()
        project.snakemake(target)
        left = contents(project)
        assert "validation.nc" in left
        assert left.items() <= expected.items()


def test_an_unwritable_folder_is_named_and_a_rerun_completes(tiny: Maker, undisturbed: Project) -> None:
    project = tiny("unwritable")
    results = project.folder / "results"
    for folder in (results, results / "tiny"):
        folder.mkdir(exist_ok=True)
        folder.chmod(0o555)
        done = as_plain_user(project, "meecontact", "run", "tiny", "--cores", "2")
        folder.chmod(0o755)
        assert done.returncode == 1
        assert f"Permission denied: '{folder.relative_to(project.folder)}/" in done.stderr
        assert not [file for file in results.rglob("*") if file.is_file()]
    project.snakemake(str(RESULTS / "quantities.nc"))  # with nothing there, what follows is any run
    assert contents(project).items() <= contents(undisturbed).items()


@pytest.mark.parametrize("command", ["solve", "query"])
def test_an_unwritable_output_of_a_command_is_one_line(command: str, undisturbed: Project, tmp_path: Path) -> None:
    table = tmp_path / "table.csv"
    closed = tmp_path / "closed"
    closed.mkdir()
    row = "0.5,0.2,10000,0.05"
    table.write_text(f"volume_fraction,friction,load,radius\n{row}\n", encoding="utf-8")
    closed.chmod(0o555)
    words = {
        "solve": ["solve", str(table), "-o", str(closed / "out.nc")],
        "query": ["query", str(RESULTS / "surrogate.nc"), str(table), "-o", str(closed / "out.csv")],
    }[command]
    done = as_plain_user(undisturbed, "meecontact", *words)
    assert done.returncode == 2
    assert done.stderr == f"meecontact: {words[-1]}: Permission denied\n"
    assert not list(closed.iterdir())
