"""Shear waves along their crests in a stack, which carry no field: friction makes them (points, 8).

u(y) and tau = sigma(crest, y) of a wave obey c44 u'' = c66 k^2 u; downwards it decays as exp(-g k z), g^2 = c66 / c44,
with k u = tau / sqrt(c44 c66). Interfaces are bonded, whatever they are to the fields.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array
from solver.material.constants import Material
from solver.stack.layers import Stack


@dataclass(frozen=True)
class Sheared:
    """What a material is to these waves."""

    # c66 and c44 [Pa]
    along: float
    across: float

    @classmethod
    def of(cls, material: Material) -> "Sheared":
        """Of a material with c12, without case axes."""
        return cls(float(material.c11 - material.c12) / 2, float(material.c44))

    @property
    def rate(self) -> float:
        """g."""
        return float(np.sqrt(self.along / self.across))

    @property
    def compliance(self) -> float:
        """k u over tau of the half-space [1/Pa]."""
        return float(1 / np.sqrt(self.along * self.across))

    def wave(self, exponent: Array, *, upward: bool = False) -> Array:
        """(k u, tau) of a wave of k u = 1 at its start, at g k times the distance from it; (2, ...).

        exponent: (...), g k times the distance from the start.
        """
        size = np.exp(-exponent)
        return np.stack([size, (-size if upward else size) / self.compliance])


@dataclass(frozen=True, eq=False)
class ShearWaves:
    """These waves of a stack, of tau = 1 at the surface."""

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
        """What a wave that arrives at the bottom of every layer returns as; (k,) each."""
        below = np.full(self.k.size, 0.0 if self._base is None else self._base.compliance)
        found = []
        for body, layer in zip(self._bodies[::-1], self.stack.layers[::-1], strict=True):
            reflection = (below - body.compliance) / (below + body.compliance)
            trip = reflection * np.exp(-2 * body.rate * self.k * layer.thickness)
            below = body.compliance * (1 + trip) / (1 - trip)
            found.append(reflection)
        return found[::-1]

    def at(self, number: int, depth: Array, *, reflected: bool = False) -> Array:
        """(k u, tau) at depths below the surface within a layer, or the base as the last; (2, k, depth).

        ``reflected``: without what the layer's own half-space would carry.

        depth: (depth,), below the surface, in the unit of the stack's lengths.
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
                own = down * trip if reflected else down
                return np.asarray(own[:, None] * falls + (down * once * reflection)[:, None] * rises)
            top = down * once * (1 - reflection) / body.compliance
            start += layer.thickness
        if self._base is None:
            return np.full((2, k.size, depth.size), np.nan)
        falls = self._base.wave(self._base.rate * k[:, None] * (depth - start))
        return np.asarray((top * self._base.compliance)[:, None] * falls)
