"""Decay of Chebyshev coefficients along one factor: its rate, its noise floor and signs of a kink."""

from dataclasses import dataclass

import numpy as np

from approximation.arrays import Array

NOISE = 1e-13  # share of the largest coefficient below which coefficients are rounding of the data
NOISE_LIMIT = 1e-4  # height of a plateau above which it is roughness, not noise
EVIDENCE = 6  # fewest coefficients beyond the first two that distinguish algebraic from geometric decay
POWER = 5.0  # largest power of algebraic decay at a kink (2) or at a kink of the slope (3, 4)
PARITY = 1e-2  # ratio to its neighbours below which a coefficient is one that an even or odd function skips
RUNAWAY = 0.95  # rate beyond which the correction for aliases has diverged
SAFETY = 3.0  # factor on the coefficients that the fitted rate gives beyond the pilot
FLOOR = 5.0  # remaining error where the coefficients end in noise, over the noise's largest coefficient


@dataclass(frozen=True)
class Decay:
    """Coefficients of an output along one factor, and their decay."""

    coefficients: Array  # shape (n,); largest of every degree over all lines along the factor, over the output's range
    envelope: Array  # shape (n,); largest coefficients of every degree or higher, without aliases
    noise: float  # height below which coefficients carry no information
    rate: float  # factor from one coefficient to the next beyond the pilot, 0 where they end in noise within it
    algebraic: bool  # the coefficients fall like a power of the degree, so that no tolerance is claimed

    @property
    def affine(self) -> bool:
        """Return True if all coefficients beyond degree one are noise; two levels always appear affine."""
        return bool((self.coefficients[2:] <= self.noise).all())

    def error(self, levels: int) -> float:
        """Return the predicted interpolation error over the output's range on a number of levels."""
        tail = self.envelope[levels:]
        known = float(tail[tail > self.noise].sum())
        beyond = max(levels - len(self.envelope), 0)
        geometric = float(self.envelope[-1]) * self.rate ** (beyond + 1) / (1 - self.rate)
        # where the coefficients end in noise, the noise limits the error
        return 2 * (known + SAFETY * geometric) + (0.0 if self.affine else FLOOR * self.noise)


def decay_of(coefficients: Array) -> Decay:
    """Return the decay of the largest coefficients along one factor, over the output's range, (n,)."""
    measured = _envelope(coefficients)
    noise = max(NOISE * max(float(coefficients.max()), 1.0), _plateau(measured))
    if len(measured) < 3 or measured[-1] <= noise:
        return Decay(coefficients, measured, noise, 0.0, False)
    if _is_algebraic(measured):
        return Decay(coefficients, measured, noise, _rate(measured), True)
    return Decay(coefficients, *_unaliased(coefficients, measured, noise), algebraic=False)


def _unaliased(coefficients: Array, measured: Array, noise: float) -> tuple[Array, float, float]:
    """Return envelope, noise and rate, corrected for aliasing: n levels give a_m - a_{2n-m} in place of a_m.

    For a singularity on the real axis both have the same sign, so that the highest coefficients seem to fall too fast.
    Where the correction diverges they have opposite signs, and the measured coefficients are on the safe side.
    """
    mirror = 2 * (len(measured) - np.arange(len(measured)))
    above, rate = measured, _rate(measured)
    for _ in range(10):
        above = _envelope(coefficients / (1 - rate**mirror))
        rate = _rate(above)
        if rate > RUNAWAY:
            return measured, noise, _rate(measured)
    return above, noise, rate


def _plateau(above: Array) -> float:
    """Return the height of the plateau of noise in which the coefficients end, 0 where there is none.

    A plateau is at least four last coefficients that fall by less than a factor 3, and in the logarithm by less than a
    fifth of the fall of as many before them, which is at least a decade. No geometric or power law does so.
    """
    logs = np.log(np.maximum(above, np.finfo(np.float64).tiny))
    for start in range(2, len(above) - 3):
        length = len(above) - 1 - start
        before, after = logs[max(start - length, 0)] - logs[start], logs[start] - logs[-1]
        if before > np.log(10) and after < min(0.2 * before, np.log(3)):
            return float(above[start]) if above[start] < NOISE_LIMIT else 0.0
    return 0.0


def _envelope(coefficients: Array) -> Array:
    """Return the largest coefficient of every degree or higher, (n,), since even and odd functions skip every other."""
    filled = coefficients.copy()
    if len(filled) > 3 and max(filled[-1], filled[-3]) < PARITY * filled[-2]:
        filled[-1] = filled[-2]
    return np.asarray(np.maximum.accumulate(filled[::-1])[::-1])


def _rate(above: Array) -> float:
    """Return the geometric rate of the last half of the coefficients, of three at least."""
    degrees = np.arange(min(len(above) // 2, len(above) - 3), len(above))
    slope = float(np.polyfit(degrees, np.log(above[degrees]), 1)[0])
    return float(np.clip(np.exp(slope), 1e-6, 0.99))


def _is_algebraic(above: Array) -> bool:
    """Return True if a low power of the degree describes the coefficients better than a geometric law."""
    degrees = np.arange(2, len(above))
    if len(degrees) < EVIDENCE:
        return False
    logs = np.log(above[degrees])
    power, *_ = np.polyfit(np.log(degrees), logs, 1, full=True)
    geometric, *_ = np.polyfit(degrees, logs, 1, full=True)
    misfit_power = float(((np.polyval(power, np.log(degrees)) - logs) ** 2).sum())
    misfit_geometric = float(((np.polyval(geometric, degrees) - logs) ** 2).sum())
    return misfit_power < misfit_geometric and -power[0] < POWER
