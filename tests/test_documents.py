"""The documents say what is so: the README's Python runs as it stands, its commands exist."""

import re
import subprocess
from pathlib import Path

from docs import badges
from docs.sections import spread
from tests.workflow import nursery
from workflow.run.provenance import ROOT

README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", README, re.DOTALL)


def python(code: str, folder: Path) -> str:
    done = nursery.run(["python", "-W", "error", "-c", code], folder, ROOT)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_readme_is_short() -> None:
    assert len(README.splitlines()) <= 120


def test_the_readme_s_example_prints_what_the_readme_says(tmp_path: Path) -> None:
    (block,) = BLOCKS
    radius, _, charge, *_ = python(block, tmp_path).splitlines()
    told = re.search(r"prints (.*?) um of contact radius, and (.*?) pC/N", " ".join(README.split()))
    assert told
    for line, words, digits in ((radius, told[1], 2), (charge, told[2], 1)):
        values = [float(one) for one in re.findall(r"\d+\.\d+", line)]
        assert [f"{value:.{digits}f}" for value in values] == re.findall(r"\d+\.\d+", words)


def test_every_make_target_of_the_readme_exists() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    named = set(re.findall(r"^make (\w+)", README, re.MULTILINE))
    assert named >= {"run", "test"}
    assert all(re.search(rf"^{target}:", makefile, re.MULTILINE) for target in named)


def test_the_container_is_made_as_make_run_makes_its_environment() -> None:
    steps = (ROOT / "Dockerfile").read_text(encoding="utf-8")
    made = re.findall(r"^RUN make (.*)$", steps, re.MULTILINE)
    plan, run = (
        subprocess.run(
            ["make", "-n", "-B", "--no-print-directory", *goals], cwd=ROOT, capture_output=True, text=True, check=True
        ).stdout
        for goals in (made, ["run"])
    )
    assert "pip install -q --require-hashes -r requirements/run.txt" in plan
    assert run.startswith(plan)  # and then it runs
    version = re.search(r"^FROM python:(\d\.\d+)-slim$", steps, re.MULTILINE)
    asked = re.search(
        r'^requires-python = ">=(.*)"$', (ROOT / "pyproject.toml").read_text(encoding="utf-8"), re.MULTILINE
    )
    assert version
    assert asked
    assert version[1] == asked[1]
    users = [line.split()[1] for line in steps.splitlines() if line.startswith("USER ")]
    assert users, "the container would run as root"
    assert users[-1].split(":")[0] not in ("root", "0")
    # what the steps need is not left behind
    left = {line.rstrip("/") for line in (ROOT / ".dockerignore").read_text(encoding="utf-8").split()}
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()
    assert not {name.partition("/")[0] for name in listed} & left


def test_the_badges_are_drawn_from_the_files_that_they_speak_of() -> None:
    assert (ROOT / "docs/badges.svg").read_text(encoding="utf-8") == badges.draw()
    assert {"version", "python", "licence", "types"} <= badges.facts().keys()


def test_no_file_names_a_registry_or_a_path_of_a_machine() -> None:
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    hosts = re.compile("|".join(["python" + "hosted", "pypi" + r"\.org", "npm" + "js", "deb" + r"\.debian"]))
    for name in (name for name in listed.split("\0") if (ROOT / name).is_file()):
        assert not hosts.search((ROOT / name).read_text(encoding="utf-8", errors="replace")), name


def test_parameters_of_one_line_are_a_head_and_a_meaning() -> None:
    lines = [
        "A.",
        "",
        "Parameters",
        "-" * 10,
        "t, u : float, (n,), times [s], of what",
        "folder : Path",
        "",
        "x : int, y",
    ]
    text = "\n".join(lines)
    assert spread(text).splitlines()[4:7] == ["t, u : float, (n,)", "    times [s], of what", "folder : Path"]
    assert spread(text).endswith("x : int, y")
