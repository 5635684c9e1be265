"""Largest stresses inside half-spaces, films and bases under points, in the plane of symmetry (points, 7).

Nets, measures and search are those of the plane; each case is solved on its nets, without a table.
"""

from collections.abc import Set
from dataclasses import dataclass

import numpy as np

from approximation.arrays import Indices
from approximation.measure import Measure
from approximation.summit import Top, highest
from solver.arrays import Array
from solver.curves import PRINCIPAL, REGIONS, VON_MISES
from solver.fields import STRESSES
from solver.line.peaks import PEAKS_OF, largest
from solver.line.stressnets import DEPTH, Net, Nets, of_whole
from solver.line.table import RangeError
from solver.names import FILM_PEAKS, PEAKS
from solver.point.contact import Pressed
from solver.point.inside import Inside
from solver.point.sliding import Rubbed
from solver.point.tractions import Tractions

_CLOSE = 1e-8  # step of Newton's iteration in a panel's half-width
_BOTTOM, _FAR = 6.0, 6.0  # of a: how deep and how far from the edge a half-space is searched
_OUTER = 3  # pairs of panels added to a net at most
_TOGETHER = 64  # cases at a time: bounded memory


@dataclass(frozen=True, eq=False)
class _Searched:
    """Stresses of cases of one radius on a net."""

    net: Net  # Of lengths over ``ratio`` times the contact's radius
    ratio: float  # Contact radius in the net's unit
    stresses: Array  # (case, field, depth, x)

    @classmethod
    def on(cls, inside: Inside, net: Net, tractions: Tractions, names: tuple[str, ...]) -> "_Searched":
        """Of tractions of one radius."""
        ratio = float(tractions.ratio[0])
        sizes = np.array([ratio])
        X, Y = net.positions(sizes, net.line)[0], -net.depths(sizes)[0]
        return cls(net, ratio, inside.fields(tractions, X, Y, names))

    def top(self, measure: Measure) -> Top:
        """Where a measure of the stresses is largest."""
        return highest(self.stresses, self.net.across, measure, _CLOSE)

    def depth(self, top: Top) -> Array:
        """Depth over a of tops; (case,)."""
        return self.net.depth_at(self.ratio, top.down)


def peaks(pressed: Pressed, inside: Inside, asked: Set[str]) -> dict[str, Array]:
    """Quantities of ``solver.names.PEAKS`` or ``FILM_PEAKS`` that are asked for and the cases have; (case,) each."""
    return peaks_of(inside, Rubbed(pressed.charged).tractions, pressed.charged.radius, asked)


def peaks_of(inside: Inside, tractions: Tractions, radius: Array, asked: Set[str]) -> dict[str, Array]:
    """The same of tractions; (column,) each.

    radius: (column,), of the contacts [m].
    """
    found: dict[str, Array] = {}
    for places in _by_radius(tractions.ratio):
        own = tractions.part(places)
        values = _of_halfspace(inside, own, radius[places]) if inside.plain else _of_film(inside, own, asked)
        for name in values.keys() & asked:
            found.setdefault(name, np.empty(tractions.ratio.size))[places] = values[name]
    return {name: found[name] for name in (*PEAKS, *FILM_PEAKS) if name in found}


def _by_radius(ratio: Array) -> list[Indices]:
    """Cases of one radius, some at a time."""
    alike = [np.flatnonzero(ratio == share) for share in np.unique(ratio)]
    return [same[start : start + _TOGETHER] for same in alike for start in range(0, same.size, _TOGETHER)]


def _of_halfspace(inside: Inside, tractions: Tractions, radius: Array) -> dict[str, Array]:
    searched = _Searched.on(inside, of_whole(inside.stack, 1.0, _BOTTOM, _FAR), tractions, STRESSES)
    highest_stress = searched.top(VON_MISES)
    return {
        "peak_von_mises": highest_stress.value,
        "peak_von_mises_depth": searched.depth(highest_stress) * radius,
        "peak_principal_tension": np.maximum(searched.top(PRINCIPAL).value, 0.0),
    }


def _of_film(inside: Inside, tractions: Tractions, asked: Set[str]) -> dict[str, Array]:
    stack, ratio = inside.stack, float(tractions.ratio[0])
    nets, out = Nets(stack, ratio, ratio), dict[str, Array]()
    regions = ["interface"] + ["film"] * (len(stack.layers) == 1) + ["base"] * (not stack.rigid)
    for region in regions:  # panels through several layers would meet their jumps
        if not asked & set(PEAKS_OF[region]):
            continue
        if region == "film" and ratio >= 0.99 / DEPTH * stack.thickness:
            raise RangeError(
                f"contact: radius over thickness {ratio / stack.thickness:g} is too wide for peaks; must be < "
                f"{1 / DEPTH:g}"
            )

        def stresses_on(net: Net, names: tuple[str, ...] = REGIONS[region].stresses) -> Array:
            return _Searched.on(inside, net, tractions, names).stresses

        out |= largest(stresses_on, getattr(nets, region), np.full(tractions.ratio.size, ratio), region, _OUTER)
    return out
