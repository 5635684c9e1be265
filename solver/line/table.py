"""Outputs of every cause tabulated over the half-length, by Chebyshev series in log h (films, section 4)."""

import warnings
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from approximation.chebyshev import coefficients
from approximation.piecewise import Interval
from solver.arrays import Array
from solver.halfplane.pressing import ContactError
from solver.halfplane.sliding import RIGID_PUNCH, Punch, Sliding
from solver.line import outputs
from solver.line.basis import Basis
from solver.line.kernel import kernel
from solver.line.outputs import Assembly
from solver.line.system import System
from solver.stack.electroded import met
from solver.stack.layers import Stack

#: Range of half-lengths over the thickness of the top layer.
LEAST, MOST = 1e-4, 60.0

_PER_DECADE = 15.0  # nodes: 1e-8 between them, up to 30 thicknesses
BATCH = 50_000_000  # bytes of kernels held at once
_SECONDS = 1.8e-6  # per node, sample and term, on one core of 2020
_LONG = 15.0  # s, from which a warning announces the time
_WIDE = 3.0  # half-lengths over the thickness from which the number of terms is checked
_LAST = 5e-7  # of the largest coefficient of the pressure: bound on the last ones times h/h1, for 1e-8 of all tractions
_LAST_TERMS = 6
_REFINED, _REFINEMENTS = 1.25, 6  # factor on the number of terms, and the most times that it is applied
_LEAST_SHARE = 0.75  # of a basis's number of terms: half-lengths that need fewer have their own basis


class SlowWarning(UserWarning):
    """A table that takes longer than others."""


class RangeError(ContactError):
    """A contact narrower or wider than the range of half-lengths that is resolved."""


class LengthsError(ContactError):
    """A load that contacts of several sizes carry, or of no size: charges too large for it."""


@dataclass(frozen=True, eq=False)
class Table:
    """Outputs over a range of half-lengths."""

    system: System
    lower: float  # Range of half-lengths [m]
    upper: float
    nodes: int  # Number of Chebyshev points

    @cached_property
    def interval(self) -> Interval:
        """Range of log h with its Chebyshev points."""
        return Interval(float(np.log(self.lower)), float(np.log(self.upper)), self.nodes)

    @cached_property
    def half_lengths(self) -> Array:
        """Half-lengths [m] at the Chebyshev points of log h, in rising order; (node,)."""
        return np.exp(self.interval.points)

    @cached_property
    def at_nodes(self) -> Array:
        """Outputs at the half-lengths; (node, output, cause)."""
        basis = self.system.basis(self.upper)
        seconds = _SECONDS * self.nodes * basis.samples * basis.terms
        if seconds > _LONG:
            top = self.system.kernel.stack.top.thickness
            warnings.warn(
                f"contact: a table of half-lengths from {self.lower / top:.3g} to {self.upper / top:.3g} thicknesses "
                f"of this film takes about {float(f'{seconds:.1g}'):g} s",
                SlowWarning,
                stacklevel=2,
            )
        return at(self.system, self.half_lengths)

    @cached_property
    def series(self) -> Array:
        """Chebyshev coefficients of the outputs in log h; (node, output, cause)."""
        return coefficients(self.at_nodes)

    @cached_property
    def rates(self) -> Array:
        """Chebyshev coefficients of the derivatives in log h; (node, output, cause)."""
        return self.interval.derived(self.series)


def at(system: System, half_lengths: Array) -> Array:
    """Outputs at half-lengths (half,) [m], batched by size; (half, output, cause)."""
    out: Array = np.empty((half_lengths.size, outputs.COUNT, system.causes))
    for basis, members in batches(system, half_lengths):
        out[members] = outputs.outputs(Assembly(system, basis, half_lengths[members]))
    return out


def batches(system: System, half_lengths: Array, points: int = 2) -> list[tuple[Basis, NDArray[np.intp]]]:
    """Group half-lengths with similar numbers of terms; each group has the basis of its longest one, and indices."""
    order = np.argsort(half_lengths)
    terms = np.array([system.terms(h) for h in half_lengths[order]])
    groups = []
    end = len(order)
    while end > 0:
        basis = system.basis(float(half_lengths[order[end - 1]]))
        most = max(BATCH // (8 * 19 * basis.samples * (basis.terms + points)), 1)
        similar = int(np.searchsorted(terms, _LEAST_SHARE * basis.terms))
        start = min(max(similar, end - most), end - 1)
        groups.append((basis, order[start:end]))
        end = start
    return groups


def table(
    stack: Stack,
    friction: float = 0.0,
    conducts: tuple[bool, bool] = (True, True),
    *,
    smooth: tuple[bool, bool] = (True, True),
    degree: int = 1,
    least: float = 0.01,
    most: float = 3.0,
    nodes: int | None = None,
    accuracy: float = 1.0,
    punch: Punch = RIGID_PUNCH,
) -> Table:
    """Return the table of a stack over half-lengths from ``least`` to ``most`` thicknesses of its top layer."""
    if not LEAST <= least < most <= MOST:
        raise RangeError(f"contact: range {least:g} to {most:g} of hc/h1 is not within {LEAST:g} to {MOST:g}")
    top = stack.top.thickness
    sliding = Sliding(met(stack), np.array(friction), np.array(conducts), punch)
    system = System(kernel(stack, 2 * most * top), sliding, smooth, degree, accuracy)
    if accuracy >= 1:
        system = _refined(system, most * top)
    count = nodes or 10 + int(np.ceil(_PER_DECADE * np.log10(most / least)))
    return Table(system, least * top, most * top, count)


def _refined(system: System, half_length: float) -> System:
    """Return the system with enough terms that the last ones are negligible at a half-length [m]."""
    # reflected waves that oscillate as they decay, as in PMN-PT, need more terms than others
    ratio = half_length / system.kernel.stack.top.thickness
    if ratio < _WIDE:
        return system
    for _ in range(_REFINEMENTS):
        basis = system.basis(half_length)
        unknowns = Assembly(system, basis, np.array([half_length])).unknowns[0]
        pressures = np.abs(unknowns[: basis.pressures, : len(system.powers)])
        if np.max(pressures[-_LAST_TERMS:]) * ratio <= _LAST * np.max(pressures):
            break
        system = replace(system, accuracy=system.accuracy * _REFINED)
    return system
