"""Tractions on the whole surface of a contact with air beside it: those of the contact and the charges beside it."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array, ComplexArray
from solver.gap.airline import State
from solver.gap.charges import NEAR, Charges
from solver.gap.densities import Densities
from solver.gap.spectrum import Spectrum
from solver.line.assembly import Assembly, mixing
from solver.line.kernel import kernel
from solver.line.system import System
from solver.line.tractions import Tractions
from solver.stack.layers import Stack
from solver.stack.wavenumbers import on_panels, panels, strip

_MIRRORED = np.array([-1.0, -1.0, -1.0, 1.0])  # du/dX of the mirror image, over that of a charge
_GROWTH, _FIRST = 2.5, 100.0  # of panels in k towards 0, and the largest phase across the first


@dataclass(frozen=True, eq=False)
class AirTractions(Tractions):
    """Tractions of one contact, as one column; ``charges`` excludes the charge induced by exterior charges."""

    exterior_charges: Charges = field(kw_only=True)
    widest: float = 0.0

    @cached_property
    def _whole(self) -> Tractions:
        """Tractions of the contact, including the induced charge."""
        drawn = self.exterior_charges.terms(self.charges.shape[2])
        densities = (self.pressures, self.charges + drawn[None, :, :, None])
        return Tractions(self.system, self.basis, self.half_lengths, *densities, self.upper)

    @property
    def _half(self) -> float:
        return float(self.half_lengths[0])

    @cached_property
    def _ends(self) -> Array:
        """Ends of panels in k, from so small ones on that the farthest charges are in phase."""
        stack = self.system.kernel.stack
        ends = panels(stack, strip(stack) / 2)
        return from_smaller(ends, self._half * float(np.cosh(self.exterior_charges.ends[-1])))

    @cached_property
    def _spectrum(self) -> Spectrum:
        return Spectrum(self.exterior_charges, float(self._ends[-1] * self._half))

    def part(self, members: slice | NDArray[np.intp]) -> Self:
        """The one member: what is known of it is kept."""
        return self

    def wavenumbers(self, body: Stack, nearest: float, reach: float, width: float) -> tuple[Array, Array]:
        """Wavenumbers and weights; distant charges extend the range of long waves only."""
        reach = max(reach, self.widest)
        nearest_reach = reach - self.longest
        far = [nearest_reach + self._half * self._spectrum.reach(start * self._half) for start in self._ends[:-1]]
        return on_panels(self._ends, np.maximum(reach, far))

    def by_distance(self, body: Stack, X: Array) -> list[NDArray[np.intp]]:
        """All columns together: the charges in the gap lie far from the contact, too."""
        return [np.arange(X.shape[1])]

    def in_fourier_space(self, k: Array) -> ComplexArray:
        """(i sigma_xy, sigma_yy, D_y, B_y) at the surface at wavenumbers k [1/m]; (1, k, 4, 1)."""
        if (key := k.tobytes()) not in self._known:
            result = self._whole.in_fourier_space(k)
            result[0, :, 2:, 0] += self._half * self._spectrum.values(k * self._half).T
            self._known[key] = result
        return self._known[key]

    @cached_property
    def _known(self) -> dict[bytes, ComplexArray]:
        """Spectra that were asked for, by their wavenumbers."""
        return {}

    def on_plane(self, z: ComplexArray, *, integrated: bool = False) -> ComplexArray:
        """Hilbert transforms at points z (1, point) above the surface, as of a contact; (4, 1, point, 1).

        z: (1, point), complex, X + iY.
        """
        result = super().on_plane(z, integrated=integrated)
        result[2:, 0, :, 0] += self.exterior_charges.transforms(z[0], integrated=integrated)
        return result


def from_smaller(ends: Array, farthest: float) -> Array:
    """Ends of panels in k with smaller ones before, across the first of which the farthest charges are in phase."""
    turns = np.log(ends[1] * farthest / _FIRST) / np.log(_GROWTH)
    below = ends[1] * _GROWTH ** -np.arange(1.0, max(turns, 0) + 2)
    return np.concatenate([[0.0], below[::-1], ends[1:]])


@dataclass(frozen=True, eq=False)
class Solved:
    """Tractions of a contact with air beside it, found anew at its very half-length."""

    state: State
    points: Array
    intervals: int = NEAR

    @cached_property
    def system(self) -> System:
        """The contact's, its kernels as far as charges lie."""
        operators = self.state.problem.table.operators
        wide, narrow = operators._wide, operators.system.kernel
        if wide is None:  # a half-plane's are zero, as far as they are asked for
            reach = self.state.half * (1 + float(np.max(np.abs(self.points))))
            wide = narrow if reach <= narrow.reach else kernel(narrow.stack, reach)
        return replace(operators.system, kernel=wide)

    @cached_property
    def assembly(self) -> Assembly:
        """Assembly at the half-length of the solution."""
        half = np.array([self.state.half])
        return Assembly(self.system, self.system.basis(self.state.half), half, self.points)

    @cached_property
    def exterior_charges(self) -> Charges:
        """Charges beside the contact."""
        problem = self.state.problem
        grid, unknowns = problem.table.operators.grid, np.zeros((2, 2, problem.table.operators.grid.count))
        densities = self.state.densities / problem.powers[1]
        for place, f in enumerate(problem.fields):
            unknowns[:, f] = densities[place].reshape(-1, grid.count)  # one side is that of both
        return Charges(grid, unknowns, self.intervals)

    @cached_property
    def drawn(self) -> Array:
        """Unknowns of the contact that the charges beside it draw into it; (unknown,)."""
        basis, result = self.assembly.basis, np.zeros(self.system.unknowns(self.assembly.basis))
        terms = self.exterior_charges.terms(basis.terms + 1)
        for f, start in self.system.starts(basis).items():
            result[start : start + basis.terms + 1] = terms[f]
        return result

    def carried(self, X: Array) -> Array:
        """du/dX of (y, phi, psi, x) at X that the kernels make of the charges beside the contact; (4, point)."""
        operators = self.state.problem.table.operators
        result = np.zeros((4, X.size))
        if operators._wide is None:
            return result
        mix = np.concatenate([mixing(0.0, np.eye(3)[1 + f])[:, :4] for f in self.system.fields], 1)
        integrals = Densities(operators.grid, operators._wide).integrals(self.state.half, np.concatenate([X, -X]), mix)
        right, left = integrals.reshape(2, X.size, len(self.system.fields), 4, -1)
        for place, f in enumerate(self.system.fields):
            unknowns = self.exterior_charges.unknowns[:, f]
            result += self.state.half * (right[:, place] @ unknowns[0] + _MIRRORED * (left[:, place] @ unknowns[1])).T
        return result

    @cached_property
    def unknowns(self) -> Array:
        """Unknowns of the contact, without the induced charge; (unknown,)."""
        assembly, basis = self.assembly, self.assembly.basis
        sources = self.carried(basis.nodes)[:3] + assembly.at_nodes[0] @ self.drawn
        solutions = self.system.solve(basis, assembly.at_nodes, sources=sources[None, :, :, None])[0]
        causes = self.state._causes[1][0]
        return np.asarray(solutions @ np.append(causes, 1.0))

    @property
    def tractions(self) -> AirTractions:
        """On the whole surface."""
        basis = self.assembly.basis
        pressures, charges = self.system.split(basis, self.unknowns)
        return AirTractions(
            self.system, basis, self.assembly.half_lengths, pressures[None, :, None], charges[None, :, :, None],
            exterior_charges=self.exterior_charges,
        )  # fmt: skip
