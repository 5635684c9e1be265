"""Blocks fill the factorial in order, of whole chunks, none larger than allowed."""

from math import prod

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from workflow.dataset import tiling

FACTORIALS = st.lists(st.integers(1, 45), min_size=1, max_size=5).filter(lambda lengths: prod(lengths) <= 4000)


@settings(deadline=None, derandomize=True, max_examples=200)
@given(lengths=FACTORIALS, cases=st.sampled_from([1, 2, 3, 7, 28, 100, 168, 1000, 16384]) | st.integers(1, 5000))
@example(lengths=[5, 6, 4, 7], cases=28)
@example(lengths=[2, 13, 4], cases=100)
@example(lengths=[2, 10, 20, 40, 5], cases=1000)
@example(lengths=[2, 10, 20, 40, 5], cases=16384)
def test_blocks_fill_the_factorial_in_order_of_whole_chunks(lengths: list[int], cases: int) -> None:
    chunk = tiling.chunk_lengths(lengths, max(1, cases // 2))
    assert prod(chunk) <= max(1, cases // 2)
    regions = list(tiling.regions(lengths, chunk, cases))

    case = np.arange(prod(lengths)).reshape(lengths)
    blocks = [case[region].ravel() for region in regions]
    np.testing.assert_array_equal(np.concatenate(blocks), case.ravel())
    assert max(block.size for block in blocks) <= cases
    level = prod(lengths[1:])
    assert all(block[0] // level == block[-1] // level for block in blocks)  # of the first factor

    places = np.indices(lengths) // np.array(chunk).reshape(-1, *[1] * len(lengths))
    number = np.ravel_multi_index(tuple(places), tuple(lengths))
    held = [set(number[region].ravel().tolist()) for region in regions]
    assert sum(map(len, held)) == len(set().union(*held))  # no chunk lies in two blocks


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
