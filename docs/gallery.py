"""Draw the figures of docs/gallery.md by the scripts of examples/: ``python -m docs.gallery``.

Not a part of ``python -m docs``, whose files are the same on every machine: the last digits of a curve are not.
"""

import os
import runpy
from pathlib import Path

import matplotlib as mpl

FOLDER = Path(__file__).parent


def draw() -> None:
    """Write the figures into this folder."""
    os.chdir(FOLDER)
    with mpl.rc_context({"svg.hashsalt": "meecontact"}):
        for script in sorted((FOLDER.parent / "examples").glob("*.py")):
            runpy.run_path(str(script))


if __name__ == "__main__":
    draw()
