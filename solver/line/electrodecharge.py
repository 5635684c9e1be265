"""Charge that a contact along a line brings to an electrode below it, and to strips of it (films, section 11).

With q(k) the rows of an electrode times the transforms of the tractions, a strip of width w in the distance d collects
(1/pi) Re int q exp(ikd) 2 sin(kw/2) dk/k. On top a part of q is v of the tractions at the same place, which the
antiderivatives F of these give: Im F of what presses, Re F of what is sheared.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from functools import partial

import numpy as np

from approximation.arrays import Indices, blocks
from solver.arrays import Array, ComplexArray, joined
from solver.line.contact import FilmContact
from solver.line.similar import Films
from solver.line.windows import Kind, traction_window
from solver.stack.electrodes import Electrode, FarError, Reading, octave_of, transfers
from solver.stack.layers import StackError

_CHARGES_AT_ONCE = 200_000  # transforms of cases at wavenumbers held at once


def electrode_quantities(films: Films, reading: Reading) -> dict[str, Array]:
    """Requested electrode and strip quantities of `solver.names`, SI; (case,)."""
    reading, parts = reading.over(films.thickness), list[tuple[Indices, dict[str, Array]]]()
    for places, window, contact in films.parts:
        part = reading.part(places)
        read = partial(_OfLine, films.kind, window, contact, part, films.thickness[places])
        parts.append((places, together(part, read, contact.half_width)))
    return joined(parts, films.load.size)


def together(reading: Reading, read: Callable[[Indices, int, int], "Collected"], extent: Array) -> dict[str, Array]:
    """Outputs of cases by electrode and by octave of distances, those that all have."""
    octaves, parts = octave_of(reading.reach + extent), list[tuple[Indices, dict[str, Array]]]()
    for number in np.unique(reading.collector).tolist():
        for octave in np.unique(octaves).tolist():
            cases = np.flatnonzero((reading.collector == number) & (octaves == octave))
            if not cases.size:
                continue
            try:
                parts.append((cases, read(cases, int(number), octave).quantities()))
            except FarError as error:
                size = "" if reading.size is None else f"{reading.size[cases].max():.3g} thicknesses of the top layer; "
                raise StackError(f"patch_size: {size}{error}") from None
    return joined(parts, extent.size)


class Collected(ABC):
    """Charge that contacts of either kind bring to one electrode and to patches of it; (case,) each."""

    def __init__(self, electrode: Electrode, reading: Reading, force: Array, loads: Array, thickness: Array) -> None:
        self.electrode, self.reading, self.force, self.thickness = electrode, reading, force, thickness
        self.scale = electrode.stack.scale
        self._whole = -np.einsum("j,cj->c", electrode.whole, loads * self.scale[1:]) / self.scale[2]

    def quantities(self) -> dict[str, Array]:
        """Quantities of ``solver.names.ELECTRODE_QUANTITIES`` that the reading has; by name, SI."""
        reading, force = self.reading, self.force
        out = {
            "electrode_charge_per_force": self._whole / force,
            "electrode_stroke_per_volt": np.full_like(force, self.electrode.stroke),
        }
        if not self.electrode.on_top:
            out["electrode_pressure"] = self._pressure()
        if reading.size is not None:
            out["patch_charge_per_force"] = self._patch(reading.position) / force
        if reading.pitch is not None:
            out["crosstalk"] = self._patch(reading.pitch) / self._patch(np.zeros_like(reading.pitch))
            out["patch_charge_gradient"] = -2 * self._charge(reading.pitch / 2, slope=True) / (self.thickness * force)
        return out

    @abstractmethod
    def _pressure(self) -> Array:
        """Pressure on the electrode below the middle of the contact [Pa]."""

    def _patch(self, distance: Array) -> Array:
        """Charges of patches whose middles are at distances (case,) over the top layer's thickness."""
        return self._charge(distance, slope=False)

    @abstractmethod
    def _charge(self, distance: Array, *, slope: bool) -> Array:
        """Charges of patches without friction at distances, or their derivatives by these."""

    @property
    def _size(self) -> Array:
        return np.zeros_like(self.force) if self.reading.size is None else self.reading.size


class _OfLine(Collected):
    """Cases of one window and electrode whose distances are of like size; lengths over the top layer's thickness."""

    def __init__(
        self, kind: Kind, window: int, contact: FilmContact, reading: Reading, thickness: Array,
        cases: Indices, number: int, octave: int,
    ) -> None:  # fmt: skip
        stack, loads = kind.stack, np.concatenate([contact.load[:, None], contact.charges], -1)[cases]
        super().__init__(Electrode(stack, number), reading.part(cases), contact.load[cases], loads, thickness[cases])
        if self.electrode.on_top and reading.size is None:
            return
        self.k, self.weights, rows = transfers(stack, number, octave)
        self.tractions = traction_window(kind, window).read(contact).part(cases)
        self.carried: ComplexArray = np.empty((cases.size, 2, self.k.size), np.complex128)
        step = max(_CHARGES_AT_ONCE // self.k.size, 1)
        for block in blocks(cases.size, step):
            transforms = self.tractions.part(block).in_fourier_space(self.k)[..., 0]
            self.carried[block] = np.einsum("ckt,krt->crk", transforms, rows) / stack.scale[2]

    def _pressure(self) -> Array:
        pressure = -np.sum(self.carried[:, 1].real * self.weights, -1) / np.pi
        return np.asarray(pressure * self.scale[2] / self.scale[1])

    def _charge(self, distance: Array, *, slope: bool) -> Array:
        wave = (1j * self.k if slope else 1.0) * np.exp(1j * self.k * distance[:, None])
        share = 2 * np.sin(self.k * self._size[:, None] / 2) / self.k
        return np.asarray(np.sum((self.carried[:, 0] * wave).real * share * self.weights, -1)) / np.pi
