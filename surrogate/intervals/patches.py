"""Boxes about cases that were asked for: there intervals follow the errors of these, not a scale of the whole box.

Cases that lie near one another are a cluster; its box, a little wider, is a patch with a scale of its own: the one with
which the 95 % interval holds of the cases inside, by split conformal prediction (J. Lei et al., J. Am. Stat. Assoc. 113
(2018) 1094). It may be smaller than one, where what was asked for has made the mean better than the box's scale says.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import xarray as xr

from approximation.arrays import Array, Flags, Indices
from surrogate.intervals.guard import CORNER_LEVEL, CORNER_PLACES, SLAB_LEVEL, SLAB_PLACES

#: Two cases of a cluster have others between them, each at most so far from the next along every scaled input.
BETWEEN = 0.1
#: Dimensions of the arrays in a file.
PATCH_DIMS = {
    "patch_low": ("patch", "input"),
    "patch_high": ("patch", "input"),
    "patch_scale": ("patch", "output"),
}
#: Most patches, those of the most places; and the logarithms of scales that one may have.
MOST, BOUNDS = 64, (-8.0, 8.0)


@dataclass(frozen=True)
class Patches:
    """Logarithms of further scales within boxes; the largest of all boxes that hold a point counts."""

    # shape (k, d); Ends of the boxes, in scaled inputs
    low: Array
    high: Array
    scale: Array  # shape (k, p); What is added in each to the logarithm of a standard deviation

    @classmethod
    def about(cls, t: Array, groups: Indices, outputs: int) -> Self:
        """Return the patches about cases, of scale one.

        t: (d, n), scaled coordinates of the cases; groups: (n,), number of the group of every case; a patch needs
        `CORNER_PLACES` of them.
        """
        patches: list[tuple[int, Array]] = []
        for members in _clusters(t):
            if (count := len(np.unique(groups[members]))) >= CORNER_PLACES:
                own = t[:, members]
                # by as much as fresh cases lie beyond the others
                room = 2 * np.ptp(own, axis=1) / np.array([max(len(np.unique(row)) - 1, 1) for row in own])
                patches.append((count, np.stack([own.min(axis=1) - room, own.max(axis=1) + room])))
        patches.sort(key=lambda patch: -patch[0])
        ends = np.reshape([patch for _, patch in patches[:MOST]], (-1, 2, len(t)))
        return cls(ends[:, 0], ends[:, 1], np.zeros((len(ends), outputs)))

    def within(self, t: Array) -> Flags:
        """Return which scaled points, (d, B), lie in which patch: (k, B)."""
        low, high = self.low[..., None], self.high[..., None]
        return np.asarray(((low <= t) & (t <= high)).all(axis=1))

    def at(self, t: Array) -> Array:
        """Return what is added to logarithms at scaled points (d, B): (p, B)."""
        added = np.zeros((self.scale.shape[1], t.shape[1]))
        inside = self.within(t)
        held = np.flatnonzero(inside.any(axis=0))
        if held.size:
            own = np.where(inside[:, held, None], self.scale[:, None], -np.inf)
            added[:, held] = own.max(axis=0).T
        return added

    def fitted(self, beyond: Array, t: Array, groups: Indices) -> Self:
        """Return the patches with the scales that cases ask for.

        beyond: (p, n), by what the 95 % interval must be multiplied so that it ends at the case; t: (d, n), scaled
        coordinates of the cases; groups: (n,), number of the group of every case.
        """
        scale = np.zeros_like(self.scale)
        for own, inside in zip(scale, self.within(t), strict=True):
            count, places = int(np.count_nonzero(inside)), len(np.unique(groups[inside]))
            share = SLAB_LEVEL if places >= SLAB_PLACES else CORNER_LEVEL
            rank = min(count, int(np.ceil((count + 1) * share)))
            needed = np.sort(beyond[:, inside], axis=1)[:, rank - 1]
            with np.errstate(divide="ignore"):
                own[:] = np.where(np.isnan(needed), 0.0, np.clip(np.log(needed), *BOUNDS))
        return replace(self, scale=scale)

    def only(self, columns: Sequence[int]) -> Self:
        """Return those of some outputs."""
        return replace(self, scale=self.scale[:, list(columns)])

    def arrays(self) -> dict[str, Array]:
        """Return the arrays by name."""
        return dict(zip(PATCH_DIMS, (self.low, self.high, self.scale), strict=True))

    @classmethod
    def restore(cls, stored: xr.Dataset, inputs: int, outputs: int) -> Self | None:
        """Return what is in a file, None where it has none."""
        if "calibration_patch_low" not in stored:
            return None
        low, high, scale = (stored[f"calibration_{name}"].values for name in PATCH_DIMS)
        count = len(low)
        fits = low.shape == high.shape == (count, inputs) and scale.shape == (count, outputs)
        if not fits or not 0 < count <= MOST or not (low <= high).all() or not (np.abs(scale) <= BOUNDS[1]).all():
            raise ValueError("the patches of the calibration do not fit the model")
        return cls(low, high, scale)


def _clusters(t: Array) -> list[Indices]:
    """Cases of scaled coordinates (d, n) that chains of near ones join, by cluster."""
    from scipy.sparse import coo_array  # slow to import
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    n = t.shape[1]
    first, second = cKDTree(t.T).query_pairs(BETWEEN, p=np.inf, output_type="ndarray").T
    number = connected_components(coo_array((np.ones(len(first)), (first, second)), shape=(n, n)))[1]
    return [np.flatnonzero(number == own) for own in range(int(number.max(initial=-1)) + 1)]
