"""Chunks of a file that are quick to read, and blocks of a factorial that are solved and written together.

A block holds whole chunks, so that a chunk is compressed once and never read again while the file is written; no part
goes beyond one level of the first axis, which slabs share out.
"""

from collections.abc import Iterator, Sequence
from itertools import product
from math import ceil, prod

from storage.blocks import Region


def chunk_lengths(lengths: Sequence[int], cases: int) -> list[int]:
    """Length of a chunk along every axis.

    Chunks divide the axis that they split, where that takes no chunks of less than half of what is allowed; else the
    last of the axis holds less than it has room for.
    """
    split, most = _split(lengths, cases)
    length = lengths[split]
    even = max(part for part in range(1, most + 1) if length % part == 0)
    part = even if 2 * even >= most else _about_equal(length, most)
    return [*([1] * split), part, *lengths[split + 1 :]]


def regions(lengths: Sequence[int], chunk: Sequence[int], cases: int) -> Iterator[Region]:
    """Blocks in C order, each of whole chunks."""
    split, most = _split(lengths, cases)
    step = chunk[split] * _about_equal(ceil(lengths[split] / chunk[split]), max(1, most // chunk[split]))
    for leading in product(*(range(length) for length in lengths[:split])):
        for begin in range(0, lengths[split], step):
            part = slice(begin, min(begin + step, lengths[split]))
            whole = (slice(0, length) for length in lengths[split + 1 :])
            yield (*(slice(place, place + 1) for place in leading), part, *whole)


def _split(lengths: Sequence[int], cases: int) -> tuple[int, int]:
    """The axis that is split so that later ones are whole, and how much of it so many cases hold; 1 of the first."""
    split = next(k for k in range(1, len(lengths) + 1) if prod(lengths[k:]) <= cases) - 1
    return split, max(1, cases // prod(lengths[split + 1 :])) if split else 1


def _about_equal(length: int, most: int) -> int:
    """The largest of as few pieces as possible, of about one size."""
    return ceil(length / ceil(length / most))
