"""Progress of slabs: on a terminal, and in no log."""

import os
import pty
import struct
import termios
from fcntl import ioctl
from pathlib import Path

from tests import warm
from workflow.run.provenance import ROOT

CODE = """
from pathlib import Path
from workflow.dataset import slabs
from workflow.study import model
study = model.load('config/quickstart.yaml')
dataset = study.dataset.model_copy(update={{"slabs": 26}})
slabs.write_slab(study.model_copy(update={{"dataset": dataset}}), 0, Path({path!r}))
"""


def test_progress_shows_on_a_terminal_and_stays_out_of_a_log(tmp_path: Path) -> None:
    command = ["python", "-c", CODE.format(path=str(tmp_path / "slab.nc"))]
    assert warm.run(command, ROOT).stderr == ""
    ours, theirs = pty.openpty()
    ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 30, 100, 0, 0))
    shown = warm.Running(command, ROOT, ROOT, (os.devnull, os.devnull, os.ttyname(theirs)))
    assert shown.wait() == 0
    os.close(theirs)
    text = os.read(ours, 4096)
    os.close(ours)
    assert b"slab 1 of 26" in text
    assert b"/1600" in text
