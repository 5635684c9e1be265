"""Fields inside a half-space or a stack under point contacts, in the plane of symmetry (points, 7).

Near the surface the half-space's part is closed (:mod:`solver.point.hankel`); what the layers below reflect, and
everything deeper, decays and is integrated over the wavenumbers k with Bessel functions.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, BoolArray, ComplexArray
from solver.film.fourier import Medium
from solver.film.grading import Graded
from solver.film.kernel import strip, wavenumbers
from solver.film.reflection import LayerWaves, sideways, waves
from solver.film.stack import Layer, Stack, StackError
from solver.film.within import TURN, below, layer_waves, modal
from solver.material.constants import Material
from solver.point import hankel
from solver.point.bessel import bessel_orders
from solver.point.density import Density
from solver.point.rows import ORDERS, parted, rows_of, shear_rows
from solver.point.shear import Sheared, ShearWaves

_NEAR = 0.05  # of a: the depth above which the half-space's part is closed
_MOST_PHASE = 8000.0  # and everywhere, where the integrals over k would be longer
_STEP = 512  # wavenumbers at a time
_ENTRIES = 1 << 22  # of a block of waves: bounded memory
_ON = 1 + 1e-12  # a depth on an interface belongs to the layer above it
_DEEP = 4.0  # of a: the layer that stands for a half-space
_FARTHEST = 2000.0  # distance over the thickness of the top layer: bounded time

#: psi of (sigma_yy, D_y, B_y), the part of cos(angle), at b, of some columns; (column, 3, b).
Sines = Callable[[Array, Indices], Array]


@dataclass(frozen=True, eq=False)
class Tractions:
    """Tractions of point contacts in the units of a body; columns of cases or causes.

    Parameters
    ----------
    ratio
        Contact radius over the unit of the body's lengths; (column,).
    density
        Of the part without friction.
    friction
        eta, along x; (column,).
    sines
        Of the part that friction adds in cos(angle), eta times it; None without friction.
    """

    ratio: Array
    density: Density
    friction: Array
    sines: Sines | None = None

    @property
    def kinked(self) -> bool:
        """Whether the densities are kinked at 0 or steep at 1."""
        return self.density.kinked or self.sines is not None

    def part(self, columns: Indices) -> "Tractions":
        """Some of the columns."""
        own = self.sines
        sines = None if own is None else lambda b, some: own(b, columns[some])
        return Tractions(self.ratio[columns], self.density.part(columns), self.friction[columns], sines)

    def vectors(self, b: Array, columns: Indices) -> tuple[Array, Array | None]:
        """(sigma_xy, sigma_yy, D_y, B_y) as densities: of 1, all in cos kb; of cos(angle), the first in cos kb.

        Returns (column, 4, b) each, of some columns; none of the second without friction.
        """
        own = self.density.part(columns).at(b)
        plain = np.concatenate([np.zeros_like(own[:, :1]), own], 1)
        if self.sines is None:
            return plain, None
        return plain, np.concatenate([-self.friction[columns, None, None] * own[:, :1], self.sines(b, columns)], 1)

    def nodes(self, radius: float, near: float) -> hankel.Nodes:
        """Nodes in b for a field point, its r/a and its depth over a."""
        return hankel.nodes(radius, near, kinked=self.kinked)

    def transforms(self, phases: Array, columns: Indices) -> tuple[Array, Array | None]:
        """Tractions at the surface as waves of phases k a, of 1 and of cos(angle); (k, 4, column) each.

        Parameters
        ----------
        phases
            k a; (k,).
        columns
            Those of one radius.
        """
        at = hankel.nodes(parts=hankel.parts(phases), kinked=self.kinked)
        first, second = self.vectors(at.b, columns)
        cosines = np.cos(phases[:, None] * at.b) * at.weights
        top = np.einsum("kb,cib->kic", cosines, first, optimize=True)
        if second is None:
            return top, None
        sines = np.sin(phases[:, None] * at.b) * at.weights
        along = np.einsum("kb,cib->kic", cosines, second[:, :1], optimize=True)
        down = np.einsum("kb,cib->kic", sines, second[:, 1:], optimize=True)
        return top, np.concatenate([along, down], 1)

    def wavenumbers(self, stack: Stack, reach: float, width: float) -> tuple[Array, Array]:
        """Wavenumbers and weights of integrals over k of a stack.

        Parameters
        ----------
        stack
            Layers and base.
        reach, width
            What phases are longest over, and what waves decay over, in the unit of the body's lengths.
        """
        return wavenumbers(stack, reach, width)


@dataclass(frozen=True, eq=False)
class Inside:
    """A body with fields inside.

    Parameters
    ----------
    stack
        Layers and base; a half-space is a layer on itself, see :func:`whole`.
    plain
        Whether it is a half-space.
    graded
        The layer that the upper layers are the steps of; None: they are themselves.
    """

    stack: Stack
    plain: bool = False
    graded: Graded | None = None

    def fields(self, tractions: Tractions, X: Array, Y: Array, names: tuple[str, ...]) -> Array:
        """Fields of ``solver.halfplane.interior.LINEAR``, SI, NaN in a rigid base; (column, field, y, x).

        Potentials, too, over the unit of the body's lengths.

        Parameters
        ----------
        tractions
            Of all columns.
        X, Y
            x/a and y/a <= 0; for all columns.
        names
            Of the fields; stresses in the surface need c12 everywhere.

        Raises
        ------
        StackError
            Points farther from the contact than is resolved, the magnetic potential over an insulated base.
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
        """What the layers add to fields on the surface at x/a; (column, field, x)."""
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

    @cached_property
    def _slowest(self) -> float:
        return min(float(self.stack.media[0].slowest), self._shear.rate if self._shear else 1.0)

    @cached_property
    def _shear(self) -> Sheared | None:
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
                width = strip(self.stack) / 2
                if number == 0 and not reflected:
                    width = self._slowest * float(np.min(depth[rows]))
                reach = ratio * (1 + float(np.max(np.abs(X))))
                if reach > _FARTHEST * max(width, strip(self.stack) / 2):
                    raise StackError(f"x: {np.max(np.abs(X)):g} is farther from the contact than is resolved")
                k, weights = tractions.wavenumbers(self.stack, 2 * reach, width)
                step = max(_ENTRIES // (8 * rows.size * columns.size), 8)
                for first in range(0, k.size, min(step, _STEP)):
                    here = slice(first, first + min(step, _STEP))
                    of = _Block(self, tractions, columns, k[here], weights[here] * k[here] * ratio**2)
                    out[np.ix_(columns, np.arange(len(names)), rows)] += of.summed(
                        X * ratio, depth[rows], number, names, reflected=reflected
                    )

    def rows(self, number: int, depth: Array, names: tuple[str, ...], *, sliding: bool) -> Array:
        """:func:`rows_of` at depths within one body, the base the last, of the material there; (depth, n, field, 8)."""
        stack, layer = self.stack, self.graded
        if layer is None or number >= self._steps:
            medium = [*stack.media, stack.base_medium][number]
            assert medium is not None
            own = rows_of(medium, stack.scale, names, sliding=sliding)
            return np.broadcast_to(own, (depth.size, *own.shape))
        materials = [layer.profile(np.array(share)) for share in np.clip(depth / layer.thickness, 0.0, 1.0).tolist()]
        return np.array([rows_of(Medium(one, stack.scale), stack.scale, names, sliding=sliding) for one in materials])

    @cached_property
    def _steps(self) -> int:
        """Number of layers that are steps of the graded one."""
        ends = np.cumsum([layer.thickness for layer in self.stack.layers])
        return 0 if self.graded is None else int(np.searchsorted(ends, self.graded.thickness * (1 - 1e-9))) + 1

    # -- near the surface ----------------------------------------------------------------------------------------------
    def _closed(self, tractions: Tractions, X: Array, depth: Array, names: tuple[str, ...], potentials: bool) -> Array:
        """The half-space's part, potentials over a; (column, field, depth, x)."""
        medium, scale = self.stack.media[0], self.stack.scale
        rates, parts = medium.modes
        answers: ComplexArray = np.concatenate([medium.compliance, np.eye(4)]) @ parts  # (rate, 8, 4)
        sliding = tractions.sines is not None
        shear = self._shear if sliding else None
        if shear is not None:
            rates = np.append(rates, shear.rate)
        count = len(answers)
        depth, continued = _from_below(depth)
        plain, moved = (self.rows(0, depth * float(tractions.ratio[0]), names, sliding=of) for of in (False, True))
        out = np.empty((tractions.ratio.size, len(names), len(continued), X.size))
        for place, x in enumerate(X.tolist()):
            at = tractions.nodes(abs(x), float(np.min(depth)))
            cosines, sines = hankel.waves(rates, depth, abs(x), at, ORDERS if sliding else 3, potentials=potentials)
            weights = at.weights
            if x < 0:
                cosines[1::2], sines[1::2] = -cosines[1::2], -sines[1::2]
            first, second = tractions.vectors(at.b, np.arange(tractions.ratio.size))
            own = _applied(plain[:, :3], answers, cosines[:3, :count], first * weights)
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
    """Real part of rows (depth, n, field, 8) of answers (rate, 8, channel) to densities; (column, field, depth)."""
    moments = np.tensordot(integrals, density, (3, 2))  # (n, rate, z, column, channel)
    if rows.strides[0] == 0:  # of one material
        coefficients = np.einsum("nfs,rsi->nrfi", rows[0], answers)
        return np.asarray(np.einsum("nrfi,nrzci->cfz", coefficients, moments, optimize=True).real)
    coefficients = np.einsum("znfs,rsi->znrfi", rows, answers)
    return np.asarray(np.einsum("znrfi,nrzci->cfz", coefficients, moments, optimize=True).real)


@dataclass(frozen=True, eq=False)
class _Block:
    """Waves of some wavenumbers, with their shares of the integrals.

    Attributes
    ----------
    inside, tractions
        Of which body, of all columns.
    columns
        Those of one radius.
    k, shares
        Over the unit of the body's lengths; (k,).
    """

    inside: Inside
    tractions: Tractions
    columns: Indices
    k: Array
    shares: Array

    @cached_property
    def _tops(self) -> tuple[Array, Array | None]:
        """Tractions at the surface, of 1 and of cos(angle), but for the sums over b; (k, 4, column) each."""
        return self.tractions.transforms(self.k * float(self.tractions.ratio[self.columns[0]]), self.columns)

    def summed(self, x: Array, depth: Array, number: int, names: tuple[str, ...], *, reflected: bool) -> Array:
        """Fields at depths within one body, the base the last; (column, field, depth, x)."""
        stack = self.inside.stack
        out = np.zeros((len(self.columns), len(names), depth.size, x.size))
        orders = bessel_orders(self.k, x, 3 if self._tops[1] is None else ORDERS) * self.shares[:, None]
        parts = [(part, orders / self.k[:, None] if potentials else orders) for part, potentials in parted(names)]
        for sliding, top in enumerate(self._tops):
            if top is None:
                continue
            states = self._states(top, depth, number, reflected=reflected)
            rows = self.inside.rows(number, depth, names, sliding=bool(sliding))
            for part, weighted in parts:
                for n, J in enumerate(weighted):
                    _add(out, part, rows[:, n, part], states, J)
            if sliding and self.inside._shear is not None:
                waved = ShearWaves(stack, self.k).at(number, depth, reflected=reflected)
                pulled = np.einsum("skz,kc->kzsc", waved, -top[:, 0]) / stack.scale[0]
                material = stack.layers[number].material if number < len(stack.layers) else stack.base
                assert isinstance(material, Material)
                for n, J in enumerate(orders):
                    _add(out, np.arange(len(names)), shear_rows(Sheared.of(material), names)[None, n], pulled, J)
        return out

    def _states(self, top: Array, depth: Array, number: int, *, reflected: bool) -> Array:
        """The real form [k u; t] at depths; (k, depth, 8, column)."""
        stack, k, t = self.inside.stack, self.k, top[None].astype(np.complex128)
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
        return waves(self.inside.stack, self.k)


def _real(turned: ComplexArray) -> Array:
    return np.asarray((turned[0] * np.conj(TURN)[:, None]).real)


def _add(out: Array, fields: Indices, rows: Array, states: Array, J: Array) -> None:
    """Add rows (depth, field, s) of states (k, depth, s, column) times a Bessel function (k, x) to some fields."""
    there = np.flatnonzero(rows.any((0, 2)))
    if there.size:
        same = rows.strides[0] == 0 or len(rows) == 1  # of one material
        form, own = ("fs,kzsc->cfzk", rows[0, there]) if same else ("zfs,kzsc->cfzk", rows[:, there])
        taken = np.einsum(form, own, states, optimize=True)
        out[:, fields[there]] += taken @ J


def whole(material: Material) -> Inside:
    """A half-space: a layer of contact radii on its own material."""
    return Inside(Stack((Layer(material, _DEEP, "bonded", "bonded"),), material), plain=True)
