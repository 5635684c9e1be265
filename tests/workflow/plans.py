"""What Snakemake would run after each of some edits, asked in one process: `python plans.py TARGET < edits.json`.

Standard input is a list of lists of [file, old, new], edits that are made together; standard output a list of the rules
that a dry run names after each such list alone. Between two of them it is forgotten which sources are behind what.
"""

import contextlib
import importlib
import io
import json
import sys
from pathlib import Path

from workflow.run import provenance


def planned(target: str) -> list[str]:
    """Rules that a dry run would execute for a target."""
    from snakemake.cli import main  # takes a second

    importlib.reload(provenance)
    output = io.StringIO()
    with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output), contextlib.suppress(SystemExit):
        main(["--cores", "2", "-n", "--quiet", "host", "--", target])
    return rules(output.getvalue())


def rules(output: str) -> list[str]:
    """Names of the rules that Snakemake tells of."""
    lines = [line.strip() for line in output.splitlines()]
    named = [line for line in lines if line.startswith(("rule ", "localrule ")) and line[-1] == ":"]
    assert named or "Nothing to be done" in output, output
    return sorted({line.split()[1].rstrip(":") for line in named})


def edited(edits: list[tuple[str, str, str]], target: str) -> list[str]:
    """The plan while some things in files are others."""
    before = {file: Path(file).read_text(encoding="utf-8") for file, _, _ in edits}
    for file, old, new in edits:
        text = Path(file).read_text(encoding="utf-8")
        assert old in text, (file, old)
        Path(file).write_text(text.replace(old, new, 1), encoding="utf-8")
    try:
        return planned(target)
    finally:
        for file, text in before.items():
            Path(file).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    print(json.dumps([edited(edits, sys.argv[1]) for edits in json.load(sys.stdin)]))
