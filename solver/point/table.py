"""Point contacts on a layered body, tabulated in log a over windows of half a decade (points, 4)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from approximation.chebyshev import coefficients
from approximation.piecewise import Interval
from solver.arrays import Array
from solver.cache import cached
from solver.line.table import LEAST, MOST
from solver.point.profile import Shape
from solver.point.state import PressedState, Stiffness, conducted, halfspace
from solver.point.system import added_terms, interactions
from solver.point.tractions import Density
from solver.stack.electroded import surface
from solver.stack.layers import Stack

_A_DECADE = 2  # windows per decade, as along a line
_OVERLAP = 1.05  # of a window with its neighbours
_RADII = 20  # radii of a window up to a/h = 10: 1e-13 between them
_WIDE, _DIGITS = 2, 28.0  # first window beyond a/h = 10; exponent of the error between its radii: 1e-12
_RUNGS = 9  # of the search for a radius in a window
_FIRST, _SMOOTH, _KINKED = 12, 9.0, 14.0  # functions of a small contact; more per root of a/h, by the profile
_SMOOTH_WIDE = 7.0  # the same beyond a/h = 10: loads to 1e-12, edge strengths to 2e-10


@dataclass(frozen=True)
class PointKind:
    """Film and punch that cases share, so that one set of tables serves them."""

    film: Stack  # Its top layer of unit thickness
    conducts: tuple[bool, bool]  # Whether the punch conducts (electric, magnetic)
    shape: Shape  # The profile of the punch
    punch: float = 0.0  # N_p of an elastic punch [1/Pa], 0 of a rigid one

    @property
    def scale(self) -> Array:
        """Units of the stack: u = scale u', t = t' / scale; (4,)."""
        return self.film.scale

    @property
    def compliance(self) -> Array:
        """N of body and punch in the units of the stack, without fields that the punch does not conduct; (3, 3)."""
        total = np.array(surface(self.film)[1:, 1:])
        total[0, 0] += self.punch / self.scale[1] ** 2
        return conducted(total, np.array(self.conducts))

    def stiffness(self, added: Array) -> Stiffness:
        """Stiffness of the half-space and the layers' contribution to loads, edges and rates (..., 3, 3, 4)."""
        bare = halfspace(self.compliance, self.shape)
        return Stiffness(
            np.broadcast_to(bare.compliance, (*added.shape[:-3], 3, 3)),
            bare.loads + added[..., 0, :, :], bare.edges + added[..., 1, :, :], added[..., 2, :, :],
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class PointWindow:
    """Contacts on one film of unit thickness, over half a decade of radii and a little more."""

    kind: PointKind
    number: int  # Index of the half decade of a/h

    @cached_property
    def interval(self) -> Interval:
        """Range of log a, with its Chebyshev points."""
        return interval(self.number)

    @property
    def nodes(self) -> Array:
        """Logarithms of the radii that are solved, rising; (node,)."""
        return self.interval.points

    @cached_property
    def added(self) -> Array:
        """Legendre coefficients of the layers' contribution to the tractions at the nodes; (node, 3, n, 4)."""
        kind = self.kind
        kernel = _kernel(kind.film, self.number, kind.shape.exponent % 2 == 0)
        is_coupled = conducted(np.ones((3, 3)), np.array(kind.conducts))
        return added_terms(kind.compliance, kernel * is_coupled[..., None, None], kind.shape)

    @cached_property
    def edges(self) -> Array:
        """Strengths times a at the nodes, of u0 and g; (node, 3, 4)."""
        return self.kind.stiffness(self.read(self.nodes)).edges

    def density(self, number: int, causes: Array) -> Density:
        """Densities of causes (u0, g), (column, 4), over C a^e at a node, one column each."""
        kind = self.kind
        form = causes[:, 3:] * (-2 / np.pi * np.linalg.inv(kind.compliance)[:, 0])
        series = np.einsum("ind,cd->cin", self.added[number], causes)
        return Density(kind.shape, causes @ self.edges[number].T, form, series)

    @cached_property
    def _series(self) -> Array:
        """Chebyshev coefficients of loads, edge strengths and the latter's derivatives in log a; (node, 3, 3, 4)."""
        signs = (-1.0) ** np.arange(self.added.shape[2])
        loads, edges = 2 * np.pi * self.added[:, :, 0], np.einsum("aind,n->aid", self.added, signs)
        series = coefficients(np.stack([loads, edges], 1))
        return np.concatenate([series, self.interval.derived(series[:, 1:])], 1)

    @cached_property
    def _added_series(self) -> Array:
        """Chebyshev coefficients of ``added``; (node, 3, n, 4)."""
        return coefficients(self.added)

    def read(self, log_radius: Array) -> Array:
        """Layers' contribution to loads, edges and their rates, at radii within the window; (case, 3, 3, 4)."""
        return self.interval.read(log_radius, self._series)

    @property
    def rungs(self) -> Array:
        """Values of log a that bracket forces, the ends of the window among them; (rung,)."""
        return np.linspace(self.interval.low, self.interval.high, _RUNGS)

    def forces(self, log_radius: Array, *, grounded: bool) -> tuple[Array, Array]:
        """P over C a^(e+1), and d log P / d log a, at log (a/h), without charges or at zero potentials."""
        series, rates = self._forces[grounded]
        polynomials = self.interval.polynomials(log_radius)
        return np.exp(polynomials @ series), polynomials @ rates + self.kind.shape.exponent + 1

    @cached_property
    def _forces(self) -> list[tuple[Array, Array]]:
        """Chebyshev coefficients of log P and of its derivative, without charges and at zero potentials."""
        stiffness, charges = self.kind.stiffness(self.read(self.nodes)), np.zeros((self.nodes.size, 2))
        states = (PressedState(stiffness, self.kind.shape, charges, grounded) for grounded in (False, True))
        series = (coefficients(np.log(state.loads[..., 0])) for state in states)
        return [(log_force, self.interval.derived(log_force)) for log_force in series]

    def tractions(self, log_radius: Array, causes: Array) -> Array:
        """Layers' coefficients of the tractions of causes (u0, g), (case, 4), times a; (case, 3, n)."""
        return self.interval.read(log_radius, self._added_series, causes)


def interval(number: int, count: int | None = None) -> Interval:
    """Range of log a of a window, with ``count`` Chebyshev points."""
    step, beyond = np.log(10) / _A_DECADE, np.log(_OVERLAP)
    low, high = np.clip([number * step - beyond, (number + 1) * step + beyond], np.log(LEAST), np.log(MOST)).tolist()
    if count is None:
        count = _RADII if number < _WIDE else 1 + int(_DIGITS / np.arcsinh(np.pi / (high - low)))
    return Interval(low, high, count)


@cached
def window(kind: PointKind, number: int) -> PointWindow:
    """Window of a kind, cached."""
    return PointWindow(kind, number)


@cached
def _kernel(film: Stack, number: int, smooth: bool) -> Array:
    """Interactions of a film of unit thickness at the radii of a window, for every punch; (node, 3, 3, n, n)."""
    radii = np.exp(interval(number).points)
    reach = float(np.max(radii)) / min(float(film.media[0].slowest), 1.0)
    # a kink of the profile at its apex needs more functions
    per_root = (_SMOOTH_WIDE if number >= _WIDE else _SMOOTH) if smooth else _KINKED
    count = _FIRST + int(per_root * np.sqrt(reach))
    return interactions(film, radii, count)
