"""Tractions on the contacts of many films in the basis of one table, and their transforms (films, sections 4, 6)."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from approximation.chebyshev import coefficients
from solver.arrays import Array, ComplexArray, selected
from solver.line.antiderivatives import Antiderivatives
from solver.line.assembly import Assembly
from solver.line.basis import Basis
from solver.line.contact import FilmContact
from solver.line.system import System
from solver.line.table import BATCH, Table
from solver.line.transforms import Transforms
from solver.stack.layers import Stack
from solver.stack.wavenumbers import tapered

_FAR = 8.0  # thicknesses from which fields are far, where a smooth end of the wavenumbers costs less than rounding
_SPAN = 32.0  # ratio of the distances that share wavenumbers
_MOST = 1 << 20  # entries of a block of exponentials: bounded memory


@dataclass(frozen=True, eq=False)
class Tractions:
    """Tractions under some contacts of one system, several columns of each."""

    # The contact and the basis of the tractions
    system: System
    basis: Basis
    half_lengths: Array  # h [m]; (member,)
    pressures: Array  # Terms of sigma_yy; (member, pressures, column)
    charges: Array  # Terms of D_y and B_y; (member, 2, M + 1, column)
    upper: float | None = None  # The longest half-length that these may be of [m]; by default the longest of these

    @classmethod
    def by_cause(cls, system: System, half_lengths: Array) -> Self:
        """One column for each cause.

        half_lengths: (member,), m.
        """
        basis = system.basis(float(np.max(half_lengths)))
        room = max(BATCH // (8 * 19 * basis.samples * (basis.terms + 2)), 1)
        parts = [
            Assembly(system, basis, half_lengths[start : start + room]).unknowns
            for start in range(0, half_lengths.size, room)
        ]
        pressures, charges = system.split(basis, np.swapaxes(np.concatenate(parts), 1, 2))
        return cls(system, basis, half_lengths, np.swapaxes(pressures, 1, 2), np.moveaxis(charges, 1, -1))

    @property
    def longest(self) -> float:
        """The longest half-length that the basis is made for [m]: what resolves it, resolves all members."""
        return float(np.max(self.half_lengths)) if self.upper is None else self.upper

    def part(self, members: slice | NDArray[np.intp]) -> Self:
        """Some of the members."""
        return selected(self, members, "half_lengths", "pressures", "charges")

    def wavenumbers(self, body: Stack, nearest: float, reach: float, width: float) -> tuple[Array, Array]:
        """Nodes and weights in k of fields in a body that decay like exp(-width k); (k,) each.

        The fields are read at distances from ``nearest`` to ``reach`` from the edges [m].
        """
        k, weights, taper = tapered(body, width, np.array([nearest, reach]), _FAR)
        return k, weights * taper

    def by_distance(self, body: Stack, X: Array) -> list[NDArray[np.intp]]:
        """Columns of positions X (member or 1, x) that share wavenumbers: far from the contact short waves vanish."""
        nearest = np.min(np.abs(X) * self.half_lengths[:, None], axis=0) - self.longest
        octave = np.floor(np.log(np.maximum(nearest / (_FAR * body.thickness), 1 / _SPAN)) / np.log(_SPAN))
        return [np.flatnonzero(octave == number) for number in np.unique(octave)]

    def _vector(self, normal: ComplexArray, fields: Sequence[ComplexArray]) -> list[ComplexArray]:
        """(sigma_xy, sigma_yy, D_y, B_y) from sigma_yy and the terms of D_y and B_y."""
        c = self.system.coefficients
        whole = [fields[f] + c.follower[f] * normal if f in c.fields else fields[f] for f in (0, 1)]
        return [c.friction * normal, normal, *whole]

    def in_fourier_space(self, k: Array) -> ComplexArray:
        """(i sigma_xy, sigma_yy, D_y, B_y) at the surface at wavenumbers k [1/m]; (member, k, 4, column)."""
        h, columns = self.half_lengths, self.pressures.shape[-1]
        charges = np.concatenate([self.charges[:, 0], self.charges[:, 1]], -1)
        sums: ComplexArray = np.empty((h.size, k.size, 3 * columns), np.complex128)
        step = max(_MOST // (2 * self.basis.terms * h.size), 1)
        for start in range(0, k.size, step):
            part = sums[:, start : start + step]
            phase = h[:, None] * k[start : start + step]
            for terms, out, transforms in (
                (self.pressures, part[..., :columns], self._transforms.pressed),
                (charges, part[..., columns:], self._transforms.charged),
            ):
                out[...] = transforms(phase, terms)
        normal, *fields = np.split(sums, 3, -1)
        t = self._vector(normal, fields)
        t[0] = 1j * t[0]
        return np.asarray(h[:, None, None, None] * np.stack(t, 2), dtype=np.complex128)

    @cached_property
    def _transforms(self) -> Transforms:
        return Transforms(self.basis)

    @cached_property
    def totals(self) -> ComplexArray:
        """The same at k = 0: forces and charges; (member, 4, column)."""
        return self.in_fourier_space(np.zeros(1))[:, 0]

    def on_plane(self, z: ComplexArray, *, integrated: bool = False) -> ComplexArray:
        """Hilbert transforms H of (sigma_xy, sigma_yy, D_y, B_y) at points z above the contact, or on it."""
        count, columns = self.half_lengths.size, self.pressures.shape[-1]
        out: ComplexArray = np.empty((4, count, z.shape[1], columns), np.complex128)
        antiderivatives = Antiderivatives(self.basis)
        pressed = antiderivatives.pressed if integrated else self.basis.transformed
        charged = antiderivatives.charged if integrated else self.basis.charged
        for number, points in enumerate(z):
            members = slice(None) if len(z) == 1 else slice(number, number + 1)
            normal = pressed(points, _flat(self.pressures[members]))
            powers = charged(points)
            fields = [powers @ _flat(self.charges[members, f]) for f in (0, 1)]
            for component, value in enumerate(self._vector(normal, fields)):
                out[component, members] = np.moveaxis(value.reshape(points.size, -1, columns), 0, 1)
        return out


def _flat(terms: Array) -> Array:
    """(member, term, column) as (term, members and columns)."""
    return np.moveaxis(terms, 1, 0).reshape(terms.shape[1], -1)


@dataclass(frozen=True, eq=False)
class TractionTable:
    """Tractions over the half-lengths of a table."""

    table: Table

    @cached_property
    def _nodes(self) -> Tractions:
        return Tractions.by_cause(self.table.system, self.table.half_lengths)

    @cached_property
    def _series(self) -> tuple[Array, Array]:
        return coefficients(self._nodes.pressures), coefficients(self._nodes.charges)

    def read(self, contact: FilmContact) -> Tractions:
        """Tractions under contacts that were read from the same table, one column."""
        h = contact.half_width
        weights = self.table.polynomials(np.log(h))[:, :, None] * contact.causes.values[:, None]
        pressures, charges = (
            np.einsum("mnc,n...c->m...", weights, series, optimize=True)[..., None] for series in self._series
        )
        return Tractions(self.table.system, self._nodes.basis, h, pressures, charges, self.table.upper)
