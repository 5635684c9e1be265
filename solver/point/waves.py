"""Waves inside a body under point contacts, summed with Bessel functions in the plane of symmetry (points, 7 and 8).

A surface wave in the direction A has the sagittal fields of the plane problem, in the frame of A. Summed over A,
scalars take J_0 and components along x take J_1; the stresses in the surface turn with A and take J_0 and J_2. The
part that goes with cos(angle) has one order more, and the shear waves along the crests.

Shear waves along their crests carry no field: friction makes them. Their u(y) and tau = sigma(crest, y) obey
c44 u'' = c66 k^2 u; downwards they decay as exp(-g k z), g^2 = c66 / c44, with k u = tau / sqrt(c44 c66). Interfaces
are bonded to them, whatever they are to the fields.
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
        """State (k u, tau) of a wave of k u = 1 at its start, at `exponent` = g k distance from it; (2, ...)."""
        size = np.exp(-exponent)
        return np.stack([size, (-size if upward else size) / self.compliance])


@dataclass(frozen=True, eq=False)
class ShearWaves:
    """Shear waves of a stack, of tau = 1 at the surface."""

    stack: Stack
    k: Array

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
            trip = reflection * np.exp(-2 * body.rate * self.k * layer.thickness)
            below = body.compliance * (1 + trip) / (1 - trip)
            reflections.append(reflection)
        return reflections[::-1]

    def at(self, number: int, depth: Array, *, reflected: bool = False) -> Array:
        """State (k u, tau) at depths (depth,) below the surface within a layer, or the base as the last; (2, k, depth).

        ``reflected``: without the wave that the layer's half-space would carry.
        """
        k, top, start = self.k, np.ones(self.k.size), 0.0
        for place, (body, layer) in enumerate(zip(self._bodies, self.stack.layers, strict=True)):
            reflection, once = self._reflections[place], np.exp(-body.rate * k * layer.thickness)
            trip = reflection * once**2
            down = top * body.compliance / (1 - trip)
            if place == number:
                zeta = depth - start
                falls = body.wave(body.rate * k[:, None] * zeta)
                rises = body.wave(body.rate * k[:, None] * (layer.thickness - zeta), upward=True)
                downward = down * trip if reflected else down
                return np.asarray(downward[:, None] * falls + (down * once * reflection)[:, None] * rises)
            top = down * once * (1 - reflection) / body.compliance
            start += layer.thickness
        if self._base is None:
            return np.full((2, k.size, depth.size), np.nan)
        falls = self._base.wave(self._base.rate * k[:, None] * (depth - start))
        return np.asarray((top * self._base.compliance)[:, None] * falls)


#: Bessel functions J_0 to J_3.
ORDERS = 4

_ALONG = (
    "stress_xy",
    "electric_displacement_x",
    "magnetic_induction_x",
    "electric_field_x",
    "magnetic_field_x",
    "strain_xy",
)
_TURNING = ("stress_xx", "stress_zz", "strain_xx")


def rows_of(medium: Medium, scale: Array, names: tuple[str, ...], *, sliding: bool) -> Array:
    """Rows that turn a wave's real form [k u; t], units of the body, into fields of ``LINEAR``; (order, field, 8), SI.

    Potentials are times k.
    """
    half = medium.halfplane
    units = np.concatenate([scale, 1 / scale]) / np.concatenate([half.scale, 1 / half.scale])
    plane = field_rows(half) * units * TURN
    out = np.zeros((ORDERS, len(names), 8))
    for place, name in enumerate(names):
        if name in POTENTIALS:
            channel = 2 + tuple(POTENTIALS).index(name)
            out[1 if sliding else 0, place, channel] = scale[channel]
            continue
        row = plane[LINEAR.index(name)]
        if name in _ALONG:
            in_phase = (1j * row).real
            if sliding:
                out[[0, 2], place] = -in_phase / 2, in_phase / 2
            else:
                out[1, place] = in_phase
        elif name in _TURNING:
            stress_across = plane[LINEAR.index("stress_zz")] if name != "strain_xx" else np.zeros(8)
            stress_along = plane[LINEAR.index("stress_xx")] if name != "strain_xx" else row
            mean, half_difference = ((stress_along + stress_across) / 2).real, ((stress_along - stress_across) / 2).real
            if name == "stress_zz":
                half_difference = -half_difference
            if sliding:
                out[[1, 3], place] = mean + half_difference / 2, -half_difference / 2
            else:
                out[[0, 2], place] = mean, -half_difference
        else:
            out[1 if sliding else 0, place] = row.real
    return out


def shear_rows(body: Sheared, names: tuple[str, ...]) -> Array:
    """Rows that turn (k u, tau) of shear waves, tau = 1 per traction along x, into fields; (order, field, 2), SI."""
    out = np.zeros((ORDERS, len(names), 2))
    of_stretch = {"stress_xx": -body.along / 2, "stress_zz": body.along / 2, "strain_xx": -0.25}
    of_shear = {"stress_xy": 0.5, "strain_xy": 0.25 / body.across}
    for place, name in enumerate(names):
        if name in of_stretch:
            out[[1, 3], place, 0] = of_stretch[name]
        elif name in of_shear:
            out[[0, 2], place, 1] = of_shear[name]
    return out


def parted(names: tuple[str, ...]) -> list[tuple[Indices, bool]]:
    """Indices of the fields that are not potentials, and of the potentials, whose integrals lack a factor k."""
    potentials = np.array([name in POTENTIALS for name in names], dtype=bool)
    parts = [(np.flatnonzero(~potentials), False), (np.flatnonzero(potentials), True)]
    return [part for part in parts if part[0].size]


@dataclass(frozen=True, eq=False)
class Block:
    """Waves of some wavenumbers, with their shares of the integrals."""

    stack: Stack  # Layers and base
    tractions: Tractions  # Of all columns
    columns: Indices  # Those of one radius
    # Over the unit of the body's lengths; (k,)
    k: Array
    shares: Array

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
        """Fields at depths within one body, the base the last; (column, field, depth, x).

        x, depth: (x,) and (depth,), in the unit of the body's lengths; rows_of_parts: (n, field, 8) each, at rest and
        of cos(angle).
        """
        stack = self.stack
        out = np.zeros((len(self.columns), len(names), depth.size, x.size))
        orders = bessel_orders(self.k, x, 3 if self._tops[1] is None else ORDERS) * self.shares[:, None]
        parts = [(part, orders / self.k[:, None] if potentials else orders) for part, potentials in parted(names)]
        for sliding, (top, rows) in enumerate(zip(self._tops, rows_of_parts, strict=True)):
            if top is None:
                continue
            states = self._states(top, depth, number, reflected=reflected)
            for part, weighted in parts:
                for n, J in enumerate(weighted):
                    _add(out, part, rows[n, part], states, J)
            if sliding and not np.isnan(stack.top.material.c12):
                waved = ShearWaves(stack, self.k).at(number, depth, reflected=reflected)
                pulled = np.einsum("skz,kc->kzsc", waved, -top[:, 0]) / stack.scale[0]
                material = stack.layers[number].material if number < len(stack.layers) else stack.base
                assert isinstance(material, Material)
                for n, J in enumerate(orders):
                    _add(out, np.arange(len(names)), shear_rows(Sheared.of(material), names)[n], pulled, J)
        return out

    def _states(self, top: Array, depth: Array, number: int, *, reflected: bool) -> Array:
        """Real form [k u; t] at depths; (k, depth, 8, column)."""
        stack, k, t = self.stack, self.k, top[None].astype(np.complex128)
        start = 0.0
        for place, layer in enumerate(self._layers):
            amplitude = layer.amplitude @ t
            if place == number:
                state = layer_waves(layer, k, (depth - start)[None], amplitude, np.eye(8), reflected=reflected)
                return _real(state)
            start += layer.thickness
            t = below(layer, k, amplitude, stack.grounded[place])
        assert stack.base_medium is not None
        return _real(modal(stack.base_medium, k, (depth - start)[None], t, np.eye(8)))

    @cached_property
    def _layers(self) -> list[LayerWaves]:
        return waves(self.stack, self.k)


def _real(turned: ComplexArray) -> Array:
    """Real form of states with a leading axis of one."""
    return np.asarray((turned[0] * np.conj(TURN)[:, None]).real)


def _add(out: Array, fields: Indices, rows: Array, states: Array, J: Array) -> None:
    """Add rows (field, s) of states (k, depth, s, column) times a Bessel function (k, x) to some fields."""
    present = np.flatnonzero(rows.any(1))
    if present.size:
        values = np.einsum("fs,kzsc->cfzk", rows[present], states, optimize=True)
        out[:, fields[present]] += values @ J
