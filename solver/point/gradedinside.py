"""Fields inside films that are graded, under points: two staircases of homogeneous layers, extrapolated (points, 7).

Displacements, potentials and tractions meet at the steps; what fields take of them is the material's at the depth. The
tractions on top are those of the graded film.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from solver.arrays import Array
from solver.point.inside import Inside
from solver.point.tractions import Tractions
from solver.stack.grading import Graded, staircase
from solver.stack.layers import Stack

_SUBLAYERS = 24  # and half of them: of second order in their thickness


@dataclass(frozen=True, eq=False)
class GradedInside:
    """A film with fields inside, its top layer graded."""

    stack: Stack

    #: No half-space.
    plain: ClassVar[bool] = False

    @cached_property
    def steps(self) -> Stack:
        """The finer staircase."""
        return staircase(self.stack, _SUBLAYERS)

    def fields(self, tractions: Tractions, X: Array, Y: Array, names: tuple[str, ...]) -> Array:
        """As :meth:`Inside.fields`.

        X, Y: (x,) and (y,), x/a and y/a <= 0.
        """
        found = np.empty((tractions.ratio.size, len(names), Y.size, X.size))
        for ratio in np.unique(tractions.ratio):
            own = np.flatnonzero(tractions.ratio == ratio)
            part = tractions.part(own)
            fine, coarse = (self._by(count, part, X, Y, names) for count in (_SUBLAYERS, _SUBLAYERS // 2))
            found[own] = fine + (fine - coarse) / 3
        return found

    def _by(self, count: int, tractions: Tractions, X: Array, Y: Array, names: tuple[str, ...]) -> Array:
        body, top = staircase(self.stack, count), self.stack.top
        assert isinstance(top, Graded)
        return Inside(body, graded=top).fields(tractions, X, Y, names)
