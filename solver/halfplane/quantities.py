"""Every quantity of ``solver.names.QUANTITIES`` that a contact has, from its closed forms."""

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
    """Response of the punch; scalars per case, shapes as small as each needs.

    What belongs to the potential of a field means nothing where the punch does not conduct that field.
    """

    contact: Contact
    datum: Array
    punch_datum: Array | None = None

    @cached_property
    def log_width(self) -> Array:
        """ell = log(h / 2L)."""
        return np.log(self.contact.half_width / (2 * self.datum))

    def _bracket(self, shape: Shape) -> Array:
        """The bracket of B_J over pi int S; (..., 3)."""
        sliding = self.contact.sliding
        along = sliding.coupling - sliding.friction_coupling
        follower = (sliding.friction * shape.follower_moment)[..., None]
        pressed = sliding.normal_compliance * shape.logarithmic_moment[..., None]
        return (pressed + along * follower) / (np.pi * self.contact.shape.total)[..., None]

    @cached_property
    def _load_constant(self) -> Array:
        """B_J; (..., 3)."""
        return self._bracket(self.contact.shape) - self._shear_part

    @property
    def _shear_part(self) -> Array:
        """eta k_J / 2; (..., 3)."""
        return self.contact.friction[..., None] * self.contact.sliding.coupling / 2

    @property
    def _datum_part(self) -> Array:
        """Change of u_y(a) / P by an elastic punch's separate datum; (...)."""
        if self.punch_datum is None:
            return np.zeros(())
        return self.contact.sliding.punch.compliance / np.pi * np.log(self.datum / self.punch_datum)

    @cached_property
    def _load_constant_rate(self) -> Array:
        """d (P B_J) / dP; (..., 3)."""
        pressing = self.contact.pressing
        widened = pressing.width_rate[..., None] * self._bracket(self.contact.shape)
        return widened + self._bracket(pressing.shape_rate) - self._shear_part

    def _displacement(self, J: int) -> Array:
        """u_J(a)."""
        c, N = self.contact, self.contact.sliding.compliance
        charge_part = dot(N[..., J, 1:], c.charges) / np.pi
        return np.asarray(self._load_part(J) * c.load + charge_part * self.log_width)

    def _load_part(self, J: int) -> Array:
        """u_J(a) / P without charges."""
        N = self.contact.sliding.compliance
        part = N[..., J, 0] / np.pi * self.log_width + self._load_constant[..., J]
        return part if J else part + self._datum_part

    def _load_tangent(self, J: int, *, charged: bool) -> Array:
        """d u_J(a) / dP, with or without the charges of the case."""
        c, N = self.contact, self.contact.sliding.compliance
        width_rate = c.pressing.width_rate / np.pi
        tangent = N[..., J, 0] * (self.log_width / np.pi + width_rate) + self._load_constant_rate[..., J]
        if J == 0:
            tangent = tangent + self._datum_part
        if charged:
            tangent = tangent + dot(N[..., J, 1:], c.charges) * width_rate / c.load
        return np.asarray(tangent)

    @property
    def depth(self) -> Array:
        """g(a) - u_y(a): approach of the punch, at its origin, relative to the datum [m]."""
        return self.contact.pressing.rise - self._displacement(0)

    @cached_property
    def _depth_tangent(self) -> Array:
        """d depth / dP at fixed charges [m2/N]."""
        c = self.contact
        return c.pressing.rise_rate / c.load - self._load_tangent(0, charged=True)

    def potential(self, field: int) -> Array:
        """Electric [V] (field 0) or magnetic [A] (field 1) potential of the punch relative to the datum."""
        return self._displacement(1 + field)

    def sensitivity(self, field: int) -> Array:
        """d potential / d load without charges [V m/N, A m/N]."""
        return self._load_tangent(1 + field, charged=False)

    def short_circuit(self, field: int) -> Array:
        """Charge per load that makes the potential 0, the other charge 0 [C/N, Wb/N]."""
        N = self.contact.sliding.compliance
        return -np.pi * self._load_part(1 + field) / (N[..., 1 + field, 1 + field] * self.log_width)

    def two_port(self, field: int) -> Compliance:
        """Compliance of a field; its derivatives in the charge lack log_width/pi, on which no ratio of them depends."""
        N = self.contact.sliding.compliance
        return Compliance(
            self._depth_tangent,
            -N[..., 0, 1 + field],
            self._load_tangent(1 + field, charged=True),
            N[..., 1 + field, 1 + field],
        )

    def stroke(self, field: int) -> Array:
        """Depth per potential at fixed load and other charge [m/V, m/A]; a constant of the material."""
        return self.two_port(field).stroke

    def blocked_load(self, field: int) -> Array:
        """Load per potential at fixed depth and other charge [N/(m V), N/(m A)]."""
        return self.two_port(field).blocked_force


def quantities(contact: Contact, datum: Array, punch_datum: Array | None = None) -> dict[str, Array]:
    """Each quantity in the smallest shape that it needs.

    A quantity that means nothing for some of the cases is left out for all: the response of a field that a punch does
    not conduct, and what is infinite at a corner (the pressure, edge intensities and edge stresses).
    """
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
    answers = response.potential, response.sensitivity, response.short_circuit, response.stroke, response.blocked_load
    for field, names in enumerate(RESPONSES):
        if contact.sliding.conducts[..., field].all():
            out |= {name: answer(field) for name, answer in zip(names, answers, strict=False)}
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
            out[f"electric_edge_intensity_{end}"], out[f"magnetic_edge_intensity_{end}"] = (
                intensities[..., 0],
                intensities[..., 1],
            )
    return out
