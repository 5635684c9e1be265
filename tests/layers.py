"""Which layer a test is of, and which of a product's cases `make test` takes.

`make check` runs the layer ``unit``: in this process, on what is computed in a moment. ``dense`` is what searches
densely, solves in 50 digits, or fits a study; ``process`` starts programs; ``browser`` opens a page. `make test` runs
all four, and of a product of cases that bears ``sampled`` a few, in which each value of each parameter stands if they
suffice; `make soak` runs the others.
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

#: Files and folders of which every test starts programs, whatever its fixtures.
PROCESSES = (
    "tests/faults/",
    "tests/slurm/",
    "tests/storage/test_netcdf.py",
    "tests/test_benchmarks.py",
    "tests/test_docs.py",
    "tests/test_public_names.py",
    "tests/test_recipes.py",
    "tests/test_tutorials.py",
    "tests/workflow/calculator/test_calculated.py",
)

#: Files and folders of dense searches, solutions in 50 digits and fits of studies.
DENSE = (
    "tests/solver/face/test_air.py",
    "tests/solver/face/test_film_bodies.py",
    "tests/solver/face/test_films.py",
    "tests/solver/face/test_own_base.py",
    "tests/solver/face/test_scans.py",
    "tests/solver/line/",
    "tests/solver/halfplane/test_coalescing_roots.py",
    "tests/solver/halfplane/test_conduction.py",
    "tests/solver/halfplane/test_friction_coupling.py",
    "tests/solver/halfplane/test_interior.py",
    "tests/solver/halfplane/test_peaks.py",
    "tests/solver/halfplane/test_precise.py",
    "tests/solver/halfplane/test_precision.py",
    "tests/solver/halfplane/test_speed.py",
    "tests/solver/point/test_inside.py",
    "tests/solver/point/test_peaks.py",
    "tests/solver/point/test_precise.py",
    "tests/solver/point/test_sliding.py",
    "tests/solver/gap/",
    "tests/solver/test_contract.py",
    "tests/solver/test_curves.py",
    "tests/surrogate/face/test_persistence.py",
    "tests/surrogate/gp/test_finiterank.py",
    "tests/surrogate/gp/test_properties.py",
    "tests/surrogate/gp/test_scattergp.py",
    "tests/surrogate/intervals/",
    "tests/surrogate/search/",
    "tests/surrogate/transforms/curves/",
    "tests/surrogate/use/",
    "tests/test_examples.py",
    "tests/test_numbers.py",
    "tests/verification/",
    "tests/workflow/cli/test_learn.py",
    "tests/workflow/dataset/",
    "tests/workflow/design/",
    "tests/workflow/learning/",
    "tests/workflow/report/test_figures.py",
    "tests/workflow/report/test_films.py",
    "tests/workflow/report/test_firstscreen.py",
    "tests/workflow/study/test_categories.py",
    "tests/workflow/study/test_grouped.py",
    "tests/workflow/study/test_layered.py",
)

#: Of those folders, files of moments.
MOMENTS = (
    "tests/solver/line/test_stack.py",
    "tests/solver/gap/test_densities.py",
    "tests/solver/gap/test_equilibration.py",
    "tests/verification/test_oracles.py",
    "tests/workflow/design/test_answer.py",
    "tests/workflow/design/test_counting.py",
    "tests/workflow/design/test_judging.py",
    "tests/workflow/design/test_searching.py",
    "tests/workflow/design/test_sources.py",
    "tests/workflow/design/test_spoken.py",
)


def layer(file: str, marks: Iterable[str], fixtures: Iterable[str]) -> str:
    """The layer of a test."""
    named = [name for name in LAYERS if name in set(marks)]
    if named:
        return named[-1]
    if RUNS & set(fixtures) or file.startswith(PROCESSES):
        return "process"
    return "dense" if file.startswith(DENSE) and file not in MOMENTS else "unit"


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
