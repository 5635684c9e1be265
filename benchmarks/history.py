"""Keep what was measured: ``python -m benchmarks.history`` appends the numbers of `results/benchmarks.json`.

One row a number in `benchmarks/history.csv`: date, commit, cores, measurement, name, value. Ratios compare across
machines; seconds compare only where the machine is the same.
"""

import csv
import io
import json
import os
import subprocess
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from storage.files import write_text
from workflow.run.provenance import ROOT

HISTORY = Path(__file__).with_name("history.csv")
HEADER = ["date", "commit", "cores", "measurement", "name", "value"]


def numbers(found: Mapping[str, Any]) -> Iterator[tuple[str, str, float]]:
    """Measurement, name and value of every plain number; tables are left to the page."""
    for measurement, content in sorted(found.items()):
        if isinstance(content, Mapping):
            for name, value in content.items():
                if isinstance(value, int | float) and not isinstance(value, bool):
                    yield measurement, name, float(value)


def printed(content: Mapping[str, Any]) -> str:
    """The numbers of one measurement, a line each, for a terminal."""
    return "\n".join(f"  {name:50s} {value:.6g}" for _, name, value in numbers({"": content}))


def appended(history: str, found: Mapping[str, Any], date: str, commit: str, cores: int) -> str:
    """The history with today's rows."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    if not history:
        writer.writerow(HEADER)
    for measurement, name, value in numbers(found):
        writer.writerow([date, commit, cores, measurement, name, f"{value:.6g}"])
    return history + text.getvalue()


def main() -> None:
    """Append what `make bench` measured last."""
    measured = json.loads((ROOT / "results/benchmarks.json").read_text(encoding="utf-8"))
    done = subprocess.run(["git", "rev-parse", "--short", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=True)
    history = HISTORY.read_text(encoding="utf-8") if HISTORY.exists() else ""
    date = datetime.now(UTC).date().isoformat()
    write_text(HISTORY, appended(history, measured, date, done.stdout.strip(), len(os.sched_getaffinity(0))))


if __name__ == "__main__":
    main()
