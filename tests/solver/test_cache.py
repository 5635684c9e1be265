"""Stored results are bounded by their bytes together; one thread of BLAS while a case is solved."""

from functools import cached_property
from typing import Any

import numpy as np
import pytest
import xarray as xr
from threadpoolctl import threadpool_info, threadpool_limits

import solver
from solver import cache
from solver.arrays import Array
from solver.face.cases import Cases


class _Table:
    """A table that fills itself when it is read."""

    def __init__(self, size: int) -> None:
        self.size = size

    @cached_property
    def values(self) -> Array:
        return np.zeros(self.size)


@cache.cached
def _table(number: int, size: int) -> _Table:
    return _Table(size)


def test_results_are_dropped_by_their_bytes_the_least_recently_used_first(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "LARGEST", 20e6)
    for number in range(6):
        table = _table(number, 1_000_000)  # 8 MB when it is read, nothing when it is stored
        assert table.values.size == 1_000_000
        assert _table(number, 1_000_000) is table
    assert cache.trim() <= 20e6
    misses = _table.misses
    assert _table(5, 1_000_000).size == _table(4, 1_000_000).size
    assert _table.misses == misses
    _table(0, 1_000_000)
    assert _table.misses == misses + 1
    assert _table(7, 10_000_000).values.size  # larger than the bound: kept as long as it is the newest
    assert cache.trim() > 20e6
    _table(8, 1)
    assert cache.trim() <= 20e6


def threads() -> set[int]:
    return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}


def test_every_solution_is_made_so(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[set[int]] = []
    original = Cases.labelled

    def labelled(*arguments: Any, **options: Any) -> dict[str, xr.Variable]:
        seen.append(threads())
        return original(*arguments, **options)

    case = {"material": "PZT-4", "radius": 0.05, "load": 1e4}
    solver.solve(case)  # loads every BLAS
    monkeypatch.setattr(Cases, "labelled", labelled)
    with threadpool_limits(2, "blas"):
        before = threads()
        solver.solve(case)
        assert threads() == before
    assert seen == [{1}]
