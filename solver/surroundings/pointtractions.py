"""Tractions of a point contact with air beside it: those below the punch and the rings beside it (points, 6, 7).

Below the punch the density in b is that of a contact without air, its strength what the rings leave at the edge; beside
it, b > 1, it is (2/pi) S of the rings (:mod:`solver.surroundings.rings`).
"""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Self

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array
from solver.film.kernel import on_panels, panels
from solver.film.stack import Stack
from solver.point import hankel
from solver.point.density import Density
from solver.point.pressure import added_forms, halfspace_form
from solver.point.tractions import Tractions
from solver.surroundings.airpoint import PointState
from solver.surroundings.charges import Charges
from solver.surroundings.ringoperators import RingOperators
from solver.surroundings.rings import Rings
from solver.surroundings.spectrum import Spectrum
from solver.surroundings.tractions import from_smaller


@dataclass(frozen=True, eq=False)
class AirPointTractions(Tractions):
    """Those of one contact, one column, without friction.

    Parameters
    ----------
    beside
        (2/pi) S beside the contact, one half of it on each side; of the two fields.
    """

    beside: Charges = field(kw_only=True)

    def part(self, columns: Indices) -> Self:
        """The one column: what is known of it is kept."""
        return self

    def nodes(self, radius: float, near: float) -> hankel.Nodes:
        """As without air, and beside the contact as far as charges lie.

        Parameters
        ----------
        radius : float, r/a
        near : float, depth over a
        """
        return hankel.nodes(radius, near, kinked=self.kinked, beyond=self._ends)

    @cached_property
    def _ends(self) -> list[float]:
        return [float(end) for end in np.cosh(self.beside.ends[1:])]

    def vectors(self, b: Array, columns: Indices) -> tuple[Array, None]:
        """As without air, and at b > 1; (1, 4, b).

        Parameters
        ----------
        b : ndarray, shape (b,), over a
        columns : ndarray of int, the one
        """
        within = b <= 1
        found = np.zeros((1, 4, b.size))
        found[:, 1:, within] = self.density.at(b[within])
        found[0][2:, ~within] = 2 * self.beside.at(b[~within])
        return found, None

    def transforms(self, phases: Array, columns: Indices) -> tuple[Array, None]:
        """As without air, with the spectra of the rings; (k, 4, 1).

        Parameters
        ----------
        phases : ndarray, shape (k,), k a
        columns : ndarray of int, the one
        """
        at = hankel.nodes(parts=hankel.parts(phases), kinked=self.kinked)
        found = np.zeros((phases.size, 4, 1))
        found[:, 1:, 0] = np.cos(phases[:, None] * at.b) @ (self.density.at(at.b)[0] * at.weights).T
        found[:, 2:, 0] += self._spectrum(float(np.max(phases))).at(phases).real.T
        return found, None

    def wavenumbers(self, stack: Stack, reach: float, width: float) -> tuple[Array, Array]:
        """As without air; charges far away count for long waves alone.

        Parameters
        ----------
        stack : Stack, layers and base
        reach, width : float, what phases are longest over and what waves decay over, in the unit of the body's lengths
        """
        ratio = float(self.ratio[0])
        ends = from_smaller(panels(stack, width), ratio * self._ends[-1])
        spectrum = self._spectrum(float(ends[-1]) * ratio)
        far = [reach + ratio * spectrum.reach(start * ratio) for start in ends[:-1].tolist()]
        return on_panels(ends, np.array(far))

    def _spectrum(self, most: float) -> Spectrum:
        """One that reaches a wavenumber, shared by all of a power of two."""
        power = int(np.ceil(np.log2(most)))
        if power not in self._spectra:
            self._spectra[power] = Spectrum(self.beside, 2.0**power)
        return self._spectra[power]

    @cached_property
    def _spectra(self) -> dict[int, Spectrum]:
        return {}


@dataclass(frozen=True, eq=False)
class SolvedPoint:
    """What lies on the surface of a contact with air beside it, found anew at its very radius; units of the body.

    Parameters
    ----------
    state
        The solution.
    operators
        Those that it was found with, at any radius.
    """

    state: PointState
    operators: RingOperators

    @property
    def unit(self) -> float:
        """Of the tractions, C a^(e-1)."""
        return self.state.size / self.state.radius

    @property
    def _rings(self) -> Rings:
        return self.operators.rings

    @property
    def _channels(self) -> list[int]:
        return self.operators.rows.channels

    @cached_property
    def _series(self) -> Array:
        """Coefficients of all but the profile's closed part; (channel, n)."""
        return np.asarray(self.operators.series(self.state.radius) @ self.state.columns)

    @property
    def _form(self) -> Array:
        """Sizes of the profile's closed part; (channel,)."""
        return np.asarray(-2 / np.pi * self.operators.inverse[:, 0])

    def tractions(self, ratio: float) -> AirPointTractions:
        """On the whole surface; the contact radius over the unit of the body's lengths."""
        signs = (-1.0) ** np.arange(self._series.shape[1])
        strengths, form, series = (
            self._of_channels(value)[None] * self.unit for value in (self._series @ signs, self._form, self._series)
        )
        density = Density(self.operators.shape, strengths, form, series)
        return AirPointTractions(np.array([ratio]), density, np.zeros(1), beside=self._beside)

    @cached_property
    def _beside(self) -> Charges:
        grid = self._rings.grid
        S = np.zeros((2, grid.count))
        for field_, own in zip(self.operators.rows.fields, self.state.over_size, strict=True):
            S[field_] = self._rings.gathered @ own / grid.size * (self.unit / np.pi)
        return Charges(grid, np.stack([S, S]))

    def at(self, r: Array) -> Array:
        """sigma_yy, D_y and B_y at r/a, never 1; (3, place)."""
        away = np.abs(r)
        within = away < 1
        x = np.sqrt((1 - away[within]) * (1 + away[within]))
        found = np.zeros((len(self._channels), r.size))
        found[:, within] = self._series @ added_forms(x, self._series.shape[1]).T
        found[:, within] += self._form[:, None] * halfspace_form(self.operators.shape, x, away[within])
        strengths = self._series @ (-1.0) ** np.arange(self._series.shape[1])
        drawn, beyond = self._rings.poisson(x), self._rings.read(away[~within])
        for place, own in enumerate(self.state.over_size):
            left = strengths[1 + place] - 2 / np.pi * self._rings.at_edge @ own  # none but of the emptiest gaps
            found[1 + place, within] += drawn @ own + left / x
            found[1 + place, ~within] = beyond @ own
        return self._of_channels(found) * self.unit

    def _of_channels(self, values: Array) -> Array:
        """Values of the channels among those of (y, phi, psi), others 0."""
        found = np.zeros((3, *values.shape[1:]))
        found[self._channels] = values
        return found
