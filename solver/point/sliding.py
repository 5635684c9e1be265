"""Sliding along x to first order in friction (points, 8).

The contact stays a circle and moves by c; sigma, D and B get a part t_1(r) cos(angle), t_1 the sine transform of psi:

    N psi + layers = (2/pi) c C e rise b^(e-1) e_y - eta k H[phi_sigma],    psi_sigma(1) = 0,

k the coupling of normal and tangential directions, less that of the punch, H the Hilbert transform. H is steep beside
the edge: that part is kept apart, in closed form, and what the layers add to it is smooth: Nystroem's method, spectral.
"""

import warnings
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from approximation.chebyshev import coefficients
from solver.arrays import Array, BoolArray
from solver.film.kernel import strip, wavenumbers
from solver.film.reflection import waves
from solver.film.windows import Indices
from solver.halfplane.precision import PrecisionWarning
from solver.halfplane.surface import HalfPlane
from solver.point import hankel
from solver.point.body import Film
from solver.point.density import Density
from solver.point.inside import Inside, Tractions
from solver.point.pressed import Contact, Friction, Pressed
from solver.point.profile import Shape
from solver.point.table import PointKind, Window, window

_FIRST, _MORE = 24, 12.0  # nodes of a small contact, and what a wide one adds
_KEPT = 128
_MOST_FRICTION, _MOST_ANGLE = 0.6, 0.2  # beyond which a warning tells the size of what is neglected
_EDGE = np.ones(1)
_ANGLES = 60  # nodes of the integrals around the edge


@dataclass(frozen=True, eq=False)
class Rubbed:
    """Contacts with their densities, without friction and of its first order.

    Parameters
    ----------
    contact
        The contacts.
    """

    contact: Contact

    @property
    def _unit(self) -> Array:
        """Of the densities; (case,)."""
        return np.asarray(self.contact.size / self.contact.radius)

    @cached_property
    def density(self) -> Density:
        """Without friction, units of the body."""
        contact, body = self.contact, self.contact.pressed.body
        inverse = np.linalg.inv(contact.state.stiffness.compliance)
        form = np.broadcast_to(-2 / np.pi * inverse[..., :, 0], contact.state.strengths.shape)
        series = _series(contact) if isinstance(body, Film) else np.zeros((*form.shape, 0))
        unit = self._unit[:, None]
        return Density(body.shape, contact.state.strengths * unit, form * unit, series * unit[..., None])

    @property
    def ratio(self) -> Array:
        """Contact radii over the unit of the body's lengths, 1 on half-spaces; (case,)."""
        body = self.contact.pressed.body
        return self.contact.radius / body.thickness if isinstance(body, Film) else np.ones_like(self.contact.radius)

    @property
    def tractions(self) -> Tractions:
        """What presses and rubs."""
        friction = self.contact.pressed.friction
        if friction is None or not np.any(friction.coefficient):
            return Tractions(self.ratio, self.density, np.zeros_like(self.ratio))
        return Tractions(self.ratio, self.density, friction.coefficient, self.sines)

    @property
    def _friction(self) -> Friction:
        friction = self.contact.pressed.friction
        if friction is None:
            raise ValueError("contacts without friction do not slide")
        return friction

    @cached_property
    def _response(self) -> "Response":
        return Response(
            self.contact.state.stiffness.compliance, self._friction.coupling, self.contact.pressed.body.shape
        )

    @cached_property
    def _added(self) -> tuple[Array, Array]:
        """Per eta: c/a, and Legendre coefficients of what the layers add to psi; (case,), (case, 3, n)."""
        contact, body = self.contact, self.contact.pressed.body
        if not isinstance(body, Film):
            shift = self._response.shift(self.density.turned(_EDGE)[:, 0, 0])
            return shift / self._unit, np.zeros((*self.density.form.shape, 1))
        parts = []
        for places, of in body.windows(contact.radius):
            log_ratio = np.log(contact.radius[places] / body.thickness[places])
            read = sliding_window(of.kind, of.number, self._friction.punch).read(log_ratio)
            parts.append((places, np.einsum("cdf,cd->cf", read, contact.state.causes[places, 1:])))
        longest = max(found.shape[1] for _, found in parts)
        whole = np.zeros((contact.radius.size, longest))
        for places, found in parts:
            whole[places, : found.shape[1]] = found
        series = np.zeros((contact.radius.size, 3, (longest - 1) // 3))
        for places, found in parts:
            own = found[:, 1:].reshape(places.size, 3, -1)
            series[places, :, : own.shape[2]] = own
        return whole[:, 0], series * self._unit[:, None, None]

    @property
    def offset(self) -> Array:
        """c [m]: how far the contact moves to the trailing side; (case,)."""
        return np.asarray(self._friction.coefficient * self._added[0] * self.contact.radius)

    def sines(self, b: Array, columns: Indices | None = None) -> Array:
        """psi, units of the body; (case, 3, b)."""
        some = np.arange(self.ratio.size) if columns is None else columns
        (shift, series), unit = self._added, self._unit
        turned = self.density.part(some).turned(b)[:, 0]
        own = self._response.part(some).closed(turned, b, (shift * unit)[some])
        own = own + series[some] @ _legendre(b, series.shape[-1]).T
        return np.asarray(self._friction.coefficient[some, None, None] * own)

    @property
    def strengths(self) -> Array:
        """What friction adds to the strengths of (sigma_yy, D_y, B_y) at the trailing edge, SI; (case, 3)."""
        found = self.sines(_EDGE)[..., 0] / self.contact.pressed.units
        found[:, 0] = 0.0
        return np.asarray(found)

    def tension(self, rim: "Rim") -> Array:
        """sigma_xx just outside the trailing edge [Pa]; (case,)."""
        contact, friction = self.contact, self._friction
        of_loads = np.einsum("...i,...i->...", rim.coupling, contact.loads) / (2 * np.pi * contact.radius**2)
        x, w = np.polynomial.legendre.leggauss(_ANGLES)
        angle, weights = np.pi / 4 * (1 + x), np.pi / 4 * w
        rubbed = (
            friction.coefficient[:, None] * self.density.falling(np.sin(angle))[:, 0] / contact.pressed.units[:, :1]
        )
        first, third = (rubbed @ (np.sin(n * angle) * weights) for n in (1, 3))
        at = hankel.nodes(kinked=True)
        turned = self.sines(at.b) @ (at.b * at.weights) / contact.pressed.units
        found = rim.shear * (2 * np.einsum("...i,...i->...", rim.coupling, turned) - of_loads)
        along, across = rim.tangential, rim.transverse * rim.shear / 4
        found -= (along * (rim.stiffness - rim.shear / 4) + across) * first - (along * rim.shear / 4 - across) * third
        if isinstance(body := contact.pressed.body, Film):
            for places, of in body.windows(contact.radius):
                log_ratio = np.log(contact.radius[places] / body.thickness[places])
                read = sliding_window(of.kind, of.number, friction.punch).tensions(log_ratio)
                plain, slid = np.einsum("cmd,cd->mc", read, contact.state.causes[places, 1:])
                found[places] += (plain + friction.coefficient[places] * slid) * self._unit[places]
        return np.asarray(found)

    @property
    def angle(self) -> Array:
        """theta = eta kappa / lambda of the half-space of the top, whose square is neglected; (case,)."""
        inverse = np.linalg.inv(self._response.compliance)
        return np.asarray(
            self._friction.coefficient * np.einsum("...i,...i->...", inverse[..., 0, :], self._response.coupling)
        )


@dataclass(frozen=True, eq=False)
class Rim:
    """What the surface of the top answers beside the contact, SI; (case,) each, or of one body.

    Attributes
    ----------
    coupling
        k of the body; (..., 3).
    stiffness, shear
        C11 = c11 - h T3^-1 h, and c11 - c12 [Pa].
    tangential, transverse
        (L^-1)_xx, and 1 / sqrt(c44 c66) [1/Pa].
    """

    coupling: Array
    stiffness: Array
    shear: Array
    tangential: Array
    transverse: Array

    @classmethod
    def of(cls, half: HalfPlane) -> "Rim":
        """Of a material with c12."""
        m = half.material
        shear = np.asarray(m.c11 - m.c12)
        transverse = 1 / np.sqrt(m.c44 * shear / 2)
        return cls(half.friction_coupling, half.in_plane_stiffness, shear, half.tangential_compliance, transverse)


@dataclass(frozen=True, eq=False)
class Response:
    """What a half-space answers to friction, without layers, per eta.

    Attributes
    ----------
    compliance
        N of the contact; (..., 3, 3).
    coupling
        k of the contact; (..., 3).
    shape
        The punch, not flat.
    """

    compliance: Array
    coupling: Array
    shape: Shape

    def part(self, cases: Indices) -> "Response":
        """Some of the cases."""
        return Response(self.compliance[cases], self.coupling[cases], self.shape)

    @cached_property
    def _answers(self) -> tuple[Array, Array]:
        """N^-1 k, and N^-1 e_y for a unit shift; (..., 3) each."""
        inverse = np.linalg.inv(self.compliance)
        unit = 2 / np.pi * self.shape.exponent * self.shape.rise
        along = np.einsum("...ij,...j->...i", inverse, self.coupling)
        return np.asarray(along), np.asarray(unit * inverse[..., 0])

    def shift(self, turned: Array) -> Array:
        """c over a times the densities' unit that makes the edge smooth, of H[phi_sigma] there; (...)."""
        along, moved = self._answers
        return np.asarray(along[..., 0] * turned / moved[..., 0])

    def closed(self, turned: Array, b: Array, shift: Array) -> Array:
        """psi of H[phi_sigma] (..., b) and shifts (...); (..., 3, b)."""
        along, moved = self._answers
        return np.asarray(
            shift[..., None, None] * moved[..., None] * b ** (self.shape.exponent - 1)
            - along[..., None] * turned[..., None, :]
        )


@dataclass(frozen=True, eq=False)
class _Slid:
    """psi of causes from what is solved of them, per eta.

    Attributes
    ----------
    response, causes
        What is closed.
    solved
        c/a and Legendre coefficients; (cause, 1 + 3 n).
    """

    response: Response
    causes: Density
    solved: Array

    def __call__(self, b: Array, columns: Indices) -> Array:
        """psi; (column, 3, b)."""
        series = self.solved[columns, 1:].reshape(columns.size, 3, -1)
        own = self.response.closed(self.causes.part(columns).turned(b)[:, 0], b, self.solved[columns, 0])
        return np.asarray(own + series @ _legendre(b, series.shape[-1]).T)


@dataclass(frozen=True, eq=False)
class SlidingWindow:
    """What layers make of friction over half a decade of radii.

    Parameters
    ----------
    window
        Of the contacts without friction.
    punch
        Coupling k_p of the punch [1/Pa].
    """

    window: Window
    punch: float

    @cached_property
    def _series(self) -> Array:
        """Chebyshev coefficients of what is solved at the nodes; (node, 3, 1 + 3 n)."""
        return coefficients(self._solved)

    @cached_property
    def _response(self) -> Response:
        kind = self.window.kind
        stack = kind.film.stack()
        coupling = contact_coupling(-stack.media[0].compliance[0, 1:], stack.scale, self.punch, np.array(kind.conducts))
        return Response(kind.compliance, coupling, kind.shape)

    @cached_property
    def _solved(self) -> Array:
        """c/a and Legendre coefficients per (V, Psi, g) and eta, at the nodes; (node, 3, 1 + 3 n)."""
        kind = self.window.kind
        stack, radii = kind.film.stack(), np.exp(self.window.nodes)
        k, weights = wavenumbers(stack, 2 * float(np.max(radii)), strip(stack))
        there = np.array([True, *kind.conducts])
        difference = waves(stack, k)[0].difference
        layers = Layers(
            k,
            weights,
            np.where(there[:, None] & there, difference[:, 1:, 1:], 0.0),
            np.where(there, difference[:, 1:, 0], 0.0),
        )
        stiffness = kind.stiffness(self.window.read(self.window.nodes))
        reach = float(np.max(radii)) / min(float(stack.media[0].slowest), 1.0)
        count = _FIRST + int(_MORE * np.sqrt(reach))
        found = [
            layers.solved(self._response, self._causes(number, stiffness.edges[number]), radius, count)
            for number, radius in enumerate(radii.tolist())
        ]
        return np.array(found)

    def _causes(self, number: int, edges: Array) -> Density:
        """Densities of V, Psi and the profile, each with the depth that makes its edge smooth."""
        kind = self.window.kind
        causes = np.zeros((3, 4))
        causes[:, 1:] = np.eye(3)
        causes[:, 0] = -edges[0, 1:] / edges[0, 0]
        strengths = causes @ edges.T
        strengths[:, 0] = 0.0
        form = causes[:, 3:] * (-2 / np.pi * np.linalg.inv(kind.compliance)[:, 0])
        series = np.einsum("ind,cd->cin", self.window.added[number], causes)
        return Density(kind.shape, strengths, form, series)

    def read(self, log_radius: Array) -> Array:
        """At radii within the window; (case, 3, 1 + 3 n)."""
        return np.asarray(np.tensordot(self.window.polynomials(log_radius), self._series, 1))

    @cached_property
    def _tensions(self) -> Array:
        """Chebyshev coefficients of what the layers add to sigma_xx at the trailing edge; (node, 2, 3).

        Per (V, Psi, g), without friction and per eta [Pa].
        """
        kind, nodes = self.window.kind, self.window.nodes
        stiffness = kind.stiffness(self.window.read(nodes))
        inside, rows = Inside(kind.film.stack()), ("stress_xx",)
        found = []
        for number, ratio in enumerate(np.exp(nodes).tolist()):
            density = self._causes(number, stiffness.edges[number])
            ratios, sines = np.full(3, ratio), _Slid(self._response, density, self._solved[number])
            plain = inside.of_layers(Tractions(ratios, density, np.zeros(3)), 1.0, rows)[:, 0]
            slid = inside.of_layers(Tractions(ratios, density, np.ones(3), sines), 1.0, rows)[:, 0]
            found.append([plain, slid - plain])
        return coefficients(np.array(found))

    def tensions(self, log_radius: Array) -> Array:
        """At radii within the window; (case, 2, 3)."""
        return np.asarray(np.tensordot(self.window.polynomials(log_radius), self._tensions, 1))


@dataclass(frozen=True, eq=False)
class Layers:
    """What layers and base add to the half-space of the top, at wavenumbers.

    Attributes
    ----------
    k, weights
        (k,).
    normal, along
        Delta over (y, phi, psi), and of these to the traction along x; (k, 3, 3) and (k, 3).
    """

    k: Array
    weights: Array
    normal: Array
    along: Array

    def solved(self, response: Response, causes: Density, radius: float, count: int) -> Array:
        """c/a and Legendre coefficients of psi without the half-space's, per eta; (cause, 1 + 3 count)."""
        phases = self.k * radius
        x, w = np.polynomial.legendre.leggauss(count)
        b, weights = (1 + x) / 2, w / 2
        sines = np.sin(phases[:, None] * b)
        shares = 2 / np.pi * self.weights * radius
        own = np.einsum("ij,mn->imjn", response.compliance, np.eye(count))
        kernel = np.einsum("km,kn,kij->imjn", sines, sines * shares[:, None], self.normal, optimize=True) * weights
        whole = (own + kernel).reshape(3 * count, 3 * count)

        at = hankel.nodes(parts=int(np.max(phases) / 8) + 4, kinked=True)
        turned = causes.turned(at.b)[:, 0]
        free = response.closed(turned, at.b, np.zeros(len(turned)))
        moved = response.closed(np.zeros((1, at.b.size)), at.b, np.ones(1))
        waved = np.sin(phases[:, None] * at.b) * at.weights
        carried = np.einsum("kij,kb,cjb->ick", self.normal, waved, np.concatenate([free, moved]), optimize=True)
        pushed = np.einsum(
            "kb,cb->ck", np.cos(phases[:, None] * at.b) * at.weights, causes.at(at.b)[:, 0], optimize=True
        )
        carried[:, :-1] -= self.along.T[:, None] * pushed
        right = -np.einsum("ick,k,kn->inc", carried, shares, sines, optimize=True)
        values = np.linalg.solve(whole, right.reshape(3 * count, -1)).reshape(3, count, -1)
        series = (2 * np.arange(count) + 1)[:, None] * (_legendre(b, count).T * weights) @ values  # (3, n, cause)
        edges = np.sum(series[0], 0)  # P_n(1) = 1
        edges[:-1] += response.closed(causes.turned(_EDGE)[:, 0], _EDGE, np.zeros(len(turned)))[:, 0, 0]
        shift = -edges[:-1] / (edges[-1] + response.closed(np.zeros((1, 1)), _EDGE, np.ones(1))[0, 0, 0])
        both = np.moveaxis(series[..., :-1] + series[..., -1:] * shift, -1, 0)
        return np.concatenate([shift[:, None], both.reshape(len(shift), -1)], 1)


class FirstOrderWarning(PrecisionWarning):
    """Sliding so rough that what is of the second order in friction counts."""


def warn_of_order(pressed: Pressed) -> None:
    """Warn by :class:`FirstOrderWarning` where friction is large, with the size of what is neglected."""
    friction = pressed.friction
    if friction is None or pressed.body.shape.flat:
        return
    angle = float(np.max(np.abs(Rubbed(pressed.charged).angle), initial=0.0))
    eta = float(np.max(friction.coefficient, initial=0.0))
    if eta > _MOST_FRICTION or angle > _MOST_ANGLE:
        warnings.warn(
            f"friction: {eta:g} with the angle {angle:.2g} is solved to its first order: expect relative errors of "
            f"{angle**2:.0e}, of what friction adds {angle:.0e}",
            FirstOrderWarning,
            stacklevel=2,
        )


@lru_cache(_KEPT)
def sliding_window(kind: PointKind, number: int, punch: float) -> SlidingWindow:
    """Made once."""
    return SlidingWindow(window(kind, number), punch)


def contact_coupling(coupling: Array, scale: Array, punch: Array | float, conducts: BoolArray) -> Array:
    """k of the contact from that of the body, in its units; (..., 3).

    Parameters
    ----------
    coupling
        Of the body; (..., 3).
    scale
        Units of the body; (..., 4).
    punch
        k_p [1/Pa]; (...).
    conducts
        Of the electric and the magnetic field; (..., 2).
    """
    own = coupling - np.asarray(punch / (scale[..., 0] * scale[..., 1]))[..., None] * np.eye(3)[0]
    return np.where(np.concatenate([np.ones_like(conducts[..., :1]), conducts], -1), own, 0.0)


def _legendre(b: Array, count: int) -> Array:
    """P_n(2 b - 1); (b, n)."""
    return np.asarray(np.polynomial.legendre.legvander(2 * b - 1, count - 1))


def _series(contact: Contact) -> Array:
    """What the layers add without friction, times a; (case, 3, n)."""
    body = contact.pressed.body
    assert isinstance(body, Film)
    parts = [
        (places, of.tractions(np.log(contact.radius[places] / body.thickness[places]), contact.state.causes[places]))
        for places, of in body.windows(contact.radius)
    ]
    whole = np.zeros((contact.radius.size, 3, max(found.shape[2] for _, found in parts)))
    for places, found in parts:
        whole[places, :, : found.shape[2]] = found
    return whole
