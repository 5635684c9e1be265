"""The whole sliding contact of a punch on layers, by spectral finite elements of layers, base, elastic punch and air.

Displacement and potentials under the punch are prescribed, Coulomb's law is a row of the system (the tangential nodal
force is friction times the normal one), and the far ends are clamped. The contact is a sum of five states, u_y = 1, X,
X^2, phi = 1 and psi = 1 under the punch; only the half-length enters nonlinearly.

Neither edge may have a singular pressure. Its strength follows from moments of the nodal forces with the polynomials
orthogonal over (1-X)^(alpha-1) (1+X)^-alpha. A vanishing force on the node at the edge would be a wrong condition: D_y
and B_y are singular there and affect that node.

Air, D_y = -eps0 (V - phi)/g in the gap and its magnetic twin (docs/theory.md, section 1), is a spring on the potentials
of the exterior surface whose stiffness depends on the gap. It was written from the equations before the solver modelled
air. Gaps and potentials are iterated in turn, which converges since charges press little. An elastic punch, an
isotropic conductor, is an inverted half-plane, joined to the body in the contact.

Lengths of the mesh are in half-lengths of the contact, X = (x - c)/h.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import block_array, csr_array, eye_array
from scipy.special import eval_chebyt, eval_jacobi, gamma

from verification.oracles.film_mesh import layered_mesh
from verification.oracles.gap_response import VACUUM, Dry, Gap, along, settled, sides
from verification.oracles.spectral import ELECTRIC, FIELDS, FORCES, MAGNETIC, Body, Index, factorised
from verification.oracles.surface_response import UNITS, Array, surface_response

DATUM = 1e5  # distance of the datum on a half-plane, about, in half-lengths
_SEARCHED = np.linspace(-5, 5, 401)  # places of an interface that are searched for its extremes


@dataclass(frozen=True)
class Layer:
    """A layer: constants as for ``surface_response``, thickness [m], the potentials that vanish on its lower side."""

    material: Mapping[str, float]
    thickness: float
    grounded: tuple[int, ...] = (ELECTRIC, MAGNETIC)


@dataclass(frozen=True)
class Punch:
    """A cylinder: radius [m], friction, T [C/m], J [Wb/m], the potentials that it makes uniform in the contact."""

    radius: float
    friction: float = 0.0
    charge: float = 0.0
    magnetic_charge: float = 0.0
    conducted: tuple[int, ...] = (ELECTRIC, MAGNETIC)
    elastic: Mapping[str, float] | None = None  # Constants of its material; None: rigid


@dataclass(frozen=True, eq=False)
class FilmContact:
    """The contact of a given half-length."""

    layers: Sequence[Layer]  # From the top down
    base: Mapping[str, float] | None  # Constants of the half-plane below them; None: rigid
    punch: Punch
    half_length: float  # (a + b)/2 [m]
    order: int  # Of the polynomials of an element
    air: bool = False  # In the gap; False: D_y = 0 and B_y = 0 beside the contact

    # -- the two bodies ------------------------------------------------------------------------------------------------
    @cached_property
    def body(self) -> Body:
        """The meshed layers and base."""
        mesh = layered_mesh([layer.thickness / self.half_length for layer in self.layers], self.base is None)
        materials = [layer.material for layer in self.layers]
        return Body(mesh, materials if self.base is None else [*materials, self.base], self.order)

    @cached_property
    def below(self) -> Index:
        """Nodes of the contact, by rising x."""
        return contact(self.body)

    @property
    def places(self) -> Array:
        """X of the nodes of the contact."""
        places: Array = self.body.places[self.below, 0]
        return places

    @cached_property
    def _upper(self) -> Body | None:
        """The punch upside down: its surface has the same nodes in the contact."""
        if self.punch.elastic is None:
            return None
        mesh = layered_mesh([self.layers[0].thickness / self.half_length], False)
        return Body(mesh, [self.punch.elastic, self.punch.elastic], self.order)

    @property
    def _free(self) -> NDArray[np.bool_]:
        """Mark free unknowns; of the punch's, only its displacements are."""
        held = clamped(self.body, self.layers, self.half_length, rigid=self.base is None)
        held[self.below[:, None], [1, *self.punch.conducted]] = True
        if self._upper is None:
            return np.asarray(~held.ravel())
        x, y = self._upper.places.T
        mine = np.zeros((len(x), 4), dtype=bool)
        mine[:, 2:] = True
        mine[np.isclose(np.abs(x), x.max()) | np.isclose(y, y.min())] = True
        return ~np.concatenate([held.ravel(), mine.ravel()])

    @cached_property
    def _stiffness(self) -> "csr_array[np.float64]":
        matrix = self.body.matrix()
        if self._upper is None:
            return matrix
        return csr_array(block_array([[matrix, None], [None, self._upper.matrix()]], format="csr"))

    @cached_property
    def _joined(self) -> "tuple[csr_array[np.float64], csr_array[np.float64]]":
        """Return row and column operators: Coulomb's law and the punch's forces; u_y of the body less the punch's."""
        size, body, friction = self._stiffness.shape[0], 4 * self.below, self.punch.friction
        rows, columns = csr_array(eye_array(size)), csr_array(eye_array(size))
        rows = rows + _entries(body, body + 1, -friction, size)
        if self._upper is not None:
            mine = 4 * (len(self.body.places) + contact(self._upper))
            rows = rows + _entries(mine, body + 1, friction, size) + _entries(mine + 1, body + 1, -1.0, size)
            columns = columns + _entries(body + 1, mine + 1, -1.0, size)
        return rows, columns

    @cached_property
    def _exterior(self) -> Gap:
        """The surface beside the contact."""
        return Gap(self.body, self.order + 6)

    # -- the solution --------------------------------------------------------------------------------------------------
    @cached_property
    def _dry(self) -> Dry:
        """The system without air: the states u_y = 1, X, X^2 and, of every conducted potential, 1 under the punch."""
        below, nodes = self.below, self._exterior.nodes
        u = np.zeros((self._stiffness.shape[0], 3 + len(self.punch.conducted)))
        u[4 * below + 1, :3] = self.places[:, None] ** np.arange(3)
        for state, potential in enumerate(self.punch.conducted, start=3):
            u[4 * below + potential, state] = 1.0
        exterior = np.setdiff1d(nodes, below) if self.air else np.zeros(0, dtype=int)
        potentials = np.array([4 * exterior + potential for potential in self.punch.conducted], dtype=int).ravel()
        heights = [4 * np.unique(nodes) + 1]
        if self._upper is not None:
            heights.append(4 * (len(self.body.places) + np.unique(sides(self._upper))) + 1)
        return Dry.of(self._stiffness, *self._joined, self._free, u, potentials, below, np.concatenate(heights))

    def _charged(self, gap: Array) -> tuple[Array, Array]:
        """Scaled u (unknowns, states), in air right on the surface only, and nodal loads (node, 4, states)."""
        size, count = self._stiffness.shape[0], 4 * len(self.body.places)
        springs, pushed = csr_array((size, size)), np.zeros((size, 3 + len(self.punch.conducted)))
        for state, potential in enumerate(self.punch.conducted if self.air else (), start=3):
            spring = self._exterior.spring(potential, VACUUM[potential], gap, size)
            springs, pushed[:, state] = springs + spring, spring.sum(axis=1)
        u, loads = self._dry.charged(springs, pushed)
        return u, loads[:count].reshape(count // 4, 4, -1)

    @cached_property
    def _solved(self) -> tuple[Array, Array, Array, Array]:
        """Scaled u, nodal loads, weights of the states, and the gaps over h (side, point)."""
        x = np.abs(self._exterior.rule[0])
        curved = (x - 1) * np.sqrt(x**2 - 1) * self.half_length / (2 * self.punch.radius)
        gap = curved if self.air else np.full_like(curved, np.inf)
        return settled(self._charged, self._weighed, self._gap, gap, 1e-7)

    def _gap(self, u: Array, weights: Array) -> Array:
        """Gap over h at Gauss's points beside the contact (side, point)."""
        x, by_node = self._exterior.rule[0], u.reshape(-1, 4)[:, 1]
        profile = weights[0] + weights[1] * x + weights[2] * x**2 - self._exterior.at(by_node)
        if self._upper is not None:
            profile = profile - along(self._upper, by_node[len(self.body.places) :], x)
        return np.asarray(profile / self.half_length)

    def _weighed(self, loads: Array) -> Array:
        """Return scaled weights of the states without singular pressure, from nodal loads.

        u_y = w0 + w1 X + w2 X^2, phi = w3, psi = w4 under the punch.
        """
        conducted = self.punch.conducted
        charges = {ELECTRIC: self.punch.charge, MAGNETIC: self.punch.magnetic_charge}
        rows = np.array([*self._singular(loads[self.below, 1]), *(-loads.sum(axis=0)[list(conducted)])])
        curved = self.half_length**2 / (2 * self.punch.radius)
        right = np.array([0.0, 0.0, *(charges[field] / FORCES[field] for field in conducted)]) - rows[:, 2] * curved
        return np.insert(np.linalg.solve(np.delete(rows, 2, axis=1), right), 2, curved)

    def _singular(self, forces: Array) -> Array:
        """Strength of the singular pressure at X = -1 and 1, from nodal forces (nodes, states); shape (2, states)."""
        alpha, n = self._exponent, np.arange(2 * self.order)[:, None]
        A, B = alpha - 1, -alpha
        norm = gamma(n + A + 1) * gamma(n + B + 1) / gamma(n + 1) ** 2 / np.where(n, 2, 1)  # as A + B = -1
        series = eval_jacobi(n, A, B, self.places) @ forces / norm
        return np.stack([eval_jacobi(n[:, 0], A, B, end) @ series for end in (-1.0, 1.0)])

    @property
    def _exponent(self) -> float:
        """Exponent alpha of (1-X)^(alpha-1) (1+X)^-alpha, a pressure that is singular at both edges."""
        _, _, compliance, turn = self._reduced
        if self.punch.elastic is not None:
            above = surface_response(self.punch.elastic)
            compliance, turn = compliance + above.normal_compliance[0, 0], turn - above.shear_coupling[0]
        return float(np.arctan2(compliance, -self.punch.friction * turn)) / np.pi

    @cached_property
    def _reduced(self) -> tuple[Array, Array, float, float]:
        """Theory section 3, r, d, lam and kap of the body below over the conducted fields."""
        surface, conducted = surface_response(self.layers[0].material), [k - 1 for k in self.punch.conducted]
        N, k = surface.normal_compliance, surface.shear_coupling
        M = N[np.ix_(conducted, conducted)]
        r, d = (np.asarray(np.linalg.solve(M, part[conducted]), np.float64) for part in (N[:, 0], k))
        return r, d, float(N[0, 0] - N[0, conducted] @ r), float(k[0] - N[0, conducted] @ d)

    # -- outputs -------------------------------------------------------------------------------------------------------
    @cached_property
    def u(self) -> Array:
        """(u_x, u_y, phi, psi) of the body's nodes, in air right on the surface only, SI units; shape (nodes, 4)."""
        return np.asarray(self._solved[0].reshape(-1, 4)[: len(self.body.places)] * UNITS)

    @cached_property
    def loads(self) -> Array:
        """Nodal loads (x, y, electric, magnetic) [N/m, N/m, C/m, Wb/m] of the contact, in the order of ``places``."""
        return np.asarray(self._solved[1][self.below] * FORCES)

    @property
    def load(self) -> float:
        """P [N/m]."""
        return float(-self.loads[:, 1].sum())

    @property
    def centre(self) -> float:
        """(a - b)/2 [m]."""
        return float(self._solved[2][1] * self.punch.radius / self.half_length)

    @property
    def depth(self) -> float:
        """Depth of the punch [m]; on a half-plane relative to the surface at ``datum`` on both sides."""
        return float(self.centre**2 / (2 * self.punch.radius) - self._solved[2][0] + self._datum_displacement[1])

    def potential(self, number: int) -> float:
        """V [V] (``ELECTRIC``) or Psi [A] (``MAGNETIC``) of a punch that conducts, as depth."""
        weight = self._solved[2][3 + self.punch.conducted.index(number)]
        return float(weight * UNITS[number] - self._datum_displacement[number])

    @property
    def _datum_displacement(self) -> Array:
        """u at the datum, mean of both sides; 0 on a rigid base, where the far film is at rest."""
        return np.zeros(4) if self.base is None else self.u[self._far].mean(axis=0)

    @cached_property
    def _far(self) -> Index:
        """Nodes of the surface at the datum, one on each side."""
        x, y = self.body.places.T
        return np.argsort(np.where(y == 0, np.abs(np.log(np.maximum(np.abs(x), 1e-300) / DATUM)), np.inf))[:2]

    @property
    def datum(self) -> float:
        """Distance of the datum [m]."""
        return float(np.abs(self.body.places[self._far, 0]).mean() * self.half_length)

    def edge_intensities(self, number: int) -> tuple[float, float]:
        """lim sqrt(2 pi distance) of D_y (``one`` ELECTRIC) or B_y at x = a and at x = -b, SI units."""
        (r, d, slope, turn), row = self._reduced, self.punch.conducted.index(number)
        regular = self.loads[:, number] - (slope / turn * d[row] - r[row]) * self.loads[:, 1]  # is smooth / sqrt(1-X^2)
        n = np.arange(2 * self.order)[:, None]
        series = np.where(n[:, 0], 2, 1) * (eval_chebyt(n, self.places) @ regular) / (np.pi * self.half_length)
        leading, trailing = (np.sqrt(np.pi * self.half_length) * (series @ end ** n[:, 0]) for end in (-1.0, 1.0))
        return float(trailing), float(leading)

    def exterior(self, which: int) -> tuple[Array, Array]:
        """(x - c)/h of nodes beside the contact, and phi [V] (``ELECTRIC``) or psi [A] (``MAGNETIC``); (node,) each."""
        nodes = np.setdiff1d(self._exterior.nodes, self.below)
        return self.body.places[nodes, 0], self.u[nodes, which]

    @cached_property
    def _inside(self) -> Array:
        """u of all of the body's nodes, in air from the loads on its surface; SI units, (nodes, 4)."""
        if not self.air:
            return self.u
        free = ~clamped(self.body, self.layers, self.half_length, rigid=self.base is None).ravel()
        u = np.zeros(free.size)
        u[free] = factorised(self.body.matrix()[free][:, free]).solve(self._solved[1].ravel()[free])
        return np.asarray(u.reshape(-1, 4) * UNITS)

    def fields(self, X: ArrayLike, depth: float, layer: int = 0) -> dict[str, Array]:
        """``FIELDS`` at places X over the half-length, (n,), and a depth [m]; SI units."""
        points = np.column_stack([X, np.full(np.size(X), -depth / self.half_length)])
        return dict(zip(FIELDS, self.body.fluxes(self._inside, points, layer) / self.half_length, strict=True))

    def interface(self, layer: int) -> dict[str, float]:
        """Largest abs(sigma_xy) and largest sigma_yy [Pa] on the lower side of a layer."""
        depth = sum(above.thickness for above in self.layers[: layer + 1])
        stresses = self.fields(_SEARCHED, depth, layer)
        return {"shear": _largest(np.abs(stresses["stress_xy"])), "tension": _largest(stresses["stress_yy"])}


def contact(body: Body) -> Index:
    """Nodes of the contact, by rising x."""
    x, y = body.places.T
    touching = np.flatnonzero((y == 0) & (np.abs(x) <= 1))
    return touching[np.argsort(x[touching])]


def clamped(body: Body, layers: Sequence[Layer], length: float, *, rigid: bool) -> NDArray[np.bool_]:
    """Mark unknowns of the nodes that are zero: far away, on the base, at grounded interfaces; (nodes, 4)."""
    x, y = body.places.T
    held = np.zeros((len(x), 4), dtype=bool)
    held[np.isclose(np.abs(x), x.max())] = True
    held[np.isclose(y, y.min()), : 2 if rigid else 4] = True
    for depth, layer in zip(np.cumsum([layer.thickness for layer in layers]) / length, layers, strict=True):
        held[np.ix_(np.isclose(y, -depth), layer.grounded)] = True
    return held


def _entries(rows: Index, columns: Index, value: float, size: int) -> "csr_array[np.float64]":
    """Matrix of one value at some places; (size, size)."""
    return csr_array((np.full(len(rows), value), (rows, columns)), shape=(size, size))


def _largest(values: Array) -> float:
    """Return the largest value on a line, between the points by a parabola through three of them."""
    top = int(np.clip(np.argmax(values), 1, len(values) - 2))
    left, middle, right = values[top - 1 : top + 2]
    return float(middle - (right - left) ** 2 / (8 * (left - 2 * middle + right)))
