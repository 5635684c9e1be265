"""Results that the solver keeps between calls: the most recently used ones, together below a bound in bytes.

A table fills itself when it is read, so that its size is not known when it is stored. The sizes of all results are
therefore summed when another result is stored, and after calls of the solver for at most 2 % of the time.
"""

from collections import OrderedDict
from collections.abc import Callable
from ctypes import CDLL
from functools import cache, update_wrapper
from gc import get_referents
from threading import RLock
from time import process_time
from types import BuiltinFunctionType, FunctionType, MethodType, ModuleType
from typing import Any, Generic, ParamSpec, TypeVar

import numpy as np

LARGEST = 300e6  # bytes of all results: four jobs and a notebook fit into 2 GB beside each other

_P = ParamSpec("_P")
_R = TypeVar("_R")
_NO_DATA = (type, ModuleType, FunctionType, BuiltinFunctionType, MethodType)
_OBJECT = 100  # bytes of an object that is no array, with its share of dictionaries
_SMALL = 64  # results of small functions that are stored between two sums
_APART = 50  # durations of a sum that pass before the next call is followed by one: tables fill more slowly

_lock = RLock()
_results: OrderedDict[tuple[Any, ...], tuple[Any, Any]] = OrderedDict()  # arguments and result, the oldest first
_unsummed = 0  # small results that were stored since the last sum
_used = False  # whether a result was read or stored since the last sum: tables fill themselves
_next = 0.0  # processor time from which on a call is followed by a sum [s]


class Cached(Generic[_P, _R]):
    """A function whose results are kept; its arguments must be hashable."""

    def __init__(self, function: Callable[_P, _R], small: bool) -> None:
        self.misses = 0
        self._function, self._small = function, small
        update_wrapper(self, function)

    def __call__(self, *args: _P.args, **kwargs: _P.kwargs) -> _R:
        """The result, computed only where it is not kept."""
        key = (self._function, args, tuple(kwargs.items()))
        global _used
        with _lock:
            _used = True
            if key in _results:
                _results.move_to_end(key)
                stored: _R = _results[key][1]
                return stored
        result = self._function(*args, **kwargs)
        with _lock:
            self.misses += 1
            _results[key] = (key, result)
            _count(self._small)
        return result

    def clear(self) -> None:
        """Forget every result of the function."""
        with _lock:
            for key in [key for key in _results if key[0] is self._function]:
                del _results[key]


def cached(function: Callable[_P, _R]) -> Cached[_P, _R]:
    """A function whose results are kept as long as they are among the most recently used."""
    return Cached(function, small=False)


def cached_small(function: Callable[_P, _R]) -> Cached[_P, _R]:
    """A function of small results, below 1 MB: some dozens of them are stored between two sums."""
    return Cached(function, small=True)


def _count(small: bool) -> None:
    global _unsummed
    _unsummed += 1 if small else _SMALL
    if _unsummed >= _SMALL:
        trim()


def trim_after_call() -> None:
    """Drop what is beyond the bound, if calls of the solver since the last sum have read or stored any result."""
    if _used and process_time() >= _next:
        trim()


def trim() -> float:
    """Drop the least recently used results beyond the bound; bytes of those that stay."""
    global _unsummed, _used, _next
    start = process_time()
    with _lock:
        _unsummed, _used = 0, False
        seen: set[int] = set()
        total, dropped = 0.0, False
        for number, (key, entry) in enumerate(reversed(list(_results.items()))):
            size = _size(entry, seen)
            if number and total + size > LARGEST:  # the newest result is in use, whatever its size
                del _results[key]
                dropped = True
            else:
                total += size
        end = process_time()
        _next = end + _APART * (end - start)
    if dropped:
        _return_memory()(0)
    return total


@cache
def _return_memory() -> Callable[[int], object]:
    """The C library's function that returns freed memory to the system: glibc holds memory between arrays in use."""
    trimmed: Callable[[int], object] = getattr(CDLL(None), "malloc_trim", int)
    return trimmed


def _size(entry: object, seen: set[int]) -> float:
    """Bytes of an entry, without objects counted before."""
    size, waiting = 0.0, [entry]
    while waiting:
        value = waiting.pop()
        if id(value) in seen or isinstance(value, _NO_DATA):
            continue
        seen.add(id(value))
        if isinstance(value, np.ndarray):
            size += _OBJECT
            if isinstance(value.base, np.ndarray):
                waiting.append(value.base)
            elif value.base is None:
                size += value.nbytes
            if value.dtype == object:
                waiting.extend(value.ravel().tolist())
        else:
            size += _OBJECT
            waiting.extend(get_referents(value))
    return size
