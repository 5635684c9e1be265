"""Largest stresses of a film, of its base and on its lowest interface, from tables over half-lengths.

Stresses on Chebyshev panels tied to the edges of the contact are linear in the causes at a half-length and smooth in
its logarithm. A case is a product; the best nodes of several hills start climbs on the interpolant.
"""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from approximation.chebyshev import coefficients, interpolation
from approximation.measure import ITSELF
from approximation.summit import highest
from solver.arrays import Array, joined
from solver.curves import PRINCIPAL, REGIONS, SHEAR, VON_MISES
from solver.line.contact import FilmContact
from solver.line.interior import Interior
from solver.line.stressnets import DEPTH, Net, Nets
from solver.line.table import RangeError, Table
from solver.line.tractions import Tractions
from solver.stack.layers import StackError

#: What is searched for in each region of ``solver.curves.REGIONS``.
PEAKS_OF = {
    "interface": ("interface_shear", "interface_shear_position", "interface_tension", "interface_tension_position"),
    "film": ("film_peak_von_mises", "film_peak_principal_tension"),
    "base": ("base_peak_von_mises", "base_peak_principal_tension"),
}
_CLOSE = 1e-8  # step of Newton's iteration in a panel's half-width: the next is of its square
_CHUNK = 256  # cases at a time: bounded memory


@dataclass(frozen=True, eq=False)
class PeakTable:
    """Stresses of a film over the half-lengths of a table of contacts."""

    table: Table
    _tabled: dict[str, tuple[Net, Array]] = field(default_factory=dict, init=False, repr=False)

    def tabled(self, region: str) -> tuple[Net, Array]:
        """Net over a region, and Chebyshev coefficients in log h of its stresses; (node, stress, depth, x, cause)."""
        if region not in self._tabled:
            stack, upper = self.table.system.kernel.stack, self.table.upper
            if region == "film" and DEPTH * upper >= stack.thickness:
                raise RangeError(f"film peaks: contacts wider than {1 / DEPTH:g} thicknesses have no film under 0.1 h")
            if region == "base" and stack.rigid:
                raise StackError("base peaks: a rigid base has no stresses")
            net: Net = getattr(Nets(stack, self.table.lower, upper), region)
            self._tabled[region] = net, self._series(net, REGIONS[region].stresses)
        return self._tabled[region]

    def _series(self, net: Net, names: tuple[str, ...]) -> Array:
        lengths = self.table.half_lengths
        X, Y = net.positions(lengths, net.line), -net.depths(lengths)
        return coefficients(Interior(self._tractions).fields(X, Y, names))

    @cached_property
    def _tractions(self) -> Tractions:
        return Tractions.by_cause(self.table.system, self.table.half_lengths)

    def peaks(self, contact: FilmContact, region: str) -> dict[str, Array]:
        """Peaks in a region of contacts read from the same table, by name; (case,) each. Raises as :meth:`tabled`."""
        (net, series), h = self.tabled(region), contact.half_width
        parts = []
        for places in np.split(np.arange(h.size), range(_CHUNK, h.size, _CHUNK)):
            stresses = self.read(contact, series, slice(places[0], places[-1] + 1))
            parts.append((places, largest(stresses, net, h[places], region)))
        return joined(parts, h.size)

    def curves(self, contact: FilmContact, region: str) -> dict[str, Array]:
        """Fields of a region of ``solver.curves`` of contacts read from the same table, by name; (case, point), SI.

        They are what is searched by :meth:`peaks`, at fewer points in the bodies. Raises as :meth:`tabled`.
        """
        here, (net, series) = REGIONS[region], self.tabled(region)
        across, down = here.lines()
        values = interpolation(net.down, down) @ self.read(contact, series) @ _along(net.across, across).T
        stresses = here.panels.by_panel(values)
        out = {f"{region}_{name}": stresses[:, k] for k, name in enumerate(here.stresses)}
        if "position" in here.fields:
            out[f"{region}_position"] = net.positions(contact.half_width, across)
        return out

    def read(self, contact: FilmContact, series: Array, some: slice = slice(None)) -> Array:
        """What some contacts read from a series of this table; (case, ...).

        series: (node, ..., cause), over the table's half-lengths.
        """
        polynomials = self.table.polynomials(np.log(contact.half_width[some]))
        weights = np.einsum("cn,cq->cnq", polynomials, contact.causes.values[some]).reshape(len(polynomials), -1)
        flat = np.moveaxis(series, -1, 1).reshape(weights.shape[1], -1)
        return np.asarray((weights @ flat).reshape(-1, *series.shape[1:-1]))


def largest(stresses: Array, net: Net, half_lengths: Array, region: str) -> dict[str, Array]:
    """Peaks of stresses on the net of a region, by name; (case,) each, positions X = (x - c)/h, SI.

    Principal stresses and tension are 0 where none is tensile, and the position of the tension is then NaN.

    stresses: (case, stress, depth, x); half_lengths: (case,), in the unit of the net.
    """
    measured = ((stresses, SHEAR), (stresses[:, 1:], ITSELF))
    if region != "interface":
        measured = (stresses, VON_MISES), (stresses, PRINCIPAL)
    first, second = (highest(fields, net.across, measure, _CLOSE) for fields, measure in measured)
    tension = np.maximum(second.value, 0.0)
    if region != "interface":
        return dict(zip(PEAKS_OF[region], (first.value, tension), strict=True))
    places = [
        net.positions(half_lengths, (2.0 * top.panel - len(net.across) + 1 + top.across)[:, None])[:, 0]
        for top in (first, second)
    ]
    values = (first.value, places[0], tension, np.where(second.value > 0, places[1], np.nan))
    return dict(zip(PEAKS_OF[region], values, strict=True))


def _along(counts: tuple[int, ...], places: Array) -> Array:
    """From values at the points of panels across to those at places; a panel is 2 wide. (place, point)."""
    whole = np.zeros((places.size, sum(counts)))
    panel = np.clip(np.floor((places + len(counts)) / 2).astype(int), 0, len(counts) - 1)
    ends = np.cumsum((0, *counts))
    for number, count in enumerate(counts):
        own = np.flatnonzero(panel == number)
        local = places[own] + len(counts) - 1 - 2 * number
        whole[own, ends[number] : ends[number + 1]] = interpolation(count, local)
    return whole
