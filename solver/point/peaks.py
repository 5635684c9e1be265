"""Largest stresses inside half-spaces, films and bases under points, on the nets of the plane (points, 7)."""

from collections.abc import Set

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array
from solver.curves import REGIONS
from solver.fields import STRESSES
from solver.line.peaks import PEAKS_OF, largest, of_whole_body
from solver.line.stressnets import Net, net_of, of_whole, regions, require_depth
from solver.names import FILM_PEAKS, PEAKS
from solver.point.contact import Pressed
from solver.point.inside import Inside
from solver.point.sliding import Rubbed
from solver.point.tractions import Tractions

_BOTTOM, _FAR = 6.0, 6.0  # depth and distance from the edge over a within which a half-space is searched
_OUTER = 3  # largest number of pairs of panels added to a net
_TOGETHER = 64  # cases at a time: bounded memory


def peaks(pressed: Pressed, inside: Inside, requested: Set[str]) -> dict[str, Array]:
    """Requested quantities of ``solver.names.PEAKS`` or ``FILM_PEAKS`` that the cases have; (case,) each."""
    return peaks_of(inside, Rubbed(pressed.charged).tractions, pressed.charged.radius, requested)


def peaks_of(inside: Inside, tractions: Tractions, radius: Array, requested: Set[str]) -> dict[str, Array]:
    """Requested peaks of tractions on contacts of the radii (column,) [m]; (column,) each."""
    searched = [region for region in regions(inside.stack) if requested & set(PEAKS_OF[region])]
    if "film" in searched and not inside.plain:
        require_depth(tractions.ratio / inside.stack.thickness, "radius")
    peaks: dict[str, Array] = {}
    for columns in _by_radius(tractions.ratio):
        part = tractions.part(columns)
        values = _of_halfspace(inside, part, radius[columns]) if inside.plain else _of_film(inside, part, searched)
        for name in values.keys() & requested:
            peaks.setdefault(name, np.empty(tractions.ratio.size))[columns] = values[name]
    return {name: peaks[name] for name in (*PEAKS, *FILM_PEAKS) if name in peaks}


def _by_radius(ratio: Array) -> list[Indices]:
    """Indices of cases of one radius, at most ``_TOGETHER`` at a time."""
    by_radius = [np.flatnonzero(ratio == distinct) for distinct in np.unique(ratio)]
    return [cases[start : start + _TOGETHER] for cases in by_radius for start in range(0, cases.size, _TOGETHER)]


def _stresses(inside: Inside, net: Net, tractions: Tractions, names: tuple[str, ...]) -> Array:
    """Stresses of tractions of one radius on a net; (case, stress, depth, x)."""
    size = tractions.ratio[:1]
    return inside.fields(tractions, net.positions(size, net.line)[0], -net.depths(size)[0], names)


def _of_halfspace(inside: Inside, tractions: Tractions, radius: Array) -> dict[str, Array]:
    net = of_whole(inside.stack, 1.0, _BOTTOM, _FAR)
    out = of_whole_body(_stresses(inside, net, tractions, STRESSES), net, float(tractions.ratio[0]))
    return out | {"peak_von_mises_depth": out["peak_von_mises_depth"] * radius}


def _of_film(inside: Inside, tractions: Tractions, searched: list[str]) -> dict[str, Array]:
    ratio, out = float(tractions.ratio[0]), dict[str, Array]()
    for region in searched:

        def stresses_on(net: Net, names: tuple[str, ...] = REGIONS[region].stresses) -> Array:
            return _stresses(inside, net, tractions, names)

        out |= largest(stresses_on, net_of(inside.stack, region, ratio, ratio), tractions.ratio, region, _OUTER)
    return out
