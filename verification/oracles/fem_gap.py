"""Sliding contact of an elastic punch on layers with air beside it, by spectral finite elements.

Written from the equations (docs/theory.md, section 1; the gap's D_y = -eps0 (V - phi)/g and its magnetic twin), before
the solver knew either. Body and punch are meshed both; the punch, an isotropic conductor, is a half-plane upside down,
joined to the body in the contact. The air is a spring on the potentials of the surface beside the contact, of a
strength that the gap decides; gaps and potentials are found in turn, which converges: charges press little.

At a given half-length of the contact the two ends may carry no singular pressure; the load comes out.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import block_array, coo_array, csr_array, eye_array
from scipy.special import eval_jacobi, gamma

from verification.oracles.fem import STIFFNESS, UNITS
from verification.oracles.fem_film import ELECTRIC, MAGNETIC, Layer, Punch
from verification.oracles.film_mesh import layered_mesh
from verification.oracles.gap_response import VACUUM, Dry, along, contact, lagrange, lobatto, sides
from verification.oracles.spectral import Body, Index
from verification.oracles.surface_response import Array, surface_response

_FORCES = STIFFNESS / UNITS
_STEPS = 60
_CLOSE = 1e-7  # change of the punch's place and potentials from one step to the next, each over itself
_SMALL = 1e-6  # over the largest of them: counts as nothing
_LEAST = 1e-9  # gap over the length of an element below which the potential is as good as the punch's


@dataclass(frozen=True, eq=False)
class GapContact:
    """The contact of a given half-length.

    Attributes
    ----------
    layers : sequence of fem_film.Layer
        From the top down.
    base : mapping or None
        Constants of the half-plane below them; None: rigid.
    punch : fem_film.Punch
    half_length : float
        (a + b)/2 [m].
    permittivity : float
        Of the medium in the gap over vacuum's; 0: D_y = 0 and B_y = 0 beside the contact.
    elastic : mapping or None
        Constants of the punch's material; None: rigid.
    order : int
        Of the polynomials of an element.
    """

    layers: Sequence[Layer]
    base: Mapping[str, float] | None
    punch: Punch
    half_length: float
    permittivity: float = 1.0
    elastic: Mapping[str, float] | None = None
    order: int = 8

    # -- the two bodies ------------------------------------------------------------------------------------------------
    @cached_property
    def body(self) -> Body:
        """The meshed layers and base."""
        mesh = layered_mesh([layer.thickness / self.half_length for layer in self.layers], self.base is None)
        materials = [layer.material for layer in self.layers]
        return Body(mesh, materials if self.base is None else [*materials, self.base], self.order)

    @cached_property
    def _upper(self) -> Body | None:
        """The punch upside down: its surface has the same nodes in the contact."""
        if self.elastic is None:
            return None
        thickness = self.layers[0].thickness / self.half_length
        return Body(layered_mesh([thickness], False), [self.elastic, self.elastic], self.order)

    @cached_property
    def _below(self) -> Index:
        return contact(self.body)

    def _held(self) -> NDArray[np.bool_]:
        """Which of (u_x, u_y, phi, psi) of the body's nodes are given, and all of the punch's that are not its u."""
        x, y = self.body.places.T
        held = np.zeros((len(x), 4), dtype=bool)
        held[np.isclose(np.abs(x), x.max())] = True
        held[np.isclose(y, y.min()), : 4 if self.base else 2] = True
        depths = np.cumsum([layer.thickness for layer in self.layers]) / self.half_length
        for depth, layer in zip(depths, self.layers, strict=True):
            for potential in layer.grounded:
                held[np.isclose(y, -depth), potential] = True
        held[self._below, 1] = True
        for potential in self.punch.conducted:
            held[self._below, potential] = True
        if self._upper is None:
            return held.ravel()
        x, y = self._upper.places.T
        mine = np.zeros((len(x), 4), dtype=bool)
        mine[:, 2:] = True
        mine[np.isclose(np.abs(x), x.max()) | np.isclose(y, y.min())] = True
        return np.concatenate([held.ravel(), mine.ravel()])

    @cached_property
    def _stiffness(self) -> "csr_array[np.float64]":
        matrix = self.body.matrix()
        if self._upper is None:
            return matrix
        return csr_array(block_array([[matrix, None], [None, self._upper.matrix()]], format="csr"))

    @cached_property
    def _joined(self) -> "tuple[csr_array[np.float64], csr_array[np.float64]]":
        """Rows: Coulomb's law and what the punch answers; columns: u_y of the body gives way by the punch's."""
        size, count = self._stiffness.shape[0], 4 * len(self.body.places)
        body = 4 * self._below
        entries = [(body, body + 1, -self.punch.friction)]
        slaves: list[tuple[Index, Index, float]] = []
        if self._upper is not None:
            mine = count + 4 * contact(self._upper)
            entries += [(mine, body + 1, self.punch.friction), (mine + 1, body + 1, -1.0)]
            slaves = [(body + 1, mine + 1, -1.0)]
        rows, columns = (csr_array(eye_array(size) + _sparse(triples, size)) for triples in (entries, slaves))
        return rows, columns

    # -- the air -------------------------------------------------------------------------------------------------------
    @cached_property
    def _edges(self) -> Index:
        """Nodes of the elements' sides on the body's surface beside the contact, by rising x; (side, order + 1)."""
        return sides(self.body)

    @cached_property
    def _rule(self) -> tuple[Array, Array, Array]:
        """Shapes at Gauss's points of a side (point, node), and x and weights of all points (side, point)."""
        points, weights = np.polynomial.legendre.leggauss(self.order + 6)
        line = lobatto(self.order)
        shapes = lagrange(line, points)
        ends = self.body.places[self._edges][:, [0, -1], 0]
        half = (ends[:, 1] - ends[:, 0]) / 2
        return shapes, ends.mean(axis=1)[:, None] + half[:, None] * points, half[:, None] * weights

    def _springs(self, gap: Array) -> "dict[int, csr_array[np.float64]]":
        """Of each conducted potential: scaled int eps/g N N ds over nodes, from gaps over h (side, point)."""
        shapes, _, weights = self._rule
        nodes, least = self._edges, _LEAST * weights.sum(axis=1, keepdims=True)
        springs = {}
        for potential in self.punch.conducted:
            strength = self._medium(potential) * UNITS[potential] ** 2 / STIFFNESS
            blocks = strength * np.einsum("sp,pi,pj->sij", weights / np.maximum(gap, least), shapes, shapes)
            rows, columns = np.broadcast_arrays(nodes[:, :, None], nodes[:, None, :])
            count = len(self.body.places)
            springs[potential] = csr_array(
                coo_array((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=(count, count))
            )
        return springs

    def _medium(self, potential: int) -> float:
        """eps or mu of the gap; the medium's permittivity says nothing of mu0."""
        return VACUUM[potential] * (self.permittivity if potential == ELECTRIC else float(self.permittivity > 0))

    # -- the solution --------------------------------------------------------------------------------------------------
    @cached_property
    def _dry(self) -> Dry:
        """The system without air."""
        conducted, below = self.punch.conducted, self._below
        u = np.zeros((self._stiffness.shape[0], 3 + len(conducted)))
        u[4 * below + 1, :3] = self.body.places[below, 0][:, None] ** np.arange(3)
        for state, potential in enumerate(conducted, start=3):
            u[4 * below + potential, state] = 1.0
        beside = np.setdiff1d(self._edges, below)
        airy = np.array([4 * beside + potential for potential in conducted], dtype=int).ravel()
        touched = (4 * below[:, None] + np.arange(4)).ravel()
        raised = [4 * np.unique(self._edges) + 1]
        if self._upper is not None:
            raised.append(4 * (len(self.body.places) + np.unique(sides(self._upper))) + 1)
        return Dry.of(self._stiffness, *self._joined, ~self._held(), u, airy, touched, np.concatenate(raised))

    def _states(self, gap: Array) -> tuple[Array, Array]:
        """Scaled u (unknowns, states), right on the surface only, and nodal loads (node, 4, states) of the body.

        The states: u_y = 1, X, X^2 and, of every conducted potential, 1 under the punch.
        """
        dry, conducted, size = self._dry, self.punch.conducted, self._stiffness.shape[0]
        air, pushed = csr_array((size, size)), np.zeros((size, 3 + len(conducted)))
        springs = self._springs(gap)
        for state, potential in enumerate(conducted, start=3):
            spring = springs[potential].tocoo()
            at = 4 * spring.row + potential, 4 * spring.col + potential
            air = air + csr_array((spring.data, at), shape=(size, size))
            pushed[potential : 4 * len(self.body.places) : 4, state] = springs[potential].sum(axis=1)
        held = dry.given.copy()
        held[dry.airy] = 0.0  # the ends of the contact are left
        given = (air @ held - pushed)[dry.airy]
        inner = air[dry.airy][:, dry.airy].toarray()
        matrix = np.eye(len(inner)) - dry.flexibility @ inner
        potentials = np.linalg.solve(matrix, dry.given_there + dry.flexibility @ given)
        charged = inner @ potentials + given
        u = dry.given.copy()
        u[dry.airy] = potentials
        u[dry.raised] += dry.lift @ charged
        loads = np.zeros((size, u.shape[1]))
        loads[dry.airy] = charged
        loads[dry.touched] = dry.given_loads + dry.pressed @ charged
        count = len(self.body.places)
        return u, loads[: 4 * count].reshape(count, 4, -1)

    def _weights(self, loads: Array) -> Array:
        """Of the states, scaled."""
        conducted = self.punch.conducted
        charges = {ELECTRIC: self.punch.charge, MAGNETIC: self.punch.magnetic_charge}
        rows = np.array([
            *self._singular(loads[self._below, 1]), *(-loads[:, potential].sum(axis=0) for potential in conducted)
        ])  # fmt: skip
        curved = self.half_length**2 / (2 * self.punch.radius)
        right = np.array([0.0, 0.0, *(charges[p] / _FORCES[p] for p in conducted)]) - rows[:, 2] * curved
        return np.insert(np.linalg.solve(np.delete(rows, 2, axis=1), right), 2, curved)

    def _singular(self, forces: Array) -> Array:
        """Strength of the singular pressure at X = -1 and 1, from nodal forces (nodes, states); (2, states)."""
        A, B = self._exponents
        n = np.arange(2 * self.order)[:, None]
        norm = gamma(n + A + 1) * gamma(n + B + 1) / gamma(n + 1) ** 2 / np.where(n, 2, 1)
        series = eval_jacobi(n, A, B, self.body.places[self._below, 0]) @ forces / norm
        return np.stack([eval_jacobi(n[:, 0], A, B, end) @ series for end in (-1.0, 1.0)])

    @cached_property
    def _exponents(self) -> tuple[float, float]:
        """Exponents at X = 1 and -1 of a pressure that is singular where a conductor, or an insulator, ends."""
        conducted = [potential - 1 for potential in self.punch.conducted]
        below = surface_response(self.layers[0].material)
        N, k = below.normal_compliance, below.shear_coupling
        minus = np.linalg.solve(N[np.ix_(conducted, conducted)], N[conducted, 0])
        compliance, turn = N[0, 0] - N[0, conducted] @ minus, k[0] - k[conducted] @ minus
        if self.elastic is not None:
            above = surface_response(self.elastic)
            compliance, turn = compliance + above.normal_compliance[0, 0], turn - above.shear_coupling[0]
        alpha = np.arctan2(compliance, -self.punch.friction * turn) / np.pi
        return alpha - 1, -alpha

    @cached_property
    def _solved(self) -> tuple[Array, Array, Array, Array]:
        """Scaled u, nodal loads, weights of the states, and the gaps over h (side, point)."""
        x = self._rule[1]
        curved = (np.abs(x) - 1) * np.sqrt(np.abs(x) ** 2 - 1) * self.half_length / (2 * self.punch.radius)
        gap = curved if self.permittivity else np.full_like(curved, np.inf)
        last = np.zeros(3 + len(self.punch.conducted))
        for _ in range(_STEPS):
            states, loads = self._states(gap)
            weights = self._weights(loads)
            u, size = states @ weights, np.abs(weights)
            change = np.max(np.abs(weights - last) / np.maximum(size, _SMALL * size.max()))
            if not self.permittivity or change < _CLOSE:
                return u, loads @ weights, weights, gap
            gap, last = self._gap(u, weights), weights
        raise ArithmeticError(f"the punch's place and potentials still change by {change:.1e} after {_STEPS} steps")

    def _gap(self, u: Array, weights: Array) -> Array:
        """Gap over h at Gauss's points beside the contact (side, point)."""
        shapes, x, _ = self._rule
        raised = u.reshape(-1, 4)[self._edges, 1] @ shapes.T
        profile = weights[0] + weights[1] * x + weights[2] * x**2
        if self._upper is not None:
            mine = u.reshape(-1, 4)[len(self.body.places) :, 1]
            raised = raised + along(self._upper, mine, x)
        return np.asarray((profile - raised) / self.half_length)

    # -- what is asked of it -------------------------------------------------------------------------------------------
    @property
    def load(self) -> float:
        """P [N/m]."""
        return float(-self._solved[1][self._below, 1].sum() * _FORCES[1])

    @property
    def centre(self) -> float:
        """(a - b)/2 [m]."""
        return float(self._solved[2][1] * self.punch.radius / self.half_length)

    @property
    def depth(self) -> float:
        """Of a rigid punch on a rigid base [m]."""
        return float(self.centre**2 / (2 * self.punch.radius) - self._solved[2][0])

    def potential(self, which: int) -> float:
        """V [V] (``ELECTRIC``) or Psi [A] (``MAGNETIC``) on a rigid base."""
        return float(self._solved[2][3 + self.punch.conducted.index(which)] * UNITS[which])

    def beside(self, which: int) -> tuple[Array, Array]:
        """(x - c)/h of nodes beside the contact, and phi [V] (``ELECTRIC``) or psi [A] (``MAGNETIC``); (node,) each."""
        nodes = np.setdiff1d(self._edges, self._below)
        return self.body.places[nodes, 0], self._solved[0].reshape(-1, 4)[nodes, which] * UNITS[which]

    @property
    def gap_field(self) -> float:
        """Largest field in the gap [V/m], at Gauss's points."""
        shapes, _, _ = self._rule
        u, _, _, gap = self._solved
        phi = u.reshape(-1, 4)[self._edges, ELECTRIC] @ shapes.T * UNITS[ELECTRIC]
        wide = gap > 1e-7 * np.max(gap[np.isfinite(gap)])
        return float(np.max(np.where(wide, np.abs(self.potential(ELECTRIC) - phi) / gap, 0.0)) / self.half_length)


def _sparse(triples: Sequence[tuple[Index, Index, float]], size: int) -> "csr_array[np.float64]":
    rows, columns, values = [np.concatenate([np.zeros(0, dtype=int), *part]) for part in (
        [t[0] for t in triples], [t[1] for t in triples], [np.full(len(t[0]), t[2]) for t in triples]
    )]  # fmt: skip
    return csr_array((values.astype(float), (rows.astype(int), columns.astype(int))), shape=(size, size))
