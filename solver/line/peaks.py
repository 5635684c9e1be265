"""Largest stresses of a film, of its base and on its lowest interface, from tables over half-lengths.

Stresses on a net of Chebyshev panels are linear in the causes and smooth in the logarithm of the half-length. Panels
are added farther out until a bound excludes larger stresses beyond them.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np

from approximation.arrays import Indices
from approximation.chebyshev import coefficients, interpolation
from approximation.measure import Measure
from approximation.summit import highest
from solver.arrays import Array, joined
from solver.curves import PRINCIPAL, PULL, REGIONS, SHEAR, VON_MISES
from solver.line.interior import Interior
from solver.line.stressnets import Net, net_of
from solver.line.table import Table
from solver.line.tractions import Tractions
from solver.names import PEAKS

#: Peaks that are searched for in each region of ``solver.curves.REGIONS``.
PEAKS_OF = {
    "interface": ("interface_shear", "interface_shear_position", "interface_tension", "interface_tension_position"),
    "film": ("film_peak_von_mises", "film_peak_principal_tension"),
    "base": ("base_peak_von_mises", "base_peak_principal_tension"),
}
_NORMAL = Measure(PULL.linear[:1], PULL.root[:1])  # sigma_yy of (sigma_xy, sigma_yy), negative in compression
_CHUNK = 256  # cases at a time: bounded memory
_OUTER = 8  # most pairs of panels added to a net: 4^8 times its length, where 1/r leaves next to nothing
_NEGLIGIBLE = 1e-7  # of the largest stress on a net: the error of its interpolant
_TAIL = (1.0, 0.5, 0.0)  # coordinates in the last panel from which the tail is continued


@dataclass(frozen=True, eq=False)
class PeakTable:
    """Stresses of a film over the half-lengths of a table of contacts."""

    table: Table
    #: Most pairs of panels that are added to a net.
    outer: ClassVar[int] = _OUTER
    _known: dict[tuple[str, int], Array] = field(default_factory=dict, init=False, repr=False)

    def net(self, region: str) -> Net:
        """Return the net over a region for the half-lengths of the table."""
        return net_of(self.table.system.kernel.stack, region, self.table.lower, self.table.upper)

    def _tabled(self, region: str, net: Net) -> Array:
        """Chebyshev coefficients in log h of the stresses on a net over a region; (node, stress, depth, x, cause)."""
        if (region, net.outer) not in self._known:
            self._known[region, net.outer] = self._series(net, REGIONS[region].stresses)
        return self._known[region, net.outer]

    def _series(self, net: Net, names: tuple[str, ...]) -> Array:
        """Chebyshev coefficients in log h of named stresses on a net; (node, stress, depth, x, cause)."""
        lengths = self.table.half_lengths
        X, Y = net.positions(lengths, net.line), -net.depths(lengths)
        return coefficients(Interior(self._tractions).fields(X, Y, names))

    @cached_property
    def _tractions(self) -> Tractions:
        return Tractions.by_cause(self.table.system, self.table.half_lengths)

    def peaks(self, half_width: Array, causes: Array, region: str) -> dict[str, Array]:
        """Peaks in a region of contacts of the table, by name; (case,) each."""
        net, parts = self.net(region), []
        for cases in np.split(np.arange(half_width.size), range(_CHUNK, half_width.size, _CHUNK)):

            def stresses_on(net: Net, cases: Indices = cases) -> Array:
                return self.read(half_width[cases], causes[cases], self._tabled(region, net))

            parts.append((cases, largest(stresses_on, net, half_width[cases], region, self.outer)))
        return joined(parts, half_width.size)

    def curves(self, half_width: Array, causes: Array, region: str) -> dict[str, Array]:
        """Stresses that :meth:`peaks` searches, at the points of ``solver.curves``, by name; (case, point), SI."""
        curve, net = REGIONS[region], self.net(region)
        across, down = curve.lines()
        values = interpolation(net.down, down) @ self.read(half_width, causes, self._tabled(region, net))
        stresses = curve.panels.by_panel(values @ _along(net.across, across).T)
        out = {f"{region}_{name}": stresses[:, k] for k, name in enumerate(curve.stresses)}
        if "position" in curve.fields:
            out[f"{region}_position"] = net.positions(half_width, across)
        return out

    def read(self, half_width: Array, causes: Array, series: Array) -> Array:
        """Evaluate a series (node, ..., cause) over the table's half-lengths for contacts; (case, ...)."""
        return self.table.interval.read(np.log(half_width), series, causes)


@dataclass(frozen=True, eq=False)
class Highest:
    """Largest value of a measure of stresses, and where it occurs; (case,) each."""

    value: Array
    position: Array  # X = (x - c)/h
    down: Array  # Coordinate of the net in the depth


def largest(
    stresses_on: Callable[[Net], Array], net: Net, half_lengths: Array, region: str, outer: int
) -> dict[str, Array]:
    """Peaks in a region by name, from arguments of :func:`highest_stresses`; (case,) each, SI, X = (x - c)/h."""
    measures = (SHEAR, _NORMAL) if region == "interface" else (VON_MISES, PRINCIPAL)
    first, second = highest_stresses(stresses_on, net, half_lengths, measures, outer)
    tension = np.maximum(second.value, 0.0)  # 0, at no position, where no stress is tensile
    if region != "interface":
        return dict(zip(PEAKS_OF[region], (first.value, tension), strict=True))
    values = (first.value, first.position, tension, np.where(second.value > 0, second.position, np.nan))
    return dict(zip(PEAKS_OF[region], values, strict=True))


def of_whole_body(stresses: Array, net: Net, half_length: float) -> dict[str, Array]:
    """Quantities of ``solver.names.PEAKS`` by stresses on the net of one half-length, depth over h; (case,) each."""
    shear, pull = (highest(stresses, net.across, measure) for measure in (VON_MISES, PRINCIPAL))
    depth, tension = net.depth_at(half_length, shear.down), np.maximum(pull.value, 0.0)
    return dict(zip(PEAKS, (shear.value, depth, tension), strict=True))


def highest_stresses(
    stresses_on: Callable[[Net], Array],  # Stresses on a net; (case, stress, depth, x)
    net: Net,
    half_lengths: Array,  # In the net's unit; (case,)
    measures: Sequence[Measure],
    outer: int,  # Most pairs of panels that are added
) -> list[Highest]:
    """Largest values of measures on a net, which is continued outward until a bound excludes larger ones beyond."""
    searched = [(net, stresses_on(net))]
    negligible = _NEGLIGIBLE * np.max(np.abs(searched[0][1]), axis=(1, 2, 3))
    summits = []
    for measure in measures:
        best = np.full((3, half_lengths.size), -np.inf)
        for number in range(outer + 1):
            if number == len(searched):
                wider = searched[-1][0].outward()
                searched.append((wider, stresses_on(wider)))
            panels, stresses = searched[number]
            top = highest(stresses, panels.across, measure)
            t = panels.coordinates(top.panel, top.across)
            candidate = np.stack([top.value, panels.positions(half_lengths, t[:, None])[:, 0], top.down])
            best = np.where(top.value > best[0], candidate, best)
            if np.all(_bound_beyond(stresses, panels, half_lengths, measure) <= np.maximum(best[0], negligible)):
                break
        summits.append(Highest(*best))
    return summits


def _bound_beyond(stresses: Array, net: Net, half_lengths: Array, measure: Measure) -> Array:
    """Bound on a measure beyond the ends of a net; (case,)."""
    # Far from the contact X times a stress is a series in 1/X. A parabola through three distances of the last panel
    # continues it to infinity; the difference to a line through two of them is the margin.
    bounds = []
    last = len(net.across) - 1
    for side, panel in ((-1.0, 0), (1.0, last)):
        local = side * np.array(_TAIL)
        columns = slice(0, net.across[0]) if panel == 0 else slice(-net.across[-1], None)
        values = stresses[..., columns] @ interpolation(net.across[panel], local).T
        X = np.abs(net.positions(half_lengths, net.coordinates(np.full(local.size, panel), local)))
        scaled, nearness = np.moveaxis(values * X[:, None, None], 1, -1), 1 / X  # (case, depth, distance, stress)
        limit = _continued(scaled, nearness, 0.0)
        margin = 2 * np.max(np.abs(limit - _continued(scaled[:, :, :2], nearness[:, :2], 0.0)), axis=-1)
        tail = [measure.of(_continued(scaled, nearness, share)) for share in (0.0, 0.5, 1.0)]
        bounds.append(np.max(np.max(tail, axis=0) + margin, axis=1) * nearness[:, 0])
    return np.asarray(np.max(bounds, axis=0))


def _continued(values: Array, nearness: Array, share: float) -> Array:
    """Interpolate values (case, depth, node, stress) at 1/X = nearness (case, node) to a share of the first node."""
    target, weights = share * nearness[:, 0], np.ones_like(nearness)
    for i, j in np.ndindex(nearness.shape[1], nearness.shape[1]):
        if i != j:
            weights[:, i] *= (target - nearness[:, j]) / (nearness[:, i] - nearness[:, j])
    return np.asarray(np.einsum("cdns,cn->cds", values, weights))


def _along(counts: tuple[int, ...], t: Array) -> Array:
    """Interpolation matrix from the points of panels across, each 2 wide, to coordinates t (t,); (t, point)."""
    matrix = np.zeros((t.size, sum(counts)))
    panel = np.clip(np.floor((t + len(counts)) / 2).astype(int), 0, len(counts) - 1)
    ends = np.cumsum((0, *counts))
    for number, count in enumerate(counts):
        rows = np.flatnonzero(panel == number)
        local = t[rows] + len(counts) - 1 - 2 * number
        matrix[rows, ends[number] : ends[number + 1]] = interpolation(count, local)
    return matrix
