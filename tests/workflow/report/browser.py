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


def needs(program: str) -> Callable[[Callable[..., None]], Any]:
    """Mark for slow tests that open a page in Chromium or run a script in Node."""
    return lambda test: pytest.mark.slow(pytest.mark.needs(program)(test))


needs_browser, needs_node = needs("chromium"), needs("node")

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
    file = folder / "probe.html"
    page = text.replace("<head>", f"<head>{ERRORS}", 1).replace("</body>", f"{probe}</body>")
    file.write_text(page, encoding="utf-8")
    flags = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"]
    flags += ["--disable-quic", "--disable-component-update", "--disable-sync", f"--user-data-dir={folder / 'profile'}"]
    flags += [f"--window-size={width},900", "--virtual-time-budget=20000", "--dump-dom"]
    command = [programs.path("chromium"), *flags, file.as_uri()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=True)
    found = re.search(r'<pre id="probe">(.*?)</pre>', done.stdout, re.DOTALL)
    assert found, done.stdout[:2000]
    seen: dict[str, Any] = json.loads(html.unescape(found[1]))
    return seen


def in_node(script: str, expression: str, folder: Path) -> Any:
    """Return an expression's value after a script in Node, as plain data."""
    file = folder / "probe.js"
    file.write_text(f"{script}\nconsole.log(JSON.stringify({expression}));", encoding="utf-8")
    command = [programs.path("node"), str(file)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=True)
    return json.loads(done.stdout)
