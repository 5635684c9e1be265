"""Slabs, samples and progress."""

import os
import pty
import struct
import sys
import termios
from fcntl import ioctl
from pathlib import Path
from subprocess import PIPE, Popen

import numpy as np
import pytest
import xarray as xr

from solver.names import QUANTITIES
from storage.netcdf import read_whole
from workflow.dataset import factorial, slabs
from workflow.run.provenance import ROOT
from workflow.study import partition
from workflow.study.model import Study, load
from workflow.study.sections import Positions

CODE = """
from pathlib import Path
from workflow.dataset import slabs
from workflow.study import model
study = model.load('config/quickstart.yaml')
dataset = study.dataset.model_copy(update={{"slabs": 26}})
slabs.write_slab(study.model_copy(update={{"dataset": dataset}}), 0, Path({path!r}))
"""


@pytest.fixture(scope="module")
def study() -> Study:
    return load(ROOT / "config/quickstart.yaml")


@pytest.mark.parametrize("count", [1, 3, 26, 100])
def test_no_slab_is_without_a_level(study: Study, count: int) -> None:
    small = study.model_copy(update={"dataset": study.dataset.model_copy(update={"slabs": count})})
    assert partition.count(small) == min(count, 26)


@pytest.mark.parametrize("count", [1, 3])
def test_slabs_make_up_the_factorial(study: Study, count: int, tmp_path: Path) -> None:
    dataset = study.dataset.model_copy(update={"slabs": count, "positions": Positions(inside=4, outside=2)})
    fewer = study.factors["load"].model_copy(update={"levels": 3})
    small = study.model_copy(update={"dataset": dataset, "factors": {**study.factors, "load": fewer}})
    axes = dict(factorial.levels(small))
    for index in range(count):
        slabs.write_slab(small, index, tmp_path / f"{index}.nc")
    gathered = slabs.gather([read_whole(tmp_path / f"{index}.nc") for index in range(count)])
    xr.testing.assert_allclose(gathered, factorial.exact(small, axes)[list(QUANTITIES)], rtol=1e-13)


def test_samples_are_in_the_box_and_follow_the_seed(study: Study) -> None:
    first, again, other = (factorial.sample(study, 400, seed) for seed in ((1, 0), (1, 0), (1, 1)))
    assert first.equals(again)
    assert not first.equals(other)
    for name, axis in study.factors.items():
        values = first[name].values
        assert values.min() >= axis.low
        assert values.max() <= axis.high
        middle = np.sqrt(axis.low * axis.high) if axis.scale == "log" else (axis.low + axis.high) / 2
        assert abs(np.mean(values < middle) - 0.5) < 0.1  # uniform in the axis's own scale


def test_progress_shows_on_a_terminal_and_stays_out_of_a_log(tmp_path: Path) -> None:
    code = CODE.format(path=str(tmp_path / "slab.nc"))
    quiet = Popen([sys.executable, "-c", code], cwd=ROOT, stderr=PIPE)
    assert quiet.communicate()[1] == b""
    ours, theirs = pty.openpty()
    ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 30, 100, 0, 0))
    shown = Popen([sys.executable, "-c", code], cwd=ROOT, stderr=theirs)
    os.close(theirs)
    text = b""
    while True:
        try:
            part = os.read(ours, 4096)
        except OSError:  # the other end is closed
            break
        if not part:
            break
        text += part
    assert shown.wait() == 0
    assert b"slab 1 of 26" in text
    assert b"/1600" in text


def test_positions_of_slabs_hold_both_sides(study: Study) -> None:
    X = study.dataset.positions.values()
    assert X.size == 64
    assert X.min() == -4.0
    assert X.max() == 4.0
    assert np.count_nonzero(np.abs(X) < 1) == 40
