"""Tractions of point contacts: densities that they have in Fourier space, and what friction adds (points, 7 and 8)."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array
from solver.point import hankel
from solver.point.density import Density
from solver.stack.layers import Stack
from solver.stack.wavenumbers import wavenumbers

#: psi of (sigma_yy, D_y, B_y), the part of cos(angle), at b, of some columns; (column, 3, b).
Sines = Callable[[Array, Indices], Array]


@dataclass(frozen=True, eq=False)
class Tractions:
    """Tractions of point contacts in the units of a body; columns of cases or causes."""

    ratio: Array
    density: Density
    friction: Array
    sines: Sines | None = None

    @property
    def kinked(self) -> bool:
        """Whether the densities are kinked at 0 or steep at 1."""
        return self.density.kinked or self.sines is not None

    def part(self, columns: Indices) -> "Tractions":
        """Some of the columns."""
        own = self.sines
        sines = None if own is None else lambda b, some: own(b, columns[some])
        return Tractions(self.ratio[columns], self.density.part(columns), self.friction[columns], sines)

    def vectors(self, b: Array, columns: Indices) -> tuple[Array, Array | None]:
        """(sigma_xy, sigma_yy, D_y, B_y) as densities: of 1, all in cos kb; of cos(angle), the first in cos kb.

        Returns (column, 4, b) each, of some columns; none of the second without friction.

        b: (b,), 0 to 1.
        """
        own = self.density.part(columns).at(b)
        plain = np.concatenate([np.zeros_like(own[:, :1]), own], 1)
        if self.sines is None:
            return plain, None
        return plain, np.concatenate([-self.friction[columns, None, None] * own[:, :1], self.sines(b, columns)], 1)

    def nodes(self, radius: float, near: float) -> hankel.Nodes:
        """Nodes in b for a field point."""
        return hankel.nodes(radius, near, kinked=self.kinked)

    def transforms(self, phases: Array, columns: Indices) -> tuple[Array, Array | None]:
        """Tractions at the surface as waves of phases k a, of 1 and of cos(angle); (k, 4, column) each."""
        at = hankel.nodes(parts=hankel.parts(phases), kinked=self.kinked)
        first, second = self.vectors(at.b, columns)
        cosines = np.cos(phases[:, None] * at.b) * at.weights
        top = np.einsum("kb,cib->kic", cosines, first, optimize=True)
        if second is None:
            return top, None
        sines = np.sin(phases[:, None] * at.b) * at.weights
        along = np.einsum("kb,cib->kic", cosines, second[:, :1], optimize=True)
        down = np.einsum("kb,cib->kic", sines, second[:, 1:], optimize=True)
        return top, np.concatenate([along, down], 1)

    def wavenumbers(self, stack: Stack, reach: float, width: float) -> tuple[Array, Array]:
        """Wavenumbers and weights of integrals over k of a stack."""
        return wavenumbers(stack, reach, width)
