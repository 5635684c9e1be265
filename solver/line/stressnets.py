"""Nets of Chebyshev panels tied to the contact, over which the stresses of films are tabulated (film surrogates, 2).

Five panels lie side by side: under the contact, at its edges, and far from it, where points are even in the logarithm
of the distance from the edge. Beyond them a base feels a line force, whose stresses fall as 1/r. They can still rise
where a part that falls faster cancels them, so that :meth:`Net.outward` continues the net until the search has a bound
on the rest (:mod:`solver.line.peaks`). Down, points are even in the logarithm of the depth. The number of points keeps
the worst error of a panel's interpolant below 1e-7.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from approximation.arrays import Indices
from approximation.chebyshev import gauss_points, mapped_points
from approximation.panels import line
from solver.arrays import Array
from solver.line.table import RangeError
from solver.stack.layers import Stack

#: Ends of the panels across in their own coordinate t.
ENDS = (-5.0, -3.0, -1.0, 1.0, 3.0, 5.0)

DEPTH = 0.1  # of the half-length: the least depth of the film's peaks

_BELOW = 1 + 1e-9  # of the thickness: the top of the base
_BESIDE = 0.4  # width of the film's panels beside the edges, of the half-length
_NEAR = 2.0  # the same on the interface and in the base, of the thickness
_TAIL = 8.0  # how much farther the interface is searched: where its tension dies out its sign still changes
_FARTHEST = 8.0  # half-lengths and thicknesses, or lengths over which a base bends a film that is stiffer
_OUTWARD = 4.0  # ratio of the distances at which a panel outside the five ends and starts
_ERROR = 1e-7  # of a panel's interpolant at its worst point
_ANGLE = 1.1  # the largest that is reckoned with
_PANEL_FEWEST, _PANEL_MOST = 12, 128  # points of a panel


@dataclass(frozen=True)
class Net:
    """Points over a region of films of one stack, for half-lengths from ``least`` to ``most`` [m]."""

    # Width of the panels beside the edges: these shares of h and of the thickness together
    half_share: float
    thickness_share: float
    # Distance from the edges at which the far panels end: this share of h and this length [m]
    far_share: float
    far_length: float
    # Where fields are singular about an edge: the distance from a level line over its depth, and the angle
    rate: float
    angle: float
    # Least and largest depth, as shares of (h, thickness of all layers)
    top: tuple[float, float]
    bottom: tuple[float, float]
    thickness: float  # H: thickness of all layers [m]
    # Half-lengths [m]
    least: float
    most: float
    outer: int = 0  # Number of the pair of panels outside the five; 0: the five

    @property
    def across(self) -> tuple[int, ...]:
        """Number of points of every panel across."""
        if self.outer:
            return (self._even(_OUTWARD),) * 2
        h = np.array([self.least, self.most])
        near, sharp = self._near(h), _at(self.top, h, self.thickness)
        far, edge = self._even(np.max(self._far(h) / near)), self._linear(np.max(near / sharp))
        return far, edge, self._linear(np.max(2 * h / sharp)), edge, far

    @property
    def down(self) -> int:
        """Number of points down; 1 of an interface."""
        if self.top == self.bottom:
            return 1
        h = np.array([self.least, self.most])
        return self._even(np.max(_at(self.bottom, h, self.thickness) / _at(self.top, h, self.thickness)))

    def outward(self) -> Self:
        """The pair of panels that continues this net to distances four times as large."""
        return replace(self, outer=self.outer + 1)

    def _near(self, h: Array) -> Array:
        """Width of the panels at the edges [m]."""
        return self.half_share * h + self.thickness_share * self.thickness

    def _far(self, h: Array) -> Array:
        """Distance from the edges at which the far panels end [m]."""
        return self.far_share * h + self.far_length

    def _even(self, ratio: float) -> int:
        """Points of a panel between lengths of a ratio, even in the logarithm: singularities lie at an angle."""
        return _points(np.arcsinh(2 * self.angle / np.log(ratio)))

    def _linear(self, width: float) -> int:
        """Points of a panel that ends above an edge, its width over the depth."""
        return _points(np.arccosh(1 + 2j * self.rate / width).real)

    def positions(self, half_lengths: Array, t: Array) -> Array:
        """X = (x - c)/h for h (case,) [m] at coordinates t along the surface, (point,) or by case; (case, point)."""
        h = half_lengths[:, None]
        near, far, size = self._near(h), self._far(h), np.abs(t)
        linear, even = (np.clip((size - start) / 2, 0.0, 1.0) for start in (1, 3))
        distance = near * linear * (far / near) ** even * _OUTWARD ** np.maximum((size - 5) / 2, 0.0)
        return np.asarray(np.clip(t, -1.0, 1.0) + np.sign(t) * distance / h)

    def coordinates(self, panel: Indices, local: Array) -> Array:
        """Coordinates t of points in panels, numbered from the left, at local (point,) in -1 to 1; (point,)."""
        if self.outer:
            return np.where(panel == 0, -1.0, 1.0) * (4 + 2 * self.outer) + local
        return 2.0 * panel - 4 + local

    def depths(self, half_lengths: Array) -> Array:
        """-y/h of the points down; (case, point)."""
        return np.array([self.depth_at(h, gauss_points(self.down)) for h in half_lengths.tolist()])

    def depth_at(self, h: float, t: Array) -> Array:
        """-y/h at coordinates down; as t."""
        low, high = (np.log(_at(share, np.array(h), self.thickness)) for share in (self.top, self.bottom))
        return np.asarray(np.exp((low + high) / 2 + (high - low) / 2 * t) / h)

    @property
    def line(self) -> Array:
        """Coordinates t of the points across."""
        if self.outer:
            start, end = 3.0 + 2 * self.outer, 5.0 + 2 * self.outer
            return np.concatenate([mapped_points(self.across[0], *ends) for ends in ((-end, -start), (start, end))])
        return line(self.across, ENDS)


#: Of every region the width of the panels beside the edges and the least and largest depth, as shares of the
#: half-length and of the thickness, and how much farther it is searched.
_SHARES = {
    "interface": ((0.0, _NEAR), (0.0, 1.0), (0.0, 1.0), _TAIL),
    "film": ((_BESIDE, 0.0), (DEPTH, 0.0), (0.0, 1.0), 1.0),
    "base": ((0.0, _NEAR), (0.0, _BELOW), (2.0, 2.0), 1.0),
}


def regions(stack: Stack) -> list[str]:
    """Regions whose largest stresses are searched: panels through several layers would meet their jumps."""
    return ["interface"] + ["film"] * (len(stack.layers) == 1) + ["base"] * (not stack.rigid)


def require_depth(ratio: Array, size: str) -> None:
    """Refuse contacts so wide over the thickness that no depth of the film lies below a tenth of their size."""
    if (widest := float(np.max(ratio, initial=0.0))) > 0.99 / DEPTH:
        raise RangeError(f"contact: {size} over thickness {widest:g} is too wide for peaks; must be < {1 / DEPTH:g}")


def net_of(stack: Stack, region: str, least: float, most: float) -> Net:
    """Net over a region, for half-lengths from ``least`` to ``most`` [m]."""
    near, top, bottom, tail = _SHARES[region]
    stiffness = max(float(layer.material.c11) for layer in stack.layers)
    base = stiffness if isinstance(stack.base, str) else float(stack.base.c11)
    bending = float(stack.thickness * np.cbrt(max(1.0, stiffness / base)))  # over which a soft base bends a stiff film
    far = _FARTHEST, tail * (bending * _FARTHEST)
    return Net(*near, *far, *singular(stack), top, bottom, stack.thickness, least, most)


def of_whole(stack: Stack, half: float, bottom: float, farthest: float) -> Net:
    """Points of one body, layers alike, below depth 0.1 h."""
    ends = (DEPTH, 0.0), (bottom, 0.0)
    return Net(_BESIDE, 0.0, farthest, 0.0, *singular(stack), *ends, stack.thickness, half, half)


def singular(stack: Stack) -> tuple[float, float]:
    """Least rate and angle of the waves of all layers and the base, see :class:`Net`."""
    media = [*stack.media, *filter(None, [stack.base_medium])]
    rates = np.concatenate([np.linalg.eigvals(medium.decay) for medium in media])
    return float(np.min(rates.real)), min(float(np.pi / 2 - np.max(np.abs(np.angle(rates)))), _ANGLE)


def _points(decay: float) -> int:
    """Points from the decay of Chebyshev coefficients."""
    return int(np.clip(np.ceil(-np.log(_ERROR) / decay), _PANEL_FEWEST, _PANEL_MOST))


def _at(share: tuple[float, float], h: Array, thickness: float) -> Array:
    return share[0] * h + share[1] * thickness
