"""Largest stresses of a film, of its base and on its lowest interface, from tables over half-lengths.

Stresses on Chebyshev panels tied to the edges of the contact are linear in the causes at a half-length and smooth in
its logarithm. A case is a product; the best nodes of several hills start climbs on the interpolant.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from approximation.chebyshev import coefficients
from approximation.measure import ITSELF, Measure
from approximation.summit import Top, highest
from solver.arrays import Array
from solver.curves import PRINCIPAL, SHEAR, VON_MISES
from solver.film.contact import FilmContact
from solver.film.interior import Interior
from solver.film.net import DEPTH, Net, Nets
from solver.film.stack import Stack, StackError
from solver.film.table import RangeError, Table
from solver.film.tractions import Tractions

_STRESSES = ("stress_xx", "stress_yy", "stress_xy", "stress_zz")
_CLOSE = 1e-8  # step of Newton's iteration in a panel's half-width: the next is of its square
_CHUNK = 256  # cases at a time: bounded memory


@dataclass(frozen=True, eq=False)
class InterfacePeaks:
    """Largest stresses on the upper side of the lowest interface; (case,) each, positions X = (x - c)/h.

    Attributes
    ----------
    shear, shear_position
        Largest abs(sigma_xy) [Pa].
    tension, tension_position
        Largest sigma_yy [Pa]; 0 and NaN where none is tensile.
    """

    shear: Array
    shear_position: Array
    tension: Array
    tension_position: Array


@dataclass(frozen=True, eq=False)
class BodyPeaks:
    """Largest von Mises and principal stress of the film below depth 0.1 h, or of the base [Pa]; (case,) each.

    The principal stress is 0 where none is tensile.
    """

    von_mises: Array
    principal_tension: Array


@dataclass(frozen=True, eq=False)
class PeakTable:
    """Stresses of a film over the half-lengths of a table of contacts.

    Parameters
    ----------
    table
        Table of the contacts.
    """

    table: Table

    # -- nets ----------------------------------------------------------------------------------------------------------
    @cached_property
    def interface_net(self) -> Net:
        """Points on the upper side of the lowest interface."""
        return self._nets.interface

    @cached_property
    def film_net(self) -> Net:
        """Points of the film from depth 0.1 h to the interface."""
        if DEPTH * self.table.upper >= self._thickness:
            raise RangeError(f"film peaks: contacts wider than {1 / DEPTH:g} thicknesses have no film under 0.1 h")
        return self._nets.film

    @cached_property
    def base_net(self) -> Net:
        """Points of the base from the interface to two half-lengths and a thickness below it."""
        if self._stack.rigid:
            raise StackError("base peaks: a rigid base has no stresses")
        return self._nets.base

    @property
    def _nets(self) -> Nets:
        return Nets(self._stack, self.table.lower, self.table.upper)

    @property
    def _thickness(self) -> float:
        return self._stack.thickness

    @property
    def _stack(self) -> Stack:
        return self.table.system.kernel.stack

    # -- series --------------------------------------------------------------------------------------------------------
    @cached_property
    def interface_series(self) -> Array:
        """Chebyshev coefficients in log h of (sigma_xy, sigma_yy) on the interface; (node, 2, 1, x, cause)."""
        return self._series(self.interface_net, ("stress_xy", "stress_yy"))

    @cached_property
    def film_series(self) -> Array:
        """Chebyshev coefficients in log h of the four stresses; (node, 4, depth, x, cause)."""
        return self._series(self.film_net, _STRESSES)

    @cached_property
    def base_series(self) -> Array:
        """As of the film."""
        return self._series(self.base_net, _STRESSES)

    def _series(self, net: Net, names: tuple[str, ...]) -> Array:
        lengths = self.table.half_lengths
        X, Y = net.positions(lengths, net.line), -net.depths(lengths)
        return coefficients(Interior(self._tractions).fields(X, Y, names))

    @cached_property
    def _tractions(self) -> Tractions:
        return Tractions.by_cause(self.table.system, self.table.half_lengths)

    # -- peaks ---------------------------------------------------------------------------------------------------------
    def interface(self, contact: FilmContact) -> InterfacePeaks:
        """Largest stresses on the lowest interface of contacts read from the same table."""
        net = self.interface_net
        stresses = self.read(contact, self.interface_series)
        shear, pull = _summit(stresses, SHEAR, net), _summit(stresses[:, 1:], ITSELF, net)
        pulled = pull.value > 0
        return InterfacePeaks(
            shear.value,
            _place(shear, contact, net),
            np.where(pulled, pull.value, 0.0),
            np.where(pulled, _place(pull, contact, net), np.nan),
        )

    def film(self, contact: FilmContact) -> BodyPeaks:
        """Largest stresses of the film below depth 0.1 h of contacts read from the same table."""
        return self._body(contact, self.film_net, self.film_series)

    def base(self, contact: FilmContact) -> BodyPeaks:
        """Largest stresses of the half-plane below the film, of contacts read from the same table."""
        return self._body(contact, self.base_net, self.base_series)

    def _body(self, contact: FilmContact, net: Net, series: Array) -> BodyPeaks:
        count = contact.load.size
        largest = np.empty((2, count))
        for start in range(0, count, _CHUNK):
            some = slice(start, start + _CHUNK)
            stresses = self.read(contact, series, some)
            for number, measure in enumerate((VON_MISES, PRINCIPAL)):
                largest[number, some] = _summit(stresses, measure, net).value
        return BodyPeaks(largest[0], np.maximum(largest[1], 0.0))

    def read(self, contact: FilmContact, series: Array, some: slice = slice(None)) -> Array:
        """What some contacts read from a series of this table; (case, ...).

        Parameters
        ----------
        contact : FilmContact, with half-lengths and causes
        series : ndarray, shape (node, ..., cause), over the table's half-lengths
        some : slice, of the contacts
        """
        polynomials = self.table.polynomials(np.log(contact.half_width[some]))
        weights = np.einsum("cn,cq->cnq", polynomials, contact.causes.values[some]).reshape(len(polynomials), -1)
        flat = np.moveaxis(series, -1, 1).reshape(weights.shape[1], -1)
        return np.asarray((weights @ flat).reshape(-1, *series.shape[1:-1]))


def _summit(stresses: Array, measure: Measure, net: Net) -> Top:
    """Where a measure of stresses (case, field, depth, x) is largest on a net."""
    return highest(stresses, net.across, measure, _CLOSE)


def _place(top: Top, contact: FilmContact, net: Net) -> Array:
    """X of tops; (case,)."""
    t = 2.0 * top.panel - len(net.across) + 1 + top.across
    return net.positions(contact.half_width, t[:, None])[:, 0]
