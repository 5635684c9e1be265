"""Follow the tutorials as a reader would: ``python -m docs.tutorial`` writes what is printed into them.

It copies their figures too. Not a part of ``python -m docs``: it runs studies, and needs results/quickstart.
"""

import contextlib
import io
import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib as mpl

from docs.notebook import Part, parts

FOLDER = Path(__file__).parent / "tutorials"
ROOT = FOLDER.parents[1]
PAGES = sorted(FOLDER.glob("*.md"))
ON_QUICKSTART = {"measured", "million"}  # what needs results/quickstart


def command(line: str) -> str:
    """What a command prints."""
    program, *words = shlex.split(line)
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"}
    called = [str(Path(sys.executable).with_name(program)), *words]
    return subprocess.run(called, env=environment, check=True, capture_output=True, text=True).stdout


def follow(page: str, folder: Path, run: Callable[[str], str] = command) -> Iterator[tuple[Part, str]]:
    """Do what a page says, in a folder: every part that is done, and what it prints.

    Files are written, commands run as processes, and all Python of the page is one session of this process.
    """
    session: dict[str, object] = {}
    with contextlib.chdir(folder), mpl.rc_context({"backend": "svg", "svg.hashsalt": "meecontact"}):
        for part in parts(page):
            printed = io.StringIO()
            if part.kind == "sh":
                for line in part.text.splitlines():
                    printed.write(run(line))
            elif part.kind == "python":
                with contextlib.redirect_stdout(printed):
                    exec(compile(part.text, "tutorial", "exec"), session)
            elif part.file:
                Path(part.file).write_text(f"{part.text}\n", encoding="utf-8")
            yield part, printed.getvalue()


def told(page: str, folder: Path, run: Callable[[str], str] = command) -> str:
    """The page with what its commands and its Python print in the blocks that show it."""
    last = ""
    for part, printed in follow(page, folder, run):
        if part.kind == "text":
            page = page.replace(f"```text\n{part.text}\n```", f"```text\n{last}```")
        last = printed or last
    return page


def write() -> None:
    """Write what every tutorial prints into it, and its figures beside it."""
    for path in PAGES:
        with TemporaryDirectory() as made:
            for name in ("config", "results/quickstart"):
                Path(made, name).parent.mkdir(exist_ok=True)
                Path(made, name).symlink_to(ROOT / name)
            path.write_text(told(path.read_text(encoding="utf-8"), Path(made)), encoding="utf-8")
            for figure in Path(made).glob("*.svg"):
                shutil.copy(figure, FOLDER)


if __name__ == "__main__":
    write()
