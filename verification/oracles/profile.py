"""Rigid punch profiles for the collocation oracle: a slope and the places of the corners."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from verification.oracles.surface_response import Array


@dataclass(frozen=True)
class Profile:
    """A rigid punch."""

    slope: Callable[[Array], Array]  # dg/dx [1] at x [m], arrays
    # Place x [m] of the right and of the left edge where the punch has its corner there; None for a smooth edge
    sharp_trailing: float | None = None
    sharp_leading: float | None = None

    @property
    def smooth(self) -> bool:
        """Return True if both edges are smooth."""
        return self.sharp_trailing is None and self.sharp_leading is None

    @property
    def sharp(self) -> bool:
        """Return True if both edges are sharp."""
        return self.sharp_trailing is not None and self.sharp_leading is not None


def cylinder(radius: float) -> Profile:
    """Circular punch in the parabolic approximation of theory section 1."""
    return Profile(lambda x: x / radius)


def circle(radius: float) -> Profile:
    """The circle itself, for which there is no closed form: here the number of terms matters."""
    return Profile(lambda x: x / np.sqrt(radius**2 - x**2))


def flat(width: float, tilt: float = 0.0) -> Profile:
    """Flat punch centred on x = 0."""
    return Profile(lambda x: np.full_like(x, tilt), width / 2, -width / 2)


def wedge(slope: float, corner: str = "leading") -> Profile:
    """Triangular punch with its corner at x = 0."""
    return _cornered(lambda x: np.full_like(x, slope if corner == "leading" else -slope), corner)


def half_cylinder(radius: float, corner: str = "leading") -> Profile:
    """Half of the cylinder with its corner at x = 0."""
    return _cornered(lambda x: x / radius, corner)


def _cornered(slope: Callable[[Array], Array], corner: str) -> Profile:
    return Profile(slope, sharp_leading=0.0) if corner == "leading" else Profile(slope, sharp_trailing=0.0)
