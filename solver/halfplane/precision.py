"""Rounding error of the surface response, estimated from its difference in two other systems of units.

Against closed forms and 50 digits, for constants 1e18 times apart and up to 1 - 1e-15 of the limiting speed, the
estimate was 45 times too low at worst.
"""

import warnings
from dataclasses import dataclass

import numpy as np

from solver.arrays import Array, outer
from solver.halfplane.surface import HalfPlane

#: Largest estimate without a warning: quantities derived from the tensors may lose 100 times as much.
TOLERATED = 1e-11
_SUSPECT = 1e-13  # the condition of L times the rounding unit; 4e-15 for every built-in material at rest
_UNITS = (1.1, 1.1, 1.7, 0.7), (0.9, 0.9, 0.6, 1.3)  # no powers of two, so that the response rounds in another way


class PrecisionWarning(UserWarning):
    """A solution that rounding has cost more digits than the others."""


@dataclass(frozen=True, eq=False)
class _Rescaled(HalfPlane):
    """A half-plane whose response is computed in other units."""

    units: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)

    @property
    def scale(self) -> Array:
        return super().scale * self.units


def rounding(half: HalfPlane) -> float:
    """Largest estimated relative rounding error of the compliance and the friction coupling over all cases."""
    unit = np.finfo(np.float64).eps
    with np.errstate(all="ignore"):
        if not np.any(half.speed > 0) and unit * np.max(half.condition) <= _SUSPECT:
            return 0.0
        rescaled = [_Rescaled(half.material, half.speed, units=units) for units in _UNITS]
        return max(float(np.max(_difference(half, other))) for other in rescaled)


def _difference(half: HalfPlane, other: HalfPlane) -> Array:
    """Largest difference of an entry relative to the diagonal entries; (...)."""
    size = np.sqrt(np.abs(np.linalg.diagonal(half.compliance)))
    compliance = np.abs(other.compliance - half.compliance) / outer(size)
    coupling = np.abs(other.friction_coupling - half.friction_coupling) / (size * size[..., :1])
    return np.asarray(np.maximum(np.max(compliance, (-2, -1)), np.max(coupling, -1)))


def warn_of_rounding(half: HalfPlane) -> None:
    """Warn by :class:`PrecisionWarning` where rounding costs more than ``TOLERATED``."""
    lost = rounding(half)
    if lost > TOLERATED:
        cause = "a speed so near the limiting one" if np.any(half.speed > 0) else "constants so far apart"
        warnings.warn(
            f"{half.material.name}: {cause} that rounding costs digits: expect relative errors of {lost:.0e} and more",
            PrecisionWarning,
            stacklevel=2,
        )
