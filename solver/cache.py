"""Cache of the solver's results: the most recently used ones, below a bound in bytes.

Stored tables grow when they are read. So the sizes of all results are summed again when a result is stored and after a
call of the solver, for at most 2 % of the time.
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

LARGEST = 300e6  # bytes of all results: four jobs and a notebook fit into 2 GB

_P = ParamSpec("_P")
_R = TypeVar("_R")
_NO_DATA = (type, ModuleType, FunctionType, BuiltinFunctionType, MethodType)
_OBJECT = 100  # bytes of an object other than an array, with its share of dictionaries
_PAUSE = 50  # time from one sum to the next, in durations of a sum: tables grow more slowly

_lock = RLock()
_results: OrderedDict[tuple[Any, ...], tuple[Any, Any]] = OrderedDict()  # arguments and result, the oldest first
_used = False  # whether a result was read or stored since the last sum: reading makes tables grow
_next = 0.0  # processor time of the next sum [s]


class Cached(Generic[_P, _R]):
    """A function of hashable arguments whose results are stored."""

    def __init__(self, function: Callable[_P, _R]) -> None:
        self.misses = 0
        self._function = function
        update_wrapper(self, function)

    def __call__(self, *args: _P.args, **kwargs: _P.kwargs) -> _R:
        """Return the stored result, or compute and store it."""
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
        """Drop every result of the function."""
        global _next
        with _lock:
            _next = 0.0
            for key in [key for key in _results if key[0] is self._function]:
                del _results[key]


def cached(function: Callable[_P, _R]) -> Cached[_P, _R]:
    """Return a function whose most recently used results are stored."""
    return Cached(function)


def trim_at_times() -> None:
    """Call :func:`trim` if the last sum was long ago and a result was read or stored since."""
    if _used and process_time() >= _next:
        trim()


def trim() -> float:
    """Drop the least recently used results beyond the bound, and return the bytes of the others."""
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
        _next = end + _PAUSE * (end - start)
    if dropped:
        _return_memory()(0)
    return total


@cache
def _return_memory() -> Callable[[int], object]:
    """Return the C library's function that frees memory for the system; glibc keeps it between arrays in use."""
    trimmed: Callable[[int], object] = getattr(CDLL(None), "malloc_trim", int)
    return trimmed


def _size(entry: object, counted: set[int]) -> tuple[float, set[int]]:
    """Bytes of an entry, and identities of its objects, without those counted before."""
    size, pending, objects = 0.0, [entry], set[int]()
    while pending:
        value = pending.pop()
        if id(value) in counted or id(value) in objects or isinstance(value, _NO_DATA):
            continue
        objects.add(id(value))
        size += _OBJECT
        if isinstance(value, np.ndarray):
            if isinstance(value.base, np.ndarray):
                pending.append(value.base)
            elif value.base is None:
                size += value.nbytes
            if value.dtype == object:
                pending.extend(value.ravel().tolist())
        else:
            pending.extend(get_referents(value))
    return size, objects
