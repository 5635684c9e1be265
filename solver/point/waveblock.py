"""Waves of some wavenumbers inside a body under point contacts, summed with Bessel functions (points, 7)."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, ComplexArray
from solver.material.constants import Material
from solver.point.bessel import bessel_orders
from solver.point.shear import Sheared, ShearWaves
from solver.point.tractions import Tractions
from solver.point.wavefields import ORDERS, parted, shear_rows
from solver.stack.layers import Stack
from solver.stack.layerwaves import TURN, below, layer_waves, modal
from solver.stack.reflection import LayerWaves, waves


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
        """Tractions at the surface, of 1 and of cos(angle), but for the sums over b; (k, 4, column) each."""
        return self.tractions.transforms(self.k * float(self.tractions.ratio[self.columns[0]]), self.columns)

    def summed(
        self, x: Array, depth: Array, number: int, names: tuple[str, ...], taken: Sequence[Array], *, reflected: bool
    ) -> Array:
        """Fields at depths within one body, the base the last; (column, field, depth, x).

        x, depth: (x,) and (depth,), in the unit of the body's lengths; taken: (n, field, 8) each, rows of the fields:
        at rest, and of cos(angle).
        """
        stack = self.stack
        out = np.zeros((len(self.columns), len(names), depth.size, x.size))
        orders = bessel_orders(self.k, x, 3 if self._tops[1] is None else ORDERS) * self.shares[:, None]
        parts = [(part, orders / self.k[:, None] if potentials else orders) for part, potentials in parted(names)]
        for sliding, (top, rows) in enumerate(zip(self._tops, taken, strict=True)):
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
        """The real form [k u; t] at depths; (k, depth, 8, column)."""
        stack, k, t = self.stack, self.k, top[None].astype(np.complex128)
        start = 0.0
        for place, layer in enumerate(self._layers):
            amplitude = layer.amplitude @ t
            if place == number:
                found = layer_waves(layer, k, (depth - start)[None], amplitude, np.eye(8), reflected=reflected)
                return _real(found)
            start += layer.thickness
            t = below(layer, k, amplitude, stack.grounded[place])
        assert stack.base_medium is not None
        return _real(modal(stack.base_medium, k, (depth - start)[None], t, np.eye(8)))

    @cached_property
    def _layers(self) -> list[LayerWaves]:
        return waves(self.stack, self.k)


def _real(turned: ComplexArray) -> Array:
    return np.asarray((turned[0] * np.conj(TURN)[:, None]).real)


def _add(out: Array, fields: Indices, rows: Array, states: Array, J: Array) -> None:
    """Add rows (field, s) of states (k, depth, s, column) times a Bessel function (k, x) to some fields."""
    there = np.flatnonzero(rows.any(1))
    if there.size:
        taken = np.einsum("fs,kzsc->cfzk", rows[there], states, optimize=True)
        out[:, fields[there]] += taken @ J
