"""Fields over panels whose largest values are outputs, and their low-rank basis."""

from dataclasses import dataclass
from typing import Self

import numpy as np
import xarray as xr

from approximation.arrays import Array
from approximation.measure import Measure
from approximation.panels import Panels

_FIRST = 32  # singular vectors that are computed first; their number is doubled until they suffice


@dataclass(frozen=True)
class Curves:
    """Fields at the points of panels, as variables of the training data."""

    fields: tuple[str, ...]  # names of variables; a measure takes the first of them
    # For every field the positive variable that it is divided by, learnt by its logarithm; empty: none. The fields of
    # a measure have one size.
    sizes: tuple[str, ...]
    panels: Panels
    dim: str  # dimension of the points

    def shapes(self, data: xr.Dataset) -> Array:
        """Return the fields over their sizes, (case, field, point)."""
        whole = []
        for name, size in zip(self.fields, self.sizes, strict=True):
            field = data[name] / data[size] if size else data[name]
            if field.sizes.get(self.dim) != self.panels.size:
                raise ValueError(f"field {name!r} has {field.sizes.get(self.dim)} points of {self.panels.size}")
            values = field.transpose(..., self.dim).values.reshape(-1, self.panels.size)
            if not np.isfinite(values).all():
                raise ValueError(f"field {name!r} is not finite in some case")
            whole.append(values)
        return np.stack(whole, axis=1)


@dataclass(frozen=True)
class Largest:
    """An output: the maximum of a measure of curves, or a field's value at that maximum."""

    curves: int  # number of the curves
    measure: Measure  # outputs with the same measure share the search
    place: int = -1  # number of the field that is read at the maximum; -1: the measure itself


@dataclass(frozen=True, eq=False)
class Basis:
    """Fields as a mean plus vectors times scores."""

    mean: Array  # shape (field, point); mean of the training cases
    vectors: Array  # shape (rank, field, point); orthonormal over `scales`
    scales: Array  # shape (field,); root-mean-square size of every field

    @classmethod
    def of(cls, values: Array, error: float) -> Self:
        """Return the fewest right singular vectors that reproduce cases (case, field, point) to an error."""
        mean = values.mean(axis=0)
        scales = np.sqrt((values**2).mean(axis=(0, 2)))
        scales[scales == 0] = 1.0
        centred = ((values - mean) / scales[:, None]).reshape(len(values), -1)
        allowed, total = error**2 * centred.size, float((centred**2).sum())
        from sklearn.utils.extmath import randomized_svd  # slow to import: a model from its file needs it not

        most, count = min(centred.shape), _FIRST
        while True:  # random projections from a fixed seed: N. Halko et al., SIAM Rev. 53 (2011) 217
            count = min(count, most)
            _, sizes, vectors = randomized_svd(centred, count, n_oversamples=8, n_iter=3, random_state=0)
            left = total - np.cumsum(sizes**2)
            # cancellation leaves no less of the total than its rounding
            modes = int(np.count_nonzero(np.append(total, left[:-1]) > max(allowed, 1e-14 * total)))
            if modes < count or count == most:
                break
            count *= 2
        modes = max(modes, 1)
        return cls(mean, vectors[:modes].reshape(modes, *mean.shape) * scales[:, None], scales)

    def scores(self, values: Array) -> Array:
        """Return the scores of fields, (B, field, point): (rank, B)."""
        weights = self.vectors / self.scales[:, None] ** 2
        return np.asarray(weights.reshape(len(weights), -1) @ (values - self.mean).reshape(len(values), -1).T)

    def error(self, share: float) -> float:
        """Return the error of each score that causes a root-mean-square error of `share` of the fields' sizes."""
        return float(share * np.sqrt(self.mean.size / len(self.vectors)))

    def state(self, number: int) -> dict[str, tuple[tuple[str, ...], Array]]:
        """Return the arrays with their dimensions, for a file."""
        dims = (f"field_{number}", f"curve_point_{number}")
        return {
            f"curve_mean_{number}": (dims, self.mean),
            f"curve_vectors_{number}": ((f"score_{number}", *dims), self.vectors),
            f"curve_scales_{number}": (dims[:1], self.scales),
        }

    @classmethod
    def restore(cls, stored: xr.Dataset, number: int, panels: Panels) -> Self:
        """Return the basis in a file."""
        mean, vectors, scales = (stored[f"curve_{part}_{number}"].values for part in ("mean", "vectors", "scales"))
        fits = vectors.ndim == 3 and vectors.shape[1:] == mean.shape and scales.shape == mean.shape[:1]
        if not fits or mean.shape[-1] != panels.size or not (scales > 0).all():
            raise ValueError(f"the basis of curves {number} does not fit their panels")
        return cls(mean, vectors, scales)
