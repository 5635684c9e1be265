"""The page sends nothing, CI pins its actions, and the list of slow tests is true."""

import re

import yaml

from tests import layers
from workflow.run.provenance import ROOT


def test_the_page_may_load_and_send_nothing() -> None:
    page = (ROOT / "workflow/report/templates/report.html.j2").read_text(encoding="utf-8")
    match = re.search(r'<meta http-equiv="Content-Security-Policy" content="([^"]*)">', page)
    assert match
    assert match.start() < page.index("<style>")
    policy = dict(part.strip().split(" ", 1) for part in match[1].split(";"))
    assert policy["default-src"] == policy["base-uri"] == policy["form-action"] == "'none'"
    allowed = {source for sources in policy.values() for source in sources.split()}
    assert allowed == {"'none'", "'unsafe-inline'", "data:"}  # no address


def test_actions_are_pinned_by_digest() -> None:
    steps = yaml.safe_load((ROOT / ".github/workflows/ci.yml").read_text(encoding="utf-8"))["jobs"]["all"]["steps"]
    used = [step["uses"] for step in steps if "uses" in step]
    assert used
    for action in used:
        assert re.fullmatch(r"[\w-]+/[\w-]+@[0-9a-f]{40}", action)


def test_every_listed_file_exists() -> None:
    assert not [name for name in layers.FILES.split() if not (ROOT / "tests" / name).exists()]
