"""The benchmark history keeps plain numbers and never changes what it holds."""

import csv
import io

from benchmarks.history import HEADER, appended

FOUND = {
    "dataset": {"cases_per_second": 38264.25, "table": [{"a": 1.0}], "good": True},
    "exact": {"ratio": 2},
    "machine": "a machine",
}


def test_rows_are_appended_after_what_is_there() -> None:
    first = appended("", FOUND, "2026-11-21", "abc1234", 2)
    both = appended(first, FOUND, "2026-11-22", "def5678", 4)
    assert both.startswith(first)
    rows = list(csv.reader(io.StringIO(both)))
    assert rows[0] == HEADER
    assert rows[1] == ["2026-11-21", "abc1234", "2", "dataset", "cases_per_second", "38264.2"]
    assert rows[2] == ["2026-11-21", "abc1234", "2", "exact", "ratio", "2"]
    assert [row[1] for row in rows[1:]] == ["abc1234", "abc1234", "def5678", "def5678"]
