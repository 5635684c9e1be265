"""Distributions of (truth - mean) / std: standard normal before a calibration, tabulated quantiles after it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self, TypeAlias

import numpy as np
import scipy  # scipy.special, slow to import, and not every job asks for intervals

from approximation.arrays import Array

NOMINAL = 0.95  # default level of intervals, which calibrations make hold everywhere
# Central levels of the tabulated quantiles; the last one gives the extremes of the cases.
LEVELS = (0.0, 0.25, 0.5, 0.6827, 0.8, 0.9, NOMINAL, 0.98, 0.99, 0.999, 1.0)
ONE_STD = LEVELS[3]  # central level of one standard deviation to either side
# Both ends of the central levels as probabilities, ascending.
PROBABILITIES = np.array([(1 - level) / 2 for level in reversed(LEVELS)] + [(1 + level) / 2 for level in LEVELS[1:]])


def central(level: float) -> Array:
    """Return the probabilities at the ends of a central interval."""
    return np.array([(1 - level) / 2, (1 + level) / 2])


class Normal:
    """The standard normal distribution, of every output."""

    def highest_level(self) -> float:
        """Return the largest central level, just below one."""
        return float(np.nextafter(1.0, 0.0))

    def quantile(self, q: Array) -> Array:
        """Return quantiles at probabilities q of any shape: (..., 1)."""
        return np.asarray(scipy.special.ndtri(q))[..., None]

    def ends(self, level: float) -> Array:
        """Return the lower and upper end of the central interval of a level: (2, 1)."""
        return self.quantile(central(level))

    def inverse(self, q: Array) -> Array:
        """Return quantiles at probabilities q of any shape, in that shape."""
        return np.asarray(scipy.special.ndtri(q))

    def cdf(self, z: Array) -> Array:
        """Return the probability of values up to z, any shape."""
        return np.asarray(scipy.special.ndtr(z))

    def crps(self, z: Array) -> Array:
        """Return the continuous ranked probability score at z, any shape, in standard deviations."""
        # T. Gneiting and A. E. Raftery, J. Am. Stat. Assoc. 102 (2007) 359, equation 21
        return np.asarray(
            z * (2 * scipy.special.ndtr(z) - 1) + np.sqrt(2 / np.pi) * np.exp(-0.5 * z * z) - 1 / np.sqrt(np.pi)
        )


@dataclass(frozen=True)
class Tabulated:
    """Quantiles of held-out cases, linear between `PROBABILITIES`."""

    quantiles: Array  # shape (len(PROBABILITIES), p); ascending
    cases: int  # number of the held-out cases

    @classmethod
    def of(cls, scores: Array) -> Self:
        """Return the distribution of scores, (p, n)."""
        levels = np.abs(2 * PROBABILITIES - 1)
        # a little more than the level, since the calibration is fitted to the same cases
        corrected = 1 - (1 - levels) * (1 - 0.3 * levels**12)
        # of n + 1 exchangeable scores a share p does not exceed the sorted score number p (n + 1) - 1, from 0
        # (R. J. Hyndman and Y. Fan, Am. Stat. 50 (1996) 361, definition 6)
        position = (1 + np.sign(PROBABILITIES - 0.5) * corrected) / 2 * (scores.shape[1] + 1) - 1
        ordered = np.sort(scores, axis=1)
        places = np.arange(scores.shape[1])
        return cls(np.stack([np.interp(position, places, row) for row in ordered], axis=1), scores.shape[1])

    def highest_level(self) -> float:
        """Return the largest central level whose ends lie within n cases, 1 - 2/(n + 1), at most 0.999."""
        return min(LEVELS[-2], 1 - 2 / (self.cases + 1))

    def quantile(self, q: Array) -> Array:
        """Return quantiles at probabilities q of any shape: (..., p)."""
        q = np.clip(q, 0, 1)
        k = np.minimum(PROBABILITIES.searchsorted(q, side="right") - 1, len(PROBABILITIES) - 2)
        below, first = self.quantiles[k], PROBABILITIES[k]
        slope = (self.quantiles[k + 1] - below) / (PROBABILITIES[k + 1] - first)[..., None]
        return np.asarray(slope * (q - first)[..., None] + below)

    def ends(self, level: float) -> Array:
        """Return the lower and upper end of the central interval of a level: (2, p)."""
        return self.quantile(central(level))

    def inverse(self, q: Array) -> Array:
        """Return the quantiles of every output at its own probabilities, (p, n)."""
        return np.stack([np.interp(row, PROBABILITIES, z) for row, z in zip(q, self.quantiles.T, strict=True)])

    def cdf(self, z: Array) -> Array:
        """Return the probability of values up to z, (p, n)."""
        return np.stack([np.interp(row, ends, PROBABILITIES) for row, ends in zip(z, self.quantiles.T, strict=True)])

    def crps(self, z: Array) -> Array:
        """Return the integral of (F(x) - (x >= z))^2 over x at z, (p, n); F is linear between the quantiles."""
        out = np.empty_like(z)
        for row, values, quantiles in zip(out, z, self.quantiles.T, strict=True):
            F, wide = PROBABILITIES, np.diff(quantiles)
            # integrals of F^2 up to every quantile, and of (1 - F)^2 from it on
            below = np.append(0, np.cumsum(_square(wide, F[:-1], F[1:])))
            above = np.append(np.cumsum(_square(wide, 1 - F[:-1], 1 - F[1:])[::-1])[::-1], 0)
            inside = np.clip(values, quantiles[0], quantiles[-1])
            k = np.clip(np.searchsorted(quantiles, inside, side="right") - 1, 0, len(quantiles) - 2)
            probability = np.interp(inside, quantiles, F)
            left = below[k] + _square(inside - quantiles[k], F[k], probability)
            right = above[k + 1] + _square(quantiles[k + 1] - inside, 1 - probability, 1 - F[k + 1])
            row[:] = left + right + np.abs(values - inside)
        return out

    def only(self, columns: Sequence[int]) -> Self:
        """Return the distributions of the outputs `columns`."""
        return replace(self, quantiles=self.quantiles[:, list(columns)])


#: Distribution of (truth - mean) / std for every output.
Distribution: TypeAlias = Normal | Tabulated


def _square(width: Array, first: Array, last: Array) -> Array:
    """Return the integral over a width of the square of a function that is linear between two values."""
    return np.asarray(width * (first * first + first * last + last * last) / 3)
