"""A flipped bit, a missing tail or another file in place of a netCDF file that a rule reads is not passed on."""

import os
import shutil
from pathlib import Path

from tests.faults.conftest import RESULTS, contents
from tests.workflow.conftest import Project


def flip(content: bytes) -> bytes:
    """One bit, in the middle."""
    middle = len(content) // 2
    return content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]


def cut(content: bytes) -> bytes:
    """All but the last byte."""
    return content[:-1]


# what is done to files, what is said of them, and what is made from each
CASES = [
    (
        cut,
        "incomplete",
        {"fields/slab_1.nc": "quantities.nc", "fields/effect_friction.nc": "figures/effect_friction.svg"},
    ),
    (None, "holds tiny/fields/slab_1.nc", {"fields/slab_0.nc": "quantities.nc"}),  # which are swapped
    (flip, "altered", {"fields/slab_0.nc": "figures/fields.svg", "quantities.nc": "surrogate.nc"}),
]


def test_damage_is_named_and_not_passed_on(undisturbed: Project, tmp_path: Path) -> None:
    project = Project(tmp_path / "tampered")
    results = project.folder / RESULTS
    for damage, says, pairs in CASES:
        shutil.rmtree(project.folder, ignore_errors=True)
        shutil.copytree(undisturbed.folder, project.folder, symlinks=True)
        for name, target in pairs.items():
            written = (results / name).stat()
            other = results / name if damage else results / "fields/slab_1.nc"
            (results / name).write_bytes((damage or bytes)(other.read_bytes()))
            os.utime(results / name, ns=(written.st_atime_ns, written.st_mtime_ns))
            (results / target).unlink()
        targets = [str(RESULTS / target) for target in pairs.values()]
        done = project.snakemake("--keep-going", *targets, check=False)
        assert done.returncode == 1
        for name, target in pairs.items():
            assert f"FormatError: {RESULTS / name}: {says}" in done.stderr
            assert not (results / target).exists(), target
            (results / name).unlink()  # as docs/runs.md says
    project.snakemake(*targets)
    assert contents(project) == contents(undisturbed)
