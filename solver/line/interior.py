"""Fields inside films and their bases: the half-plane's closed form and integrals over k (films, section 6)."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from approximation.arrays import blocks
from solver.arrays import Array, BoolArray, ComplexArray
from solver.halfplane.interior import LINEAR, POTENTIALS, field_rows
from solver.line.tractions import Tractions
from solver.stack.fourier import Medium
from solver.stack.layers import Stack, StackError
from solver.stack.reflection import TURN, LayerWaves, below, held, layer_waves, modal, waves
from solver.stack.wavenumbers import strip

FARTHEST = 2000.0  # distance over the width of the strip: bounded time

_WAVENUMBERS_AT_ONCE = 512  # wavenumbers at a time
_WAVES_AT_ONCE = 1 << 20  # entries of a block of waves: bounded memory
_ON = 1 + 1e-12  # a depth on an interface belongs to the layer above it


@dataclass(frozen=True, eq=False)
class Interior:
    """Fields inside a film and its base under tractions at its surface."""

    tractions: Tractions

    @property
    def body(self) -> Stack:
        """Layers and base of the film."""
        return self.tractions.system.kernel.stack

    def fields(self, X: Array, Y: Array, names: tuple[str, ...]) -> Array:
        """Fields of ``solver.halfplane.interior.LINEAR`` at X = (x - c)/h, Y = y/h; (member, field, y, x, column)."""
        which = [LINEAR.index(name) for name in names]
        groups = self.tractions.by_distance(self.body, X)
        values = [self._fields(X[:, columns], Y, which) for columns in groups]
        return np.concatenate(values, 3)[:, :, :, np.argsort(np.concatenate(groups))]

    def _fields(self, X: Array, Y: Array, which: list[int]) -> Array:
        """Fields by index in ``LINEAR`` at positions that share wavenumbers; (member, field, y, x, column)."""
        if len(which) < 8:  # fewer rows to sum than those of the state
            return np.moveaxis(self._summed(X, Y, [self._rows_of(medium, which) for medium in self._media]), 2, 1)
        states = self._summed(X, Y, [np.eye(8) for _ in self._media])
        rows = self._rows(-Y * self.tractions.half_lengths[:, None], which)
        flat = states.reshape(*states.shape[:3], -1)
        return np.moveaxis((rows @ flat).reshape(*rows.shape[:3], *states.shape[3:]), 2, 1)

    def potentials(self, X: Array, Y: Array, datum: Array) -> Array:
        """Electric [V] and magnetic [A] potential, the latter void on an insulated base; (member, 2, y, x, column)."""
        stack, tractions = self.body, self.tractions
        out = self._summed(X, Y, [np.eye(8)[2:4]] * len(self._media), integrated=True)
        h, width = tractions.half_lengths, strip(stack)
        k, weights = self._wavenumbers(X)
        near = float(weights / k @ np.exp(-k * width))  # the datum of the integrals is the width
        totals = tractions.totals.real
        to_datum = np.log(np.broadcast_to(datum, h.shape) / width)[:, None, None]
        body = self._body_at(-Y * h[:, None])
        for number, far in enumerate(_far(stack, totals)):
            constant = (to_datum - near) * far
            if number == 0:  # the closed form's datum is h
                constant += (near - np.log(h / width)[:, None, None]) * (stack.media[0].compliance @ totals)[:, 2:]
            out += np.where((body == number)[:, :, None, None, None], constant[:, None, :, None] / np.pi, 0)
        return np.moveaxis(out * stack.scale[2:, None, None], 2, 1)

    @property
    def _media(self) -> list[Medium]:
        """Media of the layers and, if it is elastic, of the base."""
        return [*self.body.media, *filter(None, [self.body.base_medium])]

    def _body_at(self, depth: Array) -> NDArray[np.intp]:
        """Number of the layer, or of the base as the last one, at each depth [m], of the shape of ``depth``."""
        ends = np.cumsum([layer.thickness for layer in self.body.layers]) * _ON
        return np.searchsorted(ends, depth)

    def _rows(self, depth: Array, which: list[int]) -> Array:
        """Matrices from [u,x; t] to fields at depths (member, y), NaN in a rigid base; (member, y, field, 8)."""
        body, rows = self._body_at(depth), np.full((*depth.shape, len(which), 8), np.nan)
        for number, medium in enumerate(self._media):
            rows[body == number] = self._rows_of(medium, which)
        return rows

    def _rows_of(self, medium: Medium, which: list[int]) -> Array:
        """Matrix from the state [u,x; t] in a medium to fields; (field, 8)."""
        half, scale = medium.halfplane, self.body.scale
        units = np.concatenate([scale, 1 / scale]) / np.concatenate([half.scale, 1 / half.scale], -1)
        return np.asarray(field_rows(half)[..., which, :] * units[..., None, :])

    def _wavenumbers(self, X: Array) -> tuple[Array, Array]:
        """Nodes and weights in k for positions X (member or 1, x); (k,) each."""
        tractions, width = self.tractions, strip(self.body) / 2
        sizes = tractions.longest if len(X) == 1 else tractions.half_lengths[:, None]
        reach = float(np.max(np.abs(X) * sizes, initial=0.0)) + tractions.longest
        nearest = float(np.min(np.abs(X) * tractions.half_lengths[:, None], initial=np.inf)) - tractions.longest
        return tractions.wavenumbers(self.body, nearest, reach, width)

    def _summed(self, X: Array, Y: Array, rows: list[Array], *, integrated: bool = False) -> Array:
        """Rows of [u,x; t] of each body, or their integrals over x up to constants; (member, y, row, x, column)."""
        stack, h = self.body, self.tractions.half_lengths
        depth = -Y * h[:, None]
        body, columns, count = self._body_at(depth), self.tractions.pressures.shape[-1], len(rows[0])
        out: Array = np.zeros((h.size, depth.shape[1], count, X.shape[1], columns))
        k, weights = self._wavenumbers(X)
        factors = weights / np.pi / (1j * k if integrated else 1)
        most = max(_WAVES_AT_ONCE // (min(k.size, _WAVENUMBERS_AT_ONCE) * depth.shape[1] * count * columns), 1)
        for block in blocks(k.size, _WAVENUMBERS_AT_ONCE):
            layers = waves(stack, k[block])
            for members in blocks(h.size, most):
                top = self.tractions.part(members).in_fourier_space(k[block])
                transforms = self._waves(layers, k[block], top, depth[members], body[members], rows)
                transforms *= factors[block, None, None, None]
                x = X[members] if len(X) > 1 else X
                _add(out[members], x * h[members, None], k[block], transforms)
        if np.any(inside := np.any(body == 0, 0)):
            upper = (body[:, inside] == 0)[:, :, None, None, None]
            closed = self._halfplane(X, Y[:, inside], rows[0], integrated=integrated)
            out[:, inside] += np.where(upper, closed * h[:, None, None, None, None] if integrated else closed, 0)
        if stack.rigid:
            out[body == len(stack.layers)] = np.nan
        return out

    def _waves(
        self, layers: list[LayerWaves], k: Array, top: ComplexArray, depth: Array, body: NDArray[np.intp],
        rows: list[Array],
    ) -> ComplexArray:  # fmt: skip
        """Rows of [u,x; t] in Fourier space, without the top layer's half-plane part; (member, k, y, row, column)."""
        # top: (i sigma_xy, sigma_yy, D_y, B_y) at the surface, then at each interface; (member, k, 4, column)
        out: ComplexArray = np.zeros((*top.shape[:2], depth.shape[1], len(rows[0]), top.shape[-1]), np.complex128)
        start, all_waves = 0.0, np.arange(k.size)
        for number, layer in enumerate(layers):
            amplitude = layer.amplitude @ top
            for members, depths, inside in _blocks(body == number):
                zeta = np.clip(depth[np.ix_(members, depths)] - start, 0.0, layer.thickness)
                fields = layer_waves(layer, k, zeta, amplitude[members], rows[number], reflected=number == 0)
                out[np.ix_(members, all_waves, depths)] += np.where(inside[:, None, :, None, None], fields, 0)
            start += layer.thickness
            top = below(layer, k, amplitude, self.body.grounded[number])
        base = self.body.base_medium
        if base is not None:
            for members, depths, inside in _blocks(body == len(layers)):
                zeta = np.maximum(depth[np.ix_(members, depths)] - start, 0.0)
                fields = modal(base, k, zeta, top[members], rows[-1])
                out[np.ix_(members, all_waves, depths)] += np.where(inside[:, None, :, None, None], fields, 0)
        return out

    def _halfplane(self, X: Array, Y: Array, rows: Array, *, integrated: bool) -> Array:
        """Rows of [u,x; t] in a half-plane of the top material, in closed form; (member, y, row, x, column)."""
        medium, shape = self.body.media[0], (max(len(X), len(Y)), Y.shape[1], X.shape[1])
        response = rows @ (TURN[:, None] * np.concatenate([medium.compliance, np.eye(4)]))
        out = np.zeros(())
        for rate, part in zip(*medium.modes, strict=True):
            z = np.empty(shape, np.complex128)  # x - c and the rate times the depth, over h
            z.real = X[:, None, :] + rate.imag * Y[..., None]
            z.imag = np.abs(rate.real * Y)[..., None]
            H = self.tractions.on_plane(z.reshape(shape[0], -1), integrated=integrated)
            H[0] *= 1j
            out = out + ((-1j * response @ part) @ H.reshape(4, -1)).real
        return np.moveaxis(out.reshape(len(rows), -1, *shape[1:], self.tractions.pressures.shape[-1]), 0, 2)


def _far(stack: Stack, totals: Array) -> list[Array]:
    """Limit of k (phi, psi) as k -> 0 in each body under total tractions (member, 4, column); (member, 2, column)."""
    responses = [np.zeros((4, 4)) if stack.base_medium is None else stack.base_medium.compliance]
    for components in reversed(stack.grounded):
        responses.append(held(responses[-1], components))
    *responses_below, Y = responses
    limits, t = [(Y @ totals)[:, 2:]], totals
    for Y, components in zip(responses_below[::-1], stack.grounded, strict=True):
        free, fixed = [i for i in range(4) if i not in components], list(components)
        t = np.array(t)
        t[:, fixed] = -np.linalg.pinv(Y[np.ix_(fixed, fixed)]) @ Y[np.ix_(fixed, free)] @ t[:, free]
        limits.append((Y @ t)[:, 2:])
    return limits


def _blocks(inside: BoolArray) -> Iterator[tuple[NDArray[np.intp], NDArray[np.intp], BoolArray]]:
    """Yield, unless it is empty, the smallest block of members and depths with points inside a body, and its flags."""
    if np.any(inside):
        members, depths = np.flatnonzero(inside.any(1)), np.flatnonzero(inside.any(0))
        yield members, depths, inside[np.ix_(members, depths)]


def _add(out: Array, x: Array, k: Array, transforms: ComplexArray) -> None:
    """Add waves (member, k, y, row, column) at positions x (member, x) to ``out`` (member, y, row, x, column)."""
    phase = x[..., None] * k
    flat = transforms.reshape(*transforms.shape[:2], -1)
    real, imaginary = (np.ascontiguousarray(part) for part in (flat.real, flat.imag))
    summed = np.cos(phase) @ real - np.sin(phase) @ imaginary
    out += np.moveaxis(summed.reshape(*phase.shape[:2], *transforms.shape[2:]), 1, 3)


def fields_of(tractions: Tractions, X: Array, Y: Array, names: tuple[str, ...], datum: Array) -> Array:
    """Named fields inside films and bases under tractions of one column, SI; (member, field, y, x)."""
    if "magnetic_potential" in names and tractions.system.kernel.stack.insulated:
        raise StackError("magnetic_potential: is not given inside a film on a base that insulates the magnetic field")
    farthest = FARTHEST * strip(tractions.system.kernel.stack) / 2 / tractions.longest - 1
    if np.max(np.abs(X), initial=0.0) > farthest:
        raise StackError(
            f"x: {np.max(np.abs(X)):g} is farther from the contact than the fields inside this film are resolved, "
            f"{farthest:.3g}"
        )
    linear = tuple(name for name in names if name in LINEAR)
    interior = Interior(tractions)
    parts = [interior.fields(X[None], Y[None], linear)] if linear else []
    parts += [interior.potentials(X[None], Y[None], datum)] if len(linear) < len(names) else []
    available = (*linear, *POTENTIALS)
    return np.concatenate(parts, 1)[..., 0][:, [available.index(name) for name in names]]
