"""Findings of a verification, and their verdict."""

import json
from pathlib import Path
from typing import Any


class RedError(Exception):
    """Some check is red."""


def findings(files: list[Path]) -> list[dict[str, Any]]:
    """Read the findings of the groups, as :mod:`verification` wrote them."""
    return [json.loads(file.read_text(encoding="utf-8")) for file in files]


def verdict(files: list[Path]) -> str:
    """Return one line if all checks are green; RedError otherwise."""
    checks = [check for group in findings(files) for check in group["checks"]]
    red = [f"{check['name']} ({check['error']} > {check['tolerance']})" for check in checks if not check["passed"]]
    if red or not checks:
        raise RedError(f"{len(red)} of {len(checks)} checks are red: {'; '.join(red)}")
    return f"{len(checks)} checks, all green\n"
