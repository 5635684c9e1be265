"""Fields inside a half-space or a stack under point contacts, in the plane of symmetry (points, 7).

Near the surface the half-space's part is closed (:mod:`solver.point.hankel`). The layers' reflections, and all fields
deeper, decay and are integrated over the wavenumbers k with Bessel functions.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, BoolArray, ComplexArray
from solver.material.constants import Material
from solver.point import hankel
from solver.point.tractions import Tractions
from solver.point.waves import ORDERS, Block, Sheared, parted, rows_of, shear_rows
from solver.stack.layers import Layer, Stack, StackError
from solver.stack.reflection import sideways
from solver.stack.wavenumbers import strip

_NEAR = 0.05  # of a: the depth above which the half-space's part is closed
_MOST_PHASE = 8000.0  # and everywhere, where the integrals over k would be longer
_STEP = 512  # wavenumbers at a time
_ENTRIES = 1 << 22  # of a block of waves: bounded memory
_ON = 1 + 1e-12  # a depth on an interface belongs to the layer above it
_DEEP = 4.0  # of a: the layer that stands for a half-space
_FARTHEST = 2000.0  # distance over the thickness of the top layer: bounded time


@dataclass(frozen=True, eq=False)
class Inside:
    """A body with fields inside."""

    stack: Stack
    plain: bool = False

    def fields(self, tractions: Tractions, X: Array, Y: Array, names: tuple[str, ...]) -> Array:
        """Fields of ``solver.halfplane.interior.LINEAR``, SI, NaN in a rigid base; (column, field, y, x).

        Potentials, too, over the unit of the body's lengths.
        """
        if "magnetic_potential" in names and sideways(self.stack):
            raise StackError(
                "fields: 'magnetic_potential' over a base that passes no flux on is relative to nothing below it; "
                "take magnetic_field_x, or a base that is grounded"
            )
        out = np.zeros((tractions.ratio.size, len(names), Y.size, X.size))
        ratios, which = np.unique(tractions.ratio, return_inverse=True)
        closed = np.zeros((which.size, Y.size), dtype=bool)
        for number, ratio in enumerate(ratios.tolist()):
            columns = np.flatnonzero(which.ravel() == number)
            depth = -Y * ratio
            bodies = np.searchsorted(self._ends, depth)
            near = (bodies == 0) & self._is_near(-Y, X)
            closed[columns] = near
            self._add_waves(out, tractions, columns, (X, depth, bodies, near), names)
            if self.stack.rigid:
                out[np.ix_(columns, np.arange(len(names)), np.flatnonzero(bodies == len(self.stack.layers)))] = np.nan
        if np.any(rows := closed.any(0)):
            for part, integrated in parted(names):
                own = self._closed(tractions, X, -Y[rows], tuple(names[place] for place in part), integrated)
                own = own * tractions.ratio[:, None, None, None] if integrated else own
                out[np.ix_(np.arange(len(out)), part, np.flatnonzero(rows))] += np.where(
                    closed[:, None, rows, None], own, 0.0
                )
        return out

    def of_layers(self, tractions: Tractions, X: Array, names: tuple[str, ...]) -> Array:
        """What the layers add to fields on the surface at x/a; (column, field, x).

        X: (x,), x/a.
        """
        out = np.zeros((tractions.ratio.size, len(names), 1, X.size))
        points = X, np.zeros(1), np.zeros(1, dtype=np.intp), np.ones(1, dtype=bool)
        for ratio in np.unique(tractions.ratio):
            self._add_waves(out, tractions, np.flatnonzero(tractions.ratio == ratio), points, names)
        return out[:, :, 0]

    @cached_property
    def _ends(self) -> Array:
        return np.cumsum([layer.thickness for layer in self.stack.layers]) * _ON

    def _is_near(self, depth: Array, X: Array) -> BoolArray:
        """Where the half-space's part is closed, of depths over a."""
        far = float(np.max(np.abs(X), initial=1.0)) + 1
        return np.asarray(depth * self._slowest < max(_NEAR, 34 * far / _MOST_PHASE))

    def _decay(self, depth: float) -> float:
        """Of waves on their way down to a depth, over k."""
        thickness = np.array([layer.thickness for layer in self.stack.layers])
        above = np.append(0.0, np.cumsum(thickness))[: self._rates.size]
        crossed = np.clip(depth - above, 0.0, np.append(thickness, np.inf)[: self._rates.size])
        return float(crossed @ self._rates)

    @cached_property
    def _rates(self) -> Array:
        """Of the slowest waves of every layer, and of a base that yields."""
        media = [*self.stack.media, *filter(None, [self.stack.base_medium])]
        base = [] if isinstance(self.stack.base, str) else [self.stack.base]
        shear = [_shear_rate(material) for material in [*(layer.material for layer in self.stack.layers), *base]]
        return np.minimum([float(medium.slowest) for medium in media], shear)

    @cached_property
    def _slowest(self) -> float:
        return float(self._rates[0])

    @cached_property
    def shear(self) -> Sheared | None:
        """The shear waves of the top; none without c12."""
        material = self.stack.top.material
        return None if np.isnan(material.c12) else Sheared.of(material)

    # -- waves ---------------------------------------------------------------------------------------------------------
    def _add_waves(
        self, out: Array, tractions: Tractions, columns: Indices,
        points: tuple[Array, Array, Indices, BoolArray], names: tuple[str, ...],
    ) -> None:  # fmt: skip
        """Add what is integrated over k: the layers' part near the surface, and everything deeper."""
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
                taken = self._rows(number, names)
                step = max(_ENTRIES // (8 * rows.size * columns.size), 8)
                for first in range(0, k.size, min(step, _STEP)):
                    here = slice(first, first + min(step, _STEP))
                    of = Block(self.stack, tractions, columns, k[here], weights[here] * k[here] * ratio**2)
                    out[np.ix_(columns, np.arange(len(names)), rows)] += of.summed(
                        X * ratio, depth[rows], number, names, taken, reflected=reflected
                    )

    def _rows(self, number: int, names: tuple[str, ...]) -> tuple[Array, Array]:
        """Return :func:`rows_of` in one body: at rest, and of cos(angle); (n, field, 8) each."""
        medium = [*self.stack.media, self.stack.base_medium][number]
        assert medium is not None
        at_rest, sliding = (rows_of(medium, self.stack.scale, names, sliding=slides) for slides in (False, True))
        return at_rest, sliding

    # -- near the surface ----------------------------------------------------------------------------------------------
    def _closed(self, tractions: Tractions, X: Array, depth: Array, names: tuple[str, ...], potentials: bool) -> Array:
        """The half-space's part, potentials over a; (column, field, depth, x)."""
        medium, scale = self.stack.media[0], self.stack.scale
        rates, parts = medium.modes
        answers: ComplexArray = np.concatenate([medium.compliance, np.eye(4)]) @ parts  # (rate, 8, 4)
        sliding = tractions.sines is not None
        shear = self.shear if sliding else None
        if shear is not None:
            rates = np.append(rates, shear.rate)
        count = len(answers)
        depth, continued = _from_below(depth)
        plain, moved = self._rows(0, names)
        out = np.empty((tractions.ratio.size, len(names), len(continued), X.size))
        for place, x in enumerate(X.tolist()):
            at = tractions.nodes(abs(x), float(np.min(depth)))
            cosines, sines = hankel.waves(rates, depth, abs(x), at, ORDERS if sliding else 3, potentials=potentials)
            weights = at.weights
            if x < 0:
                cosines[1::2], sines[1::2] = -cosines[1::2], -sines[1::2]
            first, second = tractions.vectors(at.b, np.arange(tractions.ratio.size))
            own = _applied(plain[:3], answers, cosines[:3, :count], first * weights)
            if second is not None:
                second = second * weights
                own = own + _applied(moved, answers[..., :1], cosines[:, :count], second[:, :1])
                own = own + _applied(moved, answers[..., 1:], sines[:, :count], second[:, 1:])
                if shear is not None:
                    # k u is the compliance times tau, and both fall alike
                    rows = shear_rows(shear, names) @ np.array([shear.compliance, 1.0])
                    pulled = np.einsum("nzb,cb->nzc", cosines[:, count].real, -second[:, 0])
                    own = own + np.einsum("nf,nzc->cfz", rows, pulled) / scale[0]
            out[..., place] = own @ continued.T
        return out


def _shear_rate(material: Material) -> float:
    """Of shear waves along crests; 1 without c12."""
    return 1.0 if np.isnan(material.c12) else Sheared.of(material).rate


def _from_below(depth: Array) -> tuple[Array, Array]:
    """Depths at which to sum, and what takes values there to those at all depths; (sum,) and (depth, sum)."""
    shallow = depth < hankel.LEAST
    places = hankel.LEAST * np.arange(1, 4)
    found = np.concatenate([places, depth[~shallow]]) if np.any(shallow) else depth
    continued = np.zeros((depth.size, found.size))
    continued[np.flatnonzero(~shallow), np.arange(found.size - np.count_nonzero(~shallow), found.size)] = 1.0
    t = depth[shallow] / hankel.LEAST
    if t.size:  # Lagrange's polynomials through 1, 2, 3
        continued[shallow, :3] = np.stack([(t - 2) * (t - 3) / 2, (t - 1) * (3 - t), (t - 1) * (t - 2) / 2], -1)
    return found, continued


def _applied(rows: Array, answers: ComplexArray, integrals: ComplexArray, density: Array) -> Array:
    """Real part of rows (n, field, 8) of answers (rate, 8, channel) to densities; (column, field, depth)."""
    moments = np.tensordot(integrals, density, (3, 2))  # (n, rate, z, column, channel)
    coefficients = np.einsum("nfs,rsi->nrfi", rows, answers)
    return np.asarray(np.einsum("nrfi,nrzci->cfz", coefficients, moments, optimize=True).real)


def whole(material: Material) -> Inside:
    """A half-space: a layer of contact radii on its own material."""
    return Inside(Stack((Layer(material, _DEEP, "bonded", "bonded"),), material), plain=True)
