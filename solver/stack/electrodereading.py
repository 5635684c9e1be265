"""The electrode that a case reads: all of it, or a patch of it and the patch beside that."""

from dataclasses import dataclass, replace

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, selected
from solver.names import CHOICES

#: Indices of the shapes of patches among ``solver.names.CHOICES["patch"]``.
DISC, STRIP = (CHOICES["patch"].index(name) for name in ("disc", "strip"))


@dataclass(frozen=True, eq=False)
class Reading:
    """Electrode that each case reads, and patches of it at zero volts; (case,) each."""

    collector: Array  # Number of the electrode, 1 for the uppermost
    shape: Array  # Of its patches: place in ``solver.names.CHOICES["patch"]``
    position: Array  # Of the patch's middle from that of the contact [m]
    size: Array | None = None  # Diameter of a disc, width of a strip across x [m]; None: no patches
    pitch: Array | None = None  # Distance of neighbours [m]; None: no neighbours

    def part(self, places: Indices) -> "Reading":
        """Some of the cases."""
        return selected(self, places, *vars(self))

    def over(self, length: Array) -> "Reading":
        """Return the reading with its lengths over `length` [m], (case,)."""
        size, pitch = (None if values is None else values / length for values in (self.size, self.pitch))
        return replace(self, position=self.position / length, size=size, pitch=pitch)

    @property
    def reach(self) -> Array:
        """Distance from the middle of the contact to the farthest point of the patches [m]; (case,)."""
        if self.size is None:
            return np.zeros_like(self.position)
        pitch = np.zeros_like(self.position) if self.pitch is None else self.pitch
        return np.asarray(np.maximum(np.abs(self.position), pitch) + self.size / 2)
