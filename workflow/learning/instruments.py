"""Errors of instruments: a gain near one and an offset near zero, with priors of their sizes."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from approximation.arrays import Array
from surrogate import GaussianProcess
from surrogate.data.measurements import Measurements
from workflow.study import categories


@dataclass(frozen=True)
class Instrument:
    """A gain or an offset of what measures a quantity."""

    quantity: str  # What is measured, without the names of categories: one instrument measures all of them
    gain: bool  # Whether it multiplies (the reading is 1 + gain times as large), or is added
    std: float  # Prior standard deviation: of the gain; of the offset in SI units
    units: str = ""  # Of an offset

    @property
    def family(self) -> str:
        """Kind of the error in words."""
        return "gain" if self.gain else "offset"

    @property
    def name(self) -> str:
        """Name of the instrument's error."""
        return f"{self.quantity}_{self.family}"

    @property
    def prior(self) -> str:
        """The prior in words."""
        return f"+-{100 * self.std:.3g} %" if self.gain else f"+-{self.std:.3g} {self.units}".strip()

    def change(self, z: float) -> str:
        """A scaled value in words."""
        return f"{100 * self.std * z:+.3g} %" if self.gain else f"{self.std * z:+.3g} {self.units}".strip()

    def measures(self, model: GaussianProcess, rows: Measurements) -> NDArray[np.bool_]:
        """Return whether the instrument has read each measured value, (n,)."""
        names = [categories.parted(name)[0] for name in model.outputs_]
        return np.array([names[q] == self.quantity for q in rows.output.tolist()], np.bool_)


def shown(
    instruments: list[Instrument], model: GaussianProcess, rows: Measurements, z: Array, mean: Array, slopes: Array
) -> tuple[Array, Array]:
    """Readings of true means at scaled instruments, (n,), and slopes by constants and instruments, (n, k + m)."""
    gain, offset, columns = np.ones(len(mean)), np.zeros(len(mean)), []
    for instrument, value in zip(instruments, z.tolist(), strict=True):
        column = instrument.std * instrument.measures(model, rows) * (mean if instrument.gain else 1.0)
        columns.append(column)
        if instrument.gain:
            gain += instrument.std * value * instrument.measures(model, rows)
        else:
            offset += value * column
    return gain * mean + offset, np.column_stack([gain[:, None] * slopes, *columns])
