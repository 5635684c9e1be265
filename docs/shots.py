"""Take the README's picture, the answers of the quickstart's report: ``python -m docs.shots``; needs Chromium."""

import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image, ImageChops

from docs.pages import ROOT

_WIDTH, _HEIGHT, _MARGIN = 1200, 1100, 8  # pixels
_ALONE = """<style>
  body { padding: 24px 12px !important }
</style><script>setTimeout(() => document.body.replaceChildren(document.querySelector("#answers")), 3000);</script>"""


def take() -> None:
    """Write docs/report-answers.png from results/quickstart/report.html."""
    report = (ROOT / "results/quickstart/report.html").read_text(encoding="utf-8")
    with TemporaryDirectory() as folder:
        page, picture = Path(folder) / "alone.html", Path(folder) / "picture.png"
        page.write_text(report + _ALONE, encoding="utf-8")
        options = ["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--virtual-time-budget=5000"]
        options += [f"--user-data-dir={folder}/profile", f"--screenshot={picture}", f"--window-size={_WIDTH},{_HEIGHT}"]
        subprocess.run(["chromium", *options, page.as_uri()], check=True, capture_output=True)
        whole = Image.open(picture).convert("RGB")
        box = ImageChops.difference(whole, Image.new("RGB", whole.size, whole.getpixel((0, 0)))).getbbox()
        assert box is not None, "the screenshot is empty"
        left, top, right, bottom = box
        edges = (left - _MARGIN, top - _MARGIN, min(right + _MARGIN, _WIDTH), min(bottom + _MARGIN, _HEIGHT))
        whole.crop((max(edges[0], 0), max(edges[1], 0), *edges[2:])).quantize(256).save(
            ROOT / "docs/report-answers.png", optimize=True
        )


if __name__ == "__main__":
    take()
