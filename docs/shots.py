"""Take the pictures of docs/start.md from the quickstart's report: ``python -m docs.shots``; needs Chromium.

Not a part of ``python -m docs``: a picture of a page is no one's to compare byte for byte.
"""

import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image, ImageChops

FOLDER = Path(__file__).parent
REPORT = FOLDER.parent / "results/quickstart/report.html"
#: What is shown, by the name of its picture: an element of the page, and how much of its height [px].
SHOWN = {"answers": ("#answers", 900), "whatif": ("#whatif", 1760), "matters": ("#figure-sensitivity", 900)}
_WIDTH, _EDGE = 1200, 8
_ALONE = """<style>
  body {{ padding: 24px 12px !important }}
</style><script>setTimeout(() => document.body.replaceChildren(document.querySelector("{0}")), 3000);</script>"""


def _shoot() -> None:
    """Write the pictures into this folder."""
    page = REPORT.read_text(encoding="utf-8")
    with TemporaryDirectory() as folder:
        for name, (element, height) in SHOWN.items():
            alone, picture = Path(folder) / "alone.html", Path(folder) / "picture.png"
            alone.write_text(page + _ALONE.format(element), encoding="utf-8")
            options = ["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--virtual-time-budget=5000"]
            options += [f"--user-data-dir={folder}/profile", f"--screenshot={picture}"]
            options += [f"--window-size={_WIDTH},{height}"]
            subprocess.run(["chromium", *options, alone.as_uri()], check=True, capture_output=True)
            whole = Image.open(picture).convert("RGB")
            box = ImageChops.difference(whole, Image.new("RGB", whole.size, whole.getpixel((0, 0)))).getbbox()
            assert box is not None, element
            left, top, right, bottom = box
            room = (max(left - _EDGE, 0), max(top - _EDGE, 0), min(right + _EDGE, _WIDTH), min(bottom + _EDGE, height))
            whole.crop(room).quantize(256).save(FOLDER / f"report-{name}.png", optimize=True)


if __name__ == "__main__":
    _shoot()
