"""Maximum of a measure of curves by a scan and Newton's iteration, with derivatives by the scores of the curves."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from approximation.arrays import Array, Indices
from approximation.chebyshev import gauss_points
from approximation.measure import Measure
from approximation.panels import Panels, jets, rows
from approximation.summit import Top, at_bound, climb, gradient_curvature
from surrogate.transforms.curves.basis import Basis

# Most local maxima that are climbed, and how far below the highest they may lie: maxima lie between scanned points
CLIMBED, RIVAL = 4, 0.1


@dataclass(frozen=True, eq=False)
class Landscape:
    """Curves of a low-rank basis on panels."""

    basis: Basis
    panels: Panels

    def summit(self, scores: Array, measure: Measure) -> Top:
        """Return the maximum of a measure of curves with scores (rank, B)."""
        scan, ones = self.panels.scan, np.concatenate([np.ones((1, scores.shape[1])), scores])
        scanned = self._scanned[:, : measure.fields * scan.points.size]
        fields = (ones.T.astype(scanned.dtype) @ scanned).reshape(scores.shape[1], measure.fields, -1)
        hills = scan.hills(measure.values(fields))
        cases = np.arange(len(hills))
        top = hills.argmax(axis=1)
        floor = hills[cases, top]
        floor = floor - RIVAL * np.abs(floor)
        curves, points = [cases], [top]
        for _ in range(CLIMBED - 1):
            hills[cases, top] = -np.inf
            top = hills.argmax(axis=1)
            rival = np.flatnonzero(hills[cases, top] > floor)
            if not rival.size:
                break
            curves.append(rival)
            points.append(top[rival])
        return self._highest(ones, measure, np.concatenate(curves), np.concatenate(points))

    def read(self, scores: Array, summit: Top, field: int) -> Array:
        """Return a field at the maxima `summit` of curves with scores (rank, B): (B,)."""
        out, ones = np.empty(scores.shape[1]), np.concatenate([np.ones((1, scores.shape[1])), scores])
        for number in np.unique(summit.panel).tolist():
            members = np.flatnonzero(summit.panel == number)
            fields = self._fields(ones[:, members], number, slice(field, field + 1))
            out[members] = jets(fields, *self._rows(number, summit, members))[:, 0, 0, 0]
        return out

    def sensitivity(self, scores: Array, measure: Measure, summit: Top, place: int) -> Array:
        """Return derivatives of the maximum, or of field `place` >= 0 at it, by the scores (rank, B): (rank, B)."""
        out = np.empty_like(scores)
        ones = np.concatenate([np.ones((1, scores.shape[1])), scores])
        for number in np.unique(summit.panel).tolist():
            members = np.flatnonzero(summit.panel == number)
            across, down = self._rows(number, summit, members)
            by_score = np.einsum("rfdc,npc,nqd->nrfqp", self._by_panel[number], across, down, optimize=True)
            jet = np.einsum("rn,nrfqp->nfqp", ones[:, members], by_score)
            out[:, members] = self._sensitivity(jet, by_score[:, 1:], measure, place, summit, members).T
        return out

    def _sensitivity(
        self, jet: Array, by_score: Array, measure: Measure, place: int, summit: Top, members: Indices
    ) -> Array:
        """Return derivatives (n, rank) from jets (n, field, 3, 3) of the curves and of the basis functions."""
        inner, parts = jet[:, : measure.fields], by_score[:, :, : measure.fields]
        bent = measure.bent(inner[..., 0, 0])
        if place < 0:  # the measure is stationary at its maximum, so that the maximum's motion has no part
            return np.asarray(np.einsum("nm,nrm->nr", bent.slope, parts[..., 0, 0]))
        gradient, (uu, vv, uv) = gradient_curvature(inner, bent)
        coordinates, counts = (summit.across[members], summit.down[members]), self._shape[::-1]
        free = ~np.stack([at_bound(*axis) for axis in zip(coordinates, gradient, counts, strict=True)], axis=1)
        steep = inner[..., [0, 1], [1, 0]]
        mixed = np.einsum("nm,nrms->nsr", bent.slope, parts[..., [0, 1], [1, 0]])
        mixed += np.einsum("nms,nmk,nrk->nsr", steep, bent.bend, parts[..., 0, 0], optimize=True)
        curvature = np.stack([uu, uv, uv, vv], axis=-1).reshape(-1, 2, 2)
        curvature = np.where(free[:, :, None] & free[:, None], curvature, np.eye(2))
        # the maximum moves so that the gradient stays zero
        moved = -np.linalg.pinv(curvature, hermitian=True) @ np.where(free[..., None], mixed, 0.0)
        return np.asarray(
            by_score[:, :, place, 0, 0]
            + jet[:, place, 0, 1, None] * moved[:, 0]
            + jet[:, place, 1, 0, None] * moved[:, 1]
        )

    def _highest(self, ones: Array, measure: Measure, curves: Indices, points: Indices) -> Top:
        """Return the highest maximum of every curve that is reached from points of the scan on `curves`."""
        scan = self.panels.scan
        panel = scan.panel[points]
        start = scan.across[points], scan.down[points]
        fields = np.empty((points.size, measure.fields, *self._shape))
        for number in np.unique(panel).tolist():
            members = np.flatnonzero(panel == number)
            fields[members] = self._fields(ones[:, curves[members]], number, slice(measure.fields))
        tops = np.stack(climb(fields, measure, start))
        order = np.lexsort((-tops[2], curves))
        best = order[np.searchsorted(curves[order], np.arange(ones.shape[1]))]
        return Top(panel[best], tops[0, best], tops[1, best], tops[2, best])

    def _rows(self, number: int, summit: Top, members: Indices) -> tuple[Array, Array]:
        down, across = self._shape
        return rows(across, summit.across[members]), rows(down, summit.down[members])

    def _fields(self, ones: Array, number: int, fields: slice) -> Array:
        """Return fields on a panel, (n, field, down, across), of curves with scores (rank, n) below a row of ones."""
        panel_fields = self._by_panel[number][:, fields]
        return (ones.T @ panel_fields.reshape(len(panel_fields), -1)).reshape(-1, *panel_fields.shape[1:])

    @cached_property
    def _whole(self) -> Array:
        """Mean and vectors of the basis, (1 + rank, field, point)."""
        return np.concatenate([self.basis.mean[None], self.basis.vectors])

    @cached_property
    def _scanned(self) -> NDArray[np.float32]:
        """Mean and vectors at the points of the scan, (1 + rank, field x point); single precision finds the maxima."""
        scanned = self._whole[..., self.panels.scan.points].reshape(len(self._whole), -1)
        return np.ascontiguousarray(scanned, dtype=np.float32)

    @property
    def _shape(self) -> tuple[int, int]:
        """Largest number of points down and across of a panel."""
        return max(self.panels.down), max(self.panels.across)

    @cached_property
    def _by_panel(self) -> list[Array]:
        """Mean and vectors on every panel at `_shape` points, so that all panels are climbed at once."""
        most_down, most_across = (gauss_points(count) for count in self._shape)
        parts = []
        for down, across, part in self.panels.parts:
            panel_fields = self._whole[..., part].reshape(*self._whole.shape[:2], down, across)
            parts.append(rows(down, most_down)[:, 0] @ panel_fields @ rows(across, most_across)[:, 0].T)
        return parts
