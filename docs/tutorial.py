"""Follow the tutorials as a reader would; ``python -m docs.tutorial`` updates the output that they show."""

import contextlib
import io
import os
import shlex
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib as mpl

from docs.pages import ROOT, Part, tutorial_parts

FOLDER = ROOT / "docs/tutorials"
PAGES = sorted(FOLDER.glob("*.md"))
ON_QUICKSTART = {"measured"}  # tutorials that need results/quickstart


def command(line: str) -> str:
    """Standard output of a command."""
    program, *words = shlex.split(line)
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"}
    called = [str(Path(sys.executable).with_name(program)), *words]
    return subprocess.run(called, env=environment, check=True, capture_output=True, text=True).stdout


def follow(page: str, folder: Path, run: Callable[[str], str] = command) -> Iterator[tuple[Part, str]]:
    """Yield every part of a page with its printed output, after doing in `folder` what the part says.

    Files are written, commands run as processes, and all Python of the page is one session of this process.
    """
    session: dict[str, object] = {}
    with contextlib.chdir(folder), mpl.rc_context({"backend": "svg", "svg.hashsalt": "meecontact"}):
        for part in tutorial_parts(page):
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


def updated(page: str, folder: Path, run: Callable[[str], str] = command) -> str:
    """Return the page with the present output of its commands and its Python."""
    last = ""
    for part, printed in follow(page, folder, run):
        if part.kind == "text":
            page = page.replace(f"```text\n{part.text}\n```", f"```text\n{last}```")
        last = printed or last
    return page


def write() -> None:
    """Update the output in all tutorials; needs results/quickstart."""
    for path in PAGES:
        with TemporaryDirectory() as folder:
            for name in ("config", "results/quickstart"):
                Path(folder, name).parent.mkdir(exist_ok=True)
                Path(folder, name).symlink_to(ROOT / name)
            path.write_text(updated(path.read_text(encoding="utf-8"), Path(folder)), encoding="utf-8")


if __name__ == "__main__":
    write()
