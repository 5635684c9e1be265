"""Answers at physical points: block by block, their errors scaled and distributed as held-out cases say."""

from collections.abc import Callable

import numpy as np

from approximation.arrays import Array, blocks
from surrogate.data.inputs import physical_points, unit_coordinates
from surrogate.face.core import Core
from surrogate.intervals.calibration import Calibration
from surrogate.intervals.distribution import NOMINAL, Distribution, Normal

# Queries are answered in blocks of this size, so that intermediate arrays stay in cache and memory stays bounded.
BLOCK = 2048


class Physical(Core):
    """A model asked at physical points, with calibrated standard deviations.

    Attributes
    ----------
    calibration_ : Calibration or None
        What `calibrate` has learnt; None before.
    level_ : float
        Level of its intervals where none is said.
    """

    calibration_: Calibration | None
    level_: float = NOMINAL

    def all_mean_std(self, X: Array, with_std: bool) -> tuple[Array, Array | None]:
        """Return the same as `mean_std` at any number of points, block by block: (p, n) each.

        Parameters
        ----------
        X : ndarray, shape (n, d), points in physical units
        with_std : bool, whether deviations are wanted; None otherwise
        """
        mean = np.empty((len(self.outputs_), len(X)))
        std = np.empty_like(mean) if with_std else None
        for block in blocks(len(X), BLOCK):
            mean[:, block], deviation = self.mean_std(X[block], with_std)
            if std is not None and deviation is not None:
                std[:, block] = deviation
        return mean, std

    def mean_std(self, X: Array, with_std: bool) -> tuple[Array, Array | None]:
        """Return the means and calibrated standard deviations at points of any place: (p, B) each.

        Parameters
        ----------
        X : ndarray, shape (B, d), points in physical units
        with_std : bool, whether deviations are wanted; None otherwise
        """
        t, calibration = unit_coordinates(self.inputs_, X), self.calibration_
        mean, variance = self.mean_variance(t, self._weights() if with_std else None)
        if not with_std or variance is None:
            return mean, None
        return mean, np.sqrt(variance) if calibration is None else calibration.std(variance, t)

    def means(self, t: Array) -> Array:
        """Return the means at any number of scaled coordinates (d, n), block by block: (p, n)."""
        return in_blocks(t, lambda block: self.mean_variance(block, None)[0])

    def calibrated_at(self, X: Array) -> Array:
        """Return the scaled coordinates that the calibration knows physical points (n, d) by: (e, n)."""
        return unit_coordinates(self.inputs_, X)

    def variance(self, t: Array, weights: Array) -> Array:
        """Return the variance of `mean_variance`, (p, B).

        Parameters
        ----------
        t : ndarray, shape (d, B), scaled coordinates
        weights : ndarray, shape (parts, p), of the parts of the variance
        """
        variance = self.mean_variance(t, weights)[1]
        return np.zeros((len(self.outputs_), t.shape[1])) if variance is None else variance

    def physical_slopes(self, X: Array, scaled: Callable[[Array], Array]) -> Array:
        """Turn derivatives by scaled coordinates into those by physical inputs.

        Parameters
        ----------
        X : ndarray, shape (n, d)
            Physical points.
        scaled : callable
            Takes scaled coordinates, (d, B); gives derivatives by them, (d, p, B).

        Returns
        -------
        ndarray, shape (d, p, n)
        """
        slopes = np.empty((len(self.inputs_), len(self.outputs_), len(X)))
        for block in blocks(len(X), BLOCK):
            slopes[..., block] = scaled(unit_coordinates(self.inputs_, X[block]))
        return np.asarray(slopes * self.unit_slopes(X))

    def unit_slopes(self, X: Array) -> Array:
        """Return the derivatives of the scaled coordinates by the inputs at physical points (n, d): (d, 1, n)."""
        return np.stack([own.unit_slope(X[:, k]) for k, own in enumerate(self.inputs_)])[:, None]

    def physical(self, t: Array) -> Array:
        """Return the physical points of scaled coordinates, (d, n): (n, d)."""
        return physical_points(self.inputs_, t)

    def slope_stds(self, t: Array) -> Array:
        """Return the calibrated standard deviations of the derivatives by scaled coordinates (d, B): (d, p, B)."""
        std = np.sqrt(np.maximum(self.slope_variances(t, self._weights()), 0))
        return std if self.calibration_ is None else np.asarray(std * self.calibration_.stretch(t))

    @property
    def distribution(self) -> Distribution:
        """Distribution of (truth - mean) / std: what the calibration cases say, a normal one without them."""
        return Normal() if self.calibration_ is None else self.calibration_.distribution

    def checked_level(self, level: float | None) -> float:
        """Return a level that the calibration cases tell, by default `level_`; ValueError as `check_level`."""
        chosen = self.level_ if level is None else level
        self.check_level(chosen)
        return chosen

    def check_level(self, level: float) -> None:
        """Raise ValueError, with what is allowed, for a level of intervals that the calibration cases do not tell."""
        most = self.distribution.highest_level()
        if not 0 < level <= most:
            raise ValueError(f"level {level:g} is not between 0 and {most:.10g}{self._told()}")

    def _told(self) -> str:
        """Who sets the bounds of levels, for messages."""
        if self.calibration_ is None:
            return ""
        return f", all that {self.calibration_.distribution.cases} calibration cases tell"

    def _weights(self) -> Array:
        return np.ones((self.parts, len(self.outputs_))) if self.calibration_ is None else self.calibration_.weights


def in_blocks(t: Array, asked: Callable[[Array], Array]) -> Array:
    """Return what many points give, (p, n), asked for in blocks.

    t: (d, n), scaled coordinates.
    """
    return np.concatenate([asked(t[:, block]) for block in blocks(t.shape[1], BLOCK)], axis=1)
