"""BLAS on one thread: matrices are small here, and threads waiting for each other take three times as long."""

import sys
from contextlib import AbstractContextManager
from functools import cache

from threadpoolctl import ThreadpoolController

_OF_SCIPY = ("scipy.linalg._fblas", "scipy.special._ufuncs")  # modules that load its BLAS, beside that of numpy


@cache
def _controller(_loaded: tuple[bool, ...]) -> ThreadpoolController:
    """Controller of the libraries that are loaded by now, which take a third of a half-plane's solution to find."""
    return ThreadpoolController()


def one_thread() -> AbstractContextManager[object]:
    """Return a context in which BLAS uses one thread."""
    loaded = tuple(module in sys.modules for module in _OF_SCIPY)
    limit: AbstractContextManager[object] = _controller(loaded).limit(limits=1, user_api="blas")
    return limit
