"""Results that the solver keeps between calls: the most recently used ones, together below a bound in bytes.

A table fills itself when it is read, so that the sizes of all results are summed anew from time to time, for at most
2 % of the time: when a result is stored and after a call of the solver.
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
_APART = 50  # durations of a sum that pass before the next one: tables fill more slowly

_lock = RLock()
_results: OrderedDict[tuple[Any, ...], tuple[Any, Any]] = OrderedDict()  # arguments and result, the oldest first
_used = False  # whether a result was read or stored since the last sum: tables fill themselves
_next = 0.0  # processor time of the next sum [s]


class Cached(Generic[_P, _R]):
    """A function whose results are kept; its arguments must be hashable."""

    def __init__(self, function: Callable[_P, _R]) -> None:
        self.misses = 0
        self._function = function
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
            trim_at_times()
        return result

    def clear(self) -> None:
        """Forget every result of the function."""
        global _next
        with _lock:
            _next = 0.0
            for key in [key for key in _results if key[0] is self._function]:
                del _results[key]


def cached(function: Callable[_P, _R]) -> Cached[_P, _R]:
    """A function whose results are kept as long as they are among the most recently used."""
    return Cached(function)


def trim_at_times() -> None:
    """Drop what is beyond the bound, if any result was read or stored since a sum that was long ago."""
    if _used and process_time() >= _next:
        trim()


def trim() -> float:
    """Drop the least recently used results beyond the bound; bytes of those that stay."""
    global _used, _next
    start = process_time()
    with _lock:
        _used, total, counted, dropped = False, 0.0, set[int](), False
        for number, (key, entry) in enumerate(reversed(list(_results.items()))):
            size, objects = _size(entry, counted)
            if number and total + size > LARGEST:  # the newest result is in use, whatever its size
                del _results[key]
                dropped = True
            else:
                total += size
                counted |= objects
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


def _size(entry: object, counted: set[int]) -> tuple[float, set[int]]:
    """Bytes of an entry, without objects counted before, and the identities of its other objects."""
    size, waiting, objects = 0.0, [entry], set[int]()
    while waiting:
        value = waiting.pop()
        if id(value) in counted or id(value) in objects or isinstance(value, _NO_DATA):
            continue
        objects.add(id(value))
        size += _OBJECT
        if isinstance(value, np.ndarray):
            if isinstance(value.base, np.ndarray):
                waiting.append(value.base)
            elif value.base is None:
                size += value.nbytes
            if value.dtype == object:
                waiting.extend(value.ravel().tolist())
        else:
            waiting.extend(get_referents(value))
    return size, objects
