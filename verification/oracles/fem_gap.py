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
from scipy.sparse import block_array, csr_array, eye_array

from verification.oracles.fem_film import ELECTRIC, FORCES, FilmContact, clamped, contact, factorised
from verification.oracles.film_mesh import layered_mesh
from verification.oracles.gap_response import LEAST, SMALL, STEPS, VACUUM, Dry, Gap, along, sides
from verification.oracles.spectral import Body, Index
from verification.oracles.surface_response import UNITS, Array, surface_response

_CLOSE = 1e-7  # change of the punch's place and potentials from one step to the next, each over itself


@dataclass(frozen=True, eq=False)
class GapContact(FilmContact):
    """The contact of a given half-length."""

    order: int = 8
    permittivity: float = 1.0  # Of the medium in the gap over vacuum's; 0: D_y = 0 and B_y = 0 beside the contact
    elastic: Mapping[str, float] | None = None  # Constants of the punch's material; None: rigid

    # -- the two bodies ------------------------------------------------------------------------------------------------
    @cached_property
    def _upper(self) -> Body | None:
        """The punch upside down: its surface has the same nodes in the contact."""
        if self.elastic is None:
            return None
        thickness = self.layers[0].thickness / self.half_length
        return Body(layered_mesh([thickness], False), [self.elastic, self.elastic], self.order)

    @property
    def _free(self) -> NDArray[np.bool_]:
        """Mark free unknowns; of the punch's, only its displacements are."""
        if self._upper is None:
            return np.asarray(~self.held().ravel())
        x, y = self._upper.places.T
        mine = np.zeros((len(x), 4), dtype=bool)
        mine[:, 2:] = True
        mine[np.isclose(np.abs(x), x.max()) | np.isclose(y, y.min())] = True
        return ~np.concatenate([self.held().ravel(), mine.ravel()])

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
        body = 4 * self.below
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
    def _exterior(self) -> Gap:
        """The surface beside the contact."""
        return Gap(self.body, self.order + 6)

    def _medium(self, potential: int) -> float:
        """eps or mu of the gap; the medium's permittivity says nothing of mu0."""
        return VACUUM[potential] * (self.permittivity if potential == ELECTRIC else float(self.permittivity > 0))

    # -- the solution --------------------------------------------------------------------------------------------------
    @cached_property
    def _dry(self) -> Dry:
        """The system without air."""
        below, nodes = self.below, self._exterior.nodes
        exterior = np.setdiff1d(nodes, below)
        airy = np.array([4 * exterior + potential for potential in self.punch.conducted], dtype=int).ravel()
        touched = (4 * below[:, None] + np.arange(4)).ravel()
        raised = [4 * np.unique(nodes) + 1]
        if self._upper is not None:
            raised.append(4 * (len(self.body.places) + np.unique(sides(self._upper))) + 1)
        u = self.prescribed(self._stiffness.shape[0])
        return Dry.of(self._stiffness, *self._joined, self._free, u, airy, touched, np.concatenate(raised))

    def _charged(self, gap: Array) -> tuple[Array, Array]:
        """Scaled u (unknowns, states), right on the surface only, and nodal loads (node, 4, states) of the body."""
        size, count, weights = self._stiffness.shape[0], 4 * len(self.body.places), self._exterior.rule[1]
        wide = np.maximum(gap, LEAST * weights.sum(axis=1, keepdims=True))
        air, pushed = csr_array((size, size)), np.zeros((size, 3 + len(self.punch.conducted)))
        for state, potential in enumerate(self.punch.conducted, start=3):
            spring = self._exterior.spring(potential, self._medium(potential) * weights / wide, size)
            air, pushed[:, state] = air + spring, spring.sum(axis=1)
        u, loads = self._dry.charged(air, pushed)
        return u, loads[:count].reshape(count // 4, 4, -1)

    @property
    def exponents(self) -> tuple[float, float]:
        """Exponents of the pressure at X = 1 and -1, including an elastic punch."""
        if self.elastic is None:
            return super().exponents
        conducted = [potential - 1 for potential in self.punch.conducted]
        below, above = surface_response(self.layers[0].material), surface_response(self.elastic)
        N, k = below.normal_compliance, below.shear_coupling
        minus = np.linalg.solve(N[np.ix_(conducted, conducted)], N[conducted, 0])
        compliance = N[0, 0] - N[0, conducted] @ minus + above.normal_compliance[0, 0]
        turn = k[0] - k[conducted] @ minus - above.shear_coupling[0]
        alpha = np.arctan2(compliance, -self.punch.friction * turn) / np.pi
        return alpha - 1, -alpha

    @cached_property
    def _solved(self) -> tuple[Array, Array, Array, Array]:
        """Scaled u, nodal loads, weights of the states, and the gaps over h (side, point)."""
        x = self._exterior.rule[0]
        curved = (np.abs(x) - 1) * np.sqrt(np.abs(x) ** 2 - 1) * self.half_length / (2 * self.punch.radius)
        gap = curved if self.permittivity else np.full_like(curved, np.inf)
        last = np.zeros(3 + len(self.punch.conducted))
        for _ in range(STEPS):
            states, loads = self._charged(gap)
            weights = self.weighed(loads[self.below, 1], loads.sum(axis=0))
            u, size = states @ weights, np.abs(weights)
            change = np.max(np.abs(weights - last) / np.maximum(size, SMALL * size.max()))
            if not self.permittivity or change < _CLOSE:
                return u, loads @ weights, weights, gap
            gap, last = self._gap(u, weights), weights
        raise ArithmeticError(f"the punch's place and potentials still change by {change:.1e} after {STEPS} steps")

    def _gap(self, u: Array, weights: Array) -> Array:
        """Gap over h at Gauss's points beside the contact (side, point)."""
        x, by_node = self._exterior.rule[0], u.reshape(-1, 4)[:, 1]
        profile = weights[0] + weights[1] * x + weights[2] * x**2 - self._exterior.at(by_node)
        if self._upper is not None:
            profile = profile - along(self._upper, by_node[len(self.body.places) :], x)
        return np.asarray(profile / self.half_length)

    # -- outputs: depth and potentials on a rigid base -----------------------------------------------------------------
    @cached_property
    def weights(self) -> Array:
        """Weights of the states, scaled."""
        return self._solved[2]

    @cached_property
    def u(self) -> Array:
        """(u_x, u_y, phi, psi) of the body's nodes, right on the surface only, SI units; shape (nodes, 4)."""
        return np.asarray(self._solved[0].reshape(-1, 4)[: len(self.body.places)] * UNITS)

    @cached_property
    def loads(self) -> Array:
        """Nodal loads of the contact, as without air."""
        return np.asarray(self._solved[1][self.below] * FORCES)

    def exterior(self, which: int) -> tuple[Array, Array]:
        """(x - c)/h of nodes beside the contact, and phi [V] (``ELECTRIC``) or psi [A] (``MAGNETIC``); (node,) each."""
        nodes = np.setdiff1d(self._exterior.nodes, self.below)
        return self.body.places[nodes, 0], self.u[nodes, which]

    @cached_property
    def inside(self) -> Array:
        """u of all of the body's nodes, from the loads on its surface; SI units, (nodes, 4)."""
        free = ~clamped(self.body, self.layers, self.half_length, rigid=self.base is None).ravel()
        u = np.zeros(free.size)
        u[free] = factorised(self.body.matrix()[free][:, free]).solve(self._solved[1].ravel()[free])
        return np.asarray(u.reshape(-1, 4) * UNITS)

    @property
    def gap_field(self) -> float:
        """Largest field in the gap [V/m], at Gauss's points."""
        gap, phi = self._solved[3], self._exterior.at(self.u[:, ELECTRIC])
        wide = gap > 1e-7 * np.max(gap[np.isfinite(gap)])
        return float(np.max(np.where(wide, np.abs(self.potential(ELECTRIC) - phi) / gap, 0.0)) / self.half_length)


def _sparse(triples: Sequence[tuple[Index, Index, float]], size: int) -> "csr_array[np.float64]":
    rows, columns, values = [np.concatenate([np.zeros(0, dtype=int), *part]) for part in (
        [t[0] for t in triples], [t[1] for t in triples], [np.full(len(t[0]), t[2]) for t in triples]
    )]  # fmt: skip
    return csr_array((values.astype(float), (rows.astype(int), columns.astype(int))), shape=(size, size))
