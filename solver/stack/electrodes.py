"""Electrodes of a stack, and the transfers from tractions at the surface to the charge of each (films, section 11)."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, ComplexArray, selected
from solver.cache import cached
from solver.names import CHOICES
from solver.stack.layers import Stack, StackError
from solver.stack.reflection import below, waves
from solver.stack.wavenumbers import wavenumbers

_TOP, _PHI = -1, 2  # the surface among the interfaces; phi among (x, y, phi, psi)
_FARTHEST = 2000.0  # distance over the width of the strip: bounded time


class FarError(StackError):
    """Patch beyond the resolved distance; the caller adds its size to the message."""


def electrodes(stack: Stack) -> list[tuple[int, ...]]:
    """Interfaces of each electrode (-1: surface, 0: below the top layer); a metal joins those above and below it."""
    # a metal on top is the electrode at the surface
    interfaces: list[tuple[int, ...]] = [(_TOP,)] if stack.electroded and not stack.conductors[0] else []
    for number, components in enumerate(stack.grounded):
        if 2 not in components:
            continue
        if interfaces and stack.conductors[number] and interfaces[-1][-1] == number - 1:
            interfaces[-1] = (*interfaces[-1], number)
        else:
            interfaces.append((number,))
    return interfaces


@dataclass(frozen=True, eq=False)
class Electrode:
    """One electrode of a stack, and its charge per traction (i sigma_xy, sigma_yy, D_y, B_y) at the surface."""

    stack: Stack
    number: int  # From the top, from 1 on

    def __post_init__(self) -> None:
        count = len(electrodes(self.stack))
        if not 1 <= self.number <= count:
            raise StackError(
                f"collector: {self.number} is not one of the {count} electrodes of this body, from the top"
            )
        if self.stack.insulated:
            raise StackError(
                "collector: electrodes are not given in a stack with a base that insulates the magnetic field"
            )

    @property
    def interfaces(self) -> tuple[int, ...]:
        """Interfaces of the electrode, as :func:`electrodes` counts them."""
        return electrodes(self.stack)[self.number - 1]

    @property
    def on_top(self) -> bool:
        """True if the electrode lies on the surface, where it has no patches."""
        return self.interfaces == (_TOP,)

    @property
    def width(self) -> float:
        """Length of the slowest decay of transfers, exp(-k width) [m]."""
        above = range(self.interfaces[0] + 1)
        return float(sum(self.stack.layers[i].thickness * float(self.stack.media[i].slowest) for i in above))

    @property
    def between(self) -> list[range]:
        """Layers between the electrode and its neighbours above and below, if it has them."""
        neighbours = electrodes(self.stack)
        ends = [(_TOP - 1,), *neighbours, (len(self.stack.layers),)]
        above, interfaces, below = ends[self.number - 1 : self.number + 2]
        layers = [range(above[-1] + 1, interfaces[0] + 1)] if self.number > 1 else []
        if self.number < len(neighbours):
            layers.append(range(interfaces[-1] + 1, below[0] + 1))
        return layers

    @property
    def capacitance(self) -> float:
        """Capacitance to the neighbours per area, of layers that may thicken but not widen [F m-2]."""
        scale, total = float(self.stack.scale[_PHI]), 0.0
        for layers in self.between:
            crossed = [(self.stack.layers[i].thickness, self.stack.media[i].system[_PHI, 4 + _PHI]) for i in layers]
            total += 1 / (scale**2 * sum(thickness * abs(float(inverse)) for thickness, inverse in crossed))
        return total

    def transfers(self, reach: float) -> tuple[Array, Array, Array]:
        """Wavenumbers [1/m] and weights (k,) for distances up to ``reach`` [m], and :meth:`rows` at these."""
        if self.on_top:
            raise StackError("patch_size: of the electrode on top; must be absent: a layer of metal on top has patches")
        if reach > _FARTHEST * self.width:
            farthest = _FARTHEST * self.width / self.stack.top.thickness
            raise FarError(f"the patch reaches farther from the contact than is resolved, {farthest:.3g} times that")
        k, weights = wavenumbers(self.stack, reach, self.width)
        return k, weights, self.rows(k)

    def rows(self, k: Array) -> Array:
        """Charge, and sigma_yy on the upper face, per traction at the surface, units of the stack; (k, 2, 4)."""
        layers = waves(self.stack, k)
        t: ComplexArray = np.tile(np.eye(4) + 0j, (k.size, 1, 1))
        out, last = np.zeros((k.size, 2, 4)), len(self.stack.layers) - 1
        if self.stack.electroded:
            Y = self.stack.media[0].compliance + layers[0].difference
            t[:, _PHI] = -Y[:, _PHI] / Y[:, _PHI, _PHI, None]
            t[:, :, _PHI] = 0.0
        for number, layer in enumerate(layers):
            amplitude = layer.amplitude @ t
            down = layer.medium.falling(k * layer.thickness) @ amplitude
            above = down + layer.reflection @ down
            t = below(layer, k, np.asarray(amplitude), self.stack.grounded[number])
            if number == self.interfaces[0]:
                out[:, 1] = above[:, 1].real
            if number in self.interfaces:
                out[:, 0] += above[:, 2].real - (0.0 if number == last and self.stack.rigid else t[:, 2].real)
            if number == self.interfaces[-1]:
                break
        return out

    @cached_property
    def whole(self) -> Array:
        """Charge of an unbounded electrode per total (sigma_yy, D_y, B_y) at the surface (films, F11.2); (3,)."""
        t, charge = np.eye(4)[:, 1:], np.zeros(3)
        grounded = ((_PHI,) if self.stack.electroded else (), *self.stack.grounded)
        for number, (A, C) in enumerate(_long_wave_terms(self.stack), _TOP):
            above, t = t[2], _tractions_below(t, A, C, grounded[number + 1])
            if number in self.interfaces:
                charge += above - t[2]
        return charge

    @property
    def stroke(self) -> float:
        """Depth per volt of the whole electrode, by reciprocity with its charge per force [m V-1]."""
        return -float(self.whole[0] * self.stack.scale[1] / self.stack.scale[2])


@cached
def transfers(stack: Stack, number: int, octave: int) -> tuple[Array, Array, Array]:
    """Return :meth:`Electrode.transfers` for distances up to 2^octave thicknesses of the top layer."""
    return Electrode(stack, number).transfers(2.0**octave * stack.top.thickness)


def octave_of(reach: Array) -> Indices:
    """Least exponent >= 0 of two that reaches distances over the top layer's thickness, of the shape of ``reach``."""
    return np.asarray(np.ceil(np.log2(np.maximum(reach, 1.0))), dtype=np.intp)


def _long_wave_terms(stack: Stack) -> list[tuple[Array, Array]]:
    """A and C (4, 4) of Y = A + k C + ... at the surface and below each layer, before the interface's conditions."""
    A = np.zeros((4, 4)) if stack.base_medium is None else stack.base_medium.compliance
    C, terms = np.zeros((4, 4)), []
    for number in range(len(stack.layers) - 1, -1, -1):
        terms.append((A, C))
        A, C = _held(A, C, stack.grounded[number])
        system = stack.media[number].system
        (turned, inverse), (Q, _) = (np.split(rows, 2, axis=1) for rows in np.split(system, 2))
        C = C + stack.layers[number].thickness * (inverse + turned @ A + A @ turned.T - A @ Q @ A)
    return [(A, C), *terms[::-1]]


def _held(A: Array, C: Array, components: tuple[int, ...]) -> tuple[Array, Array]:
    """Return A and C of Y = A + k C where an interface holds components of u at zero."""
    A, C = np.array(A), np.array(C)
    for c in components:
        if A[c, c] != 0:
            share = A[:, c] / A[c, c]
            cross = np.outer(share, C[c])
            C = C - cross - cross.T + C[c, c] * np.outer(share, share)
            A = A - np.outer(share, A[c])
        elif C[c, c] != 0:
            C = C - np.outer(C[:, c], C[c]) / C[c, c]
        for matrix in (A, C):
            matrix[c], matrix[:, c] = 0.0, 0.0
    return A, C


def _tractions_below(t: Array, A: Array, C: Array, components: tuple[int, ...]) -> Array:
    """Tractions below an interface at k = 0 from those above (4, column); 0 for held components on a rigid base."""
    out = np.array(t)
    free = [c for c in range(4) if c not in components]
    out[list(components)] = 0.0
    by_A = [c for c in components if A[c, c] != 0]
    by_C = [c for c in components if A[c, c] == 0 and C[c, c] != 0]
    if by_A:
        out[by_A] = -np.linalg.solve(A[np.ix_(by_A, by_A)], A[np.ix_(by_A, free)] @ t[free])
    if by_C:
        known = [*free, *by_A]
        out[by_C] = -np.linalg.solve(C[np.ix_(by_C, by_C)], C[np.ix_(by_C, known)] @ out[known])
    return out


#: Indices of the shapes of patches among ``solver.names.CHOICES["patch"]``.
DISC, STRIP = (CHOICES["patch"].index(name) for name in ("disc", "strip"))


@dataclass(frozen=True, eq=False)
class Reading:
    """Electrode that each case reads, and its patches at zero volts; (case,) each."""

    collector: Array  # Number of the electrode, 1 for the uppermost
    shape: Array  # Index of the patches' shape in ``solver.names.CHOICES["patch"]``
    position: Array  # Distance of the patch's middle from that of the contact [m]
    size: Array | None = None  # Diameter of a disc, width of a strip across x [m]; None: no patches
    pitch: Array | None = None  # Distance of neighbours [m]; None: no neighbours

    def part(self, cases: Indices) -> "Reading":
        """Return the reading of the selected cases."""
        return selected(self, cases, *vars(self))

    def over(self, length: Array) -> "Reading":
        """Return the reading with its lengths divided by ``length`` (case,) [m]."""
        size, pitch = (None if values is None else values / length for values in (self.size, self.pitch))
        return replace(self, position=self.position / length, size=size, pitch=pitch)

    @property
    def reach(self) -> Array:
        """Distance from the middle of the contact to the farthest point of the patches [m]; (case,)."""
        if self.size is None:
            return np.zeros_like(self.position)
        pitch = np.zeros_like(self.position) if self.pitch is None else self.pitch
        return np.asarray(np.maximum(np.abs(self.position), pitch) + self.size / 2)
