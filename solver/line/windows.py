"""Tables of each kind of film over windows of half-lengths that are half a decade wide."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array
from solver.cache import cached
from solver.halfplane.sliding import Punch
from solver.line.peaks import PeakTable
from solver.line.stressnets import DEPTH
from solver.line.table import LEAST, MOST, LengthsError, RangeError, Table, table
from solver.line.tractions import TractionTable
from solver.stack.layers import Stack

_PER_DECADE = 2  # windows
_OVERLAP = 1.3  # factor by which a window extends into its neighbours
_HALF_LENGTHS = 20  # half-lengths of a window
FIRST = int(np.floor(_PER_DECADE * np.log10(LEAST)))
LAST = int(np.ceil(_PER_DECADE * np.log10(MOST))) - 1
_ACCURACY = 1.25  # factor on the number of terms: 1e-9 of tractions that are next to zero, too
_ROUGH_NODES, _ROUGH_ACCURACY = 8, 0.5  # of rough tables: 1e-3 of the load in a fifth of the time
_LOST_UNIT = 0.1  # m, thickness from which the user may have meant micrometres


@dataclass(frozen=True)
class Kind:
    """Properties shared by all cases that one set of tables serves."""

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
    """Return the table of a film of unit thickness over a window of half-lengths, numbered in half decades from 1."""
    ends = 10.0 ** (np.array([number, number + 1]) / _PER_DECADE) * np.array([1 / _OVERLAP, _OVERLAP])
    least, most = np.clip(ends, LEAST, MOST)
    nodes, accuracy = (_ROUGH_NODES, _ROUGH_ACCURACY) if rough else (_HALF_LENGTHS, _ACCURACY)
    return table(
        kind.stack, kind.friction, kind.conducts,
        smooth=kind.smooth, degree=kind.degree, least=float(least), most=float(most), nodes=nodes, accuracy=accuracy,
        punch=kind.elastic,
    )  # fmt: skip


@cached
def traction_window(kind: Kind, number: int) -> TractionTable:
    """Return the table of tractions over one window."""
    return TractionTable(window(kind, number))


@cached
def peak_window(kind: Kind, number: int) -> PeakTable:
    """Return the table of stresses over one window, up to the half-length h whose depth 0.1 h still is in the film."""
    contacts = window(kind, number)
    return PeakTable(replace(contacts, upper=min(contacts.upper, 0.99 / DEPTH * kind.stack.thickness)))


def number_of(ratio: Array) -> Indices:
    """Number of the window of each half-length over the thickness, of the shape of ``ratio``."""
    number = np.floor(_PER_DECADE * np.log10(ratio))
    return np.asarray(np.clip(number, FIRST, LAST), dtype=np.intp)


def searched(
    guess: Array,  # Half-length or radius over the thickness; (case,)
    direction: Callable[[Indices, int], Indices],  # -1, 0 or 1 of cases whose contact is below, in or above a window
    thickness: Array,  # Of the top layers [m]; (case,)
    size: str,
    load: str,
) -> Indices:
    """Number of the window of every contact, searched from a guess on; (case,)."""
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
    """Return the error for contacts that are narrower, or else wider, than the resolved range."""
    how = "narrower" if narrower else "wider"
    least, most = float(np.min(thickness)), float(np.max(thickness))
    metres = f"{least:g}{'' if least == most else f' to {most:g}'}"
    hint = f"; did you mean {metres} um?" if least >= _LOST_UNIT else ""
    return RangeError(
        f"contact: {how} than the resolved range, {LEAST:g} to {MOST:g} of {size} over thickness "
        f"(thickness {metres} m{hint})"
    )
