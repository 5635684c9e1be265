"""The page in a real browser: every figure drawn, nothing loaded from elsewhere, no script needed."""

import html
import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.workflow.conftest import Project

BROWSER = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
needs_browser = pytest.mark.skipif(BROWSER is None, reason="no Chromium: the browser tests are left out")

PROBE = """
<script>
addEventListener("load", () => {
  const out = {
    images: [...document.images].map(
      i => ({complete: i.complete, width: i.naturalWidth, shown: i.clientWidth, alt: i.alt})),
    overflow: document.documentElement.scrollWidth - document.documentElement.clientWidth,
    loaded: performance.getEntriesByType("resource").map(e => e.name).filter(n => !n.startsWith("data:")),
    text: document.body.innerText,
  };
  const pre = document.createElement("pre");
  pre.id = "probe";
  pre.textContent = JSON.stringify(out);
  document.body.replaceChildren(pre);
});
</script>
"""


def page(project: Project) -> str:
    return (project.folder / "results/small/report.html").read_text(encoding="utf-8")


def opened(text: str, folder: Path, width: int) -> dict[str, object]:
    """What a headless Chromium sees of a page at some width."""
    assert BROWSER is not None
    file = folder / "probe.html"
    file.write_text(text.replace("</body>", f"{PROBE}</body>"), encoding="utf-8")
    flags = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"]
    flags += ["--disable-quic", "--disable-component-update", "--disable-sync", f"--user-data-dir={folder / 'profile'}"]
    done = subprocess.run(
        [BROWSER, *flags, f"--window-size={width},900", "--virtual-time-budget=20000", "--dump-dom", file.as_uri()],
        capture_output=True, text=True, timeout=120, check=True,
    )  # fmt: skip
    found = re.search(r'<pre id="probe">(.*?)</pre>', done.stdout, re.DOTALL)
    assert found, done.stdout[:2000]
    seen = json.loads(html.unescape(found[1]))
    assert isinstance(seen, dict)
    return seen


@needs_browser
@pytest.mark.parametrize("width", [1280, 500])
def test_every_figure_is_drawn(ran: Project, tmp_path: Path, width: int) -> None:
    seen = opened(page(ran), tmp_path, width)
    images = seen["images"]
    assert isinstance(images, list)
    assert len(images) == 8  # fields, errors, parity, intervals, two designs, two effects
    for image in images:
        assert image["complete"]
        assert image["width"] > 100
        assert image["shown"] > 100
        assert image["alt"]
    assert seen["loaded"] == []
    assert seen["overflow"] == 0


@needs_browser
def test_the_page_says_what_a_reader_needs(ran: Project, tmp_path: Path) -> None:
    text = str(opened(page(ran), tmp_path, 1280)["text"])
    for word in (
        "A small study",
        "640",
        "exact solver",
        "surrogate, mean and interval",
        "feasible; binding",
        "infeasible",
    ):
        assert word in text


def test_the_page_is_self_contained(ran: Project) -> None:
    text = page(ran)
    sources = re.findall(r'(?:src|href)="([^"]*)"', text)
    assert sources
    assert all(source.startswith(("data:", "#")) for source in sources)
    assert "<script" not in text
    assert "url(" not in text.split("</style>")[0]


def test_text_from_the_study_is_escaped(ran: Project) -> None:
    from workflow import report, study

    config = study.load(ran.folder / "config/small.yaml").model_copy(update={"title": "<script>alert(1)</script>"})
    results = ran.folder / "results/small"
    figures = sorted((results / "figures").glob("*.svg"))
    text = report.page(config, "small", results, figures, results / "provenance.json")
    assert "<script" not in text
    assert "&lt;script&gt;" in text
