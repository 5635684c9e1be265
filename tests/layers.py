"""Slow tests, which `make check` leaves out, and the cases of a product that `make test` takes.

A slow test starts programs, searches densely, solves in 50 digits, or fits a study.
"""

import os
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import pytest
from hypothesis import settings

#: Whether this is `make soak`.
SOAK = bool(os.environ.get("MEECONTACT_SOAK"))

#: Session fixtures that run a pipeline, and one that copies the project: what uses them is slow.
RUNS = ("ran", "undisturbed", "quickstart_run")
FIXTURES = {"copy", "tiny", *RUNS}

#: Files and folders of `tests/` that are slow; the mark ``slow`` names single tests of other files.
FILES = """
faults/ slurm/ cloud/ storage/test_netcdf.py
test_benchmarks.py test_docs.py test_examples.py test_machine.py test_numbers.py test_recipes.py
test_tutorials.py
solver/face/test_films.py solver/face/test_scans.py solver/gap/ solver/halfplane/test_precise.py
solver/heat/ solver/line/ solver/point/ solver/surface/ solver/test_contract.py
surrogate/gp/test_scattergp.py surrogate/intervals/ surrogate/search/
surrogate/test_contract.py surrogate/transforms/curves/ surrogate/use/
verification/
workflow/calculator/test_calculated.py workflow/dataset/ workflow/design/
workflow/device/ workflow/learning/ workflow/measured/
workflow/report/test_figures.py workflow/report/test_exact.py
workflow/study/test_bodies.py workflow/study/test_categories.py
"""


def few_and_many(few: int, many: int, **options: Any) -> Callable[[Callable[..., None]], Any]:
    """A property of a few examples, always the same, and of many others in `make soak`; without a clock."""
    count = many if SOAK else few
    same = settings(max_examples=count, derandomize=not SOAK, deadline=None, database=None, **options)
    return lambda test: pytest.mark.soakable(same(test))


def slow(file: str, fixtures: Iterable[str] = ()) -> bool:
    """Return True for a file that the list holds, and for tests with a fixture that runs a pipeline."""
    return file.startswith(tuple(f"tests/{name}" for name in FILES.split())) or not FIXTURES.isdisjoint(fixtures)


def sample(cases: Sequence[frozenset[tuple[str, object]]], count: int) -> set[int]:
    """Positions of a few cases of a product: each adds the most values that none before it has."""
    seen: set[tuple[str, object]] = set()
    taken: set[int] = set()
    spread = [k * len(cases) // count for k in range(count)]  # of cases that add as much, those far from one another
    while len(taken) < min(count, len(cases)):
        k = max(set(range(len(cases))) - taken, key=lambda k: (len(cases[k] - seen), k in spread, -k))
        taken.add(k)
        seen |= cases[k]
    return taken


def leave_to_soak(items: Iterable[pytest.Item]) -> None:
    """Mark those cases of a ``sampled`` test that only `make soak` runs."""
    products: dict[str, list[pytest.Function]] = {}
    for item in items:
        if isinstance(item, pytest.Function) and item.get_closest_marker("sampled"):
            products.setdefault(item.nodeid.partition("[")[0], []).append(item)
    for cases in products.values():
        count = next(mark.args[0] for mark in cases[0].iter_markers("sampled"))
        sampled = sample([frozenset(case.callspec.indices.items()) for case in cases], count)
        for k, case in enumerate(cases):
            if k not in sampled:
                case.add_marker("soak")
