"""Decay of Chebyshev coefficients along one factor: its rate, its noise floor, and whether it betrays a kink."""

from dataclasses import dataclass

import numpy as np

from approximation.arrays import Array

# Coefficients below this share of the largest are rounding of the data.
NOISE = 1e-13
NOISE_LIMIT = 1e-4
# Fewest coefficients above the noise, beyond the first two, that can tell algebraic from geometric decay.
EVIDENCE = 6
# Powers of algebraic decay up to this are taken as a kink (2) or a kink of the slope (3, 4).
POWER = 5.0
# Even and odd functions have every other coefficient zero, or at least this small beside its neighbours.
PARITY = 1e-2
# A rate that the correction for aliases cannot honestly end at.
RUNAWAY = 0.95
# Coefficients beyond the pilot are taken as this many times what the fitted rate gives.
SAFETY = 3.0
# What remains of the error where the coefficients end in noise, in units of its largest coefficient.
FLOOR = 5.0


@dataclass(frozen=True)
class Decay:
    """Coefficients along one factor and what they say."""

    # shape (n,); Largest coefficient of every degree over all lines along the factor, over the output's range
    coefficients: Array
    # shape (n,); The same freed of aliases, each raised to the largest coefficient of its degree or beyond
    envelope: Array
    noise: float  # Level below which coefficients carry no information
    rate: float  # Factor from one coefficient to the next beyond the pilot, 0 where they ended within it
    algebraic: bool  # The coefficients fall like a power of the degree: no tolerance is claimed

    @property
    def affine(self) -> bool:
        """Return True if only noise lies beyond degree one, which two levels cannot show and take for granted."""
        return bool((self.coefficients[2:] <= self.noise).all())

    def error(self, levels: int) -> float:
        """Return the predicted interpolation error over the output's range on a number of levels."""
        tail = self.envelope[levels:]
        known = float(tail[tail > self.noise].sum())
        beyond = max(levels - len(self.envelope), 0)
        geometric = float(self.envelope[-1]) * self.rate ** (beyond + 1) / (1 - self.rate)
        # where the coefficients end in noise, that noise is what remains of the error
        return 2 * (known + SAFETY * geometric) + (0.0 if self.affine else FLOOR * self.noise)


def decay_of(coefficients: Array) -> Decay:
    """Judge the largest coefficients along one factor, over the output's range: shape (n,)."""
    measured = _envelope(coefficients)
    noise = max(NOISE * max(float(coefficients.max()), 1.0), _plateau(measured))
    if len(measured) < 3 or measured[-1] <= noise:
        return Decay(coefficients, measured, noise, 0.0, False)
    if _is_algebraic(measured):
        return Decay(coefficients, measured, noise, _rate(measured), True)
    return Decay(coefficients, *_unaliased(coefficients, measured, noise), algebraic=False)


def _unaliased(coefficients: Array, measured: Array, noise: float) -> tuple[Array, float, float]:
    """Undo what the pilot's own aliasing hides: on n levels the coefficient of degree m is a_m - a_{2n-m}.

    For a singularity on the real axis the two have the same sign, so that the upper coefficients look too small and
    fall too fast. Where the correction runs away they have opposite signs, and the coefficients are on the safe side as
    they are.
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
    """Return the height of the plateau of noise that the coefficients end in, 0 where there is none.

    A plateau is an end of at least four coefficients that fall by less than a third, and by less than a fifth (in the
    logarithm) of what as many before them fell, which was at least a decade: neither a geometric nor a power law does
    so. A plateau above `NOISE_LIMIT` is no noise but roughness.
    """
    logs = np.log(np.maximum(above, np.finfo(np.float64).tiny))
    for start in range(2, len(above) - 3):
        length = len(above) - 1 - start
        before, after = logs[max(start - length, 0)] - logs[start], logs[start] - logs[-1]
        if before > np.log(10) and after < min(0.2 * before, np.log(3)):
            return float(above[start]) if above[start] < NOISE_LIMIT else 0.0
    return 0.0


def _envelope(coefficients: Array) -> Array:
    """Return the largest coefficient of every degree or beyond, (n,): even and odd functions skip every other."""
    filled = coefficients.copy()
    if len(filled) > 3 and max(filled[-1], filled[-3]) < PARITY * filled[-2]:
        filled[-1] = filled[-2]
    return np.asarray(np.maximum.accumulate(filled[::-1])[::-1])


def _rate(above: Array) -> float:
    """Geometric rate of the last half of the coefficients, at least of three."""
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
