"""Sliding along x to first order in friction (points, 8).

The contact stays a circle and moves by c; sigma, D and B get a part t_1(r) cos(angle), t_1 the sine transform of psi:

    N psi + layers = (2/pi) c C e rise b^(e-1) e_y - eta k H[phi_sigma],    psi_sigma(1) = 0,

k the coupling of normal and tangential directions, less that of the punch, H the Hilbert transform. What a whole
contact answers (radius, force, depth, potentials, charges) is even in eta, whatever the punch and what lies beside it,
so that its first order is what it is without friction.
"""

import warnings
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array
from solver.halfplane.precision import PrecisionWarning
from solver.point import hankel
from solver.point.body import Film
from solver.point.contact import Contact, Friction, Pressed
from solver.point.friction import Response, Rim, edge_sums, legendre
from solver.point.slidingtable import sliding_window
from solver.point.table import Window
from solver.point.tractions import Density, Tractions

_MOST_FRICTION, _MOST_ANGLE = 0.6, 0.2  # beyond which a warning tells the size of what is neglected
_EDGE = np.ones(1)


@dataclass(frozen=True, eq=False)
class Rubbed:
    """Contacts with their densities, without friction and of its first order."""

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
        series, causes = np.zeros((*form.shape, 0)), contact.state.causes
        if isinstance(body, Film):
            series = body.gathered(contact.radius, lambda of, at, places: of.tractions(at, causes[places]))
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
        assert friction is not None
        return friction

    @cached_property
    def _response(self) -> Response:
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

        def read(of: Window, log_ratio: Array, places: Indices) -> Array:
            table = sliding_window(of.kind, of.number, self._friction.punch)
            own = np.einsum("cdf,cd->cf", table.read(log_ratio), contact.state.causes[places, body.shape.driving])
            return np.insert(own[:, 1:].reshape(places.size, 3, -1), 0, own[:, :1], axis=-1)

        whole = body.gathered(contact.radius, read)
        return whole[:, 0, 0], whole[..., 1:] * self._unit[:, None, None]

    @property
    def offset(self) -> Array:
        """c [m]: how far the contact moves to the trailing side; (case,)."""
        return np.asarray(self._friction.coefficient * self._added[0] * self.contact.radius)

    def sines(self, b: Array, columns: Indices | None = None) -> Array:
        """psi, units of the body; (case, 3, b).

        b: (b,), 0 to 1.
        """
        some = np.arange(self.ratio.size) if columns is None else columns
        (shift, series), unit = self._added, self._unit
        turned = self.density.part(some).turned(b)[:, 0]
        own = self._response.part(some).closed(turned, b, (shift * unit)[some])
        own = own + series[some] @ legendre(b, series.shape[-1]).T
        return np.asarray(self._friction.coefficient[some, None, None] * own)

    @property
    def strengths(self) -> Array:
        """What friction adds to the strengths of (sigma_yy, D_y, B_y) at the trailing edge, SI; (case, 3)."""
        found = self.sines(_EDGE)[..., 0] / self.contact.pressed.units
        found[:, 0] = 0.0
        return np.asarray(found)

    def tension(self, rim: Rim) -> Array:
        """sigma_xx just outside the trailing edge [Pa]; (case,)."""
        contact, friction = self.contact, self._friction
        at = hankel.nodes(kinked=True)
        turned = self.sines(at.b) @ (at.b * at.weights) / contact.pressed.units
        unit = friction.coefficient / contact.pressed.units[:, 0]
        first, third = edge_sums(self.density)
        moments = 2 * turned - contact.loads / (2 * np.pi * contact.radius[:, None] ** 2)
        found = rim.tension(moments, (unit * first, unit * third))
        if isinstance(body := contact.pressed.body, Film):

            def read(of: Window, log_ratio: Array, places: Indices) -> Array:
                own = sliding_window(of.kind, of.number, friction.punch).tensions(log_ratio)
                plain, slid = np.einsum("cmd,cd->mc", own, contact.state.causes[places, 1:])
                return np.asarray(plain + friction.coefficient[places] * slid)

            found = found + body.gathered(contact.radius, read) * self._unit
        return np.asarray(found)

    @property
    def angle(self) -> Array:
        """theta = eta kappa / lambda of the half-space of the top, whose square is neglected; (case,)."""
        inverse = np.linalg.inv(self._response.compliance)
        return np.asarray(
            self._friction.coefficient * np.einsum("...i,...i->...", inverse[..., 0, :], self._response.coupling)
        )


class FirstOrderWarning(PrecisionWarning):
    """Sliding so rough that what is of the second order in friction counts."""


def warn_of_order(pressed: Pressed) -> None:
    """Warn by :class:`FirstOrderWarning` where friction is large, with the size of what is neglected."""
    friction = pressed.friction
    if friction is None:
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
