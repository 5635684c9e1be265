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
from solver.stack.layers import Stack

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
        """Stresses on a net of tractions of one radius."""
        ratio = float(tractions.ratio[0])
        sizes = np.array([ratio])
        X, Y = net.positions(sizes, net.line)[0], -net.depths(sizes)[0]
        return cls(net, ratio, inside.fields(tractions, X, Y, names))

    def top(self, measure: Measure) -> Top:
        """Largest value of a measure of the stresses, and its place."""
        return highest(self.stresses, self.net.across, measure)

    def depth(self, top: Top) -> Array:
        """Depth over a of tops; (case,)."""
        return self.net.depth_at(self.ratio, top.down)


def peaks(pressed: Pressed, inside: Inside, requested: Set[str]) -> dict[str, Array]:
    """Requested quantities of ``solver.names.PEAKS`` or ``FILM_PEAKS`` that the cases have; (case,) each."""
    return peaks_of(inside, Rubbed(pressed.charged).tractions, pressed.charged.radius, requested)


def peaks_of(inside: Inside, tractions: Tractions, radius: Array, requested: Set[str]) -> dict[str, Array]:
    """Requested peaks of tractions on contacts of the radii (column,) [m]; (column,) each."""
    if not inside.plain:
        _refuse_wide(inside.stack, tractions.ratio, requested)
    peaks: dict[str, Array] = {}
    for places in _by_radius(tractions.ratio):
        part = tractions.part(places)
        values = _of_halfspace(inside, part, radius[places]) if inside.plain else _of_film(inside, part, requested)
        for name in values.keys() & requested:
            peaks.setdefault(name, np.empty(tractions.ratio.size))[places] = values[name]
    return {name: peaks[name] for name in (*PEAKS, *FILM_PEAKS) if name in peaks}


def _regions(stack: Stack) -> list[str]:
    """Regions that are searched: several layers are none, since panels through them would meet their jumps."""
    return ["interface"] + ["film"] * (len(stack.layers) == 1) + ["base"] * (not stack.rigid)


def _refuse_wide(stack: Stack, ratio: Array, requested: Set[str]) -> None:
    """Refuse contacts so wide that no depth of the film lies below a tenth of the radius."""
    widest = float(np.max(ratio, initial=0.0)) / stack.thickness
    if "film" in _regions(stack) and requested & set(PEAKS_OF["film"]) and widest >= 0.99 / DEPTH:
        raise RangeError(f"contact: radius over thickness {widest:g} is too wide for peaks; must be < {1 / DEPTH:g}")


def _by_radius(ratio: Array) -> list[Indices]:
    """Indices of cases of one radius, some at a time."""
    by_radius = [np.flatnonzero(ratio == share) for share in np.unique(ratio)]
    return [cases[start : start + _TOGETHER] for cases in by_radius for start in range(0, cases.size, _TOGETHER)]


def _of_halfspace(inside: Inside, tractions: Tractions, radius: Array) -> dict[str, Array]:
    searched = _Searched.on(inside, of_whole(inside.stack, 1.0, _BOTTOM, _FAR), tractions, STRESSES)
    highest_stress = searched.top(VON_MISES)
    return {
        "peak_von_mises": highest_stress.value,
        "peak_von_mises_depth": searched.depth(highest_stress) * radius,
        "peak_principal_tension": np.maximum(searched.top(PRINCIPAL).value, 0.0),
    }


def _of_film(inside: Inside, tractions: Tractions, requested: Set[str]) -> dict[str, Array]:
    stack, ratio = inside.stack, float(tractions.ratio[0])
    nets, out = Nets(stack, ratio, ratio), dict[str, Array]()
    for region in _regions(stack):
        if not requested & set(PEAKS_OF[region]):
            continue

        def stresses_on(net: Net, names: tuple[str, ...] = REGIONS[region].stresses) -> Array:
            return _Searched.on(inside, net, tractions, names).stresses

        out |= largest(stresses_on, getattr(nets, region), np.full(tractions.ratio.size, ratio), region, _OUTER)
    return out
