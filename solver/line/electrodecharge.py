"""Charge that a contact along a line induces on an electrode below it, and on strips of it (films, F11.3)."""

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
    for cases, window, contact in films.parts:
        part = reading.part(cases)
        read = partial(_OfLine, films.kind, window, contact, part, films.thickness[cases])
        parts.append((cases, together(part, read, contact.half_width)))
    return joined(parts, films.load.size)


def together(reading: Reading, read: Callable[[Indices, int, int], "Collected"], extent: Array) -> dict[str, Array]:
    """Compute cases by electrode and octave of distances, and return the outputs that all have; (case,) each."""
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
    """Charge that contacts along a line or at a point induce on one electrode and on patches of it; (case,) each."""

    def __init__(self, electrode: Electrode, reading: Reading, force: Array, loads: Array, thickness: Array) -> None:
        self.electrode, self.reading, self.force, self.thickness = electrode, reading, force, thickness
        self.scale = electrode.stack.scale
        self._whole = -np.einsum("j,cj->c", electrode.whole, loads * self.scale[1:]) / self.scale[2]

    def quantities(self) -> dict[str, Array]:
        """Return the quantities of ``solver.names.ELECTRODE_QUANTITIES`` that the reading asks for, SI."""
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
        """Charges of patches centred at distances (case,) over the top layer's thickness [C or C/m]; (case,)."""
        return self._charge(distance, slope=False)

    @abstractmethod
    def _charge(self, distance: Array, *, slope: bool) -> Array:
        """Charges of patches at distances (case,), or their derivatives by the distance."""

    @property
    def _size(self) -> Array:
        """Size of the patches over the top layer's thickness, 0 without patches; (case,)."""
        return np.zeros_like(self.force) if self.reading.size is None else self.reading.size


class _OfLine(Collected):
    """Contacts along a line of one window, electrode and octave of distances, over the top layer's thickness."""

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
