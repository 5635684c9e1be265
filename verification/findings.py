"""Findings of a verification: checks with their errors and tolerances, convergence curves, times."""

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

_NOTHING = 1e-60  # smaller values are zero to the 50-digit oracle


@dataclass(frozen=True)
class Sizes:
    """Amount of work, which differs between the page and the tests."""

    cases: int = 12  # random cases in 50 digits
    elements: int = 24  # the highest order of finite elements is a sixth of it plus two
    timed: int = 4096  # cases of the closed form that are timed at once; 0: no timing
    seed: int = 1  # of the random cases


@dataclass(frozen=True)
class Check:
    """One comparison."""

    name: str
    compared: str  # description of the compared values
    error: float
    tolerance: float
    seconds: float  # duration of the check

    @property
    def passed(self) -> bool:
        """Return True if the error is a number within the tolerance."""
        return self.error <= self.tolerance


@dataclass(frozen=True)
class Curve:
    """Errors over a measure of effort, in a figure named ``figure``."""

    figure: str
    label: str
    effort: str
    x: Sequence[float]
    error: list[float]


@dataclass(frozen=True)
class Timing:
    """Seconds per case by both methods, at equal accuracy."""

    name: str
    error: float
    numerical: float
    closed_form_alone: float
    closed_form_batch: float


@dataclass(frozen=True)
class Findings:
    """Findings of a group."""

    title: str
    about: str
    checks: list[Check]
    curves: list[Curve] = field(default_factory=list)
    timings: list[Timing] = field(default_factory=list)

    def to_json(self) -> str:
        """Return the findings as JSON; an error that is not a number becomes null."""
        content = asdict(self)
        for check, row in zip(self.checks, content["checks"], strict=True):
            row["passed"] = check.passed
            row["error"] = check.error if np.isfinite(check.error) else None
        return json.dumps(content, indent=2, allow_nan=False) + "\n"


def check(name: str, compared: str, tolerance: float, error: Callable[..., float], *arguments: Any) -> Check:
    """Return a check with the error that a function returns, and its duration."""
    start = perf_counter()
    measured = float(error(*arguments))
    return Check(name, compared, measured, tolerance, perf_counter() - start)


def off(computed: ArrayLike, expected: ArrayLike) -> float:
    """Return the largest difference over the largest expected size, or the difference if zero is expected."""
    computed, expected = np.asarray(computed, dtype=float), np.asarray(expected, dtype=float)
    size = float(np.max(np.abs(expected)))
    return float(np.max(np.abs(computed - expected))) / (size or 1.0)


def off_each(computed: ArrayLike, expected: ArrayLike) -> float:
    """Return the largest difference of a value over its expected size."""
    computed, expected = np.asarray(computed, dtype=float), np.asarray(expected, dtype=float)
    return float(np.max(np.abs(computed - expected) / np.maximum(np.abs(expected), _NOTHING)))
