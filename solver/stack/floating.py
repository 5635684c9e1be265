"""Strips of an electrode side by side with gaps between them: their capacitances, and strips that float.

In a gap there is no charge, on a strip one potential, beyond the last gaps zero volts. At the electrode q = q0 + K phi:
q0 of the contact where all is at zero volts, K(k) > 0 of the layers. With phi' a series of ``T_m / (pi sqrt(1 - X^2))``
in every gap, phi_i that of strip i at one volt makes ``int phi K phi`` least among potentials that are what the strips'
are:

    C_ij = int phi_i K phi_j dx,    Q_i = int q0 phi_i dx.

Strips that float have no charge: ``V_f = -C_ff^-1 C_fr`` per volt of the one that is read (films, section 11).
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from scipy.special import jv

from solver.arrays import Array, ComplexArray
from solver.stack.electrodes import Electrode
from solver.stack.fourier import FLIP, falling
from solver.stack.layers import Stack, StackError
from solver.stack.reflection import held, waves
from solver.stack.wavenumbers import wavenumbers

_PHI = 2  # of (x, y, phi, psi)
_NODES = 64  # of Chebyshev's rule for two gaps that do not touch
_LEAST, _WIDE = 12, 4.0  # terms in a gap, and what its width over that of the strip adds
_MOST = 120  # terms in a gap
_NARROW = 0.02  # strip over gap
_KEPT = 256


def stiffness(stack: Stack, number: int, k: Array) -> tuple[Array, float]:
    """K over k: charge of an electrode per its potential, all others at zero; (k,), and its limit at large k.

    In the units of the stack.

    k: (k,), wavenumbers [1/m].
    """
    if stack.top.graded:
        raise StackError("floating_neighbours: of a film that is graded are not given")
    electrode = Electrode(stack, number)
    beside = [stack.conductors[i] for place in electrode.interfaces for i in (place, place + 1)]
    if electrode.on_top or any(beside):
        what = "the electrode on top" if electrode.on_top else "a metal"
        raise StackError(
            f"floating_neighbours: of {what}, whose gaps are not given; collector must be a thin one inside"
        )
    place, layers = electrode.interfaces[0], waves(stack, k)
    above: Array = np.zeros((k.size, 4, 4))  # t = above . ku of what lies above, free at the surface
    limit: Array = np.zeros((4, 4))
    rules: tuple[int, ...] = (_PHI,) if stack.electroded else ()
    for layer, own in zip(layers[: place + 1], stack.grounded, strict=False):
        Y, E = layer.medium.compliance, falling(layer.medium.decay, k * layer.thickness)
        up = FLIP * Y
        A, B = np.eye(4) - above @ Y, -np.eye(4) - above @ up
        for c in rules:
            A[:, c], B[:, c] = Y[c], up[c]
        back = E @ np.linalg.solve(A, B) @ (FLIP * E)
        above = np.asarray((np.eye(4) + back) @ np.linalg.inv(Y @ back - up))
        limit = np.asarray(-np.linalg.inv(up))
        rules = own
    if place == len(stack.layers) - 1 and stack.rigid:
        return above[:, _PHI, _PHI], float(limit[_PHI, _PHI])
    others = tuple(c for c in stack.grounded[place] if c != _PHI)
    under = [*stack.media, *filter(None, [stack.base_medium])][place + 1]
    below = [
        -1 / np.linalg.solve(np.eye(4) - Y @ Z, Y)[..., _PHI, _PHI]
        for Y, Z in (
            (held(np.array(layers[place].below), others), above),
            (held(np.array(under.compliance), others), limit),
        )
    ]
    return below[0], float(below[1])


@dataclass(frozen=True, eq=False)
class Patches(ABC):
    """Parts of one electrode side by side, in lengths over the thickness of the top layer."""

    # The electrode that they are parts of
    stack: Stack
    number: int
    # Width or diameter of the parts, and distance of their middles
    size: float
    pitch: float
    floating: int  # n: parts that float on each side of the one that is read

    @property
    @abstractmethod
    def matrix(self) -> Array:
        """Charges per voltages [F m-1 or F, over the stack's units], symmetric and positive definite; (part, part)."""

    @property
    def read(self) -> int:
        """The part in the middle."""
        return len(self.matrix) // 2

    @property
    def _width(self) -> float:
        """K/k less its limit decays like exp(-k width)."""
        place = Electrode(self.stack, self.number).interfaces[0]
        beside = [i for i in (place, place + 1) if i < len(self.stack.layers)]
        return 2 * min(self.stack.layers[i].thickness * float(self.stack.media[i].slowest) for i in beside)

    @cached_property
    def voltages(self) -> Array:
        """Of the parts where the middle one has one volt and the others float; (part,)."""
        voltages = np.ones(len(self.matrix))
        others = np.arange(voltages.size) != self.read
        voltages[others] = -np.linalg.solve(self.matrix[np.ix_(others, others)], self.matrix[others, self.read])
        return voltages

    @property
    def capacitance(self) -> float:
        """Of the middle one to all that does not float [F m-1 or F], lengths over any."""
        return float(self.matrix[self.read] @ self.voltages) / float(self.stack.scale[_PHI]) ** 2


class Strips(Patches):
    """2 n + 1 strips side by side."""

    @property
    def _gap(self) -> float:
        return self.pitch - self.size

    @cached_property
    def _terms(self) -> int:
        terms = _LEAST + int(_WIDE * self._gap / self._width)
        if terms > _MOST or self.size < _NARROW * self._gap:
            raise StackError(
                "patch_pitch: the gap between patches is too wide for floating_neighbours, "
                f"{self._gap / self.size:.3g} times the patch and {self._gap / self._width:.3g} times what is beside it"
            )
        return terms

    def _potentials(self, k: Array) -> ComplexArray:
        """Transforms of the strips' ramps, one volt each, and of what is added in the gaps; (2n + 1 + terms, k)."""
        n, p, half = self.floating, self.pitch, k * self._gap / 2
        middles = np.exp(-1j * k * p * (np.arange(2 * n + 2) - n - 0.5)[:, None])
        m = np.arange(1, self._terms + 1)[:, None]
        within = (-1j) ** m * jv(m, half) / (1j * k)
        steps = jv(0, half) * np.exp(-1j * k * p * (np.arange(2 * n + 1) - n)[:, None]) * 2 * np.sin(k * p / 2) / k
        return np.concatenate([steps, (middles[:, None] * within).reshape(-1, k.size)])

    @cached_property
    def _energy(self) -> Array:
        """int phi_a K phi_b dx of all of :meth:`_potentials`, symmetric and positive."""
        k, weights = wavenumbers(self.stack, 2 * (self.floating + 1) * self.pitch, self._width)
        over_k, limit = stiffness(self.stack, self.number, k)
        waves_ = self._potentials(k)
        smooth = (waves_ * (weights * k * (over_k - limit))) @ np.conj(waves_.T)
        return np.asarray(smooth.real / np.pi + limit * self._half_spaces)

    @property
    def _half_spaces(self) -> Array:
        """The same of K = k: minus the logarithm of distances over pi, between the terms of phi' in the gaps."""
        gaps, count = 2 * self.floating + 2, self._terms + 1
        angle = np.pi * (np.arange(_NODES + count) + 0.5) / (_NODES + count)
        X, T = np.cos(angle), np.cos(np.arange(count)[:, None] * angle) / angle.size
        half = self._gap / 2
        blocks = [np.diag([-np.log(half / 2), *(0.5 / np.arange(1, count))])]
        blocks += [-T @ np.log(d * self.pitch + half * (X - X[:, None])) @ T.T for d in range(1, gaps)]
        whole = np.empty((gaps, count, gaps, count))
        for a in range(gaps):
            for b in range(gaps):
                whole[a, :, b] = blocks[b - a] if b >= a else blocks[a - b].T
        jumps = np.zeros((gaps - 1, gaps, count))
        strips = np.arange(gaps - 1)
        jumps[strips, strips, 0], jumps[strips, strips + 1, 0] = 1.0, -1.0
        inner = np.zeros((gaps, count - 1, gaps, count))
        for a in range(gaps):
            inner[a, :, a, 1:] = np.eye(count - 1)
        basis = np.concatenate([part.reshape(-1, gaps * count) for part in (jumps, inner)])
        return np.asarray(basis @ whole.reshape(gaps * count, -1) @ basis.T / np.pi)

    @cached_property
    def _in_gaps(self) -> Array:
        """What a volt of each strip adds in the gaps; (terms of all gaps, 2n + 1)."""
        strips = 2 * self.floating + 1
        return np.asarray(-np.linalg.solve(self._energy[strips:, strips:], self._energy[strips:, :strips]))

    @cached_property
    def matrix(self) -> Array:
        """Charges per voltages of the strips [F m-1 / stack units], symmetric and positive definite; (2n+1, 2n+1)."""
        strips = 2 * self.floating + 1
        energy = self._energy[:strips, :strips] + self._energy[:strips, strips:] @ self._in_gaps
        return np.asarray(energy + energy.T) / 2

    def wave(self, k: Array) -> Array:
        """Transform of the potential under which it reads, one volt on the middle strip; real, (k,)."""
        sizes = np.concatenate([self.voltages, self._in_gaps @ self.voltages])
        return np.asarray((sizes @ self._potentials(k)).real)


@lru_cache(_KEPT)
def strips(stack: Stack, number: int, size: float, pitch: float, floating: int) -> Strips:
    """Strips, kept: they do not depend on the contact."""
    return Strips(stack, number, size, pitch, floating)
