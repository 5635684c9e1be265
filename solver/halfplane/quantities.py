"""Quantities of ``solver.names.QUANTITIES`` of a contact, from its closed forms (theory, section 6)."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array, dot
from solver.halfplane.contact import Contact
from solver.halfplane.shape import Shape
from solver.names import RESPONSES
from solver.twoport import Compliance


@dataclass(frozen=True, eq=False)
class Response:
    """Response of the punch, by displacement and potentials J = (u_y, phi, psi) at the trailing edge; (...) each.

    u_J(a) = P [N_J0 log(h / 2L) / pi + B_J] + (N_J1 T + N_J2 J) log(h / 2L) / pi, void for fields not conducted.
    """

    contact: Contact
    datum: Array  # L [m]
    punch_datum: Array | None = None  # Reference length of an elastic punch [m]; by default L

    @cached_property
    def log_width(self) -> Array:
        """Logarithm of h / 2L; (...)."""
        return np.log(self.contact.half_width / (2 * self.datum))

    def _moments(self, shape: Shape) -> tuple[Array, Array]:
        """Logarithmic moment, and follower moment times eta, over pi int S; (...)."""
        total = np.pi * self.contact.shape.total
        return shape.logarithmic_moment / total, self.contact.friction * shape.follower_moment / total

    def _constants(self, logarithmic: Array, follower: Array) -> list[Array]:
        """B_J from the moments of :meth:`_moments`, or d (P B_J) / dP from their rates; (...) each."""
        sliding, constants = self.contact.sliding, []
        for J in range(3):
            along = sliding.coupling[..., J] - sliding.friction_coupling[..., J]
            constant = along * follower - self.contact.friction * (sliding.coupling[..., J] / 2)
            pressed = sliding.normal_compliance[..., J]
            constants.append(constant + pressed * logarithmic if np.any(pressed) else constant)
        return constants

    @cached_property
    def _load_constants(self) -> list[Array]:
        """Constants B_J; (...) each."""
        return self._constants(*self._moments(self.contact.shape))

    @cached_property
    def _load_constant_rates(self) -> list[Array]:
        """Derivatives d (P B_J) / dP; (...) each."""
        if self.contact.profile.homogeneous:
            return self._load_constants  # contacts under all loads are similar
        pressing = self.contact.pressing
        pairs = zip(*(self._moments(shape) for shape in (pressing.shape, pressing.shape_rate)), strict=True)
        return self._constants(*(pressing.width_rate * moment + rate for moment, rate in pairs))

    @property
    def _datum_part(self) -> Array:
        """Change of u_y(a) / P due to an elastic punch's separate datum; (...)."""
        if self.punch_datum is None:
            return np.zeros(())
        return self.contact.sliding.punch.compliance / np.pi * np.log(self.datum / self.punch_datum)

    def _displacement(self, J: int) -> Array:
        """Displacement or potential u_J(a); (...)."""
        c, N = self.contact, self.contact.sliding.compliance
        displacement = self._load_parts[J] * c.load
        if np.any(c.charges):
            displacement = displacement + dot(N[..., J, 1:], c.charges) / np.pi * self.log_width
        return np.asarray(displacement)

    @cached_property
    def _load_parts(self) -> list[Array]:
        """u_J(a) / P without charges; (...) each."""
        N = self.contact.sliding.compliance
        parts = [N[..., J, 0] / np.pi * self.log_width + self._load_constants[J] for J in range(3)]
        return [parts[0] + self._datum_part, *parts[1:]]

    @cached_property
    def _load_tangents(self) -> list[Array]:
        """d u_J(a) / dP without charges; (...) each."""
        N, width = self.contact.sliding.compliance, (self.log_width + self.contact.pressing.width_rate) / np.pi
        tangents = [N[..., J, 0] * width + self._load_constant_rates[J] for J in range(3)]
        return [tangents[0] + self._datum_part, *tangents[1:]]

    def _charged_tangent(self, J: int) -> Array:
        """d u_J(a) / dP at the charges of the case; (...)."""
        c, N = self.contact, self.contact.sliding.compliance
        if not np.any(c.charges):
            return self._load_tangents[J]
        width_rate = c.pressing.width_rate / np.pi
        return np.asarray(self._load_tangents[J] + dot(N[..., J, 1:], c.charges) * width_rate / c.load)

    @property
    def depth(self) -> Array:
        """Approach g(a) - u_y(a) of the punch's origin, relative to the datum [m]; (...)."""
        return self.contact.pressing.rise - self._displacement(0)

    def responses(self, field: int) -> tuple[Array, ...]:
        """Quantities of a field in the order of ``RESPONSES``, relative to the datum, SI; (...) each."""
        c, N, j = self.contact, self.contact.sliding.compliance, 1 + field
        depth_tangent = c.pressing.rise_rate / c.load - self._charged_tangent(0)
        # derivatives by the charge without the factor log_width/pi, which cancels in the ratios
        port = Compliance(depth_tangent, -N[..., 0, j], self._charged_tangent(j), N[..., j, j])
        per_load = -np.pi * self._load_parts[j] / (N[..., j, j] * self.log_width)
        return self._displacement(j), self._load_tangents[j], per_load, port.stroke, port.blocked_force


def quantities(contact: Contact, datum: Array, punch_datum: Array | None = None) -> dict[str, Array]:
    """Quantities that all cases have, each in its smallest shape, without those infinite at a corner."""
    response = Response(contact, datum, punch_datum)
    out = {
        "contact_trailing": contact.trailing,
        "contact_leading": contact.leading,
        "pressure_exponent": contact.exponent,
        "depth": response.depth,
    }
    smooth = contact.profile.smooth
    if all(smooth):
        out["peak_pressure"] = contact.peak_pressure
    out |= at_edges(smooth, contact.edge_stress, contact.edge_intensity)
    for field, names in enumerate(RESPONSES):
        if contact.sliding.conducts[..., field].all():
            out |= dict(zip(names, response.responses(field), strict=False))
    return out


def at_edges(
    smooth: tuple[bool, bool], stress: Callable[[float], Array] | None, intensity: Callable[[float], Array]
) -> dict[str, Array]:
    """Stresses and edge intensities at the smooth edges of a contact, by name; (...) each."""
    out = {}
    for end, stretch, edge, is_smooth in (
        ("trailing", "trailing_tension", 1.0, smooth[0]), ("leading", "leading_compression", -1.0, smooth[1]),
    ):  # fmt: skip
        if is_smooth:
            if stress is not None:
                out[stretch] = stress(edge)
            intensities = intensity(edge)
            out[f"electric_edge_intensity_{end}"] = intensities[..., 0]
            out[f"magnetic_edge_intensity_{end}"] = intensities[..., 1]
    return out
