"""Pages in a headless Chromium with a probe, and scripts in Node."""

import html
import json
import re
import subprocess
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest

from tests import programs
from tests.programs import PATIENCE


def needs_browser(test: Callable[..., None]) -> Callable[..., None]:
    """Mark a test that opens a page."""
    return pytest.mark.slow(pytest.mark.needs("chromium")(test))  # type: ignore[no-any-return]


def needs_node(test: Callable[..., None]) -> Callable[..., None]:
    """Mark a test that runs a script without a page."""
    return pytest.mark.slow(pytest.mark.needs("node")(test))  # type: ignore[no-any-return]


#: Collects whatever a script complains about; `report` leaves the data of a probe in the page.
ERRORS = """
<script>
window.complaints = [];
addEventListener("error", (event) => complaints.push(String(event.message)));
console.error = console.warn = (...words) => complaints.push(words.join(" "));
window.report = (seen) => {
  const pre = document.createElement("pre");
  pre.id = "probe";
  pre.textContent = JSON.stringify(seen);
  document.body.replaceChildren(pre);
};
</script>
"""


def axe() -> str:
    """The checker of what people with disabilities can use, as a script."""
    return f"<script>{files('axe_core_python').joinpath('axe.min.js').read_text(encoding='utf-8')}</script>"


def opened(text: str, folder: Path, width: int, probe: str) -> dict[str, Any]:
    """Return the data that a probe finds in a page of some width, in a headless Chromium."""
    page = text.replace("<head>", f"<head>{ERRORS}", 1).replace("</body>", f"{probe}</body>")
    seen = _probed(page, folder, f"--window-size={width},900", "--virtual-time-budget=20000")
    assert isinstance(seen, dict)
    return seen


def in_node(script: str, expression: str, folder: Path) -> Any:
    """Return an expression's value after a script in Node, as plain data."""
    file = folder / "probe.js"
    file.write_text(f"{script}\nconsole.log(JSON.stringify({expression}));", encoding="utf-8")
    done = subprocess.run(
        [programs.path("node"), str(file)], capture_output=True, text=True, timeout=PATIENCE, check=True
    )
    return json.loads(done.stdout)


def _probed(page: str, folder: Path, *flags: str) -> Any:
    """Return the data that a page writes into its probe."""
    file = folder / "probe.html"
    file.write_text(page, encoding="utf-8")
    quiet = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"]
    quiet += ["--disable-quic", "--disable-component-update", "--disable-sync", f"--user-data-dir={folder / 'profile'}"]
    done = subprocess.run(
        [programs.path("chromium"), *quiet, *flags, "--dump-dom", file.as_uri()],
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=True,
    )
    probe = re.search(r'<pre id="probe">(.*?)</pre>', done.stdout, re.DOTALL)
    assert probe, done.stdout[:2000]
    return json.loads(html.unescape(probe[1]))
