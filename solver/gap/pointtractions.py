"""Tractions of a point contact in air and of its exterior charges, as densities in b (points, sections 6 and 7)."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Self

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, BoolArray
from solver.gap.airpoint import PointStates
from solver.gap.charges import Charges
from solver.gap.ringoperators import RingOperators
from solver.point import hankel
from solver.point.profile import halfspace_form
from solver.point.system import added_forms
from solver.point.tractions import Density, Tractions
from solver.stack.layers import Stack
from solver.stack.wavenumbers import panels


@dataclass(frozen=True, eq=False)
class AirPointTractions(Tractions):
    """Tractions of one contact, as one column."""

    exterior_charges: Charges = field(kw_only=True)  # (2/pi) S at b > 1 and b < -1

    def part(self, columns: Indices) -> Self:
        """Return the contact itself, with its cached spectra: it is the only column."""
        return self

    def nodes(self, radius: float, near: float) -> hankel.Nodes:
        """Nodes in b up to the farthest charges, for a field point."""
        return hankel.nodes(radius, near, kinked=self.kinked, beyond=self._ends)

    @cached_property
    def _ends(self) -> list[float]:
        return [float(end) for end in np.cosh(self.exterior_charges.ends[1:])]

    def vectors(self, b: Array, columns: Indices) -> tuple[Array, Array | None]:
        """Densities of (sigma_xy, sigma_yy, D_y, B_y) at b (b,) >= 0, at rest and of cos(angle); (1, 4, b) each."""
        within = b <= 1
        right, left = self.exterior_charges.density(b[~within]), self.exterior_charges.density(-b[~within])
        first, second = super().vectors(b[within], columns)
        plain = _joined(first, within, right + left)
        return plain, None if second is None else _joined(second, within, right - left)

    def transforms(self, phases: Array, columns: Indices) -> tuple[Array, Array | None]:
        """Hankel transforms at phases k a (k,), at rest and of cos(angle); (k, 4, 1) each."""
        plain, turned = super().transforms(phases, columns)  # of the densities below the contact
        spectrum = self.exterior_charges.spectrum(float(np.max(phases))).values(phases).T
        plain[:, 2:, 0] += spectrum.real
        if turned is not None:
            turned[:, 2:, 0] -= spectrum.imag
        return plain, turned

    def wavenumbers(self, stack: Stack, reach: float, width: float) -> tuple[Array, Array]:
        """Wavenumbers and weights; distant charges extend the range of long waves only."""
        return self.exterior_charges.wavenumbers(panels(stack, width), float(self.ratio[0]), reach)


def _joined(interior: Array, within: BoolArray, exterior: Array) -> Array:
    """Join densities of (sigma_xy, sigma_yy, D_y, B_y) below the contact and of exterior (D_y, B_y); (1, 4, b)."""
    result = np.zeros((1, 4, within.size))
    result[..., within] = interior
    result[0][2:, ~within] = exterior
    return result


@dataclass(frozen=True, eq=False)
class SolvedPoint:
    """One solved contact; tractions over C a^(e-1), displacements over C a^e, in the units of the body."""

    operators: RingOperators
    radius: float  # Over the length of the body
    unit: float  # C a^(e-1)
    columns: Array  # Sizes of the columns of the operators; (column,)
    over_size: Array  # Densities at the nodes over their size; (field, n)
    gap: Array  # (n,)
    end_factor: Array  # Factor by which the finite punch weakens the gap's field; (n,)
    conductance: Array  # Density over its size per potential, times the gap over the profile's; (field, n)
    media: Array  # eps0 and mu0 of the conducted fields; (field,)

    @classmethod
    def of(cls, states: PointStates, case: int) -> Self:
        """Solution of one case."""
        return cls(
            states.operators, float(states.radius[case]), float(states.size[case] / states.radius[case]),
            states.columns[case], states.over_size[case], states.gap[case], states.end_factor[case],
            states.terms.conductance[case], states.media[case],
        )  # fmt: skip

    @property
    def exterior_densities(self) -> Array:
        """D_y and B_y at the exterior nodes; (field, n)."""
        return self.over_size * self.operators.rings.size

    @cached_property
    def _series(self) -> Array:
        """Coefficients in f_n of the tractions without the profile's closed part, at the exact radius; (channel, n)."""
        return np.asarray(self.operators.series(self.radius) @ self.columns)

    @cached_property
    def density(self) -> Density:
        """Densities below the punch, over C a^(e-1)."""
        form = self._expanded(-2 / np.pi * self.operators.inverse[:, 0])[None]
        series = self._expanded(self._series)[None]
        strengths = series @ (-1.0) ** np.arange(series.shape[2])
        return Density(self.operators.shape, strengths, form, series)

    def tractions(self, ratio: float, turned: Array | None = None) -> AirPointTractions:
        """Tractions on the whole surface; ``turned``: exterior densities of cos(angle) over size, (field, n)."""
        rings, unit = self.operators.rings, self.unit
        grid, density = rings.grid, self.density.times(np.full(3, unit))
        S = self.over_size @ rings.abel.T
        odd = np.zeros_like(S) if turned is None else turned @ rings.turned.abel.T
        sides = np.zeros((2, 2, grid.count))
        sides[:, list(self.operators.layout.fields)] = np.stack([S + odd, S - odd]) / grid.size * (unit / np.pi)
        return AirPointTractions(np.array([ratio]), density, np.zeros(1), exterior_charges=Charges(grid, sides))

    def surface_tractions(self, r: Array) -> Array:
        """Return sigma_yy, D_y and B_y at r/a, which is never 1; (3, position)."""
        distance = np.abs(r)
        within = distance < 1
        inner, rings = distance[within], self.operators.rings
        result = np.zeros((3, r.size))
        x = np.sqrt((1 - inner) * (1 + inner))
        result[:, within] = self.bounded(inner, rings.poisson(x)) + self._edge_strengths[:, None] / x
        for field_, over_size in zip(self.operators.layout.fields, self.over_size, strict=True):
            result[1 + field_, ~within] = rings.interpolation(distance[~within]) @ over_size
        return result * self.unit

    def bounded(self, r: Array, induced: Array) -> Array:
        """Bounded part of tractions at r/a < 1 over C a^(e-1), (3, position); ``induced``: ``Rings.poisson`` there."""
        x = np.sqrt((1 - r) * (1 + r))
        result = self._series @ added_forms(x, self._series.shape[1]).T
        result -= 2 / np.pi * self.operators.inverse[:, :1] * halfspace_form(self.operators.shape, x, r)
        result[1:] += self.over_size @ induced.T
        return self._expanded(result)

    @property
    def _edge_strengths(self) -> Array:
        """Strengths at the edge over C a^(e-1), (3,): zero unless the gap's field reaches its limit (points, 6)."""
        result = self._series @ (-1.0) ** np.arange(self._series.shape[1])
        result[0] = 0.0
        result[1:] -= 2 / np.pi * self.over_size @ self.operators.rings.at_edge
        return self._expanded(result)

    def _expanded(self, values: Array) -> Array:
        """Expand values of the channels to those of (y, phi, psi), others 0; (3, ...)."""
        result = np.zeros((3, *values.shape[1:]))
        result[self.operators.layout.channels] = values
        return result
