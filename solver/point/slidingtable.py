"""Layers' contribution to sliding point contacts, tabulated over the radius (points, 8)."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from approximation.arrays import Indices
from approximation.chebyshev import coefficients, legendre_rule
from solver.arrays import Array
from solver.cache import cached
from solver.point import hankel
from solver.point.friction import Response, contact_coupling, legendre
from solver.point.inside import Inside
from solver.point.table import PointKind, PointWindow, window
from solver.point.tractions import Density, Tractions
from solver.stack.electroded import difference, surface
from solver.stack.wavenumbers import strip, wavenumbers

_FIRST, _PER_ROOT = 24, 12.0  # nodes of a small contact; more per root of a/h
_EDGE = np.ones(1)


@dataclass(frozen=True, eq=False)
class SlidingWindow:
    """Layers' contribution to friction over half a decade of radii."""

    window: PointWindow
    punch: float  # k_p of the punch [1/Pa]

    @cached_property
    def _series(self) -> Array:
        """Chebyshev coefficients of the solutions at the nodes; (node, 3, 1 + 3 n)."""
        return coefficients(self._solved)

    @cached_property
    def response(self) -> Response:
        """Response of the half-space of the top."""
        kind = self.window.kind
        stack = kind.film
        coupling = contact_coupling(-surface(stack)[0, 1:], stack.scale, self.punch, np.array(kind.conducts))
        return Response(kind.compliance, coupling, kind.shape)

    @cached_property
    def _solved(self) -> Array:
        """Shift c/a and Legendre coefficients per (V, Psi, g) and eta, at the nodes; (node, 3, 1 + 3 n)."""
        kind = self.window.kind
        stack, radii = kind.film, np.exp(self.window.nodes)
        k, weights = wavenumbers(stack, 2 * float(np.max(radii)), strip(stack))
        conducts, multiplier = np.array([True, *kind.conducts]), difference(stack, k)
        normal = np.where(conducts[:, None] & conducts, multiplier[:, 1:, 1:], 0.0)
        along = np.where(conducts, multiplier[:, 1:, 0], 0.0)
        reach = float(np.max(radii)) / min(float(stack.media[0].slowest), 1.0)
        count = _FIRST + int(_PER_ROOT * np.sqrt(reach))
        return np.array([
            _solution(self.response, self._causes(number), k * a, weights * a, normal, along, count)
            for number, a in enumerate(radii.tolist())
        ])  # fmt: skip

    @property
    def solutions(self) -> Iterator[tuple[Density, Array, Array]]:
        """Yield, per node, densities of V, Psi and the profile, and c/a and Legendre coefficients of each per eta."""
        for number, solved in enumerate(self._solved):
            yield self._causes(number), solved[:, 0], solved[:, 1:].reshape(3, 3, -1)

    def _causes(self, number: int) -> Density:
        """Densities of V, Psi and profile, each with the depth that makes its edge smooth; of u0 for a disc."""
        shape, edges = self.window.kind.shape, self.window.edges[number]
        causes = np.zeros((3, 4))
        causes[:, shape.driving] = np.eye(3)
        if shape.flat:
            return self.window.density(number, causes)
        causes[:, 0] = -edges[0, 1:] / edges[0, 0]
        density = self.window.density(number, causes)
        return replace(density, strengths=density.strengths * [0.0, 1.0, 1.0])

    def read(self, log_radius: Array) -> Array:
        """Shift and coefficients at radii within the window; (case, 3, 1 + 3 n)."""
        return self.window.interval.read(log_radius, self._series)

    @cached_property
    def _tensions(self) -> Array:
        """Chebyshev coefficients of ``tensions``, without friction and per eta, by (V, Psi, g); (node, 2, 3)."""
        inside, names, stresses = Inside(self.window.kind.film), ("stress_xx",), []
        for radius, (density, shift, series) in zip(np.exp(self.window.nodes), self.solutions, strict=True):
            ratio = np.full(3, radius)

            def sines(
                b: Array, columns: Indices, density: Density = density, shift: Array = shift, series: Array = series
            ) -> Array:
                """Density psi per eta; (column, 3, b)."""
                closed = self.response.closed(density.part(columns).hilbert(b)[:, 0], b, shift[columns])
                return np.asarray(closed + series[columns] @ legendre(b, series.shape[-1]).T)

            plain = inside.of_layers(Tractions(ratio, density, np.zeros(3)), _EDGE, names)[:, 0, 0]
            slid = inside.of_layers(Tractions(ratio, density, np.ones(3), sines), _EDGE, names)[:, 0, 0]
            stresses.append([plain, slid - plain])
        return coefficients(np.array(stresses))

    def tensions(self, log_radius: Array) -> Array:
        """Layers' contribution to sigma_xx at the trailing edge, at radii within the window [Pa]; (case, 2, 3)."""
        return self.window.interval.read(log_radius, self._tensions)


def _solution(
    response: Response, causes: Density, phases: Array, weights: Array, normal: Array, along: Array, count: int
) -> Array:
    """Shift c/a and Legendre coefficients of the layers' psi per eta, by Nystroem's method; (cause, 1 + 3 count).

    phases, weights: ka and the weights of integrals over it, (k,) each; normal: Delta over (y, phi, psi), (k, 3, 3);
    along: Delta of these by the traction along x, (k, 3).
    """
    gauss, gauss_weights = legendre_rule(count)
    b, rule = (1 + gauss) / 2, gauss_weights / 2
    sines = np.sin(phases[:, None] * b)
    wave_weights = 2 / np.pi * weights
    local = np.einsum("ij,mn->imjn", response.compliance, np.eye(count))
    kernel = np.einsum("km,kn,kij->imjn", sines, sines * wave_weights[:, None], normal, optimize=True) * rule
    system = (local + kernel).reshape(3 * count, 3 * count)

    fine = hankel.nodes(parts=hankel.parts(phases), kinked=True)
    hilbert = causes.hilbert(fine.b)[:, 0]
    by_friction = response.closed(hilbert, fine.b, np.zeros(len(hilbert)))
    by_shift = response.closed(np.zeros((1, fine.b.size)), fine.b, np.ones(1))
    fine_sines = np.sin(phases[:, None] * fine.b) * fine.weights
    fine_cosines = np.cos(phases[:, None] * fine.b) * fine.weights
    added = np.einsum("kij,kb,cjb->ick", normal, fine_sines, np.concatenate([by_friction, by_shift]), optimize=True)
    sheared = np.einsum("kb,cb->ck", fine_cosines, causes.at(fine.b)[:, 0], optimize=True)
    added[:, :-1] -= along.T[:, None] * sheared
    right = -np.einsum("ick,k,kn->inc", added, wave_weights, sines, optimize=True)
    values = np.linalg.solve(system, right.reshape(3 * count, -1)).reshape(3, count, -1)
    series = (2 * np.arange(count) + 1)[:, None] * (legendre(b, count).T * rule) @ values  # (3, n, cause)
    return response.smooth(causes.hilbert(_EDGE)[:, 0, 0], series, np.sum(series[0], 0))  # P_n(1) = 1


@cached
def sliding_window(kind: PointKind, number: int, punch: float) -> SlidingWindow:
    """Sliding window of a kind, cached."""
    return SlidingWindow(window(kind, number), punch)
