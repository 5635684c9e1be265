"""Fields inside a film and its base (films, section 6).

In the top layer the half-plane's part of the field is closed (theory section 5); what the layers below reflect, and
everything below the top layer, decays at least like exp(-k h1 g) and is integrated over the wavenumbers k. Inside, a
graded layer is two staircases of homogeneous ones, extrapolated, loaded by the tractions of the graded film.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array, ComplexArray
from solver.film.assembly import Assembly
from solver.film.basis import Basis
from solver.film.contact import FilmContact
from solver.film.fourier import FLIP, Medium, falling
from solver.film.grading import Graded, staircase
from solver.film.kernel import strip, wavenumbers
from solver.film.reflection import LayerWaves, waves
from solver.film.stack import Stack, StackError
from solver.film.system import System
from solver.halfplane.interior import LINEAR, field_rows, principal_tension, von_mises
from solver.halfplane.spectrum import spectrum

_SUBLAYERS = 24  # and half of them, extrapolated
_STRESSES = ("stress_xx", "stress_yy", "stress_xy", "stress_zz")
_DERIVED = {"von_mises": von_mises, "principal_tension": principal_tension}
_MOST = 4_000_000  # entries of a block of the synthesis: bounded memory


@dataclass(frozen=True, eq=False)
class Interior:
    """Fields of the unit causes of one system at one half-length.

    Parameters
    ----------
    system
        The contact.
    half_length
        h [m].
    sublayers
        Number of homogeneous layers that a graded one is inside.
    """

    system: System
    half_length: float
    sublayers: int = _SUBLAYERS

    @cached_property
    def basis(self) -> Basis:
        """Basis of the tractions."""
        return self.system.basis(self.half_length)

    @cached_property
    def body(self) -> Stack:
        """The stack; a graded layer as sublayers of the materials at their middles."""
        stack = self.system.kernel.stack
        return staircase(stack, self.sublayers) if stack.top.graded else stack

    @property
    def _units(self) -> Array:
        """Units of tractions of the body over those of the system; (4,)."""
        return np.asarray(self.body.scale / self.system.kernel.stack.scale)

    @cached_property
    def _terms(self) -> tuple[Array, Array]:
        """Terms of the pressure (pressures, cause) and of both fields (2, M + 1, cause)."""
        unknowns = Assembly(self.system, self.basis, np.array([self.half_length])).unknowns[0]
        pressures, charges = self.system.split(self.basis, unknowns.T)
        return pressures.T, np.moveaxis(charges, 0, -1)

    def fields(self, x: Array, depth: Array, names: tuple[str, ...]) -> Array:
        """Fields of ``solver.halfplane.interior.LINEAR`` by cause; (field, depth, x, cause), SI per unit cause.

        Parameters
        ----------
        x
            Distance from the centre of the contact [m]; (x,).
        depth
            Depth >= 0 [m]; (depth,). A depth on an interface belongs to the layer above it.
        names
            Fields; ``stress_zz`` needs c12.

        Raises
        ------
        StackError
            A depth inside a rigid base.
        """
        which = [LINEAR.index(name) for name in names]
        out: Array = np.empty((len(names), depth.size, x.size, self.system.causes))
        scale = self.body.scale
        units = np.concatenate([scale, 1 / scale])
        for medium, members, states in self._states(x, depth):
            half = self._local(medium, depth[members]).halfplane
            rows = (
                field_rows(half)[..., which, :]
                * (units / np.concatenate([half.scale, 1 / half.scale], -1))[..., None, :]
            )
            out[:, members] = np.einsum(
                "dfs,sdxc->fdxc", np.broadcast_to(rows, (members.size, *rows.shape[-2:])), states
            )
        return out

    def _local(self, medium: Medium, depth: Array) -> Medium:
        """The medium at depths; within a graded layer that of its profile: strain and traction meet at sublayers."""
        layer = self.system.kernel.stack.top
        if isinstance(layer, Graded) and np.all(depth <= layer.thickness * (1 + 1e-14)):
            return Medium(layer.profile(np.minimum(depth / layer.thickness, 1.0)), medium.scale)
        return medium

    def _states(self, x: Array, depth: Array) -> list[tuple[Medium, NDArray[np.intp], Array]]:
        """Of every body that is asked for: medium, which depths, and [u,x; t] (8, depth, x, cause)."""
        stack = self.body
        reach = float(np.max(np.abs(x), initial=0.0)) + self.half_length
        k, weights = wavenumbers(stack, reach, strip(stack) / 2)
        synthesis = _Synthesis(k, weights, x)
        top, start, found = self._transforms(k), 0.0, []
        for number, layer in enumerate(waves(stack, k)):
            end = start + layer.thickness
            inside = np.flatnonzero((depth <= end * (1 + 1e-14)) & ((depth > start * (1 + 1e-14)) | (number == 0)))
            if inside.size:
                states = synthesis.fields(*_layer_waves(layer, k, depth[inside] - start, top, reflected=number == 0))
                if number == 0:
                    states = states + self._halfplane(x, depth[inside])
                found.append((layer.medium, inside, states))
            top, start = _below(layer, k, top, stack.grounded[number]), end
        inside = np.flatnonzero(depth > start * (1 + 1e-14))
        if inside.size:
            base = stack.base_medium
            if base is None:
                raise StackError(f"depth: {depth[inside[0]]:g} m lies inside the rigid base; at most {start:g} m")
            down: ComplexArray = falling(base.decay, k * (depth[inside] - start)[:, None]) @ top
            found.append((base, inside, synthesis.fields(base.compliance @ down, down)))
        return found

    def _transforms(self, k: Array) -> ComplexArray:
        """(i sigma_xy, sigma_yy, D_y, B_y) at the surface in Fourier space for every cause; (k, 4, cause)."""
        samples = self.basis.terms + 20 + int(np.max(k) * self.half_length / 2)
        fine = Basis(self.basis.delta, self.basis.smooth, self.basis.terms, samples)
        (pressures, charges), c, h = self._terms, self.system.coefficients, self.half_length
        (S, rule), (X, charge_rule) = fine.pressure_rule, fine.charge_rule
        loaded, charged = rule @ pressures, np.moveaxis(charge_rule @ charges, 0, 1)
        t: ComplexArray = np.empty((k.size, 4, pressures.shape[-1]), np.complex128)
        for block in range(0, k.size, step := max(_MOST // samples, 1)):
            some = slice(block, block + step)
            t[some, 1] = np.exp(-1j * h * k[some, None] * S) @ loaded
            t[some, 2:] = np.tensordot(np.exp(-1j * h * k[some, None] * X), charged, 1)
        for f in c.fields:
            t[:, 2 + f] += c.follower[f] * t[:, 1]
        t[:, 0] = 1j * c.friction * t[:, 1]
        return h * t * self._units[:, None]

    def _halfplane(self, x: Array, depth: Array) -> Array:
        """[u,x; t] of the half-plane of the top material in the units of the stack; (8, depth, x, cause)."""
        half = self.body.media[0].halfplane
        nodes, parts = spectrum(half)
        both = np.concatenate([half.surface_impedance, np.eye(4)])
        (pressures, charges), c, h = self._terms, self.system.coefficients, self.half_length
        out: Array = np.zeros((8, depth.size * x.size, self.system.causes))
        X, Y = (np.ravel(v) for v in np.broadcast_arrays(x / h, -depth[:, None] / h))
        for p, part in zip(nodes, parts, strict=True):
            of_pressure, of_charge = self.basis.transforms(X + np.real(p) * Y + 1j * np.abs(np.imag(p) * Y))
            H: ComplexArray = np.empty((4, X.size, self.system.causes), np.complex128)
            H[1] = of_pressure @ pressures
            H[0] = c.friction * H[1]
            for f in (0, 1):
                H[2 + f] = of_charge @ charges[f] + (c.follower[f] if f in c.fields else 0.0) * H[1]
            out += np.tensordot(np.conj(1j * both @ part) * self._units, H, 1).real
        return out.reshape(8, depth.size, x.size, -1)


@dataclass(frozen=True, eq=False)
class _Synthesis:
    """From wavenumbers to positions x."""

    k: Array
    weights: Array
    x: Array

    def fields(self, ku: ComplexArray, t: ComplexArray) -> Array:
        """[u,x; t] at every x of waves (depth, k, 4, cause) whose x-components are times i; (8, depth, x, cause)."""
        turned = np.concatenate([ku[..., :1, :], 1j * ku[..., 1:, :], -1j * t[..., :1, :], t[..., 1:, :]], -2)
        turned = turned * (self.weights / np.pi)[:, None, None]
        out: Array = np.empty((t.shape[0], self.x.size, 8, t.shape[-1]))
        flat = np.moveaxis(turned, 1, 0).reshape(self.k.size, -1)
        parts = np.concatenate([flat.real, -flat.imag])
        for block in range(0, self.x.size, step := max(_MOST // self.k.size, 1)):
            phase = self.x[block : block + step, None] * self.k
            summed = np.concatenate([np.cos(phase), np.sin(phase)], -1) @ parts
            out[:, block : block + step] = np.moveaxis(summed.reshape(len(phase), t.shape[0], 8, -1), 0, 1)
        return np.moveaxis(out, 2, 0)


def _layer_waves(
    layer: LayerWaves, k: Array, depth: Array, top: ComplexArray, *, reflected: bool
) -> tuple[ComplexArray, ComplexArray]:
    """Waves k u and t at depths within a layer under the tractions on its top; (depth, k, 4, cause) each.

    ``reflected``: without what the layer's own half-plane would carry.
    """
    G, own = layer.medium.decay, layer.medium.compliance
    amplitude = layer.amplitude @ top
    down = -layer.round_trip @ amplitude if reflected else amplitude  # (I + F)^-1 - I = -F (I + F)^-1
    up = layer.reflection @ falling(G, k * layer.thickness) @ amplitude
    falls = falling(G, k * depth[:, None]) @ down
    rises = (FLIP * falling(G, k * (layer.thickness - depth)[:, None])) @ up
    return own @ falls - (FLIP * own) @ rises, falls + rises


def _below(layer: LayerWaves, k: Array, top: ComplexArray, held: tuple[int, ...]) -> ComplexArray:
    """Tractions on the top of what lies below a layer; an electrode carries the flux that it does not pass on."""
    down = falling(layer.medium.decay, k * layer.thickness) @ layer.amplitude @ top
    t: ComplexArray = down + layer.reflection @ down
    free = [i for i in range(4) if i not in held]
    if held and np.any(layer.below):
        Y = layer.below[:, list(held)]
        t[:, list(held)] = -np.linalg.solve(Y[:, :, list(held)], Y[:, :, free] @ t[:, free])
    return t


def interior_fields(contact: FilmContact, X: Array, Y: Array, names: tuple[str, ...]) -> Array:
    """Fields inside films and bases; (case, field, y, x), SI.

    Parameters
    ----------
    contact
        Contacts of cases.
    X, Y
        (x - c)/h and y/h <= 0; (x,) and (y,).
    names
        Names of ``solver.halfplane.interior.LINEAR``, ``von_mises`` or ``principal_tension``.

    Raises
    ------
    StackError
        A point inside a rigid base.
    """
    needed = [name for name in names if name in LINEAR]
    if any(name in _DERIVED for name in names):
        needed += _STRESSES
    linear = tuple(dict.fromkeys(needed))
    out: Array = np.empty((contact.load.size, len(names), Y.size, X.size))
    # milliseconds a case: every half-length has wavenumbers and depths of its own
    for case, h in enumerate(contact.half_width):
        system = contact.table.system
        parts = Interior(system, float(h)).fields(h * X, -h * Y, linear)
        if system.kernel.graded is not None:  # of second order in the thickness of the sublayers
            coarse = Interior(system, float(h), _SUBLAYERS // 2).fields(h * X, -h * Y, linear)
            parts = parts + (parts - coarse) / 3
        values = dict(zip(linear, parts @ contact.causes.values[case], strict=True))
        for name in names:
            if name in _DERIVED:
                values[name] = _DERIVED[name](*(values[stress] for stress in _STRESSES))
        out[case] = [values[name] for name in names]
    return out
