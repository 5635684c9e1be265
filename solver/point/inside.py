"""Fields inside a half-space or a stack under point contacts, in the plane of symmetry (points, 7)."""

from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np

from approximation.arrays import Indices, blocks
from solver.arrays import Array, BoolArray, ComplexArray
from solver.material.constants import Material
from solver.point import hankel
from solver.point.tractions import Tractions
from solver.point.waves import ORDERS, Block, Sheared, parted, rows_of, shear_rows
from solver.stack.layers import Layer, Stack, StackError
from solver.stack.reflection import sideways
from solver.stack.wavenumbers import strip

_NEAR = 0.05  # depth over a above which the half-space's part is closed
_MOST_PHASE = 8000.0  # largest phase of the integrals over k; beyond it the closed part serves at any depth
_STEP_IN_K = 512  # wavenumbers at a time
_ENTRIES = 1 << 22  # values of a block of waves: bounded memory
_PLACES = 4096  # positions along the surface at a time: bounded memory
_COLUMNS = 1024  # cases at a time: bounded memory
_ON = 1 + 1e-12  # a depth on an interface belongs to the layer above it
_DEEP = 4.0  # thickness over a of the layer that replaces a half-space
_LEVELS = np.arange(1.0, 6.0)  # least depths from which fields are extrapolated to the surface
_FARTHEST = 2000.0  # distance over the thickness of the top layer: bounded time


@dataclass(frozen=True, eq=False)
class Inside:
    """Body whose fields inside are solved."""

    stack: Stack
    plain: bool = False  # Whether it is a half-space

    def fields(self, tractions: Tractions, X: Array, Y: Array, names: tuple[str, ...]) -> Array:
        """Fields of ``LINEAR``, SI, and potentials over the length unit, NaN in a rigid base; (column, field, y, x)."""
        if "magnetic_potential" in names and sideways(self.stack):
            raise StackError(
                "fields: 'magnetic_potential' over a base that passes no flux on is relative to nothing below it; "
                "take magnetic_field_x, or a base that is grounded"
            )
        if (count := tractions.ratio.size) > _COLUMNS:
            parts = [tractions.part(np.arange(count)[block]) for block in blocks(count, _COLUMNS)]
            return np.concatenate([self.fields(part, X, Y, names) for part in parts])
        out = np.zeros((tractions.ratio.size, len(names), Y.size, X.size))
        closed = np.zeros((len(out), Y.size), dtype=bool)
        for ratio in np.unique(tractions.ratio).tolist():
            columns = np.flatnonzero(tractions.ratio == ratio)
            depth = -Y * ratio
            bodies = np.searchsorted(self._ends, depth)
            near = (bodies == 0) & self._is_near(-Y, X)
            closed[columns] = near
            self._add_waves(out, tractions, columns, (X, depth, bodies, near), names)
            if self.stack.rigid:
                out[np.ix_(columns, np.arange(len(names)), np.flatnonzero(bodies == len(self.stack.layers)))] = np.nan
        if np.any(rows := closed.any(0)):
            for part, integrated in parted(names):
                fields = self._closed(tractions, X, -Y[rows], tuple(names[number] for number in part), integrated)
                fields = fields * tractions.ratio[:, None, None, None] if integrated else fields
                out[np.ix_(np.arange(len(out)), part, np.flatnonzero(rows))] += np.where(
                    closed[:, None, rows, None], fields, 0.0
                )
        return out

    def of_layers(self, tractions: Tractions, X: Array, names: tuple[str, ...]) -> Array:
        """Layers' contribution to fields on the surface at x/a; (column, field, x)."""
        out = np.zeros((tractions.ratio.size, len(names), 1, X.size))
        points = X, np.zeros(1), np.zeros(1, dtype=np.intp), np.ones(1, dtype=bool)
        for ratio in np.unique(tractions.ratio):
            self._add_waves(out, tractions, np.flatnonzero(tractions.ratio == ratio), points, names)
        return out[:, :, 0]

    @cached_property
    def _ends(self) -> Array:
        return np.cumsum([layer.thickness for layer in self.stack.layers]) * _ON

    def _is_near(self, depth: Array, X: Array) -> BoolArray:
        """Mark depths over a at which the half-space's part is closed."""
        far = float(np.max(np.abs(X), initial=1.0)) + 1
        return np.asarray(depth * self._rates[0] < max(_NEAR, 34 * far / _MOST_PHASE))

    def _decay(self, depth: float) -> float:
        """Decay exponent over k of waves from the surface down to a depth."""
        thickness = np.array([layer.thickness for layer in self.stack.layers])
        above = np.append(0.0, np.cumsum(thickness))[: self._rates.size]
        crossed = np.clip(depth - above, 0.0, np.append(thickness, np.inf)[: self._rates.size])
        return float(crossed @ self._rates)

    @cached_property
    def _rates(self) -> Array:
        """Decay rates of the slowest waves of every layer, and of an elastic base."""
        media = [*self.stack.media, *filter(None, [self.stack.base_medium])]
        base = [] if isinstance(self.stack.base, str) else [self.stack.base]
        shear = [_shear_rate(material) for material in [*(layer.material for layer in self.stack.layers), *base]]
        return np.minimum([float(medium.slowest) for medium in media], shear)

    @cached_property
    def shear(self) -> Sheared | None:
        """Shear waves of the top; None without c12."""
        material = self.stack.top.material
        return None if np.isnan(material.c12) else Sheared.of(material)

    # -- waves ---------------------------------------------------------------------------------------------------------
    def _add_waves(
        self, out: Array, tractions: Tractions, columns: Indices,
        points: tuple[Array, Array, Indices, BoolArray], names: tuple[str, ...],
    ) -> None:  # fmt: skip
        """Add the integrals over k: the layers' part near the surface, and all fields deeper."""
        X, depth, bodies, near = points
        ratio = float(tractions.ratio[columns[0]])
        for number in np.unique(bodies).tolist():
            if number == len(self.stack.layers) and self.stack.rigid:
                continue
            for reflected in (True, False) if number == 0 else (False,):
                rows = np.flatnonzero((bodies == number) & (near == reflected))
                if not rows.size or (reflected and self.plain):
                    continue
                width = strip(self.stack) / 2 if reflected else self._decay(float(np.min(depth[rows])))
                reach = ratio * (1 + float(np.max(np.abs(X))))
                if reach > _FARTHEST * max(width, strip(self.stack) / 2):
                    raise StackError(f"x: {np.max(np.abs(X)):g} is farther from the contact than is resolved")
                k, weights = tractions.wavenumbers(self.stack, 2 * reach, width)
                rows_of_parts, level = self.rows(number, names), 8 * columns.size
                step = min(max(_ENTRIES // (level * rows.size), 8), _STEP_IN_K)
                depths = max(_ENTRIES // (8 * level), 1)
                for waves in blocks(k.size, step):
                    block = Block(self.stack, tractions, columns, k[waves], weights[waves] * k[waves] * ratio**2)
                    for low, left in product(range(0, rows.size, depths), range(0, X.size, _PLACES)):
                        chosen, along = rows[low : low + depths], np.arange(left, min(left + _PLACES, X.size))
                        out[np.ix_(columns, np.arange(len(names)), chosen, along)] += block.summed(
                            X[along] * ratio, depth[chosen], number, names, rows_of_parts, reflected=reflected
                        )

    def rows(self, number: int, names: tuple[str, ...]) -> tuple[Array, Array]:
        """Rows of :func:`rows_of` in one body, at rest and of cos(angle); (n, field, 8) each."""
        medium = [*self.stack.media, self.stack.base_medium][number]
        assert medium is not None
        at_rest, sliding = (rows_of(medium, self.stack.scale, names, sliding=slides) for slides in (False, True))
        return at_rest, sliding

    # -- near the surface ----------------------------------------------------------------------------------------------
    def _closed(self, tractions: Tractions, X: Array, depth: Array, names: tuple[str, ...], potentials: bool) -> Array:
        """Half-space's part of the fields, potentials over a; (column, field, depth, x)."""
        part, columns = _HalfspacePart(self, tractions, names, potentials), tractions.ratio.size
        out = np.empty((columns, len(names), depth.size, X.size))
        for number, x in enumerate(X.tolist()):
            least = tractions.least_depth(abs(x))
            shallow = depth < least
            base = least * _LEVELS if np.any(shallow) else np.empty(0)
            summed = np.concatenate([base, depth[~shallow]])
            nodes = tractions.nodes(abs(x), float(np.min(summed)))
            densities = tractions.vectors(nodes.b, np.arange(columns))
            step = max(_ENTRIES // (4 * ORDERS * (nodes.b.size + 4 * columns)), 1)
            levels = [summed[start : start + step] for start in range(0, summed.size, step)]
            values = np.concatenate([part.at(x, level, nodes, densities) for level in levels], -1)
            out[:, :, ~shallow, number] = values[..., base.size :]
            if base.size:
                out[:, :, shallow, number] = values[..., : base.size] @ _extrapolation(depth[shallow] / least).T
        return out


@dataclass(frozen=True, eq=False)
class _HalfspacePart:
    """Closed part of the fields, of the half-space of the top."""

    inside: Inside
    tractions: Tractions
    names: tuple[str, ...]
    potentials: bool  # Whether the names are potentials, whose integrals lack a factor k

    @cached_property
    def _modes(self) -> tuple[ComplexArray, ComplexArray]:
        """Decay rates of the half-space's waves, (rate,), and their states per traction; (rate, 8, 4)."""
        medium = self.inside.stack.media[0]
        rates, parts = medium.modes
        return rates, np.concatenate([medium.compliance, np.eye(4)]) @ parts

    @cached_property
    def _rows(self) -> tuple[Array, Array]:
        """Rows of the fields: at rest, and of cos(angle); (n, field, 8) each."""
        return self.inside.rows(0, self.names)

    def at(self, x: float, depth: Array, nodes: hankel.Nodes, densities: tuple[Array, Array | None]) -> Array:
        """Fields at one x/a and depths over a, of densities at nodes in b; (column, field, depth)."""
        (rates, states), (at_rest, of_cosine), (first, second) = self._modes, self._rows, densities
        count, shear = rates.size, None if second is None else self.inside.shear
        if shear is not None:
            rates = np.append(rates, shear.rate)
        orders = 3 if second is None else ORDERS
        cosines, sines = hankel.waves(rates, depth, abs(x), nodes, orders, potentials=self.potentials)
        if x < 0:
            cosines[1::2], sines[1::2] = -cosines[1::2], -sines[1::2]
        fields = _applied(at_rest[:3], states, cosines[:3, :count], first * nodes.weights)
        if second is None:
            return fields
        second = second * nodes.weights
        fields = fields + _applied(of_cosine, states[..., :1], cosines[:, :count], second[:, :1])
        fields = fields + _applied(of_cosine, states[..., 1:], sines[:, :count], second[:, 1:])
        if shear is None:
            return fields
        # k u is the compliance times tau, and both decay at the same rate
        rows = shear_rows(shear, self.names) @ np.array([shear.compliance, 1.0])
        shear_states = np.einsum("nzb,cb->nzc", cosines[:, count].real, -second[:, 0])
        return np.asarray(fields + np.einsum("nf,nzc->cfz", rows, shear_states) / self.inside.stack.scale[0])


def _shear_rate(material: Material) -> float:
    """Decay rate of shear waves along crests; 1 without c12."""
    return 1.0 if np.isnan(material.c12) else Sheared.of(material).rate


def _applied(rows: Array, states: ComplexArray, integrals: ComplexArray, density: Array) -> Array:
    """Real part of rows (n, field, 8) of states (rate, 8, channel) under densities; (column, field, depth)."""
    moments = np.tensordot(integrals, density, (3, 2))  # (n, rate, z, column, channel)
    coefficients = np.einsum("nfs,rsi->nrfi", rows, states)
    return np.asarray(np.einsum("nrfi,nrzci->cfz", coefficients, moments, optimize=True).real)


def _extrapolation(depth: Array) -> Array:
    """Lagrange polynomials through ``_LEVELS`` at depths over the least one; (depth, level)."""
    polynomials = [
        np.prod([(depth - other) / (level - other) for other in _LEVELS if other != level], 0) for level in _LEVELS
    ]
    return np.stack(polynomials, -1)


def whole(material: Material) -> Inside:
    """Half-space as a layer of some contact radii on its own material."""
    return Inside(Stack((Layer(material, _DEEP, "bonded", "bonded"),), material), plain=True)
