"""The whole sliding contact of a punch on layers, by spectral finite elements of the layers and of the base.

Nothing is reduced to the surface here. Displacement and potentials under the punch are given, Coulomb's law is a row
of the system (the nodal force along the surface is friction times the one across it), the far ends are clamped. Five
states, u_y = 1, X, X^2, phi = 1 and psi = 1 under the punch, make up the contact; all but the half-length is linear.

Neither edge may have a singular pressure. How singular it is comes from moments of the nodal forces with the
polynomials orthogonal over (1-X)^(alpha-1) (1+X)^-alpha. That the force on the node at the edge vanish would be another
condition, and a wrong one: D_y and B_y are singular there, and reach into that node.

Lengths of the mesh are in half-lengths of the contact, X = (x - c)/h.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array, eye_array
from scipy.sparse.linalg import SuperLU, splu
from scipy.special import eval_chebyt, eval_jacobi, gamma

from verification.oracles.film_mesh import layered_mesh
from verification.oracles.spectral import FIELDS, Body, Index
from verification.oracles.surface_response import STIFFNESS, UNITS, Array, reduced, surface_response

ELECTRIC, MAGNETIC = 2, 3  # numbers of the potentials in u = (u_x, u_y, phi, psi)
DATUM = 1e5  # distance of the datum on a half-plane, about, in half-lengths
#: N/m, N/m, C/m, Wb/m of a scaled nodal load.
FORCES = STIFFNESS / UNITS
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


@dataclass(frozen=True, eq=False)
class FilmContact:
    """The contact of a given half-length."""

    layers: Sequence[Layer]  # From the top down
    base: Mapping[str, float] | None  # Constants of the half-plane below them; None: rigid
    punch: Punch
    half_length: float  # (a + b)/2 [m]
    order: int = 10  # Of the polynomials of an element

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

    def held(self) -> NDArray[np.bool_]:
        """Mark prescribed (u_x, u_y, phi, psi) of the body's nodes."""
        below = np.zeros((len(self.body.places), 4), dtype=bool)
        below[self.below[:, None], [1, *self.punch.conducted]] = True
        return below | clamped(self.body, self.layers, self.half_length, rigid=self.base is None)

    def prescribed(self, size: int) -> Array:
        """Scaled u of the states u_y = 1, X, X^2 and, of every conducted potential, 1 under the punch; (size, states).

        Zero elsewhere, so far.
        """
        u = np.zeros((size, 3 + len(self.punch.conducted)))
        u[4 * self.below + 1, :3] = self.places[:, None] ** np.arange(3)
        for state, field in enumerate(self.punch.conducted, start=3):
            u[4 * self.below + field, state] = 1.0
        return u

    @cached_property
    def _states(self) -> tuple[Array, Array]:
        """Scaled u (nodes, 4, states) and nodal loads of the contact (nodes there, 4, states)."""
        below, free, matrix = self.below, ~self.held().ravel(), self.body.matrix()
        u = self.prescribed(len(free))
        along = csr_array((np.full(len(below), -self.punch.friction), (4 * below, 4 * below + 1)), shape=matrix.shape)
        rows = ((eye_array(len(free)) + along) @ matrix)[free]  # the free rows of a held force: Coulomb's law
        u[free] = -factorised(rows[:, free]).solve(rows @ u)
        nodal = len(self.body.places), 4, u.shape[1]
        return u.reshape(nodal), np.asarray(matrix @ u).reshape(nodal)[below]

    @cached_property
    def weights(self) -> Array:
        """Weights of the states in u_y = w0 + w1 X + w2 X^2, phi = w3, psi = w4 under the punch; scaled."""
        loads = self._states[1]
        return self.weighed(loads[:, 1], loads.sum(axis=0))

    def weighed(self, forces: Array, totals: Array) -> Array:
        """Weights that leave no singular pressure.

        forces: (nodes of the contact, states), nodal; totals: (4, states).
        """
        conducted = self.punch.conducted
        charges = {ELECTRIC: self.punch.charge, MAGNETIC: self.punch.magnetic_charge}
        rows = np.array([*self._singular(forces), *(-totals[list(conducted)])])
        curved = self.half_length**2 / (2 * self.punch.radius)
        right = np.array([0.0, 0.0, *(charges[field] / FORCES[field] for field in conducted)]) - rows[:, 2] * curved
        return np.insert(np.linalg.solve(np.delete(rows, 2, axis=1), right), 2, curved)

    def _singular(self, forces: Array) -> Array:
        """Strength of the singular pressure at X = -1 and 1, from nodal forces (nodes, states); shape (2, states)."""
        (A, B), n = self.exponents, np.arange(2 * self.order)[:, None]
        norm = gamma(n + A + 1) * gamma(n + B + 1) / gamma(n + 1) ** 2 / np.where(n, 2, 1)  # as A + B = -1
        series = eval_jacobi(n, A, B, self.places) @ forces / norm
        return np.stack([eval_jacobi(n[:, 0], A, B, end) @ series for end in (-1.0, 1.0)])

    @property
    def exponents(self) -> tuple[float, float]:
        """Exponents at X = 1 and -1 of a pressure that is singular where a conductor, or an insulator, ends."""
        conducted = tuple(field - 1 for field in self.punch.conducted)
        alpha = reduced(surface_response(self.layers[0].material), self.punch.friction, conducted)[1]
        return alpha - 1, -alpha

    @cached_property
    def u(self) -> Array:
        """(u_x, u_y, phi, psi) of the nodes, SI units; shape (nodes, 4)."""
        return np.asarray(self._states[0] @ self.weights * UNITS)

    @cached_property
    def loads(self) -> Array:
        """Nodal loads (x, y, electric, magnetic) [N/m, N/m, C/m, Wb/m] of the contact, in the order of ``places``."""
        return np.asarray(self._states[1] @ self.weights * FORCES)

    @property
    def places(self) -> Array:
        """X of the nodes of the contact."""
        places: Array = self.body.places[self.below, 0]
        return places

    @property
    def load(self) -> float:
        """P [N/m]."""
        return float(-self.loads[:, 1].sum())

    @property
    def centre(self) -> float:
        """(a - b)/2 [m]."""
        return float(self.weights[1] * self.punch.radius / self.half_length)

    @property
    def depth(self) -> float:
        """Depth of the punch [m]; on a half-plane relative to the surface at ``datum`` on both sides."""
        return float(self.centre**2 / (2 * self.punch.radius) - self.weights[0] + self._datum_displacement[1])

    def potential(self, number: int) -> float:
        """V [V] (``ELECTRIC``) or Psi [A] (``MAGNETIC``) of a punch that conducts, as depth."""
        return float(
            self.weights[3 + self.punch.conducted.index(number)] * UNITS[number] - self._datum_displacement[number]
        )

    @property
    def _datum_displacement(self) -> Array:
        """u at the datum, mean of both sides; 0 on a rigid base, where the film stands still."""
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
        surface, conducted = surface_response(self.layers[0].material), [k - 1 for k in self.punch.conducted]
        N, k = surface.normal_compliance, surface.shear_coupling
        r, d = (np.linalg.solve(N[np.ix_(conducted, conducted)], column[conducted]) for column in (N[:, 0], k))
        slope, turn = N[0, 0] - N[0, conducted] @ r, k[0] - N[0, conducted] @ d
        row = self.punch.conducted.index(number)
        regular = self.loads[:, number] - (slope / turn * d[row] - r[row]) * self.loads[:, 1]  # is smooth / sqrt(1-X^2)
        n = np.arange(2 * self.order)[:, None]
        series = np.where(n[:, 0], 2, 1) * (eval_chebyt(n, self.places) @ regular) / (np.pi * self.half_length)
        leading, trailing = (np.sqrt(np.pi * self.half_length) * (series @ end ** n[:, 0]) for end in (-1.0, 1.0))
        return float(trailing), float(leading)

    @property
    def inside(self) -> Array:
        """u of all nodes, from which fields follow; (nodes, 4)."""
        return self.u

    def fields(self, X: ArrayLike, depth: float, layer: int = 0) -> dict[str, Array]:
        """``FIELDS`` at a depth; SI units.

        X: _like, shape (n,), places over the half-length.
        """
        points = np.column_stack([X, np.full(np.size(X), -depth / self.half_length)])
        return dict(zip(FIELDS, self.body.fluxes(self.inside, points, layer) / self.half_length, strict=True))

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


def factorised(matrix: "csr_array[np.float64]") -> "SuperLU[np.float64]":
    """LU factors of a stiffness whose structure is symmetric."""
    options = {"SymmetricMode": True}
    return splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.001, options=options)


def _largest(values: Array) -> float:
    """Largest of values on a line, between them by the parabola of three."""
    top = int(np.clip(np.argmax(values), 1, len(values) - 2))
    left, middle, right = values[top - 1 : top + 2]
    return float(middle - (right - left) ** 2 / (8 * (left - 2 * middle + right)))
