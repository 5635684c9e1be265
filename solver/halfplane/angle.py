"""The friction angle of a sliding contact, tan(theta) = eta kap / lam (theory section 3), in forms regular at 0."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import exprel

from solver.arrays import Array


@dataclass(frozen=True, eq=False)
class FrictionAngle:
    """The angle and its companions, one number per case."""

    tan: Array

    @cached_property
    def cos(self) -> Array:
        """cos(theta) = sin(pi alpha)."""
        return 1 / np.hypot(1.0, self.tan)

    @cached_property
    def delta(self) -> Array:
        """theta / pi = alpha - 1/2."""
        return np.arctan(self.tan) / np.pi

    @cached_property
    def delta_over_tan(self) -> Array:
        """delta / tan(theta), 1/pi without friction."""
        return self.cos / (np.pi * np.sinc(self.delta))

    @cached_property
    def log_cos_over_tan(self) -> Array:
        """log(cos theta) / tan(theta), 0 without friction."""
        return -self.tan / (2 * exprel(np.log1p(self.tan**2)))
