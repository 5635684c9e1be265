"""Layer of each test, and the cases of a product that `make test` takes.

`make check` runs the layer ``unit``: in this process, on what is computed in a moment. ``dense`` searches densely,
solves in 50 digits, or fits a study; ``process`` starts programs; ``browser`` opens a page. `make test` runs all four,
and a few cases of a product that is marked ``sampled``, which hold each value of each parameter if they suffice;
`make soak` runs the others.
"""

import os
import subprocess
from collections.abc import Iterable, Sequence
from contextlib import AbstractContextManager
from typing import Any
from unittest import mock

import pytest

from storage import quarantine

#: Whether this is `make soak`.
SOAK = bool(os.environ.get("MEECONTACT_SOAK"))

LAYERS = ("unit", "dense", "process", "browser")

#: What makes or reads the run of a pipeline.
RUNS = {"copy", "tiny", "undisturbed", "ran", "quickstart_run"}

#: Files and folders of `tests/` of which every test starts programs, whatever its fixtures.
PROCESSES = """
faults/ slurm/ storage/test_netcdf.py test_benchmarks.py test_docs.py test_public_names.py test_recipes.py
test_tutorials.py workflow/calculator/test_calculated.py
"""

#: Those of dense searches, solutions in 50 digits and fits of studies.
DENSE = """
solver/face/test_air.py solver/face/test_films.py solver/face/test_own_base.py solver/face/test_scans.py solver/line/
solver/halfplane/test_precise.py solver/halfplane/test_interior.py solver/point/ solver/gap/ solver/heat/
solver/surface/ solver/test_contract.py solver/test_curves.py surrogate/test_contract.py
surrogate/face/test_persistence.py surrogate/gp/test_scattergp.py surrogate/intervals/ surrogate/search/
surrogate/transforms/curves/ surrogate/use/ test_examples.py test_numbers.py verification/ workflow/cli/test_learn.py
workflow/dataset/ workflow/design/ workflow/device/test_signal.py workflow/learning/ workflow/report/test_figures.py
workflow/report/test_films.py workflow/report/test_firstscreen.py workflow/study/test_categories.py
workflow/study/test_grouped.py workflow/study/test_layered.py workflow/study/test_points.py
workflow/study/test_surroundings.py workflow/test_surroundings.py
"""

#: Files of DENSE's folders that take moments.
MOMENTS = """
solver/line/test_stack.py verification/test_oracles.py workflow/design/test_answer.py workflow/design/test_judging.py
"""


def listed(file: str, names: str) -> bool:
    """Return True where a list holds the file or one of its folders."""
    return file.startswith(tuple(f"tests/{name}" for name in names.split()))


def layer(file: str, marks: Iterable[str], fixtures: Iterable[str]) -> str:
    """The layer of a test."""
    named = [name for name in LAYERS if name in set(marks)]
    if named:
        return named[-1]
    if RUNS & set(fixtures) or listed(file, PROCESSES):
        return "process"
    return "dense" if listed(file, DENSE) and not listed(file, MOMENTS) else "unit"


def sample(cases: Sequence[frozenset[tuple[str, object]]], count: int) -> set[int]:
    """Positions of a few cases of a product: each adds the most values that none before it has."""
    taken: set[int] = set()
    seen: set[tuple[str, object]] = set()
    spread = [k * len(cases) // count for k in range(count)]  # where nothing is new, far from one another
    while len(taken) < min(count, len(cases)):
        left = [k for k in range(len(cases)) if k not in taken]
        k = max(left, key=lambda k: (len(cases[k] - seen), k in spread, -k))
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


def without_programs() -> AbstractContextManager[object]:
    """Whatever starts a program fails, but for the reader that looks at a file first."""
    started = subprocess.Popen.__init__

    def refused(self: Any, command: Any, *arguments: Any, **words: Any) -> None:
        assert quarantine.SCRIPT in command, f"a test of the layer 'unit' starts {command}"
        started(self, command, *arguments, **words)

    return mock.patch.object(subprocess.Popen, "__init__", refused)
