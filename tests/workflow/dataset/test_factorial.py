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

from workflow.dataset import factorial
from workflow.run.provenance import ROOT
from workflow.study.model import Study, load

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
