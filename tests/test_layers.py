"""What `make check` leaves to `make test`, and `make test` to `make soak`, is what tests/layers.py says."""

import subprocess
import sys
from itertools import product

import pytest

from tests import layers


def test_a_sample_of_a_product_holds_each_value_of_each_parameter() -> None:
    whole = [frozenset(zip("abc", case, strict=True)) for case in product(range(5), range(2), range(3))]
    for count in (5, 6, 11):
        taken = layers.sample(whole, count)
        assert len(taken) == count
        assert set().union(*(whole[k] for k in taken)) == set().union(*whole)
    assert layers.sample(whole, 40) == set(range(30))
    assert layers.sample([frozenset({("seed", k)}) for k in range(20)], 4) == {0, 5, 10, 15}  # far from one another


@pytest.mark.parametrize(
    ("file", "marks", "fixtures", "layer"),
    [
        ("tests/solver/halfplane/test_limits.py", [], [], "unit"),
        ("tests/solver/halfplane/test_precise.py", ["parametrize"], [], "dense"),
        ("tests/workflow/design/test_budget.py", [], ["model"], "dense"),
        ("tests/workflow/design/test_budget.py", [], ["copy"], "process"),
        ("tests/workflow/design/test_spoken.py", [], [], "unit"),
        ("tests/faults/test_hostile.py", [], [], "process"),
        ("tests/workflow/report/test_page.py", ["browser"], ["ran"], "browser"),
    ],
)
def test_a_test_is_of_one_layer(file: str, marks: list[str], fixtures: list[str], layer: str) -> None:
    assert layers.layer(file, marks, fixtures) == layer


def test_every_test_has_its_layer(request: pytest.FixtureRequest) -> None:
    for item in request.session.items:
        assert len({mark.name for mark in item.iter_markers()} & set(layers.LAYERS)) == 1, item.nodeid


def test_a_unit_starts_no_program() -> None:
    with layers.without_programs(), pytest.raises(AssertionError, match="of the layer 'unit' starts"):
        subprocess.run([sys.executable, "-V"], check=True)
