"""Layers and samples of tests/layers.py: the tests of `make check`, `make test` and `make soak`."""

import subprocess
import sys
from itertools import product
from types import SimpleNamespace
from typing import Any, cast

import pytest

from tests import conftest, layers
from workflow.run.provenance import ROOT


def test_a_sample_of_a_product_holds_each_value_of_each_parameter() -> None:
    whole = [frozenset(zip("abc", case, strict=True)) for case in product(range(5), range(2), range(3))]
    for count in (5, 6, 11):
        sample = layers.sample(whole, count)
        assert len(sample) == count
        assert set().union(*(whole[k] for k in sample)) == set().union(*whole)
    assert layers.sample(whole, 40) == set(range(30))
    assert layers.sample([frozenset({("seed", k)}) for k in range(20)], 4) == {0, 5, 10, 15}  # far from one another


def test_every_test_has_its_layer_and_every_listed_file_exists(request: pytest.FixtureRequest) -> None:
    for item in request.session.items:
        assert len({mark.name for mark in item.iter_markers()} & set(layers.LAYERS)) == 1, item.nodeid
    names = f"{layers.PROCESSES} {layers.DENSE} {layers.MOMENTS}".split()
    assert not [name for name in names if not (ROOT / "tests" / name).exists()]


def test_a_unit_starts_no_program() -> None:
    with layers.without_programs(), pytest.raises(AssertionError, match="of the layer 'unit' starts"):
        subprocess.run([sys.executable, "-V"], check=True)


def test_the_last_line_says_what_was_not_run_and_how_to_get_it() -> None:
    lines: list[str] = []
    for tools in ((), ("x (Debian: x)", "y", "y")):
        skipped = [SimpleNamespace(longrepr=("a.py", 1, f"Skipped: no {tool}")) for tool in tools]
        reporter = SimpleNamespace(stats={"skipped": skipped}, write_line=lines.append)
        conftest.pytest_terminal_summary(cast(Any, reporter))
    assert lines == ["nothing was left out", "not run: 1 test: no x (Debian: x); 2 tests: no y"]
