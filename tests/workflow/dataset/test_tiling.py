"""Blocks fill the factorial in order, of whole chunks, none larger than allowed."""

from math import prod

import numpy as np
import pytest

from workflow.dataset import tiling

LENGTHS = [[5, 6, 4, 7], [4], [3, 8], [2, 10, 20, 40, 5], [2, 13, 4]]


@pytest.mark.parametrize("cases", [1, 3, 7, 28, 100, 168, 1000, 16384])
@pytest.mark.parametrize("lengths", LENGTHS)
def test_regions_fill_the_factorial_in_order(lengths: list[int], cases: int) -> None:
    seen = np.arange(prod(lengths)).reshape(lengths)
    chunk = tiling.chunk_lengths(lengths, max(1, cases // 2))
    blocks = [seen[region].ravel() for region in tiling.regions(lengths, chunk, cases)]
    np.testing.assert_array_equal(np.concatenate(blocks), seen.ravel())
    assert all(block.size <= cases for block in blocks)
    assert all(block[0] // prod(lengths[1:]) == block[-1] // prod(lengths[1:]) for block in blocks)


@pytest.mark.parametrize("cases", [1, 3, 7, 28, 100, 168, 1000, 16384])
@pytest.mark.parametrize("lengths", LENGTHS)
def test_no_chunk_lies_in_two_blocks(lengths: list[int], cases: int) -> None:
    chunk = tiling.chunk_lengths(lengths, max(1, cases // 2))
    assert prod(chunk) <= max(1, cases // 2)
    places = np.indices(lengths) // np.array(chunk).reshape(-1, *[1] * len(lengths))
    number = np.ravel_multi_index(tuple(places), tuple(lengths))
    blocks = [set(number[region].ravel().tolist()) for region in tiling.regions(lengths, chunk, cases)]
    assert sum(map(len, blocks)) == len(set().union(*blocks))


@pytest.mark.parametrize(
    ("lengths", "cases", "chunk"),
    [
        ([25, 10, 20, 40, 5], 16384, [1, 2, 20, 40, 5]),  # 4 of 10 would leave room unused
        ([25, 10, 20, 40, 5], 20000, [1, 5, 20, 40, 5]),
        ([25, 13, 100], 700, [1, 7, 100]),  # 13 is a prime
        ([26, 5, 8, 10, 4], 16384, [1, 5, 8, 10, 4]),
        ([4], 100, [1]),
    ],
)
def test_chunks_divide_the_axis_that_they_split(lengths: list[int], cases: int, chunk: list[int]) -> None:
    assert tiling.chunk_lengths(lengths, cases) == chunk
