"""Causes in which a contact's outputs are linear: powers of X in the punch's slope, and charges (films, section 4)."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from solver.arrays import Array, selected, stack
from solver.halfplane.pressing import slopes
from solver.halfplane.profile import Profile
from solver.line.table import Table


@dataclass(frozen=True, eq=False)
class Causes:
    """The causes at an extent of the contact, and their derivatives in log h and in c/h."""

    # Powers of X in g', T/h, J/h and, between corners, P/h; (..., cause)
    values: Array
    by_width: Array
    by_centre: Array
    # Constant slope a_0 that the centre gives; (...)
    constant: Array
    constant_by_width: Array
    constant_by_centre: Array


@dataclass(frozen=True, eq=False)
class Loading:
    """Punches and loads of cases in the units of a stack."""

    slope: Array  # Coefficients of g' in powers of x; (case, degree + 1)
    loads: Array  # P, T and J; (case, 3)
    smooth: tuple[bool, bool]  # Whether the trailing and the leading edge are smooth

    @classmethod
    def of(cls, table: Table, profile: Profile, load: Array, charges: Array) -> Self:
        """Return the loading of cases of P (case,) [N/m] and of T and J (case, 2) [C/m, Wb/m], in SI units."""
        scale = table.system.kernel.stack.scale
        slope = np.zeros((load.size, table.system.degree + 1))
        for k, coefficient in enumerate(profile.slope):
            slope[:, k] = coefficient / scale[1]
        return cls(slope, stack(load * scale[1], charges[:, 0] * scale[2], charges[:, 1] * scale[3]), profile.smooth)

    def part(self, cases: slice) -> "Loading":
        """Some of the cases."""
        return selected(self, cases, "slope", "loads")

    @property
    def order(self) -> int:
        """k0: 1 between smooth edges, 0 with one corner, -1 between corners."""
        return sum(self.smooth) - 1

    def at(self, half: Array, centre: Array) -> Causes:
        """Causes at contacts of half-length h and c/h, (case,) or (case, node) each."""
        axes = (slice(None), *(None,) * (half.ndim - 1))
        powers, by_width, by_centre = slopes([*np.moveaxis(self.slope[axes], -1, 0)], half, centre)
        loads = self.loads[axes] / half[..., None]
        carried = loads[..., [1, 2, 0]] if self.order == -1 else loads[..., 1:]
        first = max(self.order, 0)
        return Causes(
            np.concatenate([powers[..., first:], carried], -1),
            np.concatenate([by_width[..., first:], -carried], -1),
            np.concatenate([by_centre[..., first:], np.zeros_like(carried)], -1),
            powers[..., 0],
            by_width[..., 0],
            by_centre[..., 0],
        )
