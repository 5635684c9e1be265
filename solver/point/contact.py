"""Cases of one kind of punch on one kind of body, in SI: contacts with charges, without, and at zero potential."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array, BoolArray
from solver.point.body import Film, HalfSpace, Loading
from solver.point.profile import SAMPLES, climbed, halfspace_form, halfspace_peak
from solver.point.state import State
from solver.point.table import Window
from solver.stack.electrodereading import Reading


@dataclass(frozen=True, eq=False)
class Friction:
    """What slides along x, and what the surfaces do of it."""

    coefficient: Array  # eta; (case,)
    coupling: Array  # k of the half-space of the top less that of the punch, units of the body; (case, 3)
    punch: float = 0.0  # k_p of the punch [1/Pa], 0 of a rigid one; the same on one film


@dataclass(frozen=True, eq=False)
class Pressed:
    """Punches of revolution, pressed by forces."""

    body: HalfSpace | Film
    scale: Array
    coefficient: Array
    force: Array
    charges: Array
    conducts: BoolArray
    reading: Reading | None = None
    friction: Friction | None = None

    @property
    def units(self) -> Array:
        """Units of (y, phi, psi); (case, 3)."""
        return np.broadcast_to(self.scale[..., 1:], (self.force.size, 3))

    def contact(self, charges: Array | None = None, held: tuple[bool, bool] = (False, False)) -> "Contact":
        """The contacts under charges, or potentials where held; without any by default.

        charges: (case, 2), T [C] and J [Wb], or V and Psi where held; None: zero.
        """
        flat = self.body.shape.flat
        given = np.zeros((self.force.size, 2)) if charges is None else charges
        units = self.units[:, 1:]
        own = np.where(held, given / units, given * units)
        loading = Loading(self.coefficient / self.units[:, 0], self.force * self.units[:, 0], own, held)
        radius = self.coefficient if flat else self.body.radius(loading)
        return Contact(self, radius, loading.state(self.body.stiffness(radius), self.body.shape, radius))

    @property
    def length(self) -> Array:
        """The unit of the body's lengths [m]: the thickness of its top layer, or the contact radius; (case,)."""
        return self.body.thickness if isinstance(self.body, Film) else self.charged.radius

    @cached_property
    def charged(self) -> "Contact":
        """With the charges of the cases."""
        return self.contact(self.charges)

    @cached_property
    def uncharged(self) -> "Contact":
        """Without charges."""
        return self.contact() if np.any(self.charges) else self.charged

    @cached_property
    def grounded(self) -> "Contact":
        """With both potentials held at zero."""
        return self.contact(held=(True, True))


@dataclass(frozen=True, eq=False)
class Contact:
    """Contacts of known radii."""

    pressed: Pressed
    radius: Array
    state: State

    @property
    def size(self) -> Array:
        """C a^e, 1 of a disc, in the units of the body; (case,)."""
        shape = self.pressed.body.shape
        if shape.flat:
            return np.ones_like(self.radius)
        return self.pressed.coefficient / self.pressed.units[:, 0] * self.radius**shape.exponent

    @property
    def displacement(self) -> Array:
        """u0 = (-depth, V, Psi) [m, V, A]; (case, 3)."""
        return self.state.displacement * self.size[:, None] * self.pressed.units

    @property
    def loads(self) -> Array:
        """(P, T, J) [N, C, Wb]; (case, 3)."""
        return self.state.loads * (self.size * self.radius)[:, None] / self.pressed.units

    @property
    def intensities(self) -> Array:
        """Edge intensities lim sqrt(2 pi distance) (sigma_yy, D_y, B_y), SI; (case, 3)."""
        strength = self.state.strengths * (self.size / self.radius)[:, None]
        return np.asarray(np.sqrt(np.pi * self.radius)[:, None] * strength / self.pressed.units)

    @property
    def tangent(self) -> Array:
        """-d(P, T, J) / d(-depth, V, Psi), SI; (case, 3, 3)."""
        return self._in_units(self.state.tangent, self.pressed.units)

    @property
    def fixed(self) -> Array:
        """-d(T, J) / d(V, Psi) at a fixed contact, SI; (case, 2, 2)."""
        return self._in_units(self.state.fixed, self.pressed.units[:, 1:])

    def _in_units(self, values: Array, units: Array) -> Array:
        return np.asarray(values * self.radius[:, None, None] / (units[:, :, None] * units[:, None, :]))

    @property
    def peak_pressure(self) -> Array:
        """Largest pressure below a curved punch [Pa]; (case,)."""
        body = self.pressed.body
        of_one: Array = np.asarray(2 / np.pi * np.linalg.inv(self.state.stiffness.compliance)[..., 0, 0])
        own = of_one * halfspace_peak(body.shape) if isinstance(body, HalfSpace) else self._peak_on(body, of_one)
        return np.asarray(own * self.size / self.radius / self.pressed.units[:, 0])

    def _peak_on(self, film: Film, of_one: Array) -> Array:
        """Largest pressure over C a^(e-1) on a film: at the centre, or else climbed to."""
        causes, form = self.state.causes, halfspace_form(film.shape, SAMPLES)
        added = film.gathered(self.radius, lambda of, at, places: of.pressures(at, causes[places]))
        values = of_one[:, None] * form + added
        best = np.argmax(values, -1)
        found = values[np.arange(best.size), best]
        beside = np.flatnonzero(best < SAMPLES.size - 1)
        for places, of, log_ratio in film.part(beside).windows(self.radius[beside]):
            some = beside[places]
            between = SAMPLES[np.maximum(best[some] - 1, 0)], SAMPLES[best[some] + 1]
            found[some] = self._climbed(of, log_ratio, causes[some], of_one[some], between)
        return np.asarray(found)

    def _climbed(self, of: Window, at: Array, causes: Array, of_one: Array, between: tuple[Array, Array]) -> Array:
        added = of.terms.between(of.tractions(at, causes)[:, 0], *between)

        def pressure(x: Array) -> Array:
            return np.asarray(of_one * halfspace_form(of.kind.shape, x) - added(x))

        return climbed(pressure, *between)
