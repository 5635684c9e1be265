"""What other machines open and run: a page that loads nothing from elsewhere, and a CI whose actions cannot change."""

import re
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[1]


def test_the_page_may_load_and_send_nothing() -> None:
    page = (ROOT / "workflow/report/templates/report.html.j2").read_text(encoding="utf-8")
    found = re.search(r'<meta http-equiv="Content-Security-Policy" content="([^"]*)">', page)
    assert found
    assert found.start() < page.index("<style>")
    policy = dict(part.strip().split(" ", 1) for part in found[1].split(";"))
    assert policy["default-src"] == policy["base-uri"] == policy["form-action"] == "'none'"
    allowed = {source for sources in policy.values() for source in sources.split()}
    assert allowed == {"'none'", "'unsafe-inline'", "data:"}  # no address


def test_actions_are_pinned_by_digest() -> None:
    steps = yaml.safe_load((ROOT / ".github/workflows/ci.yml").read_text(encoding="utf-8"))["jobs"]["all"]["steps"]
    used = [step["uses"] for step in steps if "uses" in step]
    assert used
    for action in used:
        assert re.fullmatch(r"[\w-]+/[\w-]+@[0-9a-f]{40}", action)
