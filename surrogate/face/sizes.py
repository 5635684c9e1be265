"""How long a model in a file may be along what its reader's time and memory grow with, by squares and cubes."""

import re

import xarray as xr

from surrogate.data.factorial import MOST_OF_A_FACTOR

_LEVELS = r"level_\d+"
#: Most of each dimension, of a model or a member: a matrix is decomposed over levels and over cases.
MOST = {_LEVELS: MOST_OF_A_FACTOR, "case": 3000, "input": 100, "output": 10_000}
_ALL_LEVELS = 2 * MOST_OF_A_FACTOR  # of all factors together


def check_sizes(stored: xr.Dataset) -> None:
    """Raise ValueError, with a dimension and its length, where one is longer than is read."""
    for kind, most in MOST.items():
        for name, length in _lengths(stored, kind).items():
            if length > most:
                raise ValueError(f"{name} is {length} long; a model in a file has at most {most}")
    if (levels := sum(_lengths(stored, _LEVELS).values())) > _ALL_LEVELS:
        raise ValueError(f"{levels} levels of all factors; a model in a file has at most {_ALL_LEVELS}")


def _lengths(stored: xr.Dataset, kind: str) -> dict[str, int]:
    return {str(name): size for name, size in stored.sizes.items() if re.fullmatch(rf"(?:.*_)?{kind}", str(name))}
