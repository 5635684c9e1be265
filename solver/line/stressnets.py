"""Nets of Chebyshev panels tied to the contact, on which the stresses of films are tabulated.

Five panels lie side by side: under the contact, at its edges, and far from it. Points of the far panels are even in the
logarithm of the distance from the edge, points down in that of the depth. Beyond the five, stresses fall like those of
a line force, as 1/r, but can rise where a part that falls faster cancels them: :meth:`Net.outward` continues the net.
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
_FILM_EDGE = 0.4  # width of the film's panels at the edges, of the half-length
_BASE_EDGE = 2.0  # width of those on the interface and in the base, of the thickness
_TAIL = 8.0  # factor on the distance to which the interface is searched: its decaying tension still changes sign there
_FARTHEST = 8.0  # half-lengths and thicknesses, or lengths over which a base bends a film that is stiffer
_OUTWARD = 4.0  # ratio of the distances at which a panel outside the five ends and starts
_ERROR = 1e-7  # of a panel's interpolant at its worst point
_ANGLE = 1.1  # largest angle of the singularities that is used
_PANEL_FEWEST, _PANEL_MOST = 12, 128  # points of a panel


@dataclass(frozen=True)
class Net:
    """Points over a region of films of one stack, for half-lengths from ``least`` to ``most`` [m]."""

    # Width of the panels at the edges: the sum of these shares of h and of the thickness
    half_share: float
    thickness_share: float
    # Distance from the edges at which the far panels end: the sum of this share of h and this length [m]
    far_share: float
    far_length: float
    # Singularities of the fields about an edge: distance from a horizontal line over its depth, and angle
    rate: float
    angle: float
    # Least and largest depth, as shares of (h, thickness of all layers)
    top: tuple[float, float]
    bottom: tuple[float, float]
    thickness: float  # H: thickness of all layers [m]
    # Range of half-lengths [m]
    least: float
    most: float
    outer: int = 0  # Number of the pair of panels outside the five; 0: the five

    @property
    def across(self) -> tuple[int, ...]:
        """Number of points of each panel across."""
        if self.outer:
            return (self._even(_OUTWARD),) * 2
        h = np.array([self.least, self.most])
        near, sharp = self._near(h), _at(self.top, h, self.thickness)
        far, edge = self._even(np.max(self._far(h) / near)), self._linear(np.max(near / sharp))
        return far, edge, self._linear(np.max(2 * h / sharp)), edge, far

    @property
    def down(self) -> int:
        """Number of points down; 1 for an interface."""
        if self.top == self.bottom:
            return 1
        h = np.array([self.least, self.most])
        return self._even(np.max(_at(self.bottom, h, self.thickness) / _at(self.top, h, self.thickness)))

    def outward(self) -> Self:
        """Return the pair of panels that continues this net to distances four times as large."""
        return replace(self, outer=self.outer + 1)

    def _near(self, h: Array) -> Array:
        """Width of the panels at the edges [m]."""
        return self.half_share * h + self.thickness_share * self.thickness

    def _far(self, h: Array) -> Array:
        """Distance from the edges at which the far panels end [m]."""
        return self.far_share * h + self.far_length

    def _even(self, ratio: float) -> int:
        """Number of points, even in the logarithm, of a panel whose ends have this ratio; singular at the angle."""
        return _points(np.arcsinh(2 * self.angle / np.log(ratio)))

    def _linear(self, width: float) -> int:
        """Number of points of a panel that ends above an edge, by its width over the depth."""
        return _points(np.arccosh(1 + 2j * self.rate / width).real)

    def positions(self, half_lengths: Array, t: Array) -> Array:
        """X = (x - c)/h for h (case,) [m] at coordinates t across, (point,) or (case, point); (case, point)."""
        h = half_lengths[:, None]
        near, far, size = self._near(h), self._far(h), np.abs(t)
        linear, even = (np.clip((size - start) / 2, 0.0, 1.0) for start in (1, 3))
        distance = near * linear * (far / near) ** even * _OUTWARD ** np.maximum((size - 5) / 2, 0.0)
        return np.asarray(np.clip(t, -1.0, 1.0) + np.sign(t) * distance / h)

    def coordinates(self, panel: Indices, local: Array) -> Array:
        """Coordinates t of points at ``local`` (-1 to 1) in panels numbered from the left; (point,)."""
        if self.outer:
            return np.where(panel == 0, -1.0, 1.0) * (4 + 2 * self.outer) + local
        return 2.0 * panel - 4 + local

    def depths(self, half_lengths: Array) -> Array:
        """Depths -y/h of the points down for half-lengths (case,) [m]; (case, point)."""
        return np.array([self.depth_at(h, gauss_points(self.down)) for h in half_lengths.tolist()])

    def depth_at(self, h: float, t: Array) -> Array:
        """Depths -y/h at coordinates down for a half-length [m], of the shape of ``t``."""
        low, high = (np.log(_at(share, np.array(h), self.thickness)) for share in (self.top, self.bottom))
        return np.asarray(np.exp((low + high) / 2 + (high - low) / 2 * t) / h)

    @property
    def line(self) -> Array:
        """Coordinates t of the points across; (point,)."""
        if self.outer:
            start, end = 3.0 + 2 * self.outer, 5.0 + 2 * self.outer
            return np.concatenate([mapped_points(self.across[0], *ends) for ends in ((-end, -start), (start, end))])
        return line(self.across, ENDS)


#: Width of the panels at the edges, least and largest depth, as shares of (half-length, thickness), and factor on the
#: distance searched, by region.
_SHARES = {
    "interface": ((0.0, _BASE_EDGE), (0.0, 1.0), (0.0, 1.0), _TAIL),
    "film": ((_FILM_EDGE, 0.0), (DEPTH, 0.0), (0.0, 1.0), 1.0),
    "base": ((0.0, _BASE_EDGE), (0.0, _BELOW), (2.0, 2.0), 1.0),
}


def regions(stack: Stack) -> list[str]:
    """Regions whose largest stresses are searched; panels through several layers would contain jumps."""
    return ["interface"] + ["film"] * (len(stack.layers) == 1) + ["base"] * (not stack.rigid)


def require_depth(ratio: Array, size: str) -> None:
    """Refuse contacts larger than ten thicknesses: no depth of the film exceeds a tenth of their size."""
    if (widest := float(np.max(ratio, initial=0.0))) > 0.99 / DEPTH:
        raise RangeError(f"contact: {size} over thickness {widest:g} is too wide for peaks; must be < {1 / DEPTH:g}")


def net_of(stack: Stack, region: str, least: float, most: float) -> Net:
    """Return the net over a region for half-lengths from ``least`` to ``most`` [m]."""
    near, top, bottom, tail = _SHARES[region]
    stiffness = max(float(layer.material.c11) for layer in stack.layers)
    base = stiffness if isinstance(stack.base, str) else float(stack.base.c11)
    bending = float(stack.thickness * np.cbrt(max(1.0, stiffness / base)))  # over which a soft base bends a stiff film
    far = _FARTHEST, tail * (bending * _FARTHEST)
    return Net(*near, *far, *singular(stack), top, bottom, stack.thickness, least, most)


def of_whole(stack: Stack, half: float, bottom: float, farthest: float) -> Net:
    """Return the net below depth 0.1 h in a body whose layers and base are one material, for a half-length [m]."""
    ends = (DEPTH, 0.0), (bottom, 0.0)
    return Net(_FILM_EDGE, 0.0, farthest, 0.0, *singular(stack), *ends, stack.thickness, half, half)


def singular(stack: Stack) -> tuple[float, float]:
    """Least rate and angle, see :class:`Net`, of the waves of all layers and the base."""
    media = [*stack.media, *filter(None, [stack.base_medium])]
    rates = np.concatenate([np.linalg.eigvals(medium.decay) for medium in media])
    return float(np.min(rates.real)), min(float(np.pi / 2 - np.max(np.abs(np.angle(rates)))), _ANGLE)


def _points(decay: float) -> int:
    """Number of points of a panel, from the decay rate of its Chebyshev coefficients."""
    return int(np.clip(np.ceil(-np.log(_ERROR) / decay), _PANEL_FEWEST, _PANEL_MOST))


def _at(share: tuple[float, float], h: Array, thickness: float) -> Array:
    """Depth [m] from its shares of the half-length and of the thickness, of the shape of h."""
    return share[0] * h + share[1] * thickness
