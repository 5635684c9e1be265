"""Fields over panels of which largest values are asked for: what they are called, and their low-rank basis."""

from dataclasses import dataclass
from typing import Self

import numpy as np
import xarray as xr

from approximation.arrays import Array
from approximation.measure import Measure
from approximation.panels import Panels

# Directions that are looked for first, and twice as many as long as they do not suffice.
_FIRST = 32


@dataclass(frozen=True)
class Curves:
    """Fields at the points of panels, in one data set with what is learnt beside them."""

    fields: tuple[str, ...]  # Variables of the data set; a measure takes the first of them
    # For every field the positive variable by which it scales from case to case, learnt by its logarithm; empty where
    # there is none. The fields of a measure share theirs.
    sizes: tuple[str, ...]
    panels: Panels  # Where the points lie
    dim: str  # Dimension of the points

    def shapes(self, data: xr.Dataset) -> Array:
        """Return the fields over their sizes, (case, field, point), cases in the order of their dimensions."""
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
    """An output: the largest measure of curves, or what a field is where it is largest."""

    curves: int  # Number of the curves
    measure: Measure  # What is largest; outputs that share it share the search
    place: int = -1  # Number of the field that is read there; -1: the measure itself


@dataclass(frozen=True, eq=False)
class Basis:
    """Fields as a mean and a few vectors."""

    mean: Array  # shape (field, point); Mean of the training cases
    vectors: Array  # shape (rank, field, point); What every score multiplies
    scales: Array  # shape (field,); Root-mean-square size of every field: over it the vectors are orthonormal

    @classmethod
    def of(cls, values: Array, error: float) -> Self:
        """Return the least basis that holds cases (case, field, point) to a stated error.

        The vectors are the first right singular vectors of the cases, found by random projections from a fixed seed (N.
        Halko et al., SIAM Rev. 53 (2011) 217).
        """
        mean = values.mean(axis=0)
        scales = np.sqrt((values**2).mean(axis=(0, 2)))
        scales[scales == 0] = 1.0
        centred = ((values - mean) / scales[:, None]).reshape(len(values), -1)
        allowed, total = error**2 * centred.size, float((centred**2).sum())
        from sklearn.utils.extmath import randomized_svd  # slow to import: a model from its file needs it not

        most, count = min(centred.shape), _FIRST
        while True:
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
        """Return the error of every score that makes a root-mean-square error of a share of the fields."""
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
