"""Cases on a half-plane: from their factors to the contact, and to outputs by name."""

from collections.abc import Sequence, Set

import numpy as np

from solver.arrays import Array, BoolArray
from solver.face.body import Body
from solver.face.cases import Cases
from solver.face.materials import half_plane_of, material_of, punch_datum, punch_of
from solver.face.refusal import CaseError, FactorError
from solver.halfplane.contact import Contact
from solver.halfplane.fields import surface_fields
from solver.halfplane.interior import LINEAR, POTENTIALS, interior_parts, potentials
from solver.halfplane.peaks import body_curves, peaks
from solver.halfplane.precision import warn_of_rounding
from solver.halfplane.pressing import ContactError
from solver.halfplane.quantities import quantities
from solver.halfplane.sliding import Sliding
from solver.halfplane.speed import limiting_speed
from solver.material.constants import Material
from solver.names import PEAKS


class OnHalfPlane(Body):
    """Contact of cases of one kind on a half-plane; each output has the smallest shape that it needs."""

    hollow = False

    def __init__(self, cases: Cases) -> None:
        super().__init__(cases)
        self.contact = contact_of(cases)
        warn_of_rounding(self.contact.halfplane.distinct)

    @np.errstate(all="ignore")  # here and below: values that are not finite are reported with the outputs
    def quantities(self) -> dict[str, Array]:
        """Quantities of ``solver.names.QUANTITIES`` that every case has; (...)."""
        return quantities(self.contact, self.cases.number("datum"), punch_datum(self.cases))

    def peaks(self, requested: Set[str]) -> dict[str, Array]:
        """Requested quantities of ``solver.names.PEAKS``; (...)."""
        names = [name for name in PEAKS if name in requested]
        if names:
            self._require_c12(f"{names[0]} needs")
        return peaks(self.contact, requested)

    @np.errstate(all="ignore")
    def curves(self, regions: Sequence[str]) -> dict[str, Array]:
        """Sizes and, if requested, curves of the region ``body``; (...) and (..., point)."""
        self._require_c12("peak_von_mises needs")
        half = self.contact.half_width
        sizes = {"mean_pressure": self.contact.load / (2 * half), "half_length": half}
        return sizes | (body_curves(self.contact) if "body" in regions else {})

    def _surface(self, positions: Array, regular: bool) -> dict[str, Array]:
        return surface_fields(self.contact, positions, regular=regular)

    def _interior(self, x: Array, y: Array, names: tuple[str, ...]) -> dict[str, Array]:
        linear = tuple(name for name in LINEAR if name in names)
        points_y, points_x = (points.ravel() for points in np.meshgrid(y, x, indexing="ij"))
        fields = interior_parts(self.contact, points_x, points_y, linear).whole(self.contact)
        values = {name: fields[..., k, :] for k, name in enumerate(linear)}
        if set(POTENTIALS) & set(names):
            electric_and_magnetic = potentials(self.contact, points_x, points_y, self.cases.number("datum"))
            values |= {name: electric_and_magnetic[..., k, :] for k, name in enumerate(POTENTIALS)}
        return {name: values[name].reshape(*values[name].shape[:-1], y.size, x.size) for name in values}

    @property
    def _lacks_c12(self) -> str | None:
        material = self.contact.halfplane.material
        return material.name if np.any(np.isnan(material.c12)) else None


@np.errstate(all="ignore")
def contact_of(cases: Cases) -> Contact:
    """Return the contact of cases with its extent."""
    if np.any(speed := cases.number("speed")):
        _refuse_fast(material_of(cases), cases.conducts, speed)
    sliding = Sliding(half_plane_of(cases), cases.number("friction"), cases.conducts, punch_of(cases))
    contact = Contact(sliding, cases.profile, cases.force, cases.charges)
    try:
        _ = contact.pressing
    except ContactError as error:
        raise CaseError(str(error)) from None
    return contact


def _refuse_fast(material: Material, conducts: BoolArray, speed: Array) -> None:
    """Refuse speeds (...) [m/s] at or above the limiting one."""
    if np.any(np.isnan(material.rho)):
        raise FactorError(f"speed: needs the density rho [kg m-3] of {material.name}")
    V, limit = np.broadcast_arrays(speed, limiting_speed(material, conducts))
    if np.any(bad := limit <= V):
        raise CaseError(f"speed: {V[bad].flat[0]:g} m/s is not below the limiting speed {limit[bad].flat[0]:.6g} m/s")
