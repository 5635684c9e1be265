"""Tables of rings over the radius of a film's contacts: half decades, and parts of them next to a few radii.

A contact is sought in a narrow table, which is quick to read. It is made of the operators themselves where a call asks
for few radii, and of the table of half a decade where it asks for many. Which it is follows from the call alone.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np

from approximation.piecewise import Interval
from solver.arrays import Array
from solver.cache import cached
from solver.gap.ringoperators import RingOperators
from solver.gap.rings import rings
from solver.gap.ringtable import FEW, NODES, RingTable
from solver.line.windows import number_of
from solver.point.kernel import normal_kernel
from solver.point.table import PointKind, interval
from solver.stack.wavenumbers import strip

_STEP, _BEYOND = 0.11, 0.015  # of log a: a part, and what it has in common with the next one; air moves less
_MOST = 2  # parts of half a decade that are made by themselves: the next one has as many radii as the whole


@cached
def _half_decade(kind: PointKind, number: int) -> RingTable:
    return RingTable(_operators(kind), interval(number, NODES))


@cached
def _part(kind: PointKind, place: int, number: int | None) -> RingTable:
    """The part of a place in log a, from the table of half a decade or else by itself."""
    own = Interval(place * _STEP - _BEYOND, (place + 1) * _STEP + _BEYOND, FEW)
    return RingTable(_operators(kind), own, None if number is None else _half_decade(kind, number))


@cached
def _operators(kind: PointKind) -> RingOperators:
    stack = kind.film.stack()
    fields = tuple(field for field in (0, 1) if kind.conducts[field])
    return RingOperators(rings(), fields, kind.compliance, kind.shape, normal_kernel(stack), strip(stack))


def _place(ratio: float) -> int:
    return int(np.floor(np.log(ratio) / _STEP))


def _number(ratio: float) -> int:
    return int(number_of(np.array([ratio]))[0])


@dataclass(frozen=True, eq=False)
class RingWindows:
    """Tables of one kind of film."""

    kind: PointKind  # The film and the punch
    many: frozenset[int]  # Half decades of which many radii are asked for

    @classmethod
    def of(cls, kind: PointKind, ratios: Array) -> Self:
        """For radii over the thickness that a call is about.

        ratios: (...), contact radii over the thickness.
        """
        asked: dict[int, set[int]] = {}
        for ratio in np.unique(ratios).tolist():
            asked.setdefault(_number(ratio), set()).add(_place(ratio))
        return cls(kind, frozenset(number for number, places in asked.items() if len(places) > _MOST))

    def narrow(self, ratio: float) -> RingTable:
        """About a radius over the thickness."""
        number = _number(ratio)
        return _part(self.kind, _place(ratio), number if number in self.many else None)

    def wide(self, ratio: float) -> RingTable:
        """Half a decade that holds it."""
        return _half_decade(self.kind, _number(ratio))
