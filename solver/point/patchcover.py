"""What a patch of an electrode on top gets of the tractions on it: integrals over the part of the contact it covers.

A patch covers an angle of the circle of radius r about the middle of the contact. Between the radii at which that angle
has a root, r = m - h cos t makes it smooth, and the edge of the contact too.
"""

from dataclasses import dataclass

import numpy as np

from solver.arrays import Array
from solver.stack.electrodereading import STRIP

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(48)


@dataclass(frozen=True, eq=False)
class Covered:
    """Patches of one shape, their lengths over the radius of the contact; (case,) each."""

    shape: int  # Place in ``solver.names.CHOICES["patch"]``
    distance: Array  # Of the patch's middle from that of the contact
    size: Array  # Diameter of a disc, width of a strip

    def rule(self, *, slope: bool) -> tuple[Array, Array]:
        """Radii r within the contact, and weights of an integral over the covered part; (case, node) each.

        ``slope``: of its derivative by the distance.
        """
        ends = np.sort(np.clip(np.stack([*self._ends, 0 * self.size, 0 * self.size + 1], -1), 0.0, 1.0), -1)
        half, middle = (ends[:, 1:] - ends[:, :-1]) / 2, (ends[:, 1:] + ends[:, :-1]) / 2
        angle = np.pi / 2 * (1 + _NODES)
        r = np.asarray(middle[..., None] - half[..., None] * np.cos(angle)).reshape(len(half), -1)
        weights = (half[..., None] * np.sin(angle) * np.pi / 2 * _WEIGHTS).reshape(len(half), -1)
        r = np.clip(r, 1e-300, 1.0)
        with np.errstate(divide="ignore", invalid="ignore"):  # between ends that are one, whose weight is 0
            found = np.where(weights > 0, weights * r * self._angle(r, slope=slope), 0.0)
        return r, found

    @property
    def _ends(self) -> list[Array]:
        """Radii at which the angle has a root."""
        d, half = self.distance, self.size / 2
        return [np.abs(d - half), np.abs(d + half)]

    def _angle(self, r: Array, *, slope: bool) -> Array:
        """Of the circles that the patch covers, or its derivative by the distance."""
        d, half = self.distance[:, None], self.size[:, None] / 2
        if self.shape == STRIP:
            part = _beyond_slope if slope else _beyond
            return np.asarray(part(d - half, r) - part(d + half, r))
        disc = _disc_slope if slope else _disc
        return np.asarray(disc(d, half, r))


def _beyond(x: Array, r: Array) -> Array:
    """Angle of a circle about the origin that lies beyond x."""
    return np.asarray(2 * np.arccos(np.clip(x / r, -1.0, 1.0)))


def _beyond_slope(x: Array, r: Array) -> Array:
    """Derivative of :func:`_beyond` by x."""
    square = (r - x) * (r + x)
    return np.asarray(np.where(square > 0, -2 / np.sqrt(np.abs(square)), 0.0))


def _disc(d: Array, b: Array, r: Array) -> Array:
    """Angle of a circle about the origin that lies in the disc of radius b in the distance d."""
    d = np.abs(d)
    away = np.where(d > 0, d, 1.0)
    share = np.arccos(np.clip((r**2 + d**2 - b**2) / (2 * r * away), -1.0, 1.0))
    return np.asarray(2 * np.where(d > 0, share, np.where(r < b, np.pi, 0.0)))


def _disc_slope(d: Array, b: Array, r: Array) -> Array:
    away, side = np.where(d != 0, np.abs(d), 1.0), np.sign(d)
    root = ((r + away) ** 2 - b**2) * (b**2 - (r - away) ** 2)
    slope = -2 * (away**2 - r**2 + b**2) / (away * np.sqrt(np.abs(root)))
    return np.asarray(np.where((root > 0) & (d != 0), side * slope, 0.0))
