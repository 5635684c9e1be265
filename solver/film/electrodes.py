"""Electrodes within a stack: the charge that a contact brings to each (films, section 11).

An electrode is a grounded interface, or a metal with both its faces. It takes up the jump of D_y, ``D_y(above) -
D_y(below)``. In Fourier space that is a row of transfers times the tractions at the surface, from the top down as the
fields inside; its limit at k = 0, the charge of an electrode without end, follows from Y(k) = A + k C + ... in closed
form.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from solver.arrays import Array, BoolArray, ComplexArray
from solver.film.fourier import falling
from solver.film.kernel import wavenumbers
from solver.film.reflection import waves
from solver.film.stack import Stack, StackError
from solver.film.windows import Indices
from solver.film.within import below

_TOP, _PHI = -1, 2  # the surface among the interfaces; phi among (x, y, phi, psi)
_FARTHEST = 2000.0  # distance over the width of the strip: bounded time
_KEPT = 128  # transfers: 0.1 MB each

_Outputs = dict[str, Array]


def electrodes(stack: Stack) -> list[tuple[int, ...]]:
    """Interfaces of every electrode, counted from that below the top layer; a metal joins those above and below it.

    The surface counts as the interface -1.
    """
    found: list[tuple[int, ...]] = [(_TOP,)] if stack.electroded else []
    for number, held in enumerate(stack.grounded):
        if 2 not in held:
            continue
        if found and stack.conductors[number] and found[-1][-1] == number - 1:
            found[-1] = (*found[-1], number)
        else:
            found.append((number,))
    return found


@dataclass(frozen=True, eq=False)
class Electrode:
    """One electrode of a stack, by what it gets of tractions (i sigma_xy, sigma_yy, D_y, B_y) at the surface.

    Parameters
    ----------
    stack
        Homogeneous layers on a base.
    number
        Of the electrode, 1 for the uppermost.

    Raises
    ------
    StackError
        A number that no electrode has; a graded layer, a base that insulates the magnetic field.
    """

    stack: Stack
    number: int

    def __post_init__(self) -> None:
        count = len(electrodes(self.stack))
        if not 1 <= self.number <= count:
            raise StackError(f"collector: {self.number} is not one of the {count} electrodes of {self.stack.name}")
        if self.stack.top.graded or self.stack.insulated:
            what = "a graded layer" if self.stack.top.graded else "a base that insulates the magnetic field"
            raise StackError(f"collector: electrodes are not given in a stack with {what}")

    @property
    def interfaces(self) -> tuple[int, ...]:
        """Those that it joins, from that below the top layer."""
        return electrodes(self.stack)[self.number - 1]

    @property
    def on_top(self) -> bool:
        """Whether it lies on the surface: it is then given as a whole, without pressure and patches."""
        return self.interfaces == (_TOP,)

    @property
    def width(self) -> float:
        """Exponent of the slowest decay of transfers [m]: they fall like exp(-k width)."""
        above = range(self.interfaces[0] + 1)
        return float(sum(self.stack.layers[i].thickness * float(self.stack.media[i].slowest) for i in above))

    def transfers(self, reach: float) -> tuple[Array, Array, Array]:
        """Wavenumbers [1/m] and weights for distances up to reach [m], (k,) each, and rows of charge and of sigma_yy.

        Returns
        -------
        tuple
            k, weights, and (k, 2, 4).

        Raises
        ------
        StackError
            A distance that is not resolved.
        """
        if reach > _FARTHEST * self.width:
            farthest = _FARTHEST * self.width / self.stack.top.thickness
            raise StackError(
                "patch_size: the patch reaches farther from the contact than is resolved, "
                f"{farthest:.3g} thicknesses of the top layer"
            )
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
            down = falling(layer.medium.decay, k * layer.thickness) @ amplitude
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


@lru_cache(_KEPT)
def transfers(stack: Stack, number: int, octave: int) -> tuple[Array, Array, Array]:
    """As :meth:`Electrode.transfers`, kept, for distances up to 2^octave times the thickness of the top layer."""
    return Electrode(stack, number).transfers(2.0**octave * stack.top.thickness)


def joined(parts: list[tuple[Indices, _Outputs]], count: int) -> _Outputs:
    """Outputs of all cases from those of some, as far as all parts have them; (case,) each."""
    names = [name for name in parts[0][1] if all(name in values for _, values in parts)]
    out = {name: np.empty(count) for name in names}
    for places, values in parts:
        for name in names:
            out[name][places] = values[name]
    return out


def octave_of(reach: Array) -> Indices:
    """Least power of two, from 1 on, of distances over the thickness of the top layer; as ``reach``."""
    return np.asarray(np.ceil(np.log2(np.maximum(reach, 1.0))), dtype=np.intp)


def _small(stack: Stack) -> list[tuple[Array, Array]]:
    """A and C of Y = A + k C + ... at the surface and below each layer, before the interface's rules; (4, 4) each."""
    A = np.zeros((4, 4)) if stack.base_medium is None else stack.base_medium.compliance
    C, found = np.zeros((4, 4)), []
    for number in range(len(stack.layers) - 1, -1, -1):
        found.append((A, C))
        A, C = _held(A, C, stack.grounded[number])
        system = stack.media[number].system
        (turned, inverse), (Q, _) = (np.split(rows, 2, axis=1) for rows in np.split(system, 2))
        C = C + stack.layers[number].thickness * (inverse + turned @ A + A @ turned.T - A @ Q @ A)
    return [(A, C), *found[::-1]]


def _held(A: Array, C: Array, components: tuple[int, ...]) -> tuple[Array, Array]:
    """Y = A + k C where an interface holds components of u at zero."""
    A, C = np.array(A), np.array(C)
    for c in components:
        if A[c, c] != 0:
            share = A[:, c] / A[c, c]
            both = np.outer(share, C[c])
            C = C - both - both.T + C[c, c] * np.outer(share, share)
            A = A - np.outer(share, A[c])
        elif C[c, c] != 0:
            C = C - np.outer(C[:, c], C[c]) / C[c, c]
        for one in (A, C):
            one[c], one[:, c] = 0.0, 0.0
    return A, C


def _let_down(t: Array, A: Array, C: Array, components: tuple[int, ...]) -> Array:
    """Tractions below an interface at k = 0, of those above (4, column); a rigid base gets none of what is held."""
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


@dataclass(frozen=True, eq=False)
class Reading:
    """The electrode that is read, and patches of it at zero volts; (case,) each.

    Attributes
    ----------
    collector
        Number of the electrode, 1 for the uppermost.
    strips
        Whether its patches are strips across x, or else discs.
    position
        Of the patch's middle from that of the contact [m].
    size
        Diameter of a disc, width of a strip [m]; None: no patches.
    pitch
        Distance of neighbours [m]; None: no neighbours.
    """

    collector: Array
    strips: BoolArray
    position: Array
    size: Array | None = None
    pitch: Array | None = None

    def part(self, places: Indices) -> "Reading":
        """Some of the cases."""
        size, pitch = (None if one is None else one[places] for one in (self.size, self.pitch))
        return Reading(self.collector[places], self.strips[places], self.position[places], size, pitch)

    def over(self, length: Array) -> "Reading":
        """With lengths over others [m]."""
        size, pitch = (None if one is None else one / length for one in (self.size, self.pitch))
        return Reading(self.collector, self.strips, self.position / length, size, pitch)

    def together(
        self, answer: Callable[[Indices, int, int], dict[str, Array]], stack: Stack, extent: Array
    ) -> _Outputs:
        """Outputs of cases whose electrode is the same and whose distances are of like size, those that all have.

        Parameters
        ----------
        answer
            Outputs of some cases, of an electrode, for an octave of distances.
        stack
            Of all cases, its top layer of unit thickness.
        extent
            Of the contacts from their middle; (case,).

        Raises
        ------
        StackError
            Patches of an electrode on top.
        """
        octaves, found = octave_of(self.reach + extent), list[tuple[Indices, dict[str, Array]]]()
        for number in np.unique(self.collector).tolist():
            if self.size is not None and Electrode(stack, int(number)).on_top:
                raise StackError(
                    "patch_size: of the electrode on top, which is given as a whole; collector must be > 1"
                )
            for octave in np.unique(octaves).tolist():
                some = np.flatnonzero((self.collector == number) & (octaves == octave))
                if some.size:
                    found.append((some, answer(some, int(number), octave)))
        return joined(found, extent.size)

    @property
    def reach(self) -> Array:
        """How far the patches extend from the middle of the contact [m]."""
        if self.size is None:
            return np.zeros_like(self.position)
        pitch = np.zeros_like(self.position) if self.pitch is None else self.pitch
        return np.asarray(np.maximum(np.abs(self.position), pitch) + self.size / 2)


@dataclass(frozen=True, eq=False)
class Collected:
    """What patches collect, as integrals over the wavenumber that a contact of either kind gives.

    Attributes
    ----------
    reading
        The patches.
    patch
        Charges of patches whose middles are at distances (case,), by the ``reading``; (case,).
    gradient
        Their derivatives by the distance; (case,).
    """

    reading: Reading
    patch: Callable[[Array], Array]
    gradient: Callable[[Array], Array]

    def quantities(self, force: Array) -> dict[str, Array]:
        """Those of ``solver.names.ELECTRODE_QUANTITIES`` that patches have; (case,) each.

        Parameters
        ----------
        force
            What presses; (case,).
        """
        if self.reading.size is None:
            return {}
        out = {"patch_charge_per_force": self.patch(self.reading.position) / force}
        if self.reading.pitch is not None:
            own = self.patch(np.zeros_like(self.reading.pitch))
            out["crosstalk"] = self.patch(self.reading.pitch) / own
            out["patch_charge_gradient"] = -2 * self.gradient(self.reading.pitch / 2) / force
        return out
