"""Waves inside a body under point contacts, summed with Bessel functions in the plane of symmetry (points, 7 and 8).

Shear waves along their crests obey c44 u'' = c66 k^2 u with tau = sigma(crest, y) and decay as exp(-g k z), g^2 =
c66 / c44. To them every interface is bonded.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, ComplexArray
from solver.halfplane.interior import LINEAR, POTENTIALS, field_rows
from solver.material.constants import Material
from solver.point.hankel import bessel_orders
from solver.point.tractions import Tractions
from solver.stack.fourier import Medium
from solver.stack.layers import Stack
from solver.stack.reflection import TURN, LayerWaves, below, layer_waves, modal, waves


@dataclass(frozen=True)
class Sheared:
    """Elastic constants of a material for shear waves along crests."""

    # c66 and c44 [Pa]
    along: float
    across: float

    @classmethod
    def of(cls, material: Material) -> "Sheared":
        """Constants of a material with c12, without case axes."""
        return cls(float(material.c11 - material.c12) / 2, float(material.c44))

    @property
    def rate(self) -> float:
        """Decay rate g."""
        return float(np.sqrt(self.along / self.across))

    @property
    def compliance(self) -> float:
        """Compliance k u over tau of the half-space [1/Pa]."""
        return float(1 / np.sqrt(self.along * self.across))

    def wave(self, exponent: Array, *, upward: bool = False) -> Array:
        """State (k u, tau) of a wave of k u = 1 at its start, at ``exponent`` = g k distance from it; (2, ...)."""
        size = np.exp(-exponent)
        return np.stack([size, (-size if upward else size) / self.compliance])


@dataclass(frozen=True, eq=False)
class ShearWaves:
    """Shear waves of a stack, with tau = 1 at the surface."""

    stack: Stack
    k: Array  # Wavenumbers; (k,)

    @cached_property
    def _bodies(self) -> list[Sheared]:
        return [Sheared.of(layer.material) for layer in self.stack.layers]

    @cached_property
    def _base(self) -> Sheared | None:
        return None if isinstance(self.stack.base, str) else Sheared.of(self.stack.base)

    @cached_property
    def _reflections(self) -> list[Array]:
        """Reflection of a wave that arrives at the bottom of each layer; (k,) each."""
        below = np.full(self.k.size, 0.0 if self._base is None else self._base.compliance)
        reflections = []
        for body, layer in zip(self._bodies[::-1], self.stack.layers[::-1], strict=True):
            reflection = (below - body.compliance) / (below + body.compliance)
            round_trip = reflection * np.exp(-2 * body.rate * self.k * layer.thickness)
            below = body.compliance * (1 + round_trip) / (1 - round_trip)
            reflections.append(reflection)
        return reflections[::-1]

    def at(self, number: int, depth: Array, *, reflected: bool = False) -> Array:
        """State (k u, tau) at depths within a layer, or the base as the last, (depth,); (2, k, depth)."""
        # reflected: without the wave that a half-space of the layer would carry
        k, top, start = self.k, np.ones(self.k.size), 0.0
        for index, (body, layer) in enumerate(zip(self._bodies, self.stack.layers, strict=True)):
            reflection, decay = self._reflections[index], np.exp(-body.rate * k * layer.thickness)
            round_trip = reflection * decay**2
            amplitude = top * body.compliance / (1 - round_trip)
            if index == number:
                zeta = depth - start
                down = body.wave(body.rate * k[:, None] * zeta)
                up = body.wave(body.rate * k[:, None] * (layer.thickness - zeta), upward=True)
                downward = amplitude * round_trip if reflected else amplitude
                return np.asarray(downward[:, None] * down + (amplitude * decay * reflection)[:, None] * up)
            top = amplitude * decay * (1 - reflection) / body.compliance
            start += layer.thickness
        if self._base is None:
            return np.full((2, k.size, depth.size), np.nan)
        down = self._base.wave(self._base.rate * k[:, None] * (depth - start))
        return np.asarray((top * self._base.compliance)[:, None] * down)


#: Bessel functions J_0 to J_3.
ORDERS = 4

_ALONG = (
    "stress_xy", "electric_displacement_x", "magnetic_induction_x", "electric_field_x", "magnetic_field_x", "strain_xy",
)  # fmt: skip
_TURNING = ("stress_xx", "stress_zz", "strain_xx")


def rows_of(medium: Medium, scale: Array, names: tuple[str, ...], *, sliding: bool) -> Array:
    """Rows from a wave's real form [k u; t] to fields, SI, potentials times k; (order, field, 8)."""
    # Summed over directions, scalars take J_0, components along x J_1, stresses in the surface J_0 and J_2; the part
    # of cos(angle) has one order more.
    half = medium.halfplane
    units = np.concatenate([scale, 1 / scale]) / np.concatenate([half.scale, 1 / half.scale])
    plane = field_rows(half) * units * TURN
    out = np.zeros((ORDERS, len(names), 8))
    for number, name in enumerate(names):
        if name in POTENTIALS:
            channel = 2 + tuple(POTENTIALS).index(name)
            out[1 if sliding else 0, number, channel] = scale[channel]
            continue
        row = plane[LINEAR.index(name)]
        if name in _ALONG:
            in_phase = (1j * row).real
            if sliding:
                out[[0, 2], number] = -in_phase / 2, in_phase / 2
            else:
                out[1, number] = in_phase
        elif name in _TURNING:
            stress_across = plane[LINEAR.index("stress_zz")] if name != "strain_xx" else np.zeros(8)
            stress_along = plane[LINEAR.index("stress_xx")] if name != "strain_xx" else row
            mean, half_difference = ((stress_along + stress_across) / 2).real, ((stress_along - stress_across) / 2).real
            if name == "stress_zz":
                half_difference = -half_difference
            if sliding:
                out[[1, 3], number] = mean + half_difference / 2, -half_difference / 2
            else:
                out[[0, 2], number] = mean, -half_difference
        else:
            out[1 if sliding else 0, number] = row.real
    return out


def shear_rows(body: Sheared, names: tuple[str, ...]) -> Array:
    """Rows from (k u, tau) of shear waves, tau = 1 per traction along x, to fields, SI; (order, field, 2)."""
    out = np.zeros((ORDERS, len(names), 2))
    of_stretch = {"stress_xx": -body.along / 2, "stress_zz": body.along / 2, "strain_xx": -0.25}
    of_shear = {"stress_xy": 0.5, "strain_xy": 0.25 / body.across}
    for number, name in enumerate(names):
        if name in of_stretch:
            out[[1, 3], number, 0] = of_stretch[name]
        elif name in of_shear:
            out[[0, 2], number, 1] = of_shear[name]
    return out


def parted(names: tuple[str, ...]) -> list[tuple[Indices, bool]]:
    """Indices of the fields that are not potentials, and of the potentials, whose integrals lack a factor k."""
    potentials = np.array([name in POTENTIALS for name in names], dtype=bool)
    parts = [(np.flatnonzero(~potentials), False), (np.flatnonzero(potentials), True)]
    return [part for part in parts if part[0].size]


@dataclass(frozen=True, eq=False)
class Block:
    """Waves of some wavenumbers, with their weights in the integrals."""

    stack: Stack  # Layers and base
    tractions: Tractions  # Of all columns
    columns: Indices  # Columns of one radius
    k: Array  # Wavenumbers per unit of the body's lengths; (k,)
    weights: Array  # (k,)

    @cached_property
    def _tops(self) -> tuple[Array, Array | None]:
        """Tractions at the surface, at rest and of cos(angle), as integrals over b; (k, 4, column) each."""
        return self.tractions.transforms(self.k * float(self.tractions.ratio[self.columns[0]]), self.columns)

    def summed(
        self,
        x: Array,
        depth: Array,
        number: int,
        names: tuple[str, ...],
        rows_of_parts: Sequence[Array],
        *,
        reflected: bool,
    ) -> Array:
        """Fields at ``x`` and ``depth`` within one body, the base the last; (column, field, depth, x)."""
        # x, depth: in the unit of the body's lengths; rows_of_parts: at rest and of cos(angle), (n, field, 8) each
        stack = self.stack
        out = np.zeros((len(self.columns), len(names), depth.size, x.size))
        orders = bessel_orders(self.k, x, 3 if self._tops[1] is None else ORDERS) * self.weights[:, None]
        parts = [(part, orders / self.k[:, None] if potentials else orders) for part, potentials in parted(names)]
        for sliding, (top, rows) in enumerate(zip(self._tops, rows_of_parts, strict=True)):
            if top is None:
                continue
            states = self._states(top, depth, number, reflected=reflected)
            for part, weighted in parts:
                for n, J in enumerate(weighted):
                    _add(out, part, rows[n, part], states, J)
            if sliding and not np.isnan(stack.top.material.c12):
                per_traction = ShearWaves(stack, self.k).at(number, depth, reflected=reflected)
                shear_states = np.einsum("skz,kc->kzsc", per_traction, -top[:, 0]) / stack.scale[0]
                material = stack.layers[number].material if number < len(stack.layers) else stack.base
                assert isinstance(material, Material)
                for shear, J in zip(shear_rows(Sheared.of(material), names), orders, strict=True):
                    _add(out, np.arange(len(names)), shear, shear_states, J)
        return out

    def _states(self, top: Array, depth: Array, number: int, *, reflected: bool) -> Array:
        """Real form [k u; t] at depths; (k, depth, 8, column)."""
        stack, k, t = self.stack, self.k, top[None].astype(np.complex128)
        start = 0.0
        for index, layer in enumerate(self._layers):
            amplitude = layer.amplitude @ t
            if index == number:
                state = layer_waves(layer, k, (depth - start)[None], amplitude, np.eye(8), reflected=reflected)
                return _real(state)
            start += layer.thickness
            t = below(layer, k, amplitude, stack.grounded[index])
        assert stack.base_medium is not None
        return _real(modal(stack.base_medium, k, (depth - start)[None], t, np.eye(8)))

    @cached_property
    def _layers(self) -> list[LayerWaves]:
        return waves(self.stack, self.k)


def _real(states: ComplexArray) -> Array:
    """Real form of states with a leading axis of one."""
    return np.asarray((states[0] * np.conj(TURN)[:, None]).real)


def _add(out: Array, fields: Indices, rows: Array, states: Array, J: Array) -> None:
    """Add rows (field, s) of states (k, depth, s, column), summed with J (k, x), to ``fields`` of ``out``."""
    present = np.flatnonzero(rows.any(1))
    if present.size:
        values = np.einsum("fs,kzsc->cfzk", rows[present], states, optimize=True)
        out[:, fields[present]] += values @ J
