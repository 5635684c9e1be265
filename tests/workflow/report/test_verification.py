"""The verification page as real processes: what a run makes, and that a red check fails it with the page in place."""

import json
import re

from tests.workflow.conftest import Copy, Project

FEW, DRAWN = ("limits", "films"), ("films",)
GROUPS = len(FEW)
#: Groups of one check each, in place of those that take minutes.
QUICK = """\
from verification.findings import Check, Curve, Findings, Sizes, Timing

def quick(sizes: Sizes) -> Findings:
    return Findings(
        "A title", "About it.", [Check("A check", "one, other", 2e-4, 1e-3, 0.5)],
        [Curve("film_elements", "a curve", "elements", [1.0, 2.0], [1e-2, 1e-4])],
        [Timing("a punch", 1e-12, 1e-2, 1e-3, 1e-6)],
    )

GROUPS = dict.fromkeys(NAMES, quick)
"""


def shortened(project: Project) -> None:
    """Two groups, one of them with curves, of one check each."""
    sections = project.folder / "workflow/study/sections.py"
    text = sections.read_text(encoding="utf-8")
    for name, few in (("CHECK_GROUPS", FEW), ("CONVERGING", DRAWN)):
        text, replaced = re.subn(rf"^{name} = \([^)]*\)", f"{name} = {few}", text, flags=re.MULTILINE)
        assert replaced == 1
    sections.write_text(text, encoding="utf-8")
    (project.folder / "verification/__init__.py").write_text(f"NAMES = {FEW}\n{QUICK}", encoding="utf-8")


def test_a_red_check_fails_the_run_and_the_page_shows_it(copy: Copy) -> None:
    project = copy("verification", whole=True)
    results = project.folder / "results/verification"
    shortened(project)
    project.run("meecontact", "run", "verification", "--cores", "2")
    page = (results / "report.html").read_text(encoding="utf-8")
    assert f"{GROUPS} of {GROUPS}" in page
    assert '<td class="bad">red</td>' not in page
    assert (results / "verdict.txt").read_text(encoding="utf-8") == f"{GROUPS} checks, all green\n"
    assert set(json.loads((results / "provenance.json").read_text(encoding="utf-8"))["results_sha256"]) == {
        f"{group}.json" for group in FEW
    }
    edit = ("verification/findings.py", '"""', '"""Edited. ')  # a source that every group reaches
    planned = project.planned_after([edit], "results/verification/verdict.txt")
    assert planned == {"check", "figure_convergence", "provenance", "report", "verdict"}

    for file in (results / "verification").glob("*.json"):
        checks = json.loads(file.read_text(encoding="utf-8"))
        checks["checks"][0] |= {"error": 2e-2, "passed": False}
        file.write_text(json.dumps(checks), encoding="utf-8")
    done = project.run("meecontact", "run", "verification", "--cores", "2", check=False)
    assert done.returncode != 0
    assert f"RedError: {GROUPS} of {GROUPS} checks are red: A check (0.02 > 0.001)" in done.stdout + done.stderr
    page = (results / "report.html").read_text(encoding="utf-8")
    assert f"0 of {GROUPS}" in page
    assert page.count('<td class="bad">red</td>') == GROUPS
    assert not (results / "verdict.txt").exists()
