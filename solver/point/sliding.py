"""Sliding of point contacts along x, to first order in friction (points, 8)."""

import warnings
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array
from solver.halfplane.precision import PrecisionWarning
from solver.point import hankel
from solver.point.body import Film
from solver.point.contact import Friction, PointContact, Pressed
from solver.point.friction import Response, Rim, edge_sums, legendre
from solver.point.slidingtable import sliding_window
from solver.point.table import PointWindow
from solver.point.tractions import Density, Tractions

_MOST_FRICTION, _MOST_ANGLE = 0.6, 0.2  # above either a warning states the size of the neglected terms
_EDGE = np.ones(1)


@dataclass(frozen=True, eq=False)
class Rubbed:
    """Densities of contacts, without friction and to its first order."""

    contact: PointContact

    @property
    def _unit(self) -> Array:
        """Unit of the densities, C a^(e-1); (case,)."""
        return np.asarray(self.contact.size / self.contact.radius)

    @cached_property
    def density(self) -> Density:
        """Densities without friction, units of the body."""
        contact, body = self.contact, self.contact.pressed.body
        inverse = np.linalg.inv(contact.state.stiffness.compliance)
        form = np.broadcast_to(-2 / np.pi * inverse[..., :, 0], contact.state.strengths.shape)
        series, causes = np.zeros((*form.shape, 1)), contact.state.causes
        if isinstance(body, Film):
            series = body.from_windows(
                contact.radius, lambda table, log_a, cases: table.tractions(log_a, causes[cases])
            )
        unit = self._unit[:, None]
        return Density(body.shape, contact.state.strengths * unit, form * unit, series * unit[..., None])

    @property
    def ratio(self) -> Array:
        """Contact radii over the unit of the body's lengths, 1 on half-spaces; (case,)."""
        return self.contact.radius / self.contact.pressed.length

    @property
    def tractions(self) -> Tractions:
        """Tractions at rest and of cos(angle)."""
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
        """Return, per eta, c/a and Legendre coefficients of the layers' contribution to psi; (case,), (case, 3, n)."""
        contact, body = self.contact, self.contact.pressed.body
        if not isinstance(body, Film):
            shift = self._response.shift(self.density.hilbert(_EDGE)[:, 0, 0])
            return shift / self._unit, np.zeros((*self.density.form.shape, 1))

        def read(window: PointWindow, log_ratio: Array, cases: Indices) -> Array:
            table = sliding_window(window.kind, window.number, self._friction.punch)
            values = np.einsum("cdf,cd->cf", table.read(log_ratio), contact.state.causes[cases, body.shape.driving])
            return np.insert(values[:, 1:].reshape(cases.size, 3, -1), 0, values[:, :1], axis=-1)

        shift_and_series = body.from_windows(contact.radius, read)
        return shift_and_series[:, 0, 0], shift_and_series[..., 1:] * self._unit[:, None, None]

    @property
    def offset(self) -> Array:
        """Shift c [m] of the contact to the trailing side; (case,)."""
        return np.asarray(self._friction.coefficient * self._added[0] * self.contact.radius)

    def sines(self, b: Array, columns: Indices | None = None) -> Array:
        """Density psi at b, (b,) from 0 to 1, units of the body; (case, 3, b)."""
        cases = np.arange(self.ratio.size) if columns is None else columns
        (shift, series), unit = self._added, self._unit
        hilbert = self.density.part(cases).hilbert(b)[:, 0]
        psi = self._response.part(cases).closed(hilbert, b, (shift * unit)[cases])
        psi = psi + series[cases] @ legendre(b, series.shape[-1]).T
        return np.asarray(self._friction.coefficient[cases, None, None] * psi)

    @property
    def strengths(self) -> Array:
        """Strengths of (sigma_yy, D_y, B_y) that friction adds at the trailing edge, SI; (case, 3)."""
        strengths = self.sines(_EDGE)[..., 0] / self.contact.pressed.units
        strengths[:, 0] = 0.0
        return np.asarray(strengths)

    def tension(self, rim: Rim) -> Array:
        """Stress sigma_xx just outside the trailing edge [Pa]; (case,)."""
        contact, friction = self.contact, self._friction
        nodes = hankel.nodes(kinked=True)
        sine_moments = self.sines(nodes.b) @ (nodes.b * nodes.weights) / contact.pressed.units
        unit = friction.coefficient / contact.pressed.units[:, 0]
        first, third = edge_sums(self.density)
        moments = 2 * sine_moments - contact.loads / (2 * np.pi * contact.radius[:, None] ** 2)
        stress = rim.tension(moments, (unit * first, unit * third))
        if isinstance(body := contact.pressed.body, Film):

            def read(window: PointWindow, log_ratio: Array, cases: Indices) -> Array:
                tensions = sliding_window(window.kind, window.number, friction.punch).tensions(log_ratio)
                plain, slid = np.einsum("cmd,cd->mc", tensions, contact.state.causes[cases, 1:])
                return np.asarray(plain + friction.coefficient[cases] * slid)

            stress = stress + body.from_windows(contact.radius, read) * self._unit
        return np.asarray(stress)

    @property
    def angle(self) -> Array:
        """Angle theta = eta kappa / lambda of the half-space of the top, whose square is neglected; (case,)."""
        inverse = np.linalg.inv(self._response.compliance)
        return np.asarray(
            self._friction.coefficient * np.einsum("...i,...i->...", inverse[..., 0, :], self._response.coupling)
        )


class FirstOrderWarning(PrecisionWarning):
    """Sliding so rough that the neglected second order in friction matters."""


def warn_of_order(pressed: Pressed) -> None:
    """Warn by :class:`FirstOrderWarning` where friction is large, with the size of the neglected terms."""
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
