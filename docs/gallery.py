"""Draw the figures of docs/gallery.md by the scripts of examples/: ``python -m docs.gallery``.

Not a part of ``python -m docs``, whose files are the same on every machine: the last digits of a curve are not.
"""

import runpy
import shutil
from contextlib import chdir
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib as mpl

FOLDER = Path(__file__).parent


def draw() -> None:
    """Write the figures into this folder; what else the scripts write goes."""
    with TemporaryDirectory() as made, chdir(made), mpl.rc_context({"svg.hashsalt": "meecontact"}):
        for script in sorted((FOLDER.parent / "examples").glob("*.py")):
            if ".svg" in script.read_text(encoding="utf-8"):
                runpy.run_path(str(script))
        for figure in Path(made).glob("*.svg"):
            shutil.copy(figure, FOLDER)


if __name__ == "__main__":
    draw()
