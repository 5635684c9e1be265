"""Draw the figures of gallery and tutorials, and the calculator, into build/figures: ``python -m docs``."""

import runpy
import shutil
from contextlib import chdir
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib as mpl

from docs import tutorial
from docs.pages import DRAWN, ROOT
from workflow.cli.main import main


def draw() -> None:
    """Run the scripts and tutorials that draw figures, and write the calculator."""
    (DRAWN / "tutorials").mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory() as folder, chdir(folder), mpl.rc_context({"svg.hashsalt": "meecontact"}):
        for script in sorted((ROOT / "examples").glob("*.py")):
            if ".svg" in script.read_text(encoding="utf-8"):
                runpy.run_path(str(script))
        for figure in Path(folder).glob("*.svg"):
            shutil.copy(figure, DRAWN)
    for page in tutorial.PAGES:
        text = page.read_text(encoding="utf-8")
        if ".svg)" in text:
            with TemporaryDirectory() as folder:
                list(tutorial.follow(text, Path(folder)))
                for figure in Path(folder).glob("*.svg"):
                    shutil.copy(figure, DRAWN / "tutorials")
    main(["calculator", "-o", str(DRAWN / "calculator.html")])


if __name__ == "__main__":
    draw()
