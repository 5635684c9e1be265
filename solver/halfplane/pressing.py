"""Extent of the contact and shape of the pressure under a punch with a given load (theory, sections 3 and 4).

With x = c + h X, the slope is ``g' = s G(X)``, the pressure ``sigma_yy = (s / lam) S(X)`` and the load
``P = -(h s / lam) int S dX``. Two smooth edges add a balance, a corner has a given position.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import comb

import numpy as np

from solver.arrays import Array, power_series, stack
from solver.halfplane.profile import Profile
from solver.halfplane.shape import Shape, imbalance
from solver.halfplane.sliding import FrictionAngle

_NEWTON_STEPS = 100
_TOLERANCE = 4e-16
_TENSION = 1e-12  # of the largest factor of the pressure: rounding at the limit of tension
_SAMPLES = np.cos(np.pi * np.arange(257) / 256)
_NO_ODD_POWER = (
    "slope: an even power of x alone has no smooth edge on one side; a punch without corners needs an odd one"
)


class ContactError(ValueError):
    """A punch and a load without a contact of the theory."""


@dataclass(frozen=True, eq=False)
class Pressing:
    """A pressed punch; rates are derivatives in log P at fixed charges."""

    half_width: Array  # h [m]; (...)
    centre: Array  # c / h; (...)
    slope_scale: Array  # s [1]; (...)
    slope: Array  # Coefficients of G, ascending powers of X; (..., k)
    slope_rate: Array  # Those of d(s G)/dlogP / s at fixed X, where h is fixed; (..., k)
    shape: Shape  # S
    shape_rate: Shape  # d(s S)/dlogP / s at fixed X
    width_rate: Array  # dlog h/dlog P; (...)
    centre_rate: Array  # d(c/h)/dlog P; (...)

    @property
    def rise(self) -> Array:
        """Height g of the punch at the trailing edge over its origin [m]; (...)."""
        return self.half_width * self.slope_scale * _integral(self.slope, -self.centre)

    @property
    def rise_rate(self) -> Array:
        """Derivative of :attr:`rise` by log P [m]; (...)."""
        edge = self.centre + 1
        moved = sum(_by_power(self.slope)) * (self.width_rate * edge + self.centre_rate)
        turned = _integral(self.slope_rate, -self.centre) if np.any(self.slope_rate) else 0.0
        return np.asarray(self.half_width * self.slope_scale * (moved + turned))


def press(profile: Profile, angle: FrictionAngle, lam: Array, load: Array) -> Pressing:
    """Return the contact of a profile under a load (...) [N/m]."""
    if profile.width is not None:
        pressing = _between_corners(profile, profile.width, angle, lam, load)
    elif profile.homogeneous:
        pressing = _similar(profile, angle, lam, load)
    else:
        pressing = _searched(profile, angle, lam, load)
    _refuse_tension(pressing)
    return pressing


def _between_corners(profile: Profile, width: Array, angle: FrictionAngle, lam: Array, load: Array) -> Pressing:
    """Return the contact between two corners: the pressure of the slope, and that of the flat punch with the load."""
    half, smooth = width / 2, profile.smooth
    scale = lam * load / half
    flat = Shape(angle, smooth, np.ones(1))
    carried = -1 / flat.total
    slope = stack(*(c * half**k for k, c in enumerate(profile.slope))) / scale[..., None]
    rate = np.zeros(1)
    if profile.moment is not None:
        tilted = Shape.of_slope(angle, smooth, [np.ones(())]).first_moment
        slope = np.array(slope + np.zeros((*np.shape(profile.moment / load + half + tilted + carried), 1)))
        slope[..., 0] = 0.0
        untilted = Shape.of_slope(angle, smooth, _by_power(slope)).first_moment + flat.first_moment * carried
        slope[..., 0] = (-profile.moment / (half * load) - untilted) / tilted
        rate = (-flat.first_moment * carried / tilted)[..., None]

    def shape(coefficients: Array) -> Shape:
        factor = Shape.of_slope(angle, smooth, _by_power(coefficients)).factor
        factor = np.array(factor + np.zeros((*np.shape(carried), 1)))
        factor[..., 0] += carried
        return Shape(angle, smooth, factor)

    zero = np.zeros(())
    return Pressing(half, zero, scale, slope, rate, shape(slope), shape(rate), zero, zero)


def _similar(profile: Profile, angle: FrictionAngle, lam: Array, load: Array) -> Pressing:
    """Return the contact of g' = gamma x^n, whose c / h and shape depend on the friction angle only; h^(n+1) ~ P."""
    n, gamma = len(profile.slope) - 1, profile.slope[-1]
    centre = _centre(profile.smooth, angle, n)
    sign = np.sign(gamma)
    if np.all(sign == sign.flat[0]):
        sign = np.asarray(sign.flat[0])  # the shape of a cylinder is then that of all cases
    slope = [sign * term for term in _shifted_power(centre, n)]
    shape = Shape.of_slope(angle, profile.smooth, slope)
    carried = -shape.total
    if not np.all(carried > 0):
        raise ContactError("slope: the punch does not widen upwards from its lowest point: it carries no load")
    half = (lam * load / (np.abs(gamma) * carried)) ** (1 / (n + 1))
    rate = np.array(1 / (n + 1))
    shape_rate = Shape(angle, profile.smooth, n * rate * shape.factor)
    slope_rate = np.zeros(1)  # G keeps its form in x
    scale, centre_rate = np.abs(gamma) * half**n, np.zeros(())
    return Pressing(half, centre, scale, stack(*slope), slope_rate, shape, shape_rate, rate, centre_rate)


def _centre(smooth: tuple[bool, bool], angle: FrictionAngle, n: int) -> Array:
    """c / h under the slope (X + c/h)^n by Newton's iteration, in closed form for n = 1; (...)."""
    if not all(smooth):
        return np.array(1.0 if smooth[0] else -1.0)
    centre = -2 * angle.delta
    if n % 2 == 0:
        raise ContactError(_NO_ODD_POWER)
    for _ in range(_NEWTON_STEPS if n > 1 else 0):
        value, rate = (imbalance(angle, _shifted_power(centre, power)) for power in (n, n - 1))
        step = value / (n * rate)
        centre = centre - step
        if np.all(np.abs(step) <= _TOLERANCE):
            break
    return centre


def _searched(profile: Profile, angle: FrictionAngle, lam: Array, load: Array) -> Pressing:
    """Return the contact of any other slope, by Newton's iteration on log h and c / h from that of its top power."""
    half, centre = _first_guess(profile, angle, lam, load)
    for _ in range(_NEWTON_STEPS):
        (width_step, centre_step), _ = _newton(profile, angle, lam * load, half, centre)
        half = half * np.exp(-np.clip(width_step, -2, 2))
        centre = centre - np.clip(centre_step, -1, 1)
        if np.all(np.abs(width_step) + np.abs(centre_step) <= 64 * _TOLERANCE):
            break
    else:
        raise ContactError("slope: no contact of this punch carries the load")
    _, (width_rate, centre_rate) = _newton(profile, angle, lam * load, half, centre)
    value, by_width, by_centre = slopes(profile.slope, half, centre)
    change = width_rate[..., None] * by_width + centre_rate[..., None] * by_centre
    shape, shape_rate = (Shape.of_slope(angle, profile.smooth, _by_power(g)) for g in (value, change))
    return Pressing(half, centre, np.ones(()), value, np.zeros(1), shape, shape_rate, width_rate, centre_rate)


def _first_guess(profile: Profile, angle: FrictionAngle, lam: Array, load: Array) -> tuple[Array, Array]:
    """h and c / h under the highest power of the slope that has a contact without the others; (...) of all cases."""
    powers = [k for k, c in enumerate(profile.slope) if np.any(c) and (k % 2 or not all(profile.smooth))]
    if not powers:
        raise ContactError(_NO_ODD_POWER)
    n = powers[-1]
    pressing = _similar(Profile((*(np.zeros(()),) * n, profile.slope[n]), profile.smooth), angle, lam, load)
    half, centre, *_ = np.broadcast_arrays(pressing.half_width, pressing.centre, load, *profile.slope)
    return half, centre


def _newton(
    profile: Profile, angle: FrictionAngle, loaded: Array, half: Array, centre: Array
) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Newton's steps in log h and c / h, to be subtracted, and derivatives of both by log P; (...) each."""
    # the equations are that of the load, loaded = lam P, and the balance of smooth edges
    moments = [_by_power(g) for g in slopes(profile.slope, half, centre)]
    total, by_width, by_centre = (Shape.of_slope(angle, profile.smooth, g).total for g in moments)
    if not np.all(total < 0):
        raise ContactError("slope: no contact of this punch carries the load without tension")
    miss = np.log(-half * total / loaded)
    in_width, in_centre = 1 + by_width / total, by_centre / total
    off, off_in_width, off_in_centre = 0 * miss, 0 * miss, 1 + 0 * miss  # a corner fixes the centre
    if all(profile.smooth):
        off, off_in_width, off_in_centre = (imbalance(angle, g) for g in moments)
    determinant = in_width * off_in_centre - in_centre * off_in_width
    width_step = (miss * off_in_centre - in_centre * off) / determinant
    centre_step = (in_width * off - miss * off_in_width) / determinant
    return (width_step, centre_step), (off_in_centre / determinant, -off_in_width / determinant)


def slopes(slope: Sequence[Array], half: Array, centre: Array) -> tuple[Array, Array, Array]:
    """Coefficients of g'(h (X + c/h)) in powers of X, and of its derivatives by log h and c / h; (..., power) each."""
    terms = [coefficient * half**k for k, coefficient in enumerate(slope)]
    in_width = [k * term for k, term in enumerate(terms)]
    size = len(terms)
    return _shifted(terms, centre, size), _shifted(in_width, centre, size), _shifted(in_width[1:], centre, size)


def _shifted(terms: Sequence[Array], centre: Array, size: int) -> Array:
    """Coefficients of sum_k terms[k] (X + centre)^k in powers of X, with zeros up to a size; (..., size)."""
    out: Array = np.zeros((*np.broadcast_shapes(centre.shape, *(term.shape for term in terms)), size))
    for k, term in enumerate(terms):
        out[..., : k + 1] += term[..., None] * stack(*_shifted_power(centre, k))
    return out


def _refuse_tension(pressing: Pressing) -> None:
    """Refuse contacts with a positive sigma_yy."""
    coefficients = pressing.shape.factor
    samples = _SAMPLES if coefficients.shape[-1] > 1 else _SAMPLES[:1]
    factor = power_series(coefficients, samples)
    if np.any(np.max(factor, -1) > _TENSION * np.max(np.abs(factor), -1)):
        raise ContactError("contact: it would need tension between punch and surface (too much tilt or moment)")


def _shifted_power(centre: Array, n: int) -> list[Array]:
    """Coefficients of (X + centre)^n in powers of X, (...) each; the last is 1."""
    return [*(comb(n, k) * centre ** (n - k) for k in range(n)), np.ones(())]


def _by_power(coefficients: Array) -> list[Array]:
    """Split coefficients (..., k) into one array (...) for each power."""
    return [*np.moveaxis(coefficients, -1, 0)]


def _integral(coefficients: Array, low: Array) -> Array:
    """Integral from low to 1 of a polynomial in X with coefficients (..., k); (...)."""
    terms = [coefficients[..., k] * (1 - low ** (k + 1)) / (k + 1) for k in range(coefficients.shape[-1])]
    return np.asarray(sum(terms, np.zeros(())))
