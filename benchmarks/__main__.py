"""Write results/benchmarks.json: ``python -m benchmarks [NAME ...]``.

A measurement is a module of this folder with a function ``measure``; what that gives is kept under the module's name.
"""

import json
import platform
import sys
from importlib import import_module
from pathlib import Path
from time import perf_counter
from typing import Any

from benchmarks import printed
from storage.files import write_text
from workflow.run.provenance import ROOT, versions

FOLDER = ROOT / "results"
MEASUREMENTS = [
    file.stem
    for file in sorted(Path(__file__).parent.glob("*.py"))
    if "\ndef measure(" in file.read_text(encoding="utf-8")
]


def main(names: list[str]) -> int:
    """Run all measurements, or those named, and keep the others as they were."""
    unknown = [name for name in names if name not in MEASUREMENTS]
    if unknown:
        print(f"benchmarks: {unknown[0]!r} is none of {', '.join(MEASUREMENTS)}", file=sys.stderr)
        return 2
    FOLDER.mkdir(exist_ok=True)
    path = FOLDER / "benchmarks.json"
    measured = json.loads(path.read_text(encoding="utf-8")) if names and path.exists() else {}
    for name in names or MEASUREMENTS:
        print(f"{name} ...", flush=True)
        start = perf_counter()
        measured[name] = import_module(f"benchmarks.{name}").measure()
        print(printed(measured[name]))
        print(f"{name}: {perf_counter() - start:.0f} s", flush=True)
        _stored(measured, path)  # what was measured stays where a later measurement fails
    print(path)
    return 0


def _stored(results: dict[str, Any], path: Path) -> None:
    whole = results | {"machine": platform.platform(), "processor": platform.machine(), "versions": versions()}
    write_text(path, json.dumps(whole, indent=2) + "\n")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
