"""Electrodes within a stack: the charge that a contact brings to each (films, section 11).

An electrode is a grounded interface, or a metal with both its faces. It takes up the jump of D_y, ``D_y(above) -
D_y(below)``. In Fourier space this charge is a row of transfers times the tractions at the surface, solved from the top
down as the fields inside. Its limit at k = 0, the charge of an electrode without end, follows in closed form from
Y(k) = A + k C + ....
"""

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
    """Patch that reaches farther than is resolved; the caller adds its size."""


def electrodes(stack: Stack) -> list[tuple[int, ...]]:
    """Interfaces of every electrode, counted from that below the top layer; a metal joins those above and below it.

    The surface counts as the interface -1; a metal below it is that electrode itself.
    """
    places: list[tuple[int, ...]] = [(_TOP,)] if stack.electroded and not stack.conductors[0] else []
    for number, held in enumerate(stack.grounded):
        if 2 not in held:
            continue
        if places and stack.conductors[number] and places[-1][-1] == number - 1:
            places[-1] = (*places[-1], number)
        else:
            places.append((number,))
    return places


@dataclass(frozen=True, eq=False)
class Electrode:
    """One electrode of a stack, by its charge per traction (i sigma_xy, sigma_yy, D_y, B_y) at the surface."""

    stack: Stack
    number: int

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
        """Interfaces that it joins, from that below the top layer."""
        return electrodes(self.stack)[self.number - 1]

    @property
    def on_top(self) -> bool:
        """Return whether it lies on the surface, where it is read as a whole only."""
        return self.interfaces == (_TOP,)

    @property
    def width(self) -> float:
        """Exponent of the slowest decay of transfers [m]: they fall like exp(-k width)."""
        above = range(self.interfaces[0] + 1)
        return float(sum(self.stack.layers[i].thickness * float(self.stack.media[i].slowest) for i in above))

    @property
    def between(self) -> list[range]:
        """Layers from it to the next electrode above and below, as far as there is one; empty beside a metal."""
        interfaces_of_all = electrodes(self.stack)
        ends = [(_TOP - 1,), *interfaces_of_all, (len(self.stack.layers),)]
        above, interfaces, below = ends[self.number - 1 : self.number + 2]
        sublayers = [range(above[-1] + 1, interfaces[0] + 1)] if self.number > 1 else []
        return (
            [*sublayers, range(interfaces[-1] + 1, below[0] + 1)] if self.number < len(interfaces_of_all) else sublayers
        )

    @property
    def capacitance(self) -> float:
        """Capacitance to the next electrodes per area [F m-2], of plates whose layers thicken and do not widen."""
        scale, total = float(self.stack.scale[_PHI]), 0.0
        for layers in self.between:
            crossed = [(self.stack.layers[i].thickness, self.stack.media[i].system[_PHI, 4 + _PHI]) for i in layers]
            total += 1 / (scale**2 * sum(thickness * abs(float(inverse)) for thickness, inverse in crossed))
        return total

    def transfers(self, reach: float) -> tuple[Array, Array, Array]:
        """Wavenumbers [1/m], weights (k,), and rows of charge and sigma_yy for distances up to `reach` [m]."""
        if self.on_top:
            raise StackError("patch_size: of the electrode on top; must be absent: a layer of metal on top has patches")
        if reach > _FARTHEST * self.width:
            farthest = _FARTHEST * self.width / self.stack.top.thickness
            raise FarError(f"the patch reaches farther from the contact than is resolved, {farthest:.3g} times that")
        k, weights = wavenumbers(self.stack, reach, self.width)
        return k, weights, self.rows(k)

    def rows(self, k: Array) -> Array:
        """Charge, and sigma_yy on the upper face, per traction at the surface; (k, 2, 4), in the units of the stack."""
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
        """Charge of the electrode without end per total (sigma_yy, D_y, B_y) at the surface; (3,)."""
        t, charge = np.eye(4)[:, 1:], np.zeros(3)
        held = ((_PHI,) if self.stack.electroded else (), *self.stack.grounded)
        for number, (A, C) in enumerate(_small(self.stack), _TOP):
            above, t = t[2], _let_down(t, A, C, held[number + 1])
            if number in self.interfaces:
                charge += above - t[2]
        return charge

    @property
    def stroke(self) -> float:
        """Depth per volt of the whole electrode [m V-1]: reciprocal to its charge per force."""
        return -float(self.whole[0] * self.stack.scale[1] / self.stack.scale[2])


@cached
def transfers(stack: Stack, number: int, octave: int) -> tuple[Array, Array, Array]:
    """Transfers of an electrode for distances up to a power of two thicknesses, cached."""
    return Electrode(stack, number).transfers(2.0**octave * stack.top.thickness)


def octave_of(reach: Array) -> Indices:
    """Least power of two, from 1 on, of distances over the thickness of the top layer; as ``reach``."""
    return np.asarray(np.ceil(np.log2(np.maximum(reach, 1.0))), dtype=np.intp)


def _small(stack: Stack) -> list[tuple[Array, Array]]:
    """Terms A and C of Y = A + k C + ... at the surface and below each layer, before the interface's rules; (4, 4)."""
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


def _let_down(t: Array, A: Array, C: Array, components: tuple[int, ...]) -> Array:
    """Tractions below an interface at k = 0, of those above (4, column); a rigid base gets no held component."""
    out = np.array(t)
    free = [c for c in range(4) if c not in components]
    out[list(components)] = 0.0
    finite = [c for c in components if A[c, c] != 0]
    small = [c for c in components if A[c, c] == 0 and C[c, c] != 0]
    if finite:
        out[finite] = -np.linalg.solve(A[np.ix_(finite, finite)], A[np.ix_(finite, free)] @ t[free])
    if small:
        others = [*free, *finite]
        out[small] = -np.linalg.solve(C[np.ix_(small, small)], C[np.ix_(small, others)] @ out[others])
    return out


#: Indices of the shapes of patches among ``solver.names.CHOICES["patch"]``.
DISC, STRIP = (CHOICES["patch"].index(name) for name in ("disc", "strip"))


@dataclass(frozen=True, eq=False)
class Reading:
    """Electrode that each case reads, and patches of it at zero volts; (case,) each."""

    collector: Array  # Number of the electrode, 1 for the uppermost
    shape: Array  # Of its patches: place in ``solver.names.CHOICES["patch"]``
    position: Array  # Of the patch's middle from that of the contact [m]
    size: Array | None = None  # Diameter of a disc, width of a strip across x [m]; None: no patches
    pitch: Array | None = None  # Distance of neighbours [m]; None: no neighbours

    def part(self, places: Indices) -> "Reading":
        """Some of the cases."""
        return selected(self, places, *vars(self))

    def over(self, length: Array) -> "Reading":
        """Return the reading with its lengths over `length` [m], (case,)."""
        size, pitch = (None if values is None else values / length for values in (self.size, self.pitch))
        return replace(self, position=self.position / length, size=size, pitch=pitch)

    @property
    def reach(self) -> Array:
        """Distance from the middle of the contact to the farthest point of the patches [m]; (case,)."""
        if self.size is None:
            return np.zeros_like(self.position)
        pitch = np.zeros_like(self.position) if self.pitch is None else self.pitch
        return np.asarray(np.maximum(np.abs(self.position), pitch) + self.size / 2)
