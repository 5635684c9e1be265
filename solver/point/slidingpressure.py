"""Largest pressure p0 + p1 cos(angle) below sliding points, to first order in friction (points, 8)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from approximation.arrays import Indices
from approximation.chebyshev import coefficients, gauss_points
from approximation.measure import ITSELF
from approximation.summit import highest
from solver.arrays import Array
from solver.cache import cached
from solver.halfplane.interior import LINE, LINE_WEIGHTS
from solver.point.body import Film
from solver.point.contact import Friction, PointContact
from solver.point.friction import Response, legendre_rates
from solver.point.profile import Shape, halfspace_form
from solver.point.slidingtable import SlidingWindow, sliding_window
from solver.point.system import added_forms
from solver.point.tractions import Density, hilbert_form_rates, second_kind_rates

_COUNT = 20  # points of a panel
_MIDDLE = np.pi / 2 * np.array([0.25, 0.5])
_HALVINGS = 6  # of panels towards the edge
_APEX = 0.1  # r/a within which p0 + p1 cos(angle) fails below an apex of infinite curvature
_TOGETHER = 4096  # cases at a time: bounded memory


@dataclass(frozen=True, eq=False)
class Ray:
    """Panels from the centre to the edge, in the angle whose sine is r/a; the slope of psi has a logarithm there."""

    ends: Array  # Angles between panels, rising; (panel + 1,)

    @property
    def counts(self) -> tuple[int, ...]:
        """Points of the panels of both rays, from the leading edge to the trailing."""
        return (_COUNT,) * (2 * (self.ends.size - 1))

    @cached_property
    def _angles(self) -> Array:
        half = np.diff(self.ends)[:, None] / 2
        return np.asarray((self.ends[:-1, None] + half * (1 + gauss_points(_COUNT))).ravel())

    @cached_property
    def r(self) -> Array:
        """Radius r/a; (point,)."""
        return np.sin(self._angles)

    @cached_property
    def x(self) -> Array:
        """Return sqrt(1 - r^2); (point,)."""
        return np.cos(self._angles)

    @cached_property
    def b(self) -> Array:
        """Return sqrt(r^2 + w^2) of the integrals; (point, node)."""
        return np.hypot(self.r[:, None], self.x[:, None] * LINE)

    def summed(self, rates: Array) -> Array:
        """Integrate rates at ``b``, (..., point * node), over w, divided by r; (..., point)."""
        return np.asarray(rates.reshape(*rates.shape[:-1], *self.b.shape) @ LINE_WEIGHTS * (self.x / self.r))

    def top(self, middle: Array, turned: Array) -> Array:
        """Largest of p0 + p1 cos(angle), both (case, point); (case,)."""
        both_rays = np.concatenate([(middle - turned)[:, ::-1], middle + turned], 1)
        return highest(both_rays[:, None, None], self.counts, ITSELF).value


@cached
def ray_of(shape: Shape) -> Ray:
    """Ray of a shape, which leaves out an apex that is sharper than a sphere's."""
    toward = np.pi / 2 * (1 - 0.5 ** np.arange(1, _HALVINGS + 1))
    first = np.arcsin(_APEX) if shape.exponent < 2 else 0.0
    return Ray(np.unique(np.concatenate([[first], _MIDDLE, toward, [np.pi / 2]])))


@cached
def _closed_pressures(shape: Shape) -> tuple[Array, Array]:
    """Pressures p1 of a unit shift and of the half-space's unit form; (point,) each."""
    ray, e = ray_of(shape), shape.exponent
    b = ray.b.ravel()
    return (e - 1) * ray.summed(b ** (e - 2)), shape.rise * 2 / np.pi * ray.summed(hilbert_form_rates(e, b))


@cached
def _series_pressures(shape: Shape, even: int, count: int) -> tuple[Array, Array]:
    """Pressures p1 of the layers' even functions without friction, and of P_n(2 b - 1); (n, point) each."""
    ray = ray_of(shape)
    b = ray.b.ravel()
    return 2 / np.pi * ray.summed(second_kind_rates(b, even)), ray.summed(legendre_rates(b, count).T)


def turned_pressures(response: Response, density: Density, shift: Array, series: Array, channel: int = 0) -> Array:
    """Pressures p1, or -t_1 of another channel, on the ray, per eta if ``density`` is; (column, point)."""
    # shift: c/a times the densities' unit, (column,); series: layers' part of psi in P_n(2 b - 1), (column, n)
    by_friction, by_shift = response.factors
    shift_pressure, form_pressure = _closed_pressures(density.shape)
    even, per_series = _series_pressures(density.shape, density.signed.shape[-1], series.shape[-1])
    hilbert = density.form[:, :1] * form_pressure + density.signed[:, 0] @ even
    closed = (shift * by_shift[..., channel])[:, None] * shift_pressure - by_friction[..., channel, None] * hilbert
    return np.asarray(closed + series @ per_series)


@cached
def _of_halfspace(shape: Shape) -> Array:
    """Pressures p1 per eta of a half-space whose N^-1 k and (2/pi) (N^-1)_yy are 1 in the first channel; (point,)."""
    ones = np.ones((1, 3))
    density = Density(shape, 0 * ones, -ones, np.zeros((1, 3, 1)))
    response = Response(np.eye(3), np.eye(3)[0], shape)
    shift = response.shift(density.hilbert(np.ones(1))[:, 0, 0])
    return np.asarray(turned_pressures(response, density, shift, np.zeros((1, 1)))[0])


@cached
def _turned_series(window: SlidingWindow) -> Array:
    """Chebyshev coefficients over a window of the pressures p1 per (V, Psi, g) and eta; (node, point, 3)."""
    pressures = [
        turned_pressures(window.response, causes, shift, series[:, 0]) for causes, shift, series in window.solutions
    ]
    return coefficients(np.swapaxes(np.array(pressures), 1, 2))


def largest_pressure(contact: PointContact, friction: Friction) -> Array:
    """Largest pressure of curved punches that slide [Pa], for exponents below 2 at least that at rest; (case,)."""
    largest = np.array(contact.peak_pressure)
    slid = np.flatnonzero(friction.coefficient != 0)
    for first in range(0, slid.size, _TOGETHER):
        cases = slid[first : first + _TOGETHER]
        middle, turned = _pressures(contact, friction, cases)
        size = (contact.size / contact.radius / contact.pressed.units[:, 0])[cases]
        top = size * ray_of(contact.pressed.body.shape).top(middle, turned)
        largest[cases] = np.maximum(largest[cases], top)
    return largest


def _pressures(contact: PointContact, friction: Friction, cases: Indices) -> tuple[Array, Array]:
    """Pressures p0 and p1 of ``cases`` on the ray, over C a^(e-1); (case, point) each."""
    body, eta = contact.pressed.body, friction.coefficient[cases, None]
    shape, ray = body.shape, ray_of(body.shape)
    inverse = np.linalg.inv(np.broadcast_to(contact.state.stiffness.compliance, (contact.radius.size, 3, 3))[cases])
    middle = 2 / np.pi * inverse[:, :1, 0] * halfspace_form(shape, ray.x, ray.r)
    if not isinstance(body, Film):
        coupled = np.einsum("ci,ci->c", inverse[:, 0], friction.coupling[cases])
        return middle, eta * (2 / np.pi * inverse[:, 0, 0] * coupled)[:, None] * _of_halfspace(shape)
    turned = np.empty_like(middle)
    for rows, window, log_ratio in body.part(cases).windows(contact.radius[cases]):
        causes = contact.state.causes[cases[rows]]
        added = window.tractions(log_ratio, causes)[:, 0]
        middle[rows] -= added @ added_forms(ray.x, added.shape[-1]).T
        series = _turned_series(sliding_window(window.kind, window.number, friction.punch))
        turned[rows] = window.interval.read(log_ratio, series, causes[:, 1:])
    return middle, eta * turned
