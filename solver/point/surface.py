"""Fields along the surface of point contacts, below the punch and outside (points, 5)."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from approximation.arrays import Indices
from approximation.chebyshev import coefficients
from solver.arrays import Array
from solver.cache import cached
from solver.halfplane.pressing import ContactError
from solver.point.body import Film
from solver.point.contact import PointContact, Pressed
from solver.point.friction import Rim
from solver.point.inside import Inside
from solver.point.profile import finite, halfspace_form
from solver.point.system import added_forms, added_means
from solver.point.table import PointKind, window
from solver.point.tractions import Tractions

_STRESSES = ("stress_xx", "stress_zz")


def added_stresses(contact: PointContact, positions: Array) -> Array:
    """Layers' contribution to sigma_rr and sigma_tt at r/a, SI, interpolated in log a; (case, 2, position)."""
    body = contact.pressed.body
    if not isinstance(body, Film):
        return np.zeros((contact.radius.size, 2, 1))
    key = tuple(positions.tolist())
    read = body.from_windows(
        contact.radius,
        lambda table, log_ratio, _: table.interval.read(log_ratio, _series(table.kind, table.number, key)),
    )
    causes = contact.state.causes * (contact.size / contact.radius)[:, None]
    return np.asarray(np.einsum("ckd,cd->ck", read.reshape(len(read), -1, 4), causes)).reshape(len(read), 2, -1)


@cached
def _series(kind: PointKind, number: int, positions: tuple[float, ...]) -> Array:
    """Chebyshev coefficients of the stresses per (u0, g) over C a^e; (node, stress and position and cause)."""
    table, inside, X = window(kind, number), Inside(kind.film), np.array(positions)
    stresses = [
        inside.of_layers(Tractions(np.full(4, ratio), table.density(node, np.eye(4)), np.zeros(4)), X, _STRESSES)
        for node, ratio in enumerate(np.exp(table.nodes).tolist())
    ]
    return coefficients(np.moveaxis(np.stack(stresses), 1, -1).reshape(len(stresses), -1))


@dataclass(frozen=True, eq=False)
class Along:
    """Fields of contacts along a line through the middle."""

    contact: PointContact
    positions: Array  # r/a with a sign; (position,)

    @property
    def _x(self) -> Array:
        """Return sqrt(1 - r^2/a^2) below the punch, 0 outside; (position,)."""
        return np.sqrt(np.maximum((1 - self.positions) * (1 + self.positions), 0.0))

    @property
    def _units(self) -> Array:
        """Unit of a traction in SI; (case, 3, 1)."""
        pressed = self.contact.pressed
        return np.asarray(((self.contact.size / self.contact.radius)[:, None] / pressed.units)[..., None])

    @property
    def _per_form(self) -> Array:
        """Half-space's bounded part per form of the pressure; (case, 3, 1)."""
        inverse = np.linalg.inv(self.contact.state.stiffness.compliance)
        return np.asarray(-2 / np.pi * inverse[..., :, :1])

    def _form(self) -> Array:
        """Form of the half-space's pressure; (position,)."""
        shape = self.contact.pressed.body.shape
        return np.zeros(self.positions.size) if shape.flat else halfspace_form(shape, self._x, np.abs(self.positions))

    def tractions(self) -> Array:
        """Tractions sigma_yy, D_y, B_y [Pa, C m-2, T]; (case, 3, position)."""
        below = np.flatnonzero(np.abs(self.positions) < 1)
        strength, x = self.contact.state.strengths[..., None], self._x[below]
        tractions = np.zeros((*strength.shape[:-1], self.positions.size))
        tractions[..., below] = strength / x + self._per_form * self._form()[below]
        for cases, series in self._layers():
            forms = added_forms(x, series.shape[-1])
            tractions[cases[:, None, None], np.arange(3)[:, None], below] += series @ forms.T
        return np.asarray(tractions * self._units)

    def _layers(self) -> Iterator[tuple[Indices, Array]]:
        """Yield cases and their layers' coefficients, whose strength is in the half-space's part."""
        contact = self.contact
        if isinstance(film := contact.pressed.body, Film):
            for cases, table, log_ratio in film.windows(contact.radius):
                yield cases, table.tractions(log_ratio, contact.state.causes[cases])

    def means(self) -> Array:
        """Return int_0^r t s ds / r^2, half the mean traction within r; (case, 3, position)."""
        e, x = self.contact.pressed.body.shape.exponent, self._x
        within = 1 / (1 + x)
        form = (self.contact.pressed.body.shape.rise * e * within + self._form()) / (e + 1)
        beyond = 1 / np.maximum(np.abs(self.positions), 1.0) ** 2
        means = self.contact.state.strengths[..., None] * within + self._per_form * form
        for cases, series in self._layers():
            means[cases] += series @ added_means(x, series.shape[-1]).T
        return np.asarray(means * beyond * self._units)

    def stresses(self, rim: Rim) -> dict[str, Array]:
        """Stresses sigma_rr and sigma_tt [Pa] of the half-space of the top; (case, position) each."""
        tractions = self.tractions()
        dilation = -np.einsum("...j,...jp->...p", rim.coupling, tractions)
        hoop = -np.einsum("...j,...jp->...p", rim.coupling, self.means())
        shear = rim.shear[..., None]
        pressed = np.einsum("...j,...jp->...p", rim.share, tractions)
        common = (rim.stiffness[..., None] - shear) * dilation + pressed
        return {"radial_stress": common + shear * (dilation - hoop), "hoop_stress": common + shear * hoop}


def surface_fields(pressed: Pressed, positions: Array, rim: Rim | None = None) -> dict[str, Array]:
    """Fields of ``solver.fields.POINT_FIELDS`` that every case has, SI; (case, position) each."""
    shape = pressed.body.shape
    if not (shape.flat or finite(shape)) and np.any(positions == 0):
        raise ContactError(f"positions: the pressure of r^{shape.exponent:g} is infinite at 0; leave 0 out")
    along = Along(pressed.charged, positions)
    normal, electric, magnetic = np.moveaxis(along.tractions(), 1, 0)
    out = {"contact_pressure": 0.0 - normal, "electric_displacement": electric, "magnetic_induction": magnetic}
    if isinstance(pressed.body, Film) and pressed.body.kind.film.electroded:
        del out["electric_displacement"]  # it is the electrode's, also outside the punch
    if rim is None:
        return out
    added = added_stresses(along.contact, positions)
    return out | {
        name: halfspace_stress + added[:, number]
        for number, (name, halfspace_stress) in enumerate(along.stresses(rim).items())
    }
