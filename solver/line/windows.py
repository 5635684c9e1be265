"""Kinds of films and the tables of each, over windows of half-lengths that are half a decade wide."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array
from solver.cache import cached
from solver.halfplane.sliding import Punch
from solver.line.peaks import PeakTable
from solver.line.stressnets import DEPTH
from solver.line.table import LEAST, MOST, LengthsError, RangeError, Table, table, told
from solver.line.tractions import TractionTable
from solver.stack.layers import Stack

_A_DECADE = 2  # windows
_OVERLAP = 1.3  # of a window with its neighbours
_HALF_LENGTHS = 20  # half-lengths of a window
FIRST = int(np.floor(_A_DECADE * np.log10(LEAST)))
LAST = int(np.ceil(_A_DECADE * np.log10(MOST))) - 1
_ACCURACY = 1.25  # factor on the number of terms: 1e-9 of tractions that are next to zero, too
_ROUGH_NODES, _ROUGH_ACCURACY = 8, 0.5  # of their tables: 1e-3 of the load, for a fifth of the time


@dataclass(frozen=True)
class Kind:
    """Properties that cases answered by one set of tables share."""

    stack: Stack  # The film, its top layer of unit thickness, on its base
    friction: float  # Coulomb coefficient
    conducts: tuple[bool, bool]  # Whether the punch conducts (electric, magnetic)
    smooth: tuple[bool, bool]  # Whether the trailing and the leading edge of the contact are smooth
    degree: int  # Largest power of x in the slope of the punch
    punch: tuple[float, float] = (0.0, 0.0)  # N_p and k_p of the punch [1/Pa], 0 of a rigid one

    @property
    def elastic(self) -> Punch:
        """Elasticity of the punch."""
        return Punch(*(np.array(value) for value in self.punch))


@cached
def window(kind: Kind, number: int, *, rough: bool = False) -> Table:
    """Table of a film of unit thickness over one window of half-lengths, counted in half decades from 1."""
    ends = 10.0 ** (np.array([number, number + 1]) / _A_DECADE) * np.array([1 / _OVERLAP, _OVERLAP])
    least, most = np.clip(ends, LEAST, MOST)
    nodes, accuracy = (_ROUGH_NODES, _ROUGH_ACCURACY) if rough else (_HALF_LENGTHS, _ACCURACY)
    return table(
        kind.stack, kind.friction, kind.conducts,
        smooth=kind.smooth, degree=kind.degree, least=float(least), most=float(most), nodes=nodes, accuracy=accuracy,
        punch=kind.elastic,
    )  # fmt: skip


@cached
def traction_window(kind: Kind, number: int) -> TractionTable:
    """Tractions over one window."""
    return TractionTable(window(kind, number))


@cached
def peak_window(kind: Kind, number: int) -> PeakTable:
    """Stresses over one window; of a film no wider than it has a depth below 0.1 h."""
    whole = window(kind, number)
    return PeakTable(replace(whole, upper=min(whole.upper, 0.99 / DEPTH * kind.stack.thickness)))


def number_of(ratio: Array) -> Indices:
    """The window that holds half-lengths over the thickness; any shape."""
    number = np.floor(_A_DECADE * np.log10(ratio))
    return np.asarray(np.clip(number, FIRST, LAST), dtype=np.intp)


def searched(
    guess: Array, direction: Callable[[Indices, int], Indices], thickness: Array, size: str, load: str
) -> Indices:
    """The window of every contact, from a guess on; (case,).

    guess: (case,), half-length or radius over the thickness; thickness: (case,), of the top layers [m].
    """
    numbers = number_of(guess)
    open_cases = np.arange(numbers.size)
    for _ in range(LAST - FIRST + 2):
        moved = np.zeros(open_cases.size, dtype=np.intp)
        for number in np.unique(numbers[open_cases]).tolist():
            in_window = numbers[open_cases] == number
            moved[in_window] = direction(open_cases[in_window], number)
        open_cases, moved = open_cases[moved != 0], moved[moved != 0]
        if not open_cases.size:
            return numbers
        numbers[open_cases] += moved
        if np.any((numbers < FIRST) | (numbers > LAST)):
            raise beyond(bool(np.any(numbers < FIRST)), thickness, size)
    raise LengthsError(
        f"contact: no contact of one {size.split('-')[-1]} carries the {load} (charges too large for it)"
    )


def beyond(narrower: bool, thickness: Array, size: str) -> RangeError:
    """Error for contacts that are narrower, or else wider, than the resolved range."""
    how = "narrower" if narrower else "wider"
    return RangeError(
        f"contact: {how} than the resolved range, {LEAST:g} to {MOST:g} of {size} over thickness ({told(thickness)})"
    )
