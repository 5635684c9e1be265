"""Measured rows: where outputs were measured, what was read, and how well."""

from dataclasses import dataclass

import numpy as np

from approximation.arrays import Array, Indices

#: Rows that a model is corrected by, at most: the cost grows with their cube.
MOST_ROWS = 1000


@dataclass(frozen=True)
class Measurements:
    """Measured values in a flat list, a row of which may hold several outputs or none."""

    points: Array  # shape (rows, d); Inputs of every row, in their units
    # shape (n,); Row and number of the output of every value; no row has an output twice
    row: Indices
    output: Indices
    value: Array  # shape (n,); What was measured, in the output's unit
    error: Array  # shape (n,); Standard deviation of its error; NaN where nobody knows it

    def __post_init__(self) -> None:
        if any(map(np.ma.is_masked, (self.points, self.value, self.error))):
            raise ValueError("measured rows hold masked cells; leave these rows out")
        if not np.isfinite(self.points).all() or not np.isfinite(self.value).all():
            raise ValueError("measured rows must hold finite numbers")
        if (self.error <= 0).any() or np.isinf(self.error).any():
            raise ValueError("errors of measurement must be positive and finite, or NaN where unknown")
        if len({*zip(self.row.tolist(), self.output.tolist(), strict=True)}) < len(self.row):
            raise ValueError("an output is measured twice in a row")

    def of(self, output: int) -> Indices:
        """Places of the values of one output."""
        return np.flatnonzero(self.output == output)

    @property
    def outputs(self) -> list[int]:
        """Outputs that are measured anywhere, ascending."""
        return [int(number) for number in np.unique(self.output)]
