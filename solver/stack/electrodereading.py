"""What is read of an electrode: all of it, or patches of it and their neighbours."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, selected
from solver.names import CHOICES
from solver.stack.layers import StackError

#: Places of the shapes of patches.
DISC, STRIP, RING, RECTANGLE = (CHOICES["patch"].index(name) for name in ("disc", "strip", "ring", "rectangle"))

#: Below which punches nothing has a voltage: it would move their charge.
BARE = "below a punch that conducts on a bare surface; electric must be insulating, or electrode top"


Gapped = TypeVar("Gapped")


@dataclass(frozen=True, eq=False)
class Reading:
    """The electrode that is read, and patches of it at zero volts; (case,) each."""

    collector: Array  # Number of the electrode, 1 for the uppermost
    shape: Array  # Of its patches: place in ``solver.names.CHOICES["patch"]``
    position: Array  # Of the patch's middle from that of the contact [m]
    other: Array  # Inner diameter of a ring, length of a rectangle across x [m]; of others 0
    # Diameter of a disc or ring, width of a strip across x or of a rectangle [m]; None: no patches
    size: Array | None = None
    pitch: Array | None = None  # Distance of neighbours [m]; None: no neighbours
    # Number of strips or discs that float on each side; None: all of the electrode is at zero volts
    floating: Array | None = None
    voltage: Array | None = None  # Of the electrode without patches [V]; None: zero

    def part(self, places: Indices) -> "Reading":
        """Some of the cases."""
        return selected(self, places, *vars(self))

    def over(self, length: Array) -> "Reading":
        """With lengths over others [m]."""
        size, pitch = (None if given is None else given / length for given in (self.size, self.pitch))
        return replace(self, position=self.position / length, other=self.other / length, size=size, pitch=pitch)

    def refused(self, *, conducts: bool) -> None:
        """Raise StackError for voltages below a punch that conducts on a bare surface."""
        asked = {"floating_neighbours": self.floating, "electrode_voltage": self.voltage}
        given = [name for name, values in asked.items() if values is not None]
        if given and conducts:
            raise StackError(f"{given[0]}: {BARE}")

    def driven(self, quantities: dict[str, Array]) -> dict[str, Array]:
        """Quantities with the depth under the voltage of the electrode, which moves the whole surface."""
        if self.voltage is None:
            return quantities
        return quantities | {"depth": quantities["depth"] + self.voltage * quantities["electrode_stroke_per_volt"]}

    @property
    def reach(self) -> Array:
        """How far the patches extend from the middle of the contact [m]."""
        if self.size is None:
            return np.zeros_like(self.position)
        pitch = np.zeros_like(self.position) if self.pitch is None else self.pitch
        along = np.maximum(np.abs(self.position), pitch) + self.size / 2
        if self.floating is not None:
            along = along + (self.floating + 1) * pitch
            across = np.where(self.shape == DISC, self.floating * pitch, 0.0)
        else:
            across = np.where(self.shape == RECTANGLE, self.other / 2, 0.0)
        return np.asarray(np.hypot(along, across))

    def gapped(self, made: Callable[[float, float, int], Gapped]) -> tuple[Indices, list[Gapped]]:
        """Which of several each case has, and these, made of size, pitch and number of neighbours."""
        if self.size is None or self.pitch is None or self.floating is None:
            raise ValueError("no neighbours float")
        rows = np.stack([self.size, self.pitch, self.floating], -1)
        own, of_case = np.unique(rows, axis=0, return_inverse=True)
        return of_case.ravel(), [made(size, pitch, int(count)) for size, pitch, count in own.tolist()]
