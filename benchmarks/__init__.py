"""Side-by-side measurements, `make bench`, and the cost of an action."""

from collections.abc import Callable, Mapping
from resource import RUSAGE_CHILDREN, getrusage
from time import perf_counter, process_time
from typing import Any, NamedTuple, TypeVar

T = TypeVar("T")


class Cost(NamedTuple):
    """Seconds, and seconds of processor time."""

    seconds: float
    processor: float


def timed(action: Callable[[], T]) -> tuple[T, Cost]:
    """Return an action's result and its cost."""
    start, used = perf_counter(), _processor()
    answer = action()
    return answer, Cost(perf_counter() - start, _processor() - used)


def least(action: Callable[[], object], repeats: int = 3) -> Cost:
    """The least costs of some runs."""
    costs = [timed(action)[1] for _ in range(repeats)]
    return Cost(min(cost.seconds for cost in costs), min(cost.processor for cost in costs))


def _processor() -> float:
    children = getrusage(RUSAGE_CHILDREN)
    return process_time() + children.ru_utime + children.ru_stime


def printed(content: Mapping[str, Any]) -> str:
    """Numbers of one measurement, a line each, for a terminal."""
    numbers = {name: value for name, value in content.items() if isinstance(value, int | float) and value is not True}
    return "\n".join(f"  {name:50s} {value:.6g}" for name, value in numbers.items())
