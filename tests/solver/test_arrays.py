"""Rows that differ, by the columns that vary."""

import numpy as np
import pytest

from solver.arrays import Array, distinct_rows


@pytest.mark.parametrize(
    "rows",
    [
        np.tile([2.0, 1.0], (5, 1)),
        np.array([[3.0, 7.0, 1.0], [1.0, 7.0, 2.0], [3.0, 7.0, 1.0], [1.0, 7.0, np.inf]]),
        np.ones((1, 3)),
    ],
    ids=["alike", "one column constant", "one row"],
)
def test_distinct_rows_are_those_of_every_column_sorted(rows: Array) -> None:
    computed, which = distinct_rows(rows)
    distinct, all_of = np.unique(rows, axis=0, return_inverse=True)
    np.testing.assert_array_equal(computed, distinct)
    np.testing.assert_array_equal(which, all_of.ravel())
