"""Cases of one kind of punch on one kind of body, in SI: contacts with charges, without, and at zero potential."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, BoolArray
from solver.point.body import Film, HalfSpace, PointLoading
from solver.point.profile import SAMPLES, halfspace_form, halfspace_peak, highest_pressure
from solver.point.state import PressedState
from solver.point.system import added_forms
from solver.stack.electrodes import Reading


@dataclass(frozen=True, eq=False)
class Friction:
    """Friction along x, and the tangential coupling of the surfaces."""

    coefficient: Array  # eta; (case,)
    coupling: Array  # k of the half-space of the top less that of the punch, units of the body; (case, 3)
    punch: float = 0.0  # k_p of the punch [1/Pa], 0 of a rigid one; the same on one film


@dataclass(frozen=True, eq=False)
class Pressed:
    """Punches of revolution, pressed by forces."""

    body: HalfSpace | Film
    scale: Array  # Units of (x, y, phi, psi) of the body; (4,) or (case, 4)
    coefficient: Array  # C of the profile C r^e, or the radius of a disc [m]; (case,)
    force: Array  # P [N]; (case,)
    charges: Array  # T [C] and J [Wb]; (case, 2)
    conducts: BoolArray  # Whether the punch conducts (electric, magnetic); (2,) or (case, 2)
    reading: Reading | None = None  # Electrode that is read; None: none
    friction: Friction | None = None  # None: the punch does not slide

    @property
    def units(self) -> Array:
        """Units of (y, phi, psi); (case, 3)."""
        return np.broadcast_to(self.scale[..., 1:], (self.force.size, 3))

    def _contact(self, charges: Array, *, grounded: bool = False) -> "PointContact":
        """Contacts under charges T [C] and J [Wb], (case, 2), or with both potentials held at zero."""
        unit, shape = self.units[:, 0], self.body.shape
        loading = PointLoading(self.coefficient / unit, self.force * unit, charges * self.units[:, 1:], grounded)
        radius = self.coefficient if shape.flat else self.body.radius(loading)
        return PointContact(self, radius, loading.state(self.body.stiffness(radius), shape, radius))

    @property
    def length(self) -> Array:
        """Unit of the body's lengths [m]: the thickness of its top layer, or the contact radius; (case,)."""
        return self.body.thickness if isinstance(self.body, Film) else self.charged.radius

    @cached_property
    def charged(self) -> "PointContact":
        """Contacts with the charges of the cases."""
        return self._contact(self.charges)

    @cached_property
    def uncharged(self) -> "PointContact":
        """Contacts without charges."""
        return self._contact(np.zeros_like(self.charges)) if np.any(self.charges) else self.charged

    @cached_property
    def grounded(self) -> "PointContact":
        """Contacts with both potentials held at zero."""
        return self._contact(np.zeros_like(self.charges), grounded=True)


@dataclass(frozen=True, eq=False)
class PointContact:
    """Contacts of known radii, SI."""

    pressed: Pressed
    radius: Array  # a [m]; (case,)
    state: PressedState

    @property
    def size(self) -> Array:
        """C a^e, 1 for a disc, in the units of the body; (case,)."""
        shape = self.pressed.body.shape
        if shape.flat:
            return np.ones_like(self.radius)
        return self.pressed.coefficient / self.pressed.units[:, 0] * self.radius**shape.exponent

    @property
    def displacement(self) -> Array:
        """Displacement u0 = (-depth, V, Psi) [m, V, A]; (case, 3)."""
        return self.state.displacement * self.size[:, None] * self.pressed.units

    @property
    def loads(self) -> Array:
        """Loads (P, T, J) [N, C, Wb]; (case, 3)."""
        return self.state.loads * (self.size * self.radius)[:, None] / self.pressed.units

    @property
    def intensities(self) -> Array:
        """Edge intensities lim sqrt(2 pi distance) (sigma_yy, D_y, B_y), SI; (case, 3)."""
        strength = self.state.strengths * (self.size / self.radius)[:, None]
        return np.asarray(np.sqrt(np.pi * self.radius)[:, None] * strength / self.pressed.units)

    @property
    def tangent(self) -> Array:
        """Return -d(P, T, J) / d(-depth, V, Psi), SI; (case, 3, 3)."""
        return self._in_units(self.state.tangent, self.pressed.units)

    @property
    def fixed(self) -> Array:
        """Return -d(T, J) / d(V, Psi) at a fixed contact, SI; (case, 2, 2)."""
        return self._in_units(self.state.fixed, self.pressed.units[:, 1:])

    def _in_units(self, values: Array, units: Array) -> Array:
        return np.asarray(values * self.radius[:, None, None] / (units[:, :, None] * units[:, None, :]))

    @property
    def peak_pressure(self) -> Array:
        """Largest pressure below a curved punch [Pa]; (case,)."""
        body = self.pressed.body
        per_form: Array = np.asarray(2 / np.pi * np.linalg.inv(self.state.stiffness.compliance)[..., 0, 0])
        if isinstance(body, HalfSpace):
            over_unit = per_form * halfspace_peak(body.shape)
        else:
            over_unit = self._peak_on(body, per_form)
        return np.asarray(over_unit * self.size / self.radius / self.pressed.units[:, 0])

    def _peak_on(self, film: Film, per_form: Array) -> Array:
        """Largest pressure over C a^(e-1) on a film; (case,)."""
        largest = np.empty_like(self.radius)
        for cases, table, log_ratio in film.windows(self.radius):
            closed, series = per_form[cases], table.tractions(log_ratio, self.state.causes[cases])[:, 0]
            count = series.shape[-1]

            def pressure(x: Array, rows: Indices, closed: Array = closed, series: Array = series) -> Array:
                added = np.sum(series[rows] * added_forms(x, series.shape[-1]), -1)
                return np.asarray(closed[rows] * halfspace_form(film.shape, x) - added)

            samples = closed[:, None] * halfspace_form(film.shape, SAMPLES) - series @ added_forms(SAMPLES, count).T
            largest[cases] = highest_pressure(samples, pressure)
        return largest
