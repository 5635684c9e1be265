"""Targets that no design reaches are told at the end of a run, by either command."""

import re
import shutil
from pathlib import Path

from tests.workflow.conftest import Project

LINE = (
    "target impossible: not reachable: trailing_tension <= 1 MPa binds; the least violated design misses it by 9075 %"
)


def test_a_run_ends_with_it_also_where_nothing_is_to_be_done(ran: Project) -> None:
    done = ran.run("meecontact", "run", "small", "--cores", "2")
    *lines, last = done.stdout.splitlines()
    assert last == "report: results/small/report.html"
    assert re.match(
        r"sensor +beyond linear theory; otherwise recommended within the model; a tilt of .+ times "
        r"+voltage per load 4[\d.]+ mV·m/N +volume fraction 0\.6\d+, radius 1",
        lines[1],
    )
    assert re.match("impossible +not reachable +stroke per volt", lines[3])
    assert "9070 % beyond the limit" in lines[4]
    assert "writing the page" not in done.stderr  # nothing was to be done


def test_plain_snakemake_tells_it_of_the_designs_that_it_makes(ran: Project, tmp_path: Path) -> None:
    project = Project(tmp_path / "copy")
    shutil.copytree(ran.folder, project.folder, symlinks=True)
    done = project.snakemake("--force", "--", "results/small/design.nc")
    assert done.stdout.splitlines().count(LINE) == 1
