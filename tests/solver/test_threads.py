"""The solver's matrices are small: BLAS has one thread while it solves, and then as many as before."""

from typing import Any

import pytest
import xarray as xr
from threadpoolctl import threadpool_info, threadpool_limits

import solver
from solver.face.cases import Cases


def threads() -> set[int]:
    return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}


def test_every_solution_is_made_so(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[set[int]] = []
    original = Cases.labelled

    def labelled(*arguments: Any, **options: Any) -> dict[str, xr.Variable]:
        seen.append(threads())
        return original(*arguments, **options)

    monkeypatch.setattr(Cases, "labelled", labelled)
    with threadpool_limits(2, "blas"):
        before = threads()
        solver.solve({"material": "PZT-4", "radius": 0.05, "load": 1e4})
        assert threads() == before
    assert seen == [{1}]
